#include "compiler/translate/path_merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pmac::compiler::translate {
namespace {

constexpr double kRoundedPulses = 2;  // how far whole numbers may be away from what they stand for

/// Speed at the end of the first phase of a move that is too short to reach VEL, or VEL.
double reached_speed(double d, double v0, double v, double up, double stop) { return up + stop > 0 ? std::min(v, std::sqrt((2 * d + v0 * v0 * up) / (up + stop))) : v; }

AxisPart part_of(const CardMotion& motion, double from) {
  AxisPart part;
  part.from = from;
  part.is_circle = motion.kind == CardMotionKind::kCircle;
  part.to = part.is_circle ? motion.end_point : motion.kind == CardMotionKind::kMoveBy ? from + motion.target : motion.target;
  part.direction = motion.direction, part.radius = motion.radius, part.i = motion.i, part.j = motion.j, part.distance = motion.distance;
  return part;
}

bool is_about(double a, double b) { return std::abs(a - b) <= kRoundedPulses; }

/// Whether two CIRCLEs are an arc with `right` as its horizontal axis.
bool is_arc(const AxisPart& right, const AxisPart& up) {
  return right.is_circle && up.is_circle && right.direction == up.direction && right.radius == up.radius && right.distance == up.distance && right.distance > 0 &&
         is_about(up.i, right.j) && is_about(up.j, -right.i) && is_about(std::hypot(right.i, right.j), right.radius);
}

/// Axes that can make a plane, in the order right, up.
std::vector<std::array<std::string_view, 2>> planes() { return {{"X", "Y"}, {"Y", "Z"}, {"Z", "X"}}; }

PathKind kind_of(PathMove& move, const std::vector<CardPath>& cards) {
  std::vector<std::size_t> circles, moving;
  for (std::size_t k = 0; k < move.axes.size(); ++k) {
    if (move.axes[k].own_length() > 0) moving.push_back(k);
    if (move.axes[k].is_circle && move.axes[k].distance > 0) circles.push_back(k);
  }
  if (moving.empty()) return PathKind::kStand;
  if (circles.empty()) return PathKind::kLine;
  if (circles.size() != 2 || moving.size() != 2) return PathKind::kOther;
  for (const auto& [right, up] : planes()) {
    for (int turn = 0; turn < 2; ++turn, std::swap(circles[0], circles[1])) {
      if (cards[circles[0]].axis != right || cards[circles[1]].axis != up) continue;
      const AxisPart &a = move.axes[circles[0]], &b = move.axes[circles[1]];
      const bool seen_from_front = is_arc(a, b);
      if (!seen_from_front && !is_arc(b, a)) return PathKind::kOther;
      move.plane = {circles[0], circles[1]};
      move.clockwise = (a.direction > 0) == seen_from_front;
      return PathKind::kArc;
    }
  }
  return PathKind::kOther;
}

bool agree(const CardMotion& a, const CardMotion& b) {
  return a.master_length == b.master_length && a.vel == b.vel && a.acc == b.acc && a.dec == b.dec && a.stp == b.stp;
}

std::string place_of(const CardMotion& motion) { return motion.line >= 0 ? fmt::format("line {}", motion.line) : std::string(); }

/// What keeps motions from being moves of one path, told once.
bool belong_together(const std::vector<CardTrace>& traces, source::Diagnostics& diagnostics) {
  const std::size_t count = traces[0].motions.size();
  for (const CardTrace& trace : traces) {
    for (const CardMotion& motion : trace.motions) {
      if (motion.master_length != 0 || traces.size() == 1) continue;
      diagnostics.error("ACR-E16", motion.span, fmt::format("with P28=0 axis {} moves by itself beside the others; one motion program cannot do that: give P28 the longest way on all cards", trace.axis));
      return false;
    }
    if (trace.motions.size() == count) continue;
    const CardTrace& longer = trace.motions.size() > count ? trace : traces[0];
    const CardTrace& shorter = trace.motions.size() > count ? traces[0] : trace;
    diagnostics.error("ACR-E16", longer.motions[shorter.motions.size()].span, fmt::format("axis {} has a coordinated motion here and axis {} has none for it, so it would wait for ever", longer.axis, shorter.axis));
    return false;
  }
  for (std::size_t i = 0; i < count; ++i)
    for (const CardTrace& trace : traces) {
      if (agree(trace.motions[i], traces[0].motions[i])) continue;
      diagnostics.error("ACR-E16", trace.motions[i].span, fmt::format("P28, VEL, ACC, DEC or STP of axis {} differ from those of axis {} here, so the axes take different times; one move has one time", trace.axis, traces[0].axis));
      return false;
    }
  return true;
}

}  // namespace

