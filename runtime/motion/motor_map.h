// From axis positions to motor positions: either the linear axis definitions or the inverse kinematic routine.
#pragma once

#include <optional>
#include <vector>

#include "runtime/motion/types.h"

namespace pmac::motion {

class MotorKinematics {
 public:
  MotorKinematics() = default;
  explicit MotorKinematics(const MotorMap& map);

  std::size_t count() const { return count_; }
  bool is_linear() const { return !inverse_; }
  /// Mask of the axes that motor positions depend on.
  std::uint32_t axes() const { return axes_; }

  /// motor_mu: [count()]. The routine's fault, or one for a result that is not finite; motor_mu is then of no use.
  std::optional<runtime::Fault> position(const AxisVector& axis_uu, double* motor_mu, SourceLine source) const;

  /// Linear maps only: motor velocities (or any derivative) of axis velocities.
  void rate(const AxisVector& axis_rate, double* motor_rate) const;

  /// Motor velocities of axis velocities at a position, through the routine where there is one. motor_rate_mu_ms: [count()]
  std::optional<runtime::Fault> rate_at(const AxisVector& axis_uu, const AxisVector& axis_rate_uu_ms, double* motor_rate_mu_ms, SourceLine source) const;

  /// Routines only: motor velocities along an axis velocity, as the central difference of the routine's positions step_ms before and behind.
  /// False where it has no solution there.
  bool rate_by_differences(const AxisVector& axis_uu, const AxisVector& axis_rate_uu_ms, double step_ms, double* motor_rate_mu_ms, SourceLine source) const;

  /// Linear maps only: offsets, and coefficients other than 0 by motor.
  struct Term { std::size_t motor, axis; double coefficient; };
  const std::vector<Term>& terms() const { return terms_; }
  const std::vector<double>& offset_mu() const { return offset_mu_; }

 private:
  std::size_t count_ = 0;
  std::uint32_t axes_ = ~0u;
  std::vector<Term> terms_;          // non-zero coefficients, by motor
  std::vector<double> offset_mu_;
  std::function<std::optional<runtime::Fault>(const AxisVector&, double*, SourceLine)> inverse_;
  std::function<std::optional<runtime::Fault>(const AxisVector&, const RoutineRates&, double*, SourceLine)> inverse_rates_;
};

}  // namespace pmac::motion
