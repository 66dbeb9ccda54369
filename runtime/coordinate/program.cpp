// Executing a motion program: how far it calculates ahead of motion, where it waits, and the times at which moves, dwells and
// synchronous assignments happen. Source: User's Manual p681-706 and the jump-back rule; times are exact, not rounded to servo
// ticks: what follows a dwell starts at the dwell's own end.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/motor_moves.h"
#include "runtime/servo/servo_cycle.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

constexpr std::uint64_t kPassBudget = 1'000'000;  // instructions of one calculation pass
constexpr int kMaxStepsAtOneTime = 10'000;        // dwells of no length and the like, before time has to go on

}  // namespace

/// Opens the pipeline for a new sequence that starts now.
void CoordSystem::ensure_sequence(double time_ms) {
  if (on_path_) return;
  motion::PipelineConfig set_up = config();
  path_map_ = set_up.map;
  lookahead_ = set_up.lookahead;
  const double path_ms = clock_for_motion(time_ms)->path_at(time_ms);
  pipeline_.reset(set_up, calculated_uu_, path_ms);
  on_path_ = true;
  before_mu_.clear();
  forget_retrace();
  sequence_start_ms_ = path_ms;
  history_ms_ = set_up.history_ms;
  for (int motor : path_map_.motors) machine_.motors[static_cast<std::size_t>(motor)].follow_path();
}

motion::PipelineConfig CoordSystem::config() {
  const ElementStore& e = machine_.elements;
  const auto cs = static_cast<unsigned>(number_);
  motion::PipelineConfig c;
  c.segment_time_ms = e.get(ElementId::kCoordSegMoveTime, cs);
  c.servo_period_ms = machine_.period_ms();
  c.fine = machine_.options.fine;
  c.ramp_rule = machine_.options.ramp_rule;
  c.limit_jerk = machine_.options.limit_jerk;
  c.note_governing = machine_.options.note_governing;
  c.lookahead_segments = static_cast<int>(e.get(ElementId::kCoordLHDistance, cs));
  c.lookahead = c.segment_time_ms > 0 && c.lookahead_segments > 1 && lookahead_buffer > 0;
  c.radius_error_limit_uu = e.get(ElementId::kCoordRadiusErrorLimit, cs);
  c.min_arc_len = e.get(ElementId::kCoordMinArcLen, cs);
  c.max_circle_accel = e.get(ElementId::kCoordMaxCirAccel, cs);
  c.max_feed_uu = e.get(ElementId::kCoordMaxFeedRate, cs);
  c.corner_blend_bp = e.get(ElementId::kCoordCornerBlendBp, cs);
  c.corner_dwell_bp = e.get(ElementId::kCoordCornerDwellBp, cs);
  c.no_corner_bp = e.get(ElementId::kCoordNoCornerBp, cs);
  c.corner_radius_uu = e.get(ElementId::kCoordCornerRadius, cs);
  c.corner_error_uu = e.get(ElementId::kCoordCornerError, cs);
  c.corner_accel_uu_ms2 = e.get(ElementId::kCoordCornerAccel, cs) / std::pow(e.get(ElementId::kCoordFeedTime, cs), 2);
  c.added_dwell_ms = e.get(ElementId::kCoordAddedDwellTime, cs);
  c.history_ms = c.segment_time_ms > 0 ? history_wanted_ms() : 0;
  c.map = motor_map();
  for (int motor : c.map.motors) {
    const auto n = static_cast<unsigned>(motor);
    const bool held = e.get(ElementId::kCoordSoftLimitStopDis, cs) != 0;
    const PositionRange range = held ? PositionRange{} : software_limits(e, motor);
    c.limits.push_back({e.get(ElementId::kMotorMaxSpeed, n), e.get(ElementId::kMotorInvAmax, n), e.get(ElementId::kMotorInvDmax, n),
                        e.get(ElementId::kMotorInvJmax, n), range.min_mu, range.max_mu});
    c.jerk_limit_unsegmented = c.jerk_limit_unsegmented || e.assigned(ElementId::kMotorInvJmax, n);
  }
  return c;
}

/// How many commands have to be known beyond the executing one; User's Manual p681 and the Turbo manuals.
int CoordSystem::commands_wanted() const {
  return machine_.elements.get(ElementId::kCoordSegMoveTime, static_cast<unsigned>(number_)) > 0 ? 1 : 2;
}

