// The geometry of one move in axis space, without time: a straight line of all its axes, or an arc of three of them (helix and
// spiral included) with the others running along. The parameter u goes from 0 at the start to 1 at the end.
//
//   line    p(u) = start + u * delta
//   pvt     a cubic of u in every axis, with given rates at both ends
//   arc     as a line in every axis outside the plane, and in the plane
//           p(u) = center + (radius + u * radius_change) * (radial cos(u * sweep) + tangential sin(u * sweep))
#pragma once

#include <array>
#include <memory>

#include "runtime/motion/types.h"

namespace pmac::motion {

/// Axis indices of the two circle sets.
inline constexpr int kAxisX = 6, kAxisXX = 29;

/// What a pvt curve has besides its ends: derivatives with respect to u there.
struct EndRates { AxisVector start{}, end{}; };

struct Curve {
  AxisVector start{}, end{};    // every axis, also those that do not move
  AxisVector delta{};           // of the part that is linear in u; for an arc its component along the normal
  std::uint32_t moved = 0;      // axes that change (1 << axis index)
  bool is_arc = false;
  int first_axis = kAxisX;      // of the three circle axes
  std::array<double, 3> center{}, radial{}, tangential{};  // the last two are unit vectors
  std::shared_ptr<const EndRates> rates;                 // pvt only
  std::vector<double> motor_start_rate_mu, motor_end_rate_mu;  // the same of the motors, where the next two are given
  std::vector<double> motor_start_mu, motor_delta_mu;  // unsegmented: motors go straight from end to end; else empty
  double radius = 0, radius_change = 0, sweep_rad = 0;
};

/// A straight line; `moved` are the axes that differ.
Curve line(const AxisVector& start, const AxisVector& end);

/// The cubic with these derivatives (uu per u) at its ends.
Curve pvt_curve(const AxisVector& start, const AxisVector& end, const EndRates& rates);

/// Coefficients of u, u^2, u^3 of the cubic that covers delta with these rates at its ends.
std::array<double, 3> cubic_coefficients(double delta, double start_rate, double end_rate);

/// Position and derivatives with respect to u. Derivatives are written for moved axes only; the others keep what they were.
struct CurvePoint { AxisVector position, d1, d2; };
void evaluate(const Curve& curve, double u, CurvePoint& point);

/// First derivative with respect to u at u, of every axis.
AxisVector derivative(const Curve& curve, double u);

}  // namespace pmac::motion
