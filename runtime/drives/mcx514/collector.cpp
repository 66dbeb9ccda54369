#include "runtime/drives/mcx514/collector.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/motion/curve.h"

namespace pmac::drives::mcx514 {
namespace {

constexpr double kMoved_mu = 1e-6;            // less than this is rounding
constexpr double kSampleTolerance = 0.02;     // pulses, chords of curves that are given by points
constexpr double kSamePath = 1e-3;            // pulses, between an ideal line or circle and the motors

std::string who(const runtime::MoveRecord& move) {
  return move.motor >= 0 ? fmt::format("motor {}", move.motor) : fmt::format("coordinate system {}", move.coord);
}

bool stands_still(const runtime::MoveRecord& move) { return move.mode == "dwell" || move.mode == "delay"; }

/// Largest rate of the parameter over a part of a piece, 1/ms: at the ends or where it turns.
double largest_rate(const motion::PathPart& part, double duration_ms) {
  double most = std::max(std::abs(motion::parameter_rate(part, 0)), std::abs(motion::parameter_rate(part, duration_ms)));
  if (part.u[3] != 0) {
    const double turn = -part.u[2] / (3 * part.u[3]);
    if (turn > 0 && turn < duration_ms) most = std::max(most, std::abs(motion::parameter_rate(part, turn)));
  }
  return most;
}

bool same_curve(const motion::PathPiece& a, const motion::PathPiece& b) { return a.part_count == 1 && b.part_count == 1 && a.part[0].curve == b.part[0].curve; }

}  // namespace

void Collector::take(int coord, const motion::PathPiece& piece) {
  std::deque<Group>& groups = groups_[coord];
  if (groups.empty() || groups.back().command != piece.command || piece.starts_at_rest) groups.push_back({piece.command, piece.source, {}});
  groups.back().pieces.push_back(piece);
}

std::size_t Collector::slot(int motor) {
  const auto at = std::find(slots_.begin(), slots_.end(), motor);
  if (at == slots_.end() && slots_.size() == kAxes) {
    fail(fmt::format("motor {} is the fifth that moves; one chip has four axes, and interpolation over several chips is not simulated", motor));
    return 0;
  }
  if (at != slots_.end()) return static_cast<std::size_t>(at - slots_.begin());
  slots_.push_back(motor);
  return slots_.size() - 1;
}

/// Positions relative to the first ones, by axis; a motor that has left its first position gets one.
Point Collector::relative(std::span<const double> motor_mu, std::span<const int> motors) {
  Point p{};
  for (std::size_t i = 0; i < motors.size(); ++i) {
    const double base = base_mu_.try_emplace(motors[i], motor_mu[i]).first->second;
    const double moved = motor_mu[i] - base;
    const bool known = std::find(slots_.begin(), slots_.end(), motors[i]) != slots_.end();
    if (known || std::abs(moved) > kMoved_mu) p[slot(motors[i])] = moved;
  }
  return p;
}

void Collector::take(const runtime::SampleBlock& block) {
  std::vector<double> at(block.motors.size());
  for (int k = 0; k < block.count; ++k) {
    for (std::size_t m = 0; m < block.motors.size(); ++m) at[m] = block.at(static_cast<int>(m), k);
    const Point p = relative(at, block.motors);
    const std::size_t n = samples_.size();
    if (n >= 2 && samples_[n - 1].at == p && samples_[n - 2].at == p) samples_[n - 1].time_ms = block.time_ms(k);  // standing still
    else samples_.push_back({block.time_ms(k), p});
  }
  if (block.count > 0) process_ready(block.time_ms(block.count - 1));
}

void Collector::process_ready(double known_until_ms) {
  for (; !records_.empty() && records_.front().end_ms <= known_until_ms && failure_.empty(); records_.pop_front()) process(records_.front());
  const double needed_ms = records_.empty() ? last_end_ms_ : std::min(records_.front().start_ms, last_end_ms_);
  while (samples_.size() > 2 && samples_[1].time_ms < needed_ms) samples_.pop_front();
}

void Collector::process(const runtime::MoveRecord& move) {
  const bool has_motion = !stands_still(move);
  if (has_motion && move.start_ms < last_end_ms_ - 1e-6 && !last_who_.empty() && last_who_ != who(move))
    fail(fmt::format("{} and {} move at the same time (at {:.6f} s); one chip interpolates one path", last_who_, who(move), move.start_ms / 1000));
  std::deque<Group>& groups = groups_[move.coord];
  const auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.source == move.source; });
  const bool programmed = move.coord >= 0 && move.mode != "rapid" && move.mode != "dwell" && group != groups.end();
  if (programmed) {
    add_group(*group, move);
    groups.erase(groups.begin(), group + 1);
  } else if (has_motion) {
    add_samples(move);
  }
  if (has_motion) last_who_ = who(move);
  last_end_ms_ = std::max(last_end_ms_, move.end_ms);
}