bool CoordSystem::enough_ahead(double time_ms) const {
  if (pipeline_.horizon_ms() < time_base_.path_at(machine_.next_rti_ms(time_ms))) return false;
  const double path_ms = time_base_.path_at(time_ms);
  return lookahead_ ? !pipeline_.wants_more_segments(path_ms) : pipeline_.enough_until_ms(commands_wanted()) > path_ms;
}

/// The first real-time interrupt at which enough_ahead() may have become false, and before the horizon.
double CoordSystem::next_calculation_ms(double time_ms) const {
  const double in_time_ms = time_base_.time_at(pipeline_.horizon_ms()) - 2 * machine_.rti_period_ms();
  const double until_ms = std::min(time_base_.time_at(pipeline_.enough_until_ms(commands_wanted())), in_time_ms);
  if (until_ms == kNever) return kNever;
  const double next_ms = machine_.next_rti_ms(time_ms);
  return until_ms <= next_ms ? next_ms : machine_.rti_at_or_after_ms(until_ms);
}

// --- time ---------------------------------------------------------------------------------------------------------------

double CoordSystem::next_event_ms() const {
  const double due = due_.empty() || sync_.empty() ? kNever : time_base_.time_at(due_.front().time_ms);
  const double settled = time_base_.settled_from_ms() > machine_.now_ms ? time_base_.settled_from_ms() : kNever;
  const bool motors_decide = phase_ == Phase::kRapid || phase_ == Phase::kHoming;
  return std::min({shape_at_ms_, motors_decide ? motors_end_ms() : resume_ms_, due, settled});
}

/// When the last of the motors that a rapid move or home search waits for comes to rest, as things stand.
double CoordSystem::motors_end_ms() const {
  double end_ms = phase_ == Phase::kIdle || phase_ == Phase::kPaused ? 0 : resume_ms_;
  for (int motor : phase_ == Phase::kHoming ? home_motors_ : motors_) {
    const Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    const bool counts = phase_ == Phase::kHoming || (m.coord == number_ && m.has_axis());
    if (counts && m.source == Motor::Source::kProfile) end_ms = std::max(end_ms, m.seeks_trigger() ? kNever : m.profile_end_ms());
  }
  return end_ms;
}

/// A rapid move or home search is complete.
void CoordSystem::motors_arrived(double time_ms) {
  const bool axes_elsewhere = phase_ == Phase::kHoming || rapid_.trigger_axes != 0;
  report_rapid(time_ms);
  home_motors_.clear();
  phase_ = Phase::kCalculating;
  if (const std::string refusal = axes_elsewhere ? match_positions(time_ms) : std::string(); !refusal.empty())
    return fail(time_ms, {FaultKind::kForwardKinematics, item_source_, refusal});
  go_on(time_ms);
}

void CoordSystem::service(double time_ms) {
  perform_due(time_ms);
  record_executed(time_ms);
  if (shape_at_ms_ <= time_ms) shape_rate(time_ms);
  if (rapid_open_ && !program_running() && motors_end_ms() <= time_ms) report_rapid(time_ms);
  for (int steps = 0; resume_ms_ <= time_ms; ++steps) {
    if (steps == kMaxStepsAtOneTime) {
      resume_ms_ = machine_.next_rti_ms(time_ms);
      return;
    }
    switch (phase_) {
      case Phase::kIdle:
      case Phase::kPaused: resume_ms_ = kNever; break;
      case Phase::kCalculating: calculate(time_ms); break;
      case Phase::kToRest: at_rest(time_ms); break;
      case Phase::kDwelling:
        record({"dwell", item_source_, number_, -1, item_start_ms_, time_ms, 0});
        go_on(time_ms);
        break;
      case Phase::kRapid:
      case Phase::kHoming:
        if (motors_end_ms() > time_ms) return;
        for (int motor : motors_) service_motor(machine_, machine_.motors[static_cast<std::size_t>(motor)]);
        motors_arrived(time_ms);
        break;
    }
  }
}

/// An item is complete.
void CoordSystem::go_on(double time_ms) { pause_requested_ ? pause_here(time_ms) : calculate(time_ms); }

