#include "runtime/motion/line_path.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/motion/axis_vector.h"

namespace pmac::motion {
namespace {

// As the stages have them: planner, join, segmenter, timings.
constexpr double kNoTime_ms = 1e-9, kMinGap_ms = 1e-3, kSamePlace_ms = 1e-6, kShortestTime_ms = 1e-9;
constexpr double kTangentTolerance = 1e-7, kSameSpeedTolerance = 1e-12;
constexpr double kMostSegments = 1'000'000;
/// Ramps that take less time are the stages' own: pieces would be left out.
constexpr double kShortestRamps_ms = 1e-2;

bool is_line(const Curve& curve) { return !curve.is_arc && !curve.rates; }

bool corner_rules_are_off(const PipelineConfig& c) {
  return c.corner_blend_bp == 0 && c.corner_dwell_bp == 0 && c.corner_radius_uu <= 0 && c.corner_error_uu <= 0 && c.corner_accel_uu_ms2 <= 0;
}

bool are_plain(const PipelineConfig& c, const MotorKinematics& kinematics) {
  return c.segment_time_ms > 0 && !c.lookahead && c.fine == FineInterpolation::kThrough && !c.note_governing && corner_rules_are_off(c) && kinematics.is_linear() &&
         kinematics.count() <= LinePath::kMostMotors;
}

bool are_plain(const MotionCommand& like) {
  const bool times = like.ta_ms >= 0 && like.ts_ms >= 0 && like.td_ms >= 0 && like.tsd_ms >= 0 && is_valid({like.ta_ms, like.ts_ms}) && is_valid({like.td_ms, like.tsd_ms});
  const bool feed = like.feed_uu > 0 && std::isfinite(like.feed_uu) && like.feed_time_ms > 0 && !like.inverse_time && like.feed_axes2 == 0;
  return like.kind == CommandKind::kLinear && times && feed && !like.no_blend;
}

/// In the order of the entries; those that are not used add nothing.
template <std::size_t kWidth>
double sum(const LinePath::Point& values) {
  double result = 0;
  for (std::size_t i = 0; i < kWidth; ++i) result += values[i];
  return result;
}

}  // namespace

// --- taking over -----------------------------------------------------------------------------------------------------------

std::optional<LinePath> LinePath::open(const Stages& stages, const MotionCommand& like) {
  if (!are_plain(stages.config, stages.kinematics) || !are_plain(like)) return std::nullopt;
  LinePath path(stages, like);
  path.entry_ = make_ramp({like.ta_ms, like.ts_ms}, 0, stages.config.ramp_rule);
  path.exit_ = make_ramp({like.td_ms, like.tsd_ms}, 0, stages.config.ramp_rule);
  path.entry_parts_ = ramp_parts(path.entry_);
  path.room_ms_ = (path.entry_.total_ms() + path.exit_.total_ms()) / 2;
  path.feed_uu_ = stages.config.max_feed_uu > 0 ? std::min(like.feed_uu, stages.config.max_feed_uu) : like.feed_uu;
  const bool has_ramps = path.entry_.total_ms() >= kShortestRamps_ms && path.exit_.total_ms() >= kShortestRamps_ms;
  const bool takes = has_ramps && path.takes_axes() && path.takes_planner() && path.takes_segmenter() && path.takes_timings();
  return takes ? std::optional(path) : std::nullopt;
}

bool LinePath::takes_axes() {
  axes_ = stages_.kinematics.axes();
  motor_count_ = stages_.kinematics.count();
  if (static_cast<std::size_t>(std::popcount(axes_)) > kMostAxes) return false;
  entry_of_.fill(-1);
  for_each_axis(axes_, [&](std::size_t axis) {
    entry_of_[axis] = static_cast<int>(axis_count_);
    feeds_[axis_count_] = like_.feed_axes >> axis & 1u ? 1 : 0;
    axis_of_[axis_count_++] = axis;
  });
  const std::vector<MotorKinematics::Term>& terms = stages_.kinematics.terms();
  for (const MotorKinematics::Term& term : terms) term_[term_count_++] = {term.motor, static_cast<std::size_t>(entry_of_[term.axis]), term.coefficient};
  std::copy(stages_.kinematics.offset_mu().begin(), stages_.kinematics.offset_mu().end(), offset_mu_.begin());
  is_diagonal_ = std::all_of(terms.begin(), terms.end(), [this](const MotorKinematics::Term& term) { return static_cast<std::size_t>(entry_of_[term.axis]) == term.motor; });
  if (is_diagonal_)
    for (const MotorKinematics::Term& term : terms) scale_mu_uu_[term.motor] = term.coefficient;
  is_narrow_ = axis_count_ <= kNarrow && motor_count_ <= kNarrow;
  return motor_count_ > 0 && axis_count_ > 0;
}

bool LinePath::takes_planner() {
  const Planner& p = stages_.planner;
  if (!p.has_pending_ || p.rest_before_ || p.step_before_) return false;
  const Move& last = p.pending_;
  if (last.pvt || last.no_blend || !is_line(*last.curve) || (last.curve->moved & ~axes_) != 0 || !(last.time_ms > 0)) return false;
  if (last.curve->moved == 0) return false;   // the motors stand still on it: see Segmenter::stand_still()
  Line& line = line_[pending_];
  line.id = last.id;
  line.source = last.source;
  for (std::size_t i = 0; i < axis_count_; ++i) {
    line.start[i] = last.curve->start[axis_of_[i]];
    line.end[i] = p.position_[axis_of_[i]];
    line.delta[i] = last.curve->delta[axis_of_[i]];
    if (last.curve->end[axis_of_[i]] != line.end[i]) return false;
  }
  line.time_ms = last.time_ms;
  set_speed<kMostAxes>(line);
  nominal_start_ms_ = p.nominal_start_ms_;
  entry_total_ms_ = p.entry_total_ms_;
  clock_ms_ = p.clock_ms_;
  return true;
}

bool LinePath::takes_segmenter() {
  Segmenter& s = stages_.segmenter;
  if (!s.is_open_ || !s.has_previous_ || s.uniform_ || s.longest_ms_ != 0 || s.open().before.stretch == 0) return false;
  const auto take = [&](const MotorNode& from, const Row<double>& velocity_mu_ms, Node& to) {
    to.time_ms = from.time_ms;
    to.command = from.command;
    to.source = from.source;
    std::copy(from.position_mu.begin(), from.position_mu.end(), to.position_mu.begin());
    std::copy(velocity_mu_ms.begin(), velocity_mu_ms.end(), to.velocity_mu_ms.begin());
  };
  open_ = 0;
  before_ = 1;
  const MotorNode& before = s.nodes_[1 - s.open_at_];
  take(s.open(), s.open().before.velocity_mu_ms, node_[open_]);
  take(before, before.after.velocity_mu_ms, node_[before_]);
  origin_ms_ = s.origin_ms_;
  next_grid_ = s.next_grid_;
  return true;
}

/// Places follow one another: those that are known come first, and a move ends where the next one begins.
bool LinePath::takes_timings() {
  const Timings& t = stages_.timings;
  const std::size_t count = t.records_.size();
  if (count == 0 || t.records_.back().id != line_[pending_].id || t.records_.back().end.given) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const Timings::Record& record = t.records_[i];
    if (record.sync.known && i == syncs_known_) ++syncs_known_;
    if (record.start.known && i == starts_known_) ++starts_known_;
    if ((record.sync.known && i >= syncs_known_) || (record.start.known && i >= starts_known_)) return false;
    if (i + 1 == count) break;
    const Timings::Record& next = t.records_[i + 1];
    if (!record.end.given || record.end.known != next.start.known || record.end.programmed_ms != next.start.programmed_ms) return false;
  }
  return true;
}

