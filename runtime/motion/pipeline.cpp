#include "runtime/motion/pipeline.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "runtime/motion/governing.h"
#include "runtime/motion/jerk_lookahead.h"
#include "runtime/motion/line_path.h"
#include "runtime/motion/lookahead.h"
#include "runtime/motion/planner.h"
#include "runtime/motion/position_limits.h"
#include "runtime/motion/segmenter.h"
#include "runtime/motion/timeline.h"
#include "runtime/motion/timings.h"

namespace pmac::motion {
namespace {

using runtime::Fault;

constexpr double kShortestSegment_ms = 1e-6;

/// Unsegmented pvt: the cubic in u of each motor, u = u0 + rate * time.
Segment pvt_segment(const PathPiece& piece) {
  Segment segment{piece.command, piece.source, piece.start_ms, piece.duration_ms, 0, {}};
  const Curve& curve = *piece.part[0].curve;
  const double u = piece.part[0].u[0], rate = piece.part[0].u[1];
  for (std::size_t m = 0; m < curve.motor_start_mu.size(); ++m) {
    const auto [c1, c2, c3] = cubic_coefficients(curve.motor_delta_mu[m], curve.motor_start_rate_mu[m], curve.motor_end_rate_mu[m]);
    MotorCubic q;
    q.c0 = curve.motor_start_mu[m] + u * (c1 + u * (c2 + u * c3));
    q.c1 = rate * (c1 + u * (2 * c2 + u * 3 * c3));
    q.c2 = rate * rate * (c2 + 3 * c3 * u);
    q.c3 = rate * rate * rate * c3;
    segment.motor.push_back(q);
  }
  return segment;
}

/// Unsegmented: lines only, so that a motor is a cubic of time: start + delta * u(t), two of them superposed at a corner.
Segment motor_segment(const PathPiece& piece) {
  if (piece.part[0].curve->rates) return pvt_segment(piece);
  Segment segment{piece.command, piece.source, piece.start_ms, piece.duration_ms, 0, {}};
  segment.motor.resize(piece.part[0].curve->motor_start_mu.size());
  for (int i = 0; i < piece.part_count; ++i) {
    const PathPart& part = piece.part[static_cast<std::size_t>(i)];
    for (std::size_t m = 0; m < segment.motor.size(); ++m) {
      const double delta = part.curve->motor_delta_mu[m];
      MotorCubic& q = segment.motor[m];
      q.c0 += (i == 0 ? part.curve->motor_start_mu[m] : 0) + delta * part.u[0];
      q.c1 += delta * part.u[1];
      q.c2 += delta * part.u[2];
      q.c3 += delta * part.u[3];
    }
  }
  return segment;
}

/// The segments that one stands for.
void show_each(const Segment& segment, double step_ms, const std::function<void(const Segment&)>& show) {
  if (segment.passed_ms == 0) return show(segment);
  double from_ms = 0;
  const double end_ms = segment.duration_ms, first_ms = segment.passed_ms - segment.start_ms;
  for (int i = 0; first_ms + i * step_ms < end_ms - kShortestSegment_ms; ++i) {
    const double to_ms = first_ms + i * step_ms;
    show(part_of(segment, from_ms, to_ms - from_ms));
    from_ms = to_ms;
  }
  show(part_of(segment, from_ms, end_ms - from_ms));
}

}  // namespace

struct Pipeline::State {
  PipelineConfig config;
  MotorKinematics kinematics;
  Planner planner;
  std::optional<Segmenter> segmenter;   // segmented only
  std::unique_ptr<TimeLaw> lookahead;   // where it is on
  Timeline timeline;
  Timings timings;
  Governing governing;                  // where note_governing asks for it
  StageObservers observers;
  std::optional<Fault> fault;           // of a later stage: nothing more is produced until reset()
  double earliest_ms = 0;               // start of the next sequence
  double sequence_ms = 0;               // start of this one
  bool in_sequence = false;
  Move next;                            // being added
  PlannerOutput planned;
  std::optional<LinePath> lines;        // between open_lines() and close_lines()
  std::vector<Segment> segments;
  std::vector<TimedSegment> timed;

