// Angles, rotations and the point at one distance from three others.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Dense>

namespace pmac::kinematics::stock {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline double rad_from_deg(double deg) { return deg * kRadPerDeg; }
inline double deg_from_rad(double rad) { return rad / kRadPerDeg; }

/// deg plus whole turns: the value nearest to near_deg.
inline double turned_near(double deg, double near_deg) { return deg + 360 * std::round((near_deg - deg) / 360); }

inline Eigen::Matrix3d turn_x(double deg) { return Eigen::AngleAxisd(rad_from_deg(deg), Eigen::Vector3d::UnitX()).toRotationMatrix(); }
inline Eigen::Matrix3d turn_y(double deg) { return Eigen::AngleAxisd(rad_from_deg(deg), Eigen::Vector3d::UnitY()).toRotationMatrix(); }
inline Eigen::Matrix3d turn_z(double deg) { return Eigen::AngleAxisd(rad_from_deg(deg), Eigen::Vector3d::UnitZ()).toRotationMatrix(); }

/// Angles about fixed X, then Y, then Z.
struct Angles { double a_deg, b_deg, c_deg; };
inline Eigen::Matrix3d rotation(const Angles& angles) { return turn_z(angles.c_deg) * turn_y(angles.b_deg) * turn_x(angles.a_deg); }
/// b within +-90 degrees. At b = +-90 degrees only a -+ c is determined; there c is 0.
inline Angles angles_of(const Eigen::Matrix3d& r) {
  const double cos_b = std::hypot(r(0, 0), r(1, 0));
  const double b_deg = deg_from_rad(std::atan2(-r(2, 0), cos_b));
  if (cos_b < 1e-12) return {deg_from_rad(std::atan2(-r(1, 2), r(1, 1))), b_deg, 0};
  return {deg_from_rad(std::atan2(r(2, 1), r(2, 2))), b_deg, deg_from_rad(std::atan2(r(1, 0), r(0, 0)))};
}

/// The lower of the two points at `distance` from three centres: below the circumcentre of their triangle, along its normal.
/// nullopt: the centres are on a line, or too far from one another.
inline std::optional<Eigen::Vector3d> lower_point(const Eigen::Matrix3d& centres, double distance) {
  const Eigen::Vector3d a = centres.col(1) - centres.col(0), b = centres.col(2) - centres.col(0);
  Eigen::Vector3d normal = a.cross(b);
  const double area2 = normal.squaredNorm();
  if (!(area2 > 0)) return std::nullopt;
  const Eigen::Vector3d to_middle = (a.squaredNorm() * b - b.squaredNorm() * a).cross(normal) / (2 * area2);
  const double height2 = distance * distance - to_middle.squaredNorm();
  if (!(height2 >= 0)) return std::nullopt;
  if (normal.z() > 0) normal = -normal;
  return centres.col(0) + to_middle + normal * std::sqrt(height2 / area2);
}

}  // namespace pmac::kinematics::stock