// --- a line ----------------------------------------------------------------------------------------------------------------

bool LinePath::add(const Point& target, std::uint64_t id, SourceLine source) {
  return is_narrow_ ? add_line<kNarrow>(target, id, source) : add_line<kMostAxes>(target, id, source);
}

// The loops below go over kWidth entries, of which the last ones may be unused and 0: a number known beforehand makes them vectors.

template <std::size_t kWidth>
bool LinePath::add_line(const Point& target, std::uint64_t id, SourceLine source) {
  const std::size_t at = 3 - pending_ - previous_;
  Line& next = line_[at];
  const Point start = line_[pending_].end;
  next.start = start;
  next.end = target;
  for (std::size_t i = 0; i < kWidth; ++i) next.delta[i] = target[i] - start[i];
  next.id = id;
  next.source = source;
  if (!set_time<kWidth>(next)) return false;
  set_speed<kWidth>(next);
  const Blend blend = blend_into<kWidth>(next);
  if (!blend.possible) return false;
  begin_line(next, blend.ramp);
  const double boundary_ms = nominal_end_ms(), half_ms = blend.ramp.total_ms() / 2;
  cruise_until<kWidth>(blend.is_steady ? boundary_ms : boundary_ms - half_ms);
  if (!blend.is_steady) corner<kWidth>(at, blend.ramp, blend.is_whole ? entry_parts_ : ramp_parts(blend.ramp));
  if (!blend.is_steady) clock_ms_ = boundary_ms + half_ms;
  nominal_start_ms_ = boundary_ms;
  entry_total_ms_ = blend.ramp.total_ms();
  previous_ = std::exchange(pending_, at);
  ++added_;
  return true;
}