// --- programmed moves -----------------------------------------------------------------------------------------------------------------

std::optional<Point> Collector::pulses(int coord, const motion::AxisVector& axis_uu) {
  motor_mu_.assign(bytecode::kMaxMotors, std::nan(""));
  if (const auto why = context_.motors_from_axes(coord, axis_uu, motor_mu_)) {
    fail(*why);
    return std::nullopt;
  }
  std::vector<int> motors;
  std::vector<double> at;
  for (std::size_t m = 0; m < motor_mu_.size(); ++m) {
    if (std::isnan(motor_mu_[m])) continue;
    motors.push_back(static_cast<int>(m));
    at.push_back(motor_mu_[m]);
  }
  return relative(at, motors);
}

double Collector::speed(int coord, const motion::PathPiece& piece) {
  // Motor pulses per unit of the parameter, from a small step; arcs and lines have the same everywhere, others nearly so within a piece.
  double most = 0;
  for (const double share : {0.05, 0.5, 0.95}) {
    const double time = share * piece.duration_ms, step = 0.01 * piece.duration_ms;
    const auto a = pulses(coord, motion::evaluate(piece, time - step).position), b = pulses(coord, motion::evaluate(piece, time + step).position);
    if (!a || !b || step <= 0) return 0;
    const double here = distance(*a, *b) / (2 * step);
    const double rate = std::abs(motion::parameter(piece.part[0], time + step) - motion::parameter(piece.part[0], time - step)) / (2 * step);
    const bool scales = piece.part_count == 1 && rate > 0;
    most = std::max(most, scales ? here / rate * largest_rate(piece.part[0], piece.duration_ms) : here);
  }
  return most * 1000;
}

/// A stretch of an arc whose motors run on a circle in the plane of two of them.
bool Collector::make_arc(int coord, const motion::Curve& curve, double u0, double u1, PathItem& item) {
  if (!curve.is_arc || curve.radius_change != 0) return false;
  motion::CurvePoint at;
  const auto point = [&](double u) {
    motion::evaluate(curve, u, at);
    return pulses(coord, at.position);
  };
  motion::evaluate(curve, u0, at);
  motion::AxisVector center_uu = at.position;
  for (std::size_t i = 0; i < 3; ++i) center_uu[static_cast<std::size_t>(curve.first_axis) + i] = curve.center[i] + u0 * curve.delta[static_cast<std::size_t>(curve.first_axis) + i];
  const auto center = pulses(coord, center_uu), start = point(u0), end = point(u1), later = point(u0 + 1e-3 * (u1 - u0));
  if (!center || !start || !end || !later) return false;
  std::vector<std::size_t> plane;
  const auto leaves_chord = [&](std::size_t axis, double share) {
    const double chord = (*start)[axis] + share * ((*end)[axis] - (*start)[axis]);
    return std::abs(point(u0 + share * (u1 - u0)).value_or(*start)[axis] - chord) > kSamePath;
  };
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    if (std::abs((*start)[axis] - (*center)[axis]) > kSamePath || leaves_chord(axis, 0.5) || leaves_chord(axis, 0.25)) plane.push_back(axis);
  if (plane.size() != 2) return false;
  item.plane = {plane[0], plane[1]};
  item.center = {(*center)[plane[0]], (*center)[plane[1]]};
  const double sx = (*start)[plane[0]] - item.center[0], sy = (*start)[plane[1]] - item.center[1];
  const double dx = (*later)[plane[0]] - (*start)[plane[0]], dy = (*later)[plane[1]] - (*start)[plane[1]];
  item.start_angle_rad = std::atan2(sy, sx);
  item.sweep_rad = std::copysign(std::abs(curve.sweep_rad * (u1 - u0)), sx * dy - sy * dx);
  for (const double share : {0.13, 0.38, 0.61, 0.87, 1.0}) {
    const auto motors = point(u0 + share * (u1 - u0));
    if (!motors || distance(*motors, arc_point(item, share)) > kSamePath * std::max(1.0, radius(item) * 1e-6)) return false;
  }
  item.kind = PathItem::Kind::kArc;
  return true;
}

