// The way into kinematics: axes to motors and back. Linear axis definitions (#1->1000X) are rows of a matrix; stock robots stand behind
// the interface of robot.h. Nothing here knows the compiler or the runtime.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pmac::kinematics {

inline constexpr int kAxisCount = 32;
using AxisVector = std::array<double, kAxisCount>;  // _uu, by axis index

/// How one motor of a coordinate system gets its position.
struct MotorDefinition {
  enum class Kind { kLinear, kNull, kInverse, kSpindle };
  int motor = 0;
  Kind kind = Kind::kLinear;
  AxisVector coefficient_mu_uu{};  // of kLinear: motor_mu = sum(coefficient * axis) + offset
  double offset_mu = 0;
};

/// The axis definitions of one coordinate system, as a linear map and its inverse.
///
/// Forward here means motors to axes: the least-squares solution of the defined axes, which is exact for square systems; where
/// several motors follow the same combination of axes (gantry) the lowest motor decides. Source: axis definition statements,
/// User's Manual p501-510.
class AxisMap {
 public:
  AxisMap() = default;
  explicit AxisMap(std::vector<MotorDefinition> definitions);

  const std::vector<MotorDefinition>& definitions() const { return definitions_; }
  /// Axes that a linear definition names, as a mask of axis indices.
  std::uint32_t linear_axes() const { return linear_axes_; }
  bool has_inverse_motors() const;
  /// The linear definitions determine every axis they name (Coord[].Csolve).
  bool solvable() const { return solvable_; }
  /// Why not, for the user; empty when solvable.
  const std::string& reason() const { return reason_; }

  /// motor_mu[i] of definitions()[i]; motors that are not linear are left alone.
  void motors_from_axes(const AxisVector& axis_uu, std::span<double> motor_mu) const;
  /// Overwrites the axes in linear_axes() with the solution. Only when solvable().
  void axes_from_motors(std::span<const double> motor_mu, AxisVector& axis_uu) const;
  /// The same for samples side by side: one axis, from the rows of definitions()[i] (count samples each), into axis_uu. False where the
  /// axis is none of linear_axes(); nothing is written then.
  bool axis_row_from_motor_rows(int axis, std::span<const double* const> motor_mu, std::span<double> axis_uu) const;
  /// The same of velocities (or any derivative): offsets do not count.
  void motor_rates_from_axis_rates(const AxisVector& axis_rate, std::span<double> motor_rate) const;
  void axis_rates_from_motor_rates(std::span<const double> motor_rate, AxisVector& axis_rate) const;

 private:
  void solve();
  std::vector<MotorDefinition> definitions_;
  std::uint32_t linear_axes_ = 0;
  bool solvable_ = true;                 // nothing defined: nothing to solve
  std::string reason_;
  std::vector<int> axes_;                // column -> axis index
  std::vector<int> rows_;                // row -> definition index of the motors that decide
  std::vector<double> inverse_uu_mu_;    // row-major [axis column][row]
};

/// Shoulder, elbow, wrist and vertical motor of a SCARA arm, degrees and mm.
struct ScaraPose { double x_mm, y_mm, z_mm, c_deg; };
struct ScaraJoints { double shoulder_deg, elbow_deg, wrist_deg, vertical_mm; };
struct ScaraGeometry { double upper_arm_mm = 400, forearm_mm = 300, vertical_offset_mm = 250; };
enum class ScaraArm { kElbowPositive, kElbowNegative };

/// x = L1 cos m1 + L2 cos(m1+m2), y likewise with sin, c = m1+m2+m3, z = m4 + offset.
ScaraPose scara_forward(const ScaraGeometry&, const ScaraJoints&);
/// Law of cosines at elbow and shoulder; nullopt where the target is out of reach or at the shoulder.
std::optional<ScaraJoints> scara_inverse(const ScaraGeometry&, const ScaraPose&, ScaraArm);

}  // namespace pmac::kinematics