/// As make_move(): the time of the feed rate, at least that of the ramps. False where that is for the stages.
template <std::size_t kWidth>
bool LinePath::set_time(Line& line) const {
  Point feed, size, other_size;
  for (std::size_t i = 0; i < kWidth; ++i) {
    const double delta = line.delta[i];
    size[i] = std::abs(delta);
    feed[i] = delta * delta * feeds_[i];
    other_size[i] = size[i] * (1 - feeds_[i]);
  }
  double feed2 = 0, other = 0, longest = 0;
  for (std::size_t i = 0; i < kWidth; ++i) {
    feed2 += feed[i];
    other = other_size[i] > other ? other_size[i] : other;
    longest = size[i] > longest ? size[i] : longest;
  }
  if (!std::isfinite(feed2 + longest) || longest == 0) return false;
  line.length_uu = std::sqrt(feed2);
  const double by_feed_ms = line.length_uu / feed_uu_ * like_.feed_time_ms;
  double time_ms = by_feed_ms;
  if (like_.alt_feed_uu > 0) time_ms = std::max(time_ms, other / like_.alt_feed_uu * like_.feed_time_ms);
  if (like_.alt_feed_uu <= 0 && time_ms == 0) time_ms = other / feed_uu_ * like_.feed_time_ms;
  line.rule = feed_uu_ < like_.feed_uu ? TimeRule::kMaxFeedRate : TimeRule::kFeed;
  if (time_ms > by_feed_ms) line.rule = like_.alt_feed_uu > 0 ? TimeRule::kAltFeedRate : TimeRule::kFeed;
  if (line.length_uu == 0) line.length_uu = longest;
  line.time_ms = std::max(std::max(time_ms, kShortestTime_ms), room_ms_);
  if (line.time_ms > time_ms) line.rule = TimeRule::kRamps;
  return line.time_ms / stages_.config.segment_time_ms <= kMostSegments;
}

template <std::size_t kWidth>
void LinePath::set_speed(Line& line) const {
  line.per_ms = 1 / line.time_ms;
  Point square;
  for (std::size_t i = 0; i < kWidth; ++i) {
    line.velocity_uu_ms[i] = line.delta[i] / line.time_ms;
    square[i] = line.velocity_uu_ms[i] * line.velocity_uu_ms[i];
  }
  line.speed_uu_ms = std::sqrt(sum<kWidth>(square));
  for (std::size_t i = 0; i < kWidth; ++i) line.direction[i] = line.velocity_uu_ms[i] / line.speed_uu_ms;   // not a number: no direction
}

/// As decide_join().
template <std::size_t kWidth>
LinePath::Blend LinePath::blend_into(const Line& next) const {
  const Line& last = line_[pending_];
  Point change, turn;
  for (std::size_t i = 0; i < kWidth; ++i) {
    change[i] = next.velocity_uu_ms[i] - last.velocity_uu_ms[i];
    turn[i] = next.direction[i] - last.direction[i];
  }
  for (std::size_t i = 0; i < kWidth; ++i) {
    change[i] *= change[i];
    turn[i] *= turn[i];
  }
  Blend blend;
  const double turn2 = sum<kWidth>(turn);
  blend.is_steady = std::sqrt(sum<kWidth>(change)) <= kSameSpeedTolerance * std::max(last.speed_uu_ms, next.speed_uu_ms);
  const bool along_path = !blend.is_steady && turn2 <= kTangentTolerance * kTangentTolerance;
  const double room_ms = std::min(2 * last.time_ms - entry_total_ms_, 2 * next.time_ms - exit_.total_ms());
  blend.is_whole = entry_.total_ms() <= room_ms;
  blend.ramp = blend.is_whole ? entry_ : scaled_to(entry_, std::max(0.0, room_ms));
  blend.possible = !along_path && (blend.is_steady || blend.ramp.total_ms() / 2 > kNoTime_ms);
  return blend;
}