void CoordSystem::calculate(double time_ms) {
  phase_ = Phase::kCalculating;
  if (on_path_) {
    collect_timings();
    if (enough_ahead(time_ms)) {
      resume_ms_ = next_calculation_ms(time_ms);
      return;
    }
  }
  calculated_at_ms_ = time_ms;
  const auto go_back = static_cast<std::int64_t>(machine_.elements.get(ElementId::kCoordGoBack, static_cast<unsigned>(number_)));
  RunResult result = runner_.thread.run(*machine_.host, kPassBudget, std::max<std::int64_t>(go_back, 0) + 2);
  machine_.instructions += result.instructions;
  if (!program_running()) return;
  if (stop_requested_) {
    stop_requested_ = false;
    abort(time_ms);
    return;
  }
  runner_.thread.reset_jump_backs();
  std::optional<Fault> fault;
  switch (result.stop) {
    case RunStop::kSuspended: return;  // motion() has set what to wait for
    case RunStop::kBudget:
    case RunStop::kJumpBack: fault = come_to_rest(time_ms, AfterRest::kNextInterrupt); break;
    case RunStop::kEnded:
      if (goes_on_in_rotary()) {
        resume_ms_ = time_ms;
        return;
      }
      fault = come_to_rest(time_ms, AfterRest::kEnd);
      break;
    case RunStop::kFault: fault = std::move(result.fault); break;
  }
  if (fault) fail(time_ms, std::move(*fault));
}

/// Ends blending; `then` happens when the motors have come to rest.
std::optional<Fault> CoordSystem::come_to_rest(double time_ms, AfterRest then) {
  if (on_path_) {
    if (auto fault = pvt_has_ended(runner_.thread.source())) return fault;
    if (auto fault = finish_spline()) return fault;
    if (auto fault = flush_compensation()) return fault;
    if (auto fault = pipeline_.end_sequence()) return fault;
    collect_timings();
  } else if (then == AfterRest::kNextInterrupt) {
    phase_ = Phase::kCalculating;
    resume_ms_ = machine_.next_rti_ms(time_ms);
    return std::nullopt;
  }
  phase_ = Phase::kToRest;
  after_rest_ = then;
  resume_ms_ = on_path_ ? std::max(time_ms, time_base_.time_at(pipeline_.end_ms())) : time_ms;
  return std::nullopt;
}

void CoordSystem::at_rest(double time_ms) {
  machine_.catch_up();
  if (after_rest_ == AfterRest::kLimit) return stopped_at_limit(time_ms);
  settle_path(time_ms);
  switch (after_rest_) {
    case AfterRest::kHomeZero:
      machine_.motors[static_cast<std::size_t>(home_motor_)].home_here(time_ms);
      if (const std::string refusal = match_positions(time_ms); !refusal.empty())
        return fail(time_ms, {FaultKind::kForwardKinematics, item_source_, refusal});
      go_on(time_ms);
      break;
    case AfterRest::kHome: start_homing(time_ms); break;
    case AfterRest::kPositions:
      if (const std::string refusal = change_positions(time_ms, position_change_); !refusal.empty())
        return fail(time_ms, {FaultKind::kNotReady, item_source_, refusal});
      go_on(time_ms);
      break;
    case AfterRest::kPause: pause_here(time_ms); break;
    case AfterRest::kLimit: break;
    case AfterRest::kDwell: start_dwell(time_ms); break;
    case AfterRest::kRapid: start_rapid(time_ms); break;
    case AfterRest::kNextInterrupt:
      phase_ = Phase::kCalculating;
      resume_ms_ = std::max(machine_.rti_at_or_after_ms(time_ms), machine_.next_rti_ms(calculated_at_ms_));
      break;
    case AfterRest::kEnd: finish_program(); break;
  }
}

void CoordSystem::settle_path(double time_ms) {
  if (!on_path_) return;
  if (pipeline_.end_ms() > sequence_start_ms_) moves_without_time_ = 0;
  collect_timings();
  record_executed(time_ms);
  perform_due(time_ms);
  std::vector<double> position(path_map_.motors.size());
  pipeline_.sample(pipeline_.end_ms(), position, {});
  if (!map_.has_inverse_motors()) (void)motors_from_axes(calculated_uu_, position.data(), {});  // exactly the programmed end
  hold_at_limits(position);
  for (std::size_t i = 0; i < position.size(); ++i)
    machine_.motors[static_cast<std::size_t>(path_map_.motors[i])].rest(time_base_.time_at(pipeline_.end_ms()), position[i]);
  on_path_ = false;
}