/// Pieces first to last of a group: on one curve, or a single piece of another kind.
void Collector::add_part(const Group& group, int coord, std::size_t first, std::size_t last, PathItem& item) {
  const motion::PathPiece &a = group.pieces[first], &b = group.pieces[last];
  const auto start = pulses(coord, motion::evaluate(a, 0).position), end = pulses(coord, motion::evaluate(b, b.duration_ms).position);
  if (!start || !end) return;
  item.source = group.source;
  item.start = *start;
  item.end = *end;
  for (std::size_t i = first; i <= last; ++i) item.speed_pps = std::max(item.speed_pps, speed(coord, group.pieces[i]));
  const bool one_curve = a.part_count == 1;
  const motion::Curve& curve = *a.part[0].curve;
  const double u0 = motion::parameter(a.part[0], 0), u1 = motion::parameter(b.part[0], b.duration_ms);
  if (one_curve && make_arc(coord, curve, u0, u1, item)) return;
  motion::CurvePoint at;
  const auto on_curve = [&](double share) {
    motion::evaluate(curve, u0 + share * (u1 - u0), at);
    return pulses(coord, at.position).value_or(item.end);
  };
  const auto in_time = [&](double share) { return pulses(coord, motion::evaluate(a, share * a.duration_ms).position).value_or(item.end); };
  item.points = {item.start};
  if (one_curve) sample_curve(on_curve, 0, 1, kSampleTolerance, item.points);
  else sample_curve(in_time, 0, 1, kSampleTolerance, item.points);
  double off = 0;
  for (const Point& p : item.points) off = std::max(off, distance(p, nearest_on_segment(item.start, item.end, p)));
  item.kind = off <= kSamePath ? PathItem::Kind::kLine : PathItem::Kind::kPoints;
  if (item.kind == PathItem::Kind::kLine) item.points.clear();
}

void Collector::add_group(const Group& group, const runtime::MoveRecord& move) {
  double total_ms = 0, done_ms = 0;
  for (const motion::PathPiece& piece : group.pieces) total_ms += piece.duration_ms;
  for (std::size_t first = 0; first < group.pieces.size() && failure_.empty();) {
    std::size_t last = first;
    double part_ms = group.pieces[first].duration_ms;
    while (last + 1 < group.pieces.size() && same_curve(group.pieces[first], group.pieces[last + 1])) part_ms += group.pieces[++last].duration_ms;
    PathItem item;
    add_part(group, move.coord, first, last, item);
    add_item(std::move(item), move, total_ms > 0 ? done_ms / total_ms : 0, total_ms > 0 ? (done_ms + part_ms) / total_ms : 1);
    done_ms += part_ms;
    first = last + 1;
  }
  slow_down(move, group.source);
}

/// Lookahead and time base make a move slower than programmed: then what the samples show counts.
void Collector::slow_down(const runtime::MoveRecord& move, bytecode::SourceLine source) {
  double peak_pps = 0;
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    const Sample &a = samples_[i - 1], &b = samples_[i];
    if (a.time_ms < move.start_ms || b.time_ms > move.end_ms) continue;
    peak_pps = std::max(peak_pps, distance(a.at, b.at) / (b.time_ms - a.time_ms) * 1000);
  }
  if (peak_pps <= 0) return;
  for (auto item = path_.items.rbegin(); item != path_.items.rend() && item->source == source && item->start_s >= move.start_ms / 1000 - 1e-9; ++item)
    if (peak_pps < 0.995 * item->speed_pps) item->speed_pps = peak_pps;
}