/// As Planner::cruise_until().
template <std::size_t kWidth>
void LinePath::cruise_until(double time_ms) {
  const Line& last = line_[pending_];
  piece_.owner = pending_;
  piece_.start_ms = clock_ms_;
  piece_.duration_ms = time_ms - clock_ms_;
  piece_.part_count = 1;
  piece_.part[0] = {pending_, {(clock_ms_ - nominal_start_ms_) * last.per_ms, last.per_ms, 0, 0}};
  clock_ms_ = time_ms;
  walk<kWidth>();
}

/// As Planner::blend_corner().
template <std::size_t kWidth>
void LinePath::corner(std::size_t next, const Ramp& ramp, const RampParts& parts) {
  const double out = line_[pending_].per_ms, in = line_[next].per_ms, half_ms = ramp.total_ms() / 2;
  for (int k = 0; k < parts.count; ++k) {
    const RampPart& part = parts.part[static_cast<std::size_t>(k)];
    piece_.owner = next;
    piece_.start_ms = clock_ms_ + part.start_ms;
    piece_.duration_ms = part.duration_ms;
    piece_.part_count = 2;
    piece_.part[0] = {pending_, {1 - (half_ms - part.start_ms + part.integral_ms) * out, (1 - part.value) * out, -part.slope * out / 2, -part.curvature * out / 6}};
    piece_.part[1] = {next, {part.integral_ms * in, part.value * in, part.slope * in / 2, part.curvature * in / 6}};
    walk<kWidth>();
  }
}

// --- nodes and segments ------------------------------------------------------------------------------------------------------

/// As Segmenter::add(): a node on every multiple of the segment time, and one at the end.
template <std::size_t kWidth>
void LinePath::walk() {
  if (piece_.duration_ms <= kNoTime_ms) return;
  piece_made_ = true;
  const double step_ms = stages_.config.segment_time_ms, end_ms = piece_.start_ms + piece_.duration_ms, from_ms = node_[open_].time_ms;
  for (;; ++next_grid_) {
    const double time_ms = origin_ms_ + static_cast<double>(next_grid_) * step_ms;
    if (time_ms > end_ms - kMinGap_ms) {
      if (end_ms - from_ms >= kMinGap_ms) add_node<kWidth>(piece_.duration_ms, end_ms);
      if (time_ms <= end_ms + kMinGap_ms) ++next_grid_;
      break;
    }
    if (time_ms >= from_ms + kMinGap_ms) add_node<kWidth>(time_ms - piece_.start_ms, piece_.start_ms + (time_ms - piece_.start_ms));
  }
  end_is_open_ = node_[open_].time_ms != end_ms;
}

/// As evaluate() of a piece, at its time d.
template <std::size_t kWidth>
void LinePath::evaluate_at(double d, Point& position, Point& velocity) const {
  const auto place = [&](const Part& part, double& rate) {
    rate = part.u[1] + d * (2 * part.u[2] + d * 3 * part.u[3]);
    return exact_end(part.u[0] + d * (part.u[1] + d * (part.u[2] + d * part.u[3])));
  };
  double rate = 0;
  const Line& line = line_[piece_.part[0].line];
  const double u = place(piece_.part[0], rate), offset = u < 0.5 ? u : u - 1;
  const Point& base = u < 0.5 ? line.start : line.end;
  for (std::size_t i = 0; i < kWidth; ++i) {
    position[i] = base[i] + offset * line.delta[i];
    velocity[i] = line.delta[i] * rate;
  }
  if (piece_.part_count < 2) return;
  double rate2 = 0;
  const Line& next = line_[piece_.part[1].line];
  const double u2 = place(piece_.part[1], rate2), offset2 = u2 < 0.5 ? u2 : u2 - 1;
  const Point& base2 = u2 < 0.5 ? next.start : next.end;
  for (std::size_t i = 0; i < kWidth; ++i) {
    position[i] += base2[i] + offset2 * next.delta[i] - next.start[i];
    velocity[i] += next.delta[i] * rate2;
  }
}