void CoordSystem::finish_program() {
  if (rotary_ends_here()) return;
  drop_program();
  pointed_label_ = -1;
}

void CoordSystem::start_dwell(double time_ms) {
  perform_up_to(next_id_++);
  item_start_ms_ = time_ms;
  phase_ = Phase::kDwelling;
  resume_ms_ = time_ms + dwell_ms_;
}

void CoordSystem::start_homing(double time_ms) {
  perform_up_to(next_id_++);
  phase_ = Phase::kHoming;
  resume_ms_ = time_ms;
  for (int motor : home_motors_) {
    Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    const bool elsewhere = m.coord >= 0 && m.coord != number_ && machine_.coord(m.coord).program_running();
    std::string refusal;
    if (!m.closed_loop) refusal = fmt::format("error #43: MOTOR NOT CLOSED LOOP: motor {}", motor);
    else if (elsewhere) refusal = fmt::format("error #38: PROGRAM RUNNING: motor {} belongs to coordinate system {}", motor, m.coord);
    else refusal = home(machine_, m, item_source_);
    if (!refusal.empty()) return fail(time_ms, {FaultKind::kNotReady, item_source_, refusal});
  }
}

void CoordSystem::start_rapid(double time_ms) {
  perform_up_to(next_id_++);
  if (auto fault = move_rapid(time_ms, rapid_)) return fail(time_ms, std::move(*fault));
  phase_ = Phase::kRapid;
  resume_ms_ = time_ms;
}

void CoordSystem::sample(std::span<const double> time_ms, std::span<double> position_mu) {
  if (time_base_.is_real_time()) return pipeline_.sample(time_ms, position_mu, {});
  path_times_ms_.resize(time_ms.size());
  std::transform(time_ms.begin(), time_ms.end(), path_times_ms_.begin(), [this](double t) { return path_position(t); });
  pipeline_.sample(path_times_ms_, position_mu, {});
}

void CoordSystem::follow_samples(std::span<const double> time_ms, int kept, const std::vector<int>& used, std::span<const double> rows_mu) {
  for (int motor : path_map_.motors) {
    Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    const auto row = static_cast<std::size_t>(std::find(used.begin(), used.end(), motor) - used.begin());
    const std::size_t last = (row + 1) * static_cast<std::size_t>(kept) - 1;
    const double before_mu = kept > 1 ? rows_mu[last - 1] : m.position_mu;
    m.velocity_mu_ms = (rows_mu[last] - before_mu) / machine_.period_ms();  // as the controller's DesVel: over the last servo cycle
    m.position_mu = rows_mu[last];
  }
  const auto sampled = static_cast<std::size_t>(kept);
  if (sampled == time_ms.size()) return;
  sample_run_.resize(path_map_.motors.size());
  pipeline_.sample(path_position(time_ms[sampled - 1]), sample_run_, {});  // the pipeline stands there again
}

bool CoordSystem::sleeps() const { return next_event_ms() == kNever && executed_.empty() && !rapid_open_; }

bool CoordSystem::runs_along() const {
  return phase_ == Phase::kCalculating && on_path_ && time_base_.is_real_time() && shape_at_ms_ == kNever && !rapid_open_;
}

void CoordSystem::pass_samples(double time_ms) {
  if (on_path_ && history_ms_ > 0) pipeline_.pass(time_ms);
}

bool CoordSystem::may_pass_samples(double left_out_ms) const { return history_ms_ == 0 || history_ms_ > left_out_ms; }

bytecode::SourceLine CoordSystem::executing_source(double time_ms) const {
  const bytecode::SourceLine on_path = on_path_ ? pipeline_.executing_source(path_position(time_ms)) : bytecode::SourceLine{};
  if (on_path.line > 0) return on_path;
  if (phase_ == Phase::kRapid) return rapid_.source;
  return phase_ == Phase::kDwelling || phase_ == Phase::kHoming ? item_source_ : runner_.thread.source();
}

}  // namespace pmac::runtime
