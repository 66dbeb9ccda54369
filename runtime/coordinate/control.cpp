// Starting, stopping and going on: program control and time base of a coordinate system. Source: User's Manual p689-698; refusals,
// Software Reference Manual p77. Inferred: a step counts a dwell and a delay as a move; a pause among pvt moves waits for one that ends at
// rest; abort ramps by the machine's time, whatever the time base.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/motor_moves.h"
#include "runtime/state.h"

namespace pmac::runtime {

using bytecode::ElementId;

namespace {

constexpr double kMostRate = 1000;             // 100000 %
constexpr double kSamePlace_mu = 1e-6;
constexpr const char* kAtLimit = "error #39: NOT READY TO RUN: the program is suspended at a software position limit; abort it first";

}  // namespace

// --- starting -------------------------------------------------------------------------------------------------------------

std::string CoordSystem::begin(std::uint32_t number, std::int64_t label) {
  if (program_running()) return "error #38: PROGRAM RUNNING: abort it first";
  rotary_pointed_ = number == 0;
  rotary_state_ = RotaryState::kNone;
  if (rotary_pointed_) {
    if (program_active()) drop_program();
    return {};
  }
  const auto it = machine_.progs.find(number);
  if (it == machine_.progs.end()) return fmt::format("error #22: PROGRAM NOT IN BUFFER: there is no motion program {}", number);
  if (program_active()) drop_program();
  pointed_ = it->second;
  pointed_label_ = label;
  return {};
}

std::string CoordSystem::run(double time_ms) {
  const TimeBase::Hold hold = time_base_.hold_state(time_ms);
  const bool held = hold == TimeBase::Hold::kHeld || hold == TimeBase::Hold::kSlowing;
  if (phase_ == Phase::kPaused || (held && program_running())) return resume(time_ms);
  if (program_running()) return "error #38: PROGRAM RUNNING: the coordinate system executes a program already";
  if (held) time_base_.clear_hold(time_ms);   // of a program that has ended since
  return start(time_ms);
}

std::string CoordSystem::start(double time_ms) {
  if (rotary_pointed_) return start_rotary(time_ms);
  if (!pointed_) return "error #39: NOT READY TO RUN: no program selected; use b{number} first";
  return start_at(pointed_, pointed_label_, time_ms);
}

std::string CoordSystem::execute(ProgramHandle program, double time_ms) {
  if (program_active()) return fmt::format("error #38: PROGRAM RUNNING: coordinate system {} has a program to go on with", number_);
  return start_at(program, -1, time_ms);
}

std::string CoordSystem::start_at(const ProgramHandle& program, std::int64_t label, double time_ms) {
  if (std::string refusal = why_not_ready(true); !refusal.empty()) return refusal;
  if (std::string refusal = match_positions(time_ms); !refusal.empty()) return refusal;
  if (motor_map().motors.empty())
    machine_.warn(program.program->source, fmt::format("coordinate system {} has no motors; the program runs dry", number_));
  if (!runner_.thread.begin(program, label))
    return fmt::format("error #35: INVALID LABEL: program {} has no label N{}", program.program->number, label);
  runner_.thread.coord = number_;
  runner_.thread.q = q.data();
  aborted_ = {};
  machine_.elements.set(ElementId::kCoordErrorStatus, 0, static_cast<unsigned>(number_));
  block_ = {};
  stop_requested_ = pause_requested_ = pause_at_rest_ = stepping_ = step_block_ = false;
  sync_.clear();
  phase_ = Phase::kCalculating;
  resume_ms_ = time_ms;
  return {};
}

/// What the motors lack that a move needs.
std::string CoordSystem::why_not_ready(bool at_rest) const {
  for (int motor : motors_) {
    const Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    if (m.coord != number_) continue;
    const auto n = static_cast<unsigned>(motor);
    if (machine_.elements.get(ElementId::kMotorServoCtrl, n) <= 0)
      return fmt::format("error #45: MOTOR NOT ACTIVE: Motor[{}].ServoCtrl is 0", motor);
    if (machine_.elements.get(ElementId::kMotorPhaseFound, n) == 0)
      return fmt::format("error #44: MOTOR NOT PHASED: motor {}; give #{}$ first", motor, motor);
    if (!m.closed_loop) return fmt::format("error #43: MOTOR NOT CLOSED LOOP: motor {}; give #{}j/ or enable first", motor, motor);
    if (m.plus_limit && m.minus_limit) return fmt::format("error #39: NOT READY TO RUN: both overtravel switches of motor {} are tripped", motor);
    if (at_rest && m.has_axis() && m.moving()) return fmt::format("error #39: NOT READY TO RUN: motor {} is moving", motor);
  }
  return {};
}

// --- pause and step -------------------------------------------------------------------------------------------------------

std::string CoordSystem::pause(double time_ms) {
  if (!program_running()) return fmt::format("error #39: NOT READY TO RUN: coordinate system {} executes no program", number_);
  if (at_limit_) return kAtLimit;
  const bool between_items = phase_ == Phase::kCalculating;
  const bool waits_for_interrupt = phase_ == Phase::kToRest && after_rest_ == AfterRest::kNextInterrupt;
  if (waits_for_interrupt) after_rest_ = AfterRest::kPause;
  else if (!between_items) pause_requested_ = true;
  else if (pvt_goes_on()) pause_at_rest_ = true;
  else if (auto fault = come_to_rest(time_ms, AfterRest::kPause)) fail(time_ms, std::move(*fault));
  return {};
}

void CoordSystem::pause_here(double time_ms) {
  phase_ = Phase::kPaused;
  resume_ms_ = kNever;
  pause_requested_ = pause_at_rest_ = stepping_ = false;
  note_pause(time_ms);
}

/// Where the motors have to be when the program goes on.
void CoordSystem::note_pause(double time_ms) {
  paused_mu_.clear();
  for (int motor : motors_) {
    Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    paused_mu_.push_back(m.prejog_mu = m.position_at(time_ms));
  }
}

std::string CoordSystem::go_on_after_pause(double time_ms, bool one_step) {
  if (std::string refusal = why_not_ready(true); !refusal.empty()) return refusal;
  for (std::size_t i = 0; i < motors_.size() && i < paused_mu_.size(); ++i) {
    const Motor& m = machine_.motors[static_cast<std::size_t>(motors_[i])];
    if (m.coord == number_ && m.has_axis() && std::abs(m.position_at(time_ms) - paused_mu_[i]) > kSamePlace_mu)
      return fmt::format("error #46: COORD JOGGED OUT OF POSITION: motor {}; jog it back (#{}j=), or give pmatch", m.number, m.number);
  }
  stepping_ = one_step;
  phase_ = Phase::kCalculating;
  resume_ms_ = time_ms;
  return {};
}

std::string CoordSystem::step(double time_ms) {
  if (phase_ == Phase::kPaused) return go_on_after_pause(time_ms, true);
  if (program_running()) {
    if (time_base_.hold_state(time_ms) != TimeBase::Hold::kNone)
      if (std::string refusal = resume(time_ms); !refusal.empty()) return refusal;
    return pause(time_ms);
  }
  std::string refusal = start(time_ms);
  stepping_ = refusal.empty();
  return refusal;
}

std::string CoordSystem::resume(double time_ms) {
  if (phase_ == Phase::kPaused) return go_on_after_pause(time_ms, false);
  if (at_limit_ && !retracing()) return kAtLimit;
  const TimeBase::Hold hold = time_base_.hold_state(time_ms);
  if (hold == TimeBase::Hold::kNone || hold == TimeBase::Hold::kResuming)
    return fmt::format("error #39: NOT READY TO RUN: the program of coordinate system {} is neither paused nor held", number_);
  if (retracing()) return forward_on_path(time_ms);
  if (quick_stopped() && on_path_ && lookahead_) {
    shaped_by_slew_ = quick_stopped_ = false;
    begin_shaping(Shaping::kFaster);
    return {};
  }
  double slope_per_ms = 0;
  if (std::string refusal = slope_of(ElementId::kCoordFeedHoldSlew, slope_per_ms); !refusal.empty()) return refusal;
  quick_stopped_ = false;
  time_base_.release(time_ms, slope_per_ms);
  clock_changed(time_ms);
  return {};
}

// --- time base ------------------------------------------------------------------------------------------------------------

/// The slews are changes of the time base (ms) each servo cycle; 100 % is the servo period.
std::string CoordSystem::slope_of(ElementId slew, double& slope_per_ms) const {
  const double change_ms = machine_.elements.get(slew, static_cast<unsigned>(number_));
  slope_per_ms = change_ms / (machine_.period_ms() * machine_.period_ms());
  if (change_ms > 0 && std::isfinite(slope_per_ms)) return {};
  return fmt::format("error #21: ILLEGAL PARAMETER: Coord[{}].{} is {}; it must be above 0", number_,
                     slew == ElementId::kCoordTimeBaseSlew ? "TimeBaseSlew" : "FeedHoldSlew", change_ms);
}

std::string CoordSystem::set_time_base(double time_ms, double rate) {
  if (!(rate >= 0 && rate <= kMostRate))
    return fmt::format("error #23: OUT OF RANGE NUMBER: a time base of {} %; it is 0 to {} %", number_text(100 * rate), 100 * kMostRate);
  if (rate == time_base_.override_rate()) return {};
  double slope_per_ms = 0;
  if (std::string refusal = slope_of(ElementId::kCoordTimeBaseSlew, slope_per_ms); !refusal.empty()) return refusal;
  time_base_.set_override(time_ms, rate, slope_per_ms);
  if (shaping_ != Shaping::kNone) shape_at_ms_ = machine_.tick_ms(machine_.tick + 1);
  clock_changed(time_ms);
  return {};
}

std::string CoordSystem::hold(double time_ms) {
  if (!program_running()) return fmt::format("error #39: NOT READY TO RUN: coordinate system {} executes no program", number_);
  double slope_per_ms = 0;
  if (std::string refusal = slope_of(ElementId::kCoordFeedHoldSlew, slope_per_ms); !refusal.empty()) return refusal;
  const TimeBase::Hold hold = time_base_.hold_state(time_ms);
  if (retracing() && !quick_stopped_) {
    shaped_by_slew_ = true;
    begin_shaping(Shaping::kSlower);
    return {};
  }
  if (hold == TimeBase::Hold::kHeld || hold == TimeBase::Hold::kSlowing) return {};
  shaping_ = Shaping::kNone;
  shape_at_ms_ = kNever;
  time_base_.shape_end(false);
  time_base_.hold(time_ms, slope_per_ms);
  clock_changed(time_ms);
  return {};
}

/// What waits for a time of the path waits for another time of the machine now.
void CoordSystem::clock_changed(double time_ms) {
  if (!on_path_) return;
  if (phase_ == Phase::kToRest) resume_ms_ = std::max(time_ms, time_base_.time_at(pipeline_.end_ms()));
  else if (phase_ == Phase::kCalculating) resume_ms_ = std::min(resume_ms_, machine_.next_rti_ms(time_ms));
}

const TimeBase* CoordSystem::clock_for_motion(double time_ms) {
  const auto uses_it = [&](const Motor& m) { return m.moving() && m.clock == &time_base_; };
  if (!on_path_ && !time_base_.is_real_time() && std::none_of(machine_.motors.begin(), machine_.motors.end(), uses_it))
    time_base_.restart(time_ms);
  return &time_base_;
}

// --- stopping -------------------------------------------------------------------------------------------------------------

void CoordSystem::abort(double time_ms) {
  machine_.catch_up();
  if (program_active()) aborted_ = {runner_.thread.top_program(), executing_source(time_ms)};
  std::vector<double> position(path_map_.motors.size()), velocity(path_map_.motors.size());
  if (on_path_) {
    pipeline_.sample(path_position(time_ms), position, velocity);
    if (!pipeline_.end_sequence()) collect_timings();
  }
  report_unfinished(time_ms, false);
  const bool holds = machine_.elements.get(ElementId::kCoordSoftLimitStopDis, static_cast<unsigned>(number_)) != 0;
  for (std::size_t i = 0; on_path_ && i < path_map_.motors.size(); ++i) {
    Motor& m = machine_.motors[static_cast<std::size_t>(path_map_.motors[i])];
    const bool held = holds && m.limit_stop != Motor::LimitStop::kNone;   // at a software limit
    if (held) velocity[i] = 0;
    if (held) position[i] = m.position_mu;
    m.position_mu = position[i];
    m.velocity_mu_ms = velocity[i] * path_rate(time_ms);
  }
  on_path_ = false;
  for (Motor& m : machine_.motors)
    if (m.shares_with == number_) abort_motor(machine_, m);
  time_base_.clear_hold(time_ms);
  pointed_label_ = -1;
  drop_program();
}

/// The program is neither executing nor resumable.
void CoordSystem::drop_program() {
  runner_.thread.stop();
  sync_.clear();
  due_.clear();
  pending_moves_.clear();
  executed_.clear();
  end_compensation();
  spline_.cancel();
  forget_retrace();
  pvt_velocity_uu_ms_.fill(0);
  pvt_goes_on_ = false;
  block_ = {};
  home_motors_.clear();
  shaping_ = Shaping::kNone;
  shape_at_ms_ = kNever;
  pause_requested_ = pause_at_rest_ = stepping_ = quick_stopped_ = false;
  limit_fault_.reset();
  at_limit_ = false;
  rotary_state_ = RotaryState::kNone;
  phase_ = Phase::kIdle;
  resume_ms_ = kNever;
}

}  // namespace pmac::runtime