/// As Segmenter::add_node() and the exact fit: with a node the segment before it is decided.
template <std::size_t kWidth>
void LinePath::add_node(double local_ms, double time_ms) {
  const std::size_t made = 3 - open_ - before_;
  Node& node = node_[made];
  node.time_ms = time_ms;
  node.command = line_[piece_.owner].id;
  node.source = line_[piece_.owner].source;
  Point position, velocity;
  evaluate_at<kWidth>(local_ms, position, velocity);
  if (is_diagonal_) {
    for (std::size_t m = 0; m < kWidth; ++m) {
      node.position_mu[m] = offset_mu_[m] + scale_mu_uu_[m] * position[m];
      node.velocity_mu_ms[m] = 0 + scale_mu_uu_[m] * velocity[m];
    }
  } else {
    node.position_mu = offset_mu_;
    node.velocity_mu_ms = {};
    for (std::size_t k = 0; k < term_count_; ++k) {
      const Term& term = term_[k];
      node.position_mu[term.motor] += term.coefficient * position[term.axis];
      node.velocity_mu_ms[term.motor] += term.coefficient * velocity[term.axis];
    }
  }
  push_segment<kWidth>(node_[before_], node_[open_]);
  before_ = open_;
  open_ = made;
}

template <std::size_t kWidth>
void LinePath::push_segment(const Node& from, const Node& to) {
  const double duration_ms = to.time_ms - from.time_ms, start_ms = stages_.sequence_ms + from.time_ms;
  Segment& segment = stages_.timeline.extend(start_ms, duration_ms);
  segment.command = to.command;
  segment.source = to.source;
  segment.start_ms = from.time_ms;
  segment.motor.resize(motor_count_);
  Point c2, c3;
  for (std::size_t m = 0; m < kWidth; ++m) {   // as hermite_cubic()
    const double mean = (to.position_mu[m] - from.position_mu[m]) / duration_ms, v0 = from.velocity_mu_ms[m], v1 = to.velocity_mu_ms[m];
    c2[m] = (3 * mean - 2 * v0 - v1) / duration_ms;
    c3[m] = (v0 + v1 - 2 * mean) / (duration_ms * duration_ms);
  }
  MotorCubic* q = segment.motor.data();
  for (std::size_t m = 0; m < std::min(motor_count_, kWidth); ++m) q[m] = {from.position_mu[m], from.velocity_mu_ms[m], c2[m], c3[m]};
  cover(from.time_ms, start_ms, duration_ms);
}

// --- when moves are executed -----------------------------------------------------------------------------------------------------

/// The line before ends where this one begins. As Timings::add().
void LinePath::begin_line(const Line& next, const Ramp& ramp) {
  Timings& t = stages_.timings;
  const double boundary_ms = nominal_end_ms(), covered_ms = t.covered_programmed_ms_ + kSamePlace_ms;
  t.records_.back().end = {boundary_ms, 0, true, false};
  Timings::Record& record = t.records_.extend();
  record = {next.id, next.length_uu, {boundary_ms - ramp.total_ms() / 2, 0, true, false}, {boundary_ms, 0, true, false}, {}, next.rule};
  ++t.unknown_starts_;
  const std::size_t count = t.records_.size();
  if (syncs_known_ + 1 == count && record.sync.programmed_ms <= covered_ms) know_sync(t.covered_ms_);
  if (starts_known_ + 1 == count && boundary_ms <= covered_ms) know_start(t.covered_ms_);
}

void LinePath::know_sync(double time_ms) {
  Timings::Place& sync = stages_.timings.records_[syncs_known_++].sync;
  sync.time_ms = time_ms;
  sync.known = true;
}

void LinePath::know_start(double time_ms) {
  Timings& t = stages_.timings;
  Timings::Place& start = t.records_[starts_known_].start;
  start.time_ms = time_ms;
  start.known = true;
  t.starts_ms_.push_back(time_ms);
  --t.unknown_starts_;
  if (starts_known_ > 0) {
    Timings::Place& end = t.records_[starts_known_ - 1].end;
    end.time_ms = time_ms;
    end.known = true;
  }
  ++starts_known_;
}