double AxisPart::own_length() const { return is_circle ? distance : std::abs(to - from); }

double AxisPart::at(double u) const {
  if (u >= 1) return to;
  if (!is_circle) return from + (to - from) * u;
  const double theta = direction * distance / radius * u;
  return from + i * (std::cos(theta) - 1) + j * std::sin(theta);
}

double MasterTimes::at(double t) const {
  const double first = std::clamp(t, 0.0, start_s), middle = std::clamp(t - start_s, 0.0, steady_s), last = std::clamp(t - start_s - steady_s, 0.0, end_s);
  double s = speed * middle;
  if (start_s > 0) s += entry_speed * first + (speed - entry_speed) * first * first / (2 * start_s);
  if (end_s > 0) s += speed * last - speed * last * last / (2 * end_s);
  return std::min(s, length);
}

MasterTimes master_times(double d, double v0, const CardMotion& motion, const PathOptions& options) {
  const double v = motion.vel * options.vel_unit, stop = motion.stp * options.ramp_unit;
  const double up = motion.acc > 0 ? 1 / (motion.acc * options.ramp_unit) : 0;
  const double down = motion.dec > 0 ? 1 / (motion.dec * options.ramp_unit) : 0;
  const double to_rest = stop > 0 ? 1 / stop : 0;
  MasterTimes times;
  times.length = d;
  times.entry_speed = v0;
  if (stop > 0 && v0 * v0 * to_rest / 2 > d * (1 + 1e-9)) {
    times.forced_stop = true;
    times.speed = v0;
    times.end_s = 2 * d / v0;
    return times;
  }
  double ramp = up;
  times.speed = v0 <= v ? reached_speed(d, v0, v, up, to_rest) : v;
  if (v0 > v) {
    ramp = down;
    if ((v0 * v0 - v * v) * down / 2 > d - v * v * to_rest / 2)
      times.speed = stop > 0 ? std::sqrt((v0 * v0 * down - 2 * d) / (down - to_rest)) : std::sqrt(v0 * v0 - 2 * d / down);
  }
  const double peak = times.speed;
  times.start_s = std::abs(peak - v0) * ramp;
  times.end_s = peak * to_rest;
  const double rest = d - std::abs(peak * peak - v0 * v0) * ramp / 2 - peak * peak * to_rest / 2;
  times.steady_s = std::max(rest, 0.0) / peak;
  times.exit_speed = stop > 0 ? 0 : peak;
  return times;
}

std::vector<PathMove> merge(const std::vector<CardTrace>& traces, const std::vector<CardPath>& cards, const PathOptions& options, source::Diagnostics& diagnostics) {
  std::vector<PathMove> moves;
  if (traces.empty() || !belong_together(traces, diagnostics)) return moves;
  std::vector<double> position;
  for (const CardPath& card : cards) position.push_back(card.start);
  double carried = 0;
  for (std::size_t n = 0; n < traces[0].motions.size(); ++n) {
    PathMove move;
    const CardMotion& first = traces[0].motions[n];
    move.span = first.span;
    move.place = place_of(first);
    for (std::size_t k = 0; k < traces.size(); ++k) {
      move.axes.push_back(part_of(traces[k].motions[n], position[k]));
      position[k] = move.axes.back().to;
    }
    const double length = first.master_length != 0 ? first.master_length : move.axes[0].own_length();
    const bool any_waited = std::any_of(traces.begin(), traces.end(), [&](const CardTrace& trace) { return trace.motions[n].waited; });
    move.kind = kind_of(move, cards);
    if (length == 0) {
      carried = 0;
      continue;
    }
    if (first.vel <= 0) {
      diagnostics.error("ACR-E11", first.span, "VEL is 0 at this motion; set it before the first one");
      return {};
    }
    move.times = master_times(length, any_waited ? 0 : carried, first, options);
    carried = move.times.exit_speed;
    moves.push_back(std::move(move));
  }
  return moves;
}

}  // namespace pmac::compiler::translate