  bool segmented() const { return config.segment_time_ms > 0; }
  void build_stages();
  std::optional<Fault> start_at(const AxisVector& position_uu, SourceLine source);
  void start_sequence();
  std::optional<Fault> run_stages(bool ends);
  std::optional<Fault> to_segments(bool ends);
  void to_times(bool ends);
  void deliver();
  Fault stop_at(Fault reason);
  std::optional<Fault> end_at_limit();
};

void Pipeline::State::build_stages() {
  kinematics = MotorKinematics(config.map);
  segmenter.reset();
  lookahead.reset();
  if (segmented()) segmenter.emplace(config, kinematics);
  if (segmented() && config.lookahead) {
    const double window_ms = config.lookahead_segments * config.segment_time_ms;
    if (config.limit_jerk) lookahead = std::make_unique<JerkLookahead>(config.limits, window_ms, config.servo_period_ms);
    else lookahead = std::make_unique<Lookahead>(config.limits, window_ms, config.servo_period_ms);
  }
}

std::optional<Fault> Pipeline::State::start_at(const AxisVector& position_uu, SourceLine source) {
  std::vector<double> motors(kinematics.count());
  auto problem = kinematics.position(position_uu, motors.data(), source);
  if (problem) motors.assign(kinematics.count(), 0.0);
  planner.reset(position_uu, motors);
  timeline.set_rest(std::move(motors));
  return problem;
}

void Pipeline::State::start_sequence() {
  if (in_sequence) return;
  in_sequence = true;
  sequence_ms = std::max(earliest_ms, timeline.end_ms());
  timings.start_sequence(sequence_ms);
}

/// What the planner has decided goes through the other stages. ends: the sequence is complete.
std::optional<Fault> Pipeline::State::run_stages(bool ends) {
  for (const MoveBegin& begin : planned.begins) timings.add(begin);
  for (const MoveEnd& end : planned.ends) timings.add(end);
  if (observers.path) std::for_each(planned.pieces.begin(), planned.pieces.end(), observers.path);
  auto problem = to_segments(ends);
  if (problem) fault = stop_at(*problem);
  if (auto limit = end_at_limit()) problem = fault = std::move(limit);
  planned.begins.clear();
  planned.ends.clear();
  planned.pieces.clear();
  to_times(ends || problem);
  deliver();
  if (ends || problem) timings.end_sequence();
  return problem;
}

std::optional<Fault> Pipeline::State::to_segments(bool ends) {
  for (const PathPiece& piece : planned.pieces) {
    if (!segmented()) segments.push_back(motor_segment(piece));
    if (segmented())
      if (auto problem = segmenter->add(piece, segments)) return problem;
  }
  return ends && segmented() ? segmenter->finish(segments) : std::nullopt;
}

/// The path ends at the last node that could be calculated.
Fault Pipeline::State::stop_at(Fault reason) {
  segmenter->abandon(segments);
  in_sequence = false;
  return reason;
}

/// With lookahead the path ends where a motor meets its software limit; what lies behind is forgotten.
std::optional<Fault> Pipeline::State::end_at_limit() {
  for (std::size_t i = 0; lookahead && i < segments.size(); ++i) {
    const auto crossing = first_crossing(segments[i], config.limits);
    if (!crossing) continue;
    const SourceLine source = segments[i].source;
    segments[i].duration_ms = crossing->at_ms;
    segments.erase(segments.begin() + static_cast<std::ptrdiff_t>(crossing->at_ms > kShortestSegment_ms ? i + 1 : i), segments.end());
    std::vector<Segment> behind;
    segmenter->abandon(behind);
    in_sequence = false;
    const auto m = static_cast<std::size_t>(crossing->motor);
    const double limit_mu = crossing->plus ? config.limits[m].max_position_mu : config.limits[m].min_position_mu;
    return Fault{runtime::FaultKind::kSoftLimit, source,
                 fmt::format("motor {} stops on the path at Motor[{}].{} = {}", config.map.motors[m], config.map.motors[m], crossing->plus ? "MaxPos" : "MinPos", limit_mu)};
  }
  return std::nullopt;
}

void Pipeline::State::to_times(bool ends) {
  if (observers.segment)
    for (const Segment& segment : segments) show_each(segment, config.segment_time_ms, observers.segment);
  for (Segment& segment : segments) {
    if (lookahead) {
      lookahead->add(std::move(segment), timed);
      continue;
    }
    const double start_ms = sequence_ms + segment.start_ms, duration_ms = segment.duration_ms;
    TimedSegment& next_timed = timed.emplace_back();
    next_timed.segment = std::move(segment);
    next_timed.start_ms = start_ms;
    next_timed.duration_ms = duration_ms;
  }
  segments.clear();
  if (ends && lookahead) lookahead->finish(timed);
}

void Pipeline::State::deliver() {
  for (TimedSegment& segment : timed) {
    if (lookahead) segment.start_ms = std::max(timeline.end_ms(), sequence_ms);
    if (observers.timed_segment) observers.timed_segment(segment);
    if (config.note_governing) governing.cover(segment);
    timings.cover(segment);
    timeline.push(std::move(segment));
  }
  timed.clear();
}

Pipeline::Pipeline() : state_(std::make_unique<State>()) {}
Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

void Pipeline::reset(const PipelineConfig& config, const AxisVector& start_uu, double start_time_ms) {
  StageObservers observers = std::move(state_->observers);
  state_ = std::make_unique<State>();
  state_->observers = std::move(observers);
  state_->config = config;
  state_->build_stages();
  state_->timings.reset(state_->segmented());
  state_->timeline.keep_history(config.history_ms);
  const bool limits_act = !state_->segmented() || state_->lookahead;
  if (config.note_governing) state_->governing.reset(limits_act ? config.limits : std::vector<MotorLimits>{}, config.map.motors);
  state_->timeline.reset(std::vector<double>(state_->kinematics.count()), start_time_ms);
  state_->earliest_ms = start_time_ms;
  state_->fault = state_->start_at(start_uu, {});
}

void Pipeline::observe(StageObservers observers) { state_->observers = std::move(observers); }

std::optional<Fault> Pipeline::add(const MotionCommand& command) {
  State& s = *state_;
  if (s.fault) return s.fault;
  if (auto problem = make_move(command, s.planner.position(), s.planner.motor_position(), {s.config, s.kinematics}, s.next)) return problem;
  prune();
  s.start_sequence();
  s.planner.add(s.next, s.config, s.planned);
  return s.run_stages(false);
}

void Pipeline::prune() {
  state_->timeline.prune();
  state_->timings.prune(state_->timeline.sampled_ms());
}

LinePath* Pipeline::open_lines(const MotionCommand& like) {
  State& s = *state_;
  const bool observed = s.observers.path || s.observers.segment || s.observers.timed_segment;
  if (s.fault || !s.in_sequence || !s.segmenter || observed) return nullptr;
  s.lines.reset();
  if (const auto lines = LinePath::open({s.config, s.kinematics, s.planner, *s.segmenter, s.timings, s.timeline, s.sequence_ms}, like)) s.lines.emplace(*lines);
  return s.lines ? &*s.lines : nullptr;
}

void Pipeline::close_lines() {
  if (state_->lines) state_->lines->close();
  state_->lines.reset();
}

std::optional<double> Pipeline::stop_by_rule_ms(const MotionCommand& next) const {
  State& s = *state_;
  if (s.fault) return std::nullopt;
  if (make_move(next, s.planner.position(), s.planner.motor_position(), {s.config, s.kinematics}, s.next)) return std::nullopt;
  return s.planner.stop_by_rule_ms(s.next, s.config);
}

std::optional<Fault> Pipeline::end_sequence() {
  State& s = *state_;
  if (s.fault) return s.fault;
  if (!s.in_sequence) return std::nullopt;
  s.planner.end_sequence(s.planned);
  auto problem = s.run_stages(true);
  s.in_sequence = false;
  return problem;
}

void Pipeline::set_earliest_start(double time_ms) { state_->earliest_ms = std::max(state_->earliest_ms, time_ms); }

void Pipeline::set_position(const AxisVector& position_uu) {
  if (auto problem = state_->start_at(position_uu, {})) state_->fault = problem;
}

int Pipeline::commands_ahead(double time_ms) const { return state_->timings.ahead(time_ms); }

bool Pipeline::wants_more_segments(double time_ms) const {
  const State& s = *state_;
  return s.lookahead && !s.fault && s.timeline.programmed_after(time_ms) + s.lookahead->planned_ms() < s.lookahead->needed_ms();
}

double Pipeline::enough_until_ms(int commands) const {
  const State& s = *state_;
  if (!s.lookahead) return s.timings.ahead_until_ms(commands);
  return s.timeline.programmed_until_ms(s.lookahead->window_ms() - s.lookahead->planned_ms());
}

bool Pipeline::at_rest(double time_ms) const { return !state_->in_sequence && time_ms >= state_->timeline.end_ms(); }

double Pipeline::horizon_ms() const {
  const State& s = *state_;
  return std::max(s.timeline.end_ms(), s.in_sequence ? s.sequence_ms : s.earliest_ms);
}

double Pipeline::end_ms() const { return state_->timeline.end_ms(); }

void Pipeline::sample(std::span<const double> time_ms, std::span<double> position_mu, std::span<double> velocity_mu_ms) {
  state_->timeline.sample(time_ms, position_mu, velocity_mu_ms);
}

void Pipeline::pass(double time_ms) { state_->timeline.pass(time_ms); }

void Pipeline::peek(double time_ms, std::span<double> position_mu) const { state_->timeline.peek(time_ms, position_mu); }

double Pipeline::oldest_ms() const { return state_->timeline.oldest_ms(); }

double Pipeline::history_start_ms(double time_ms, double amount_ms) const { return state_->timeline.history_start_ms(time_ms, amount_ms); }

SourceLine Pipeline::executing_source(double time_ms) const { return state_->timeline.source_at(time_ms); }

const AxisVector& Pipeline::calculated_position() const { return state_->planner.position(); }

void Pipeline::take_timings(std::vector<MoveTiming>& out) {
  const std::size_t first = out.size();
  state_->timings.take(out);
  if (!state_->config.note_governing) return;
  for (std::size_t i = first; i < out.size(); ++i) {
    const bool has_own_time = out[i].rule == TimeRule::kOwnTime && !state_->lookahead;  // pvt: no limit acts
    out[i].governed = state_->governing.take(out[i].id);
    if (has_own_time) out[i].governed.clear();
  }
}
void Pipeline::take_sync_times(std::vector<SyncTime>& out) { state_->timings.take_sync_times(out); }

}  // namespace pmac::motion