/// As Timings::cover(): programmed time is executed at its own rate.
void LinePath::cover(double from_ms, double start_ms, double duration_ms) {
  Timings& t = stages_.timings;
  const double end_ms = from_ms + duration_ms, limit_ms = end_ms + kSamePlace_ms;
  const std::size_t count = t.records_.size();
  while (syncs_known_ < count && t.records_[syncs_known_].sync.programmed_ms <= limit_ms) know_sync(start_ms + duration_ms);
  while (starts_known_ < count && t.records_[starts_known_].start.programmed_ms <= limit_ms) {
    const double d = std::clamp(t.records_[starts_known_].start.programmed_ms - from_ms, 0.0, duration_ms);
    know_start(start_ms + (d >= duration_ms - kSamePlace_ms ? duration_ms : d));
  }
  t.covered_programmed_ms_ = end_ms;
  t.covered_ms_ = start_ms + duration_ms;
  for (; starts_known_ > 1 && syncs_known_ > 0; --syncs_known_, --starts_known_) {
    const Timings::Record& ended = t.records_.front();
    ended_.push_back({ended.id, ended.start.time_ms, ended.end.time_ms, ended.length_uu, ended.rule});
    t.records_.pop_front();
  }
}

// --- giving back -------------------------------------------------------------------------------------------------------------------

void LinePath::close() {
  if (added_ == 0) return;
  const CurveRef last = curve_of(line_[pending_]);
  return_planner(last);
  return_segmenter(last);
  stages_.timings.sync_delivered_ = syncs_known_;
  stages_.timings.find_due();
}

CurveRef LinePath::curve_of(const Line& line) const {
  AxisVector start = stages_.planner.position_, end = start;
  for (std::size_t i = 0; i < axis_count_; ++i) {
    start[axis_of_[i]] = line.start[i];
    end[axis_of_[i]] = line.end[i];
  }
  CurveRef curve = CurveRef::make();
  set_line(curve.fill(), start, end, axes_);
  return curve;
}

void LinePath::return_planner(const CurveRef& last) {
  Planner& p = stages_.planner;
  const Line& line = line_[pending_];
  p.position_ = last->end;
  Move& move = p.pending_;
  move.id = line.id;
  move.source = line.source;
  move.curve = last;
  move.time_ms = line.time_ms;
  move.length_uu = line.length_uu;
  move.rule = line.rule;
  move.entry = {like_.ta_ms, like_.ts_ms};
  move.exit = {like_.td_ms, like_.tsd_ms};
  move.stop_ramp = exit_;
  move.no_blend = move.pvt = false;
  move.normal = like_.normal;
  move.second_set = like_.second_set;
  p.nominal_start_ms_ = nominal_start_ms_;
  p.entry_total_ms_ = entry_total_ms_;
  p.clock_ms_ = clock_ms_;
}

void LinePath::return_segmenter(const CurveRef& last) {
  Segmenter& s = stages_.segmenter;
  const auto give = [&](const Node& from, MotorNode& to) {
    to.time_ms = from.time_ms;
    to.command = from.command;
    to.source = from.source;
    to.position_mu.resize(motor_count_);
    std::copy_n(from.position_mu.begin(), motor_count_, to.position_mu.begin());
    to.before.stretch = s.stretch_;
    to.before.velocity_mu_ms.resize(motor_count_);
    std::copy_n(from.velocity_mu_ms.begin(), motor_count_, to.before.velocity_mu_ms.begin());
    to.after = to.before;
    to.passed_ms = 0;
    to.step = false;
  };
  give(node_[open_], s.open());
  MotorNode& before = s.nodes_[1 - s.open_at_];
  give(node_[before_], before);
  std::vector<Segment> none;
  s.fit_->finish(none);
  s.fit_->add(before, none);
  s.next_grid_ = next_grid_;
  if (!piece_made_) return;
  s.end_is_open_ = end_is_open_;
  const CurveRef other = curve_of(line_[previous_]);
  PathPiece& previous = s.previous_;
  previous = {};
  previous.command = line_[piece_.owner].id;
  previous.source = line_[piece_.owner].source;
  previous.start_ms = piece_.start_ms;
  previous.duration_ms = piece_.duration_ms;
  previous.part_count = piece_.part_count;
  for (std::size_t k = 0; k < static_cast<std::size_t>(piece_.part_count); ++k) previous.part[k] = {piece_.part[k].line == pending_ ? last : other, piece_.part[k].u};
}

}  // namespace pmac::motion