void Collector::add_item(PathItem item, const runtime::MoveRecord& move, double share_start, double share_end) {
  if (!failure_.empty() || length(item) < kMoved_mu) return;
  const double duration_ms = move.end_ms - move.start_ms;
  item.start_s = (move.start_ms + share_start * duration_ms) / 1000;
  item.duration_s = (share_end - share_start) * duration_ms / 1000;
  path_.items.push_back(std::move(item));
}

// --- moves without pieces -------------------------------------------------------------------------------------------------------------

void Collector::add_samples(const runtime::MoveRecord& move) {
  PathItem item;
  item.kind = PathItem::Kind::kPoints;
  item.source = move.source;
  const Sample* before = nullptr;
  for (const Sample& sample : samples_) {
    if (sample.time_ms < move.start_ms && &sample != &samples_.back()) {
      before = &sample;
      continue;
    }
    if (item.points.empty() && before != nullptr) item.points.push_back(before->at);
    if (before != nullptr && sample.time_ms > before->time_ms) item.speed_pps = std::max(item.speed_pps, distance(before->at, sample.at) / (sample.time_ms - before->time_ms) * 1000);
    if (item.points.empty() || item.points.back() != sample.at) item.points.push_back(sample.at);
    before = &sample;
    if (sample.time_ms >= move.end_ms) break;
  }
  if (item.points.size() < 2) return;
  item.start = item.points.front();
  item.end = item.points.back();
  double off = 0;
  for (const Point& p : item.points) off = std::max(off, distance(p, nearest_on_segment(item.start, item.end, p)));
  if (off <= kSampleTolerance) {
    item.kind = PathItem::Kind::kLine;
    item.points.clear();
  }
  add_item(std::move(item), move, 0, 1);
}

std::variant<CollectedPath, std::string> Collector::finish() {
  process_ready(std::numeric_limits<double>::infinity());
  if (!failure_.empty()) return failure_;
  if (!path_.items.empty() && !samples_.empty() && distance(path_.items.back().end, samples_.back().at) > 1)
    path_.notes.push_back(fmt::format("the motors stopped {:.1f} pulses away from the end of the last move; the frames make the whole move", distance(path_.items.back().end, samples_.back().at)));
  // Axes in order of motor numbers
  std::vector<std::size_t> order(slots_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) { return slots_[a] < slots_[b]; });
  const auto reordered = [&](const Point& p) {
    Point q{};
    for (std::size_t i = 0; i < order.size(); ++i) q[i] = p[order[i]];
    return q;
  };
  for (std::size_t i = 0; i < order.size(); ++i) {
    path_.motors.push_back(slots_[order[i]]);
    path_.origin_mu[i] = base_mu_[slots_[order[i]]];
  }
  const auto place_of = [&](std::size_t axis) { return static_cast<std::size_t>(std::find(order.begin(), order.end(), axis) - order.begin()); };
  for (PathItem& item : path_.items) {
    item.start = reordered(item.start);
    item.end = reordered(item.end);
    for (Point& p : item.points) p = reordered(p);
    if (item.kind != PathItem::Kind::kArc) continue;
    item.plane = {place_of(item.plane[0]), place_of(item.plane[1])};
    if (item.plane[0] < item.plane[1]) continue;
    std::swap(item.plane[0], item.plane[1]);   // mirrored: what was counter-clockwise is clockwise
    std::swap(item.center[0], item.center[1]);
    item.start_angle_rad = M_PI / 2 - item.start_angle_rad;
    item.sweep_rad = -item.sweep_rad;
  }
  path_.end_s = last_end_ms_ / 1000;
  return std::move(path_);
}

}  // namespace pmac::drives::mcx514
