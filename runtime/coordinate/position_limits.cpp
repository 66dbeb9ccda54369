// Software position limits (Motor[].MaxPos, MinPos) of what a program moves. Source: User's Manual p429-431, p793.
//
//   lookahead            the pipeline ends the path where a motor meets its limit: the motion comes to rest there, on the path; the program
//                        is then suspended with ErrorStatus 32: it may be retraced, and waits to be aborted
//   otherwise            a move whose end lies beyond a limit is an error when it is calculated: abort, ErrorStatus 32; a path that bulges
//                        beyond (arcs) is aborted when the commanded position passes the limit (servo/servo_cycle.h)
//   SoftLimitStopDis     the motor stands at its limit while the others go on
//
// Inferred: that the check of ends aborts at once, while moves before are still executing.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/servo/servo_cycle.h"
#include "runtime/state.h"

namespace pmac::runtime {

using bytecode::ElementId;

namespace {

constexpr double kRounding_mu = 1e-6;
constexpr double kNearLimit_mu = 1e-4;

}  // namespace

bool CoordSystem::has_position_limits() const {
  return std::any_of(motors_.begin(), motors_.end(), [&](int motor) { return software_limits(machine_.elements, motor).is_on(); });
}

/// The target, moved to the limit where SoftLimitStopDis says so.
std::optional<Fault> CoordSystem::limit_target(int motor, double& target_mu, bytecode::SourceLine source) const {
  const PositionRange range = software_limits(machine_.elements, motor);
  if (target_mu <= range.max_mu + kRounding_mu && target_mu >= range.min_mu - kRounding_mu) return std::nullopt;
  const bool plus = target_mu > range.max_mu;
  if (machine_.elements.get(ElementId::kCoordSoftLimitStopDis, static_cast<unsigned>(number_)) == 0)
    return Fault{FaultKind::kSoftLimit, source, fmt::format("the target of motor {}, {:.9g} motor units, is beyond {}", motor, target_mu, limit_text(motor, plus, range))};
  target_mu = std::clamp(target_mu, range.min_mu, range.max_mu);
  return std::nullopt;
}

/// Ends of moves, where nothing else keeps them inside.
std::optional<Fault> CoordSystem::check_targets(const AxisVector& target_uu, bytecode::SourceLine source) {
  const bool held = machine_.elements.get(ElementId::kCoordSoftLimitStopDis, static_cast<unsigned>(number_)) != 0;
  if (lookahead_ || held || !has_position_limits()) return std::nullopt;
  const bool segmented = machine_.elements.get(ElementId::kCoordSegMoveTime, static_cast<unsigned>(number_)) > 0;
  if (segmented && map_.has_inverse_motors()) return std::nullopt;  // routines are called along the path, not ahead of it
  std::vector<double> target_mu(path_map_.motors.size());
  if (auto fault = motors_from_axes(target_uu, target_mu.data(), source)) return fault;
  for (std::size_t i = 0; i < target_mu.size(); ++i)
    if (auto fault = limit_target(path_map_.motors[i], target_mu[i], source)) return fault;
  return std::nullopt;
}

/// Positions of the path's motors where SoftLimitStopDis holds them at their limits.
void CoordSystem::hold_at_limits(std::span<double> position_mu) const {
  if (machine_.elements.get(ElementId::kCoordSoftLimitStopDis, static_cast<unsigned>(number_)) == 0) return;
  for (std::size_t i = 0; i < position_mu.size(); ++i) {
    const PositionRange range = software_limits(machine_.elements, path_map_.motors[i]);
    position_mu[i] = std::clamp(position_mu[i], range.min_mu, range.max_mu);
  }
}

/// The path that has been calculated ends at the limit; what is on it is executed first.
void CoordSystem::stop_at_limit(double time_ms, Fault fault) {
  limit_fault_ = std::move(fault);
  collect_timings();
  phase_ = Phase::kToRest;
  after_rest_ = AfterRest::kLimit;
  resume_ms_ = std::max(time_ms, time_base_.time_at(pipeline_.end_ms()));
}

/// As after a quick stop, which may be retraced.
void CoordSystem::stopped_at_limit(double time_ms) {
  resume_ms_ = kNever;
  time_base_.force_rate(time_ms, 0);
  time_base_.shape_end(true);
  quick_stopped_ = true;
  if (std::exchange(at_limit_, true)) return;
  report_unfinished(time_ms, false);
  std::vector<double> end_mu(path_map_.motors.size());
  pipeline_.peek(pipeline_.end_ms(), end_mu);
  for (std::size_t i = 0; i < end_mu.size(); ++i) {
    Motor& m = machine_.motors[static_cast<std::size_t>(path_map_.motors[i])];
    const PositionRange range = software_limits(machine_.elements, m.number);
    if (end_mu[i] >= range.max_mu - kNearLimit_mu) m.limit_stop = Motor::LimitStop::kPlusPosition;
    if (end_mu[i] <= range.min_mu + kNearLimit_mu) m.limit_stop = Motor::LimitStop::kMinusPosition;
  }
  machine_.elements.set(ElementId::kCoordErrorStatus, error_status(FaultKind::kSoftLimit), static_cast<unsigned>(number_));
  machine_.report_fault({time_ms, number_, -1, *limit_fault_});
}

}  // namespace pmac::runtime
