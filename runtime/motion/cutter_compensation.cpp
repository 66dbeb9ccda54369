#include "runtime/motion/cutter_compensation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "runtime/motion/circle.h"

namespace pmac::motion {
namespace {

using runtime::Fault;
using runtime::FaultKind;
using runtime::Result;

constexpr double kTangent = 1e-6;             // sine of a change of direction that is none
constexpr double kReversalCosine = -0.9998477;  // 180 degrees within 1
constexpr double kNoWay = 1e-12;              // uu
constexpr double kBackwards = 1e-9;           // uu

double side_of(const MotionCommand& command) { return command.compensation_side == 1 ? 1 : -1; }
double offset_of(const MotionCommand& command) { return side_of(command) * command.compensation_radius_uu; }

/// Angle of a compensated arc: the programmed one, less and more what its ends have moved.
double compensated_sweep(const PlaneMove& move, Point start, Point end) {
  return move.sweep_rad - signed_angle(move.start - move.center, start - move.center, move.turn) +
         signed_angle(move.end - move.center, end - move.center, move.turn);
}

/// How far a compensated move goes in its own direction; negative: backwards.
double progress(const PlaneMove& move, Point start, Point end) {
  if (move.is_arc) return compensated_sweep(move, start, end) * std::max(move.start_radius, move.end_radius);
  return dot(end - start, move.start_direction);
}

/// The point lies before the end of `a` and behind the start of `b`, where they are lines.
bool shortens_both(const OffsetCurve& a, const OffsetCurve& b, Point p) {
  const bool in_a = a.is_circle || dot(p - a.end, a.end - a.start) <= kBackwards;
  const bool in_b = b.is_circle || dot(p - b.start, b.end - b.start) >= -kBackwards;
  return in_a && in_b;
}

}  // namespace

std::optional<Fault> CutterCompensation::add(const MotionCommand& command, const AxisVector& start_uu, std::vector<MotionCommand>& out) {
  if (!active_ && command.compensation_side == 0) {
    out.push_back(command);
    return std::nullopt;
  }
  if (!active_) frame_ = PlaneFrame(command.normal);
  if (auto fault = check(command)) return fault;
  const auto geometry = plane_move(command, start_uu);
  if (const Fault* fault = std::get_if<Fault>(&geometry)) return *fault;
  const auto& move = std::get<std::optional<PlaneMove>>(geometry);
  if (!active_) position_ = start_uu;
  if (!move) return carry(command, out);
  if (!active_) return lead_in(command, *move, start_uu);
  return command.compensation_side == 0 ? lead_out(command, *move, out) : go_on(command, *move, out);
}

std::optional<Fault> CutterCompensation::flush(std::vector<MotionCommand>& out) {
  if (held_.empty()) return std::nullopt;
  Held& last = held_.back();
  last.end = offset_curve(last.move, last.start_offset, last.end_offset).end;
  if (!last.lead_in && progress(last.move, last.start, last.end) < -kBackwards)
    return Fault{FaultKind::kCcDirection, last.command.source, "the compensated move would go backwards; the tool does not fit"};
  at_rest_ = last;
  emit_all(out);
  return std::nullopt;
}

// --- what comes in ------------------------------------------------------------------------------------------------------

std::optional<Fault> CutterCompensation::check(const MotionCommand& command) const {
  if (active_ && command.normal != frame_.normal())
    return Fault{FaultKind::kCcMoveType, command.source, "a new plane normal while cutter compensation is on"};
  if (command.kind == CommandKind::kDelay) return std::nullopt;
  if (command.kind == CommandKind::kPvt)
    return Fault{FaultKind::kCcMoveType, command.source, "pvt and spline moves are not allowed while cutter compensation is on"};
  if (command.second_set)
    return Fault{FaultKind::kCcMoveType, command.source, "circle3 and circle4 are not allowed while cutter compensation is on; it acts on X Y Z"};
  if (command.feed_uu == 0 || command.inverse_time)
    return Fault{FaultKind::kCcFeedRate, command.source, "moves under cutter compensation need a feed rate; set F instead of tm or inverse time"};
  return std::nullopt;
}

/// The move's way in the plane; nothing where it has none.
Result<std::optional<PlaneMove>> CutterCompensation::plane_move(const MotionCommand& command, const AxisVector& start_uu) const {
  if (command.kind == CommandKind::kDelay) return std::optional<PlaneMove>{};
  const Point start = frame_.point(start_uu), end = frame_.point(command.target_uu);
  if (command.kind == CommandKind::kCircle && (command.has_center || command.has_radius)) {
    PipelineConfig config;
    config.radius_error_limit_uu = config_.radius_error_limit_uu;
    config.min_arc_len = config_.min_arc_len;
    const auto made = make_arc(command, start_uu, command.target_uu, config);
    if (const Fault* fault = std::get_if<Fault>(&made)) return *fault;
    const Curve& curve = std::get<Arc>(made).curve;
    AxisVector center{};
    std::copy(curve.center.begin(), curve.center.end(), center.begin() + kAxisX);
    return std::optional{plane_arc(start, end, frame_.point(center), curve.sweep_rad, command.clockwise ? -1 : 1)};
  }
  if (length(end - start) <= kNoWay) return std::optional<PlaneMove>{};
  return std::optional{plane_line(start, end)};
}

/// Motion beside the plane, or none: it waits for the move that it follows.
std::optional<Fault> CutterCompensation::carry(const MotionCommand& command, std::vector<MotionCommand>& out) {
  if (held_.empty()) {
    emit_carried(command, out);
    return std::nullopt;
  }
  std::vector<MotionCommand>& carried = held_.back().carried;
  if (static_cast<int>(carried.size()) >= config_.most_carried)
    return Fault{FaultKind::kCcBufferSize, command.source,
                 fmt::format("no motion in the plane of cutter compensation in {} moves; raise Coord[].CCSize", config_.most_carried)};
  carried.push_back(command);
  return std::nullopt;
}

CutterCompensation::Held CutterCompensation::hold(const MotionCommand& command, const PlaneMove& move) {
  Held held;
  held.command = command;
  held.move = move;
  return held;
}

std::optional<Fault> CutterCompensation::lead_in(const MotionCommand& command, const PlaneMove& move, const AxisVector& start_uu) {
  const double radius = command.compensation_radius_uu, way = length(move.end - move.start);
  if (move.is_arc) return Fault{FaultKind::kCcLeadIn, command.source, "the first move of cutter compensation must be a line"};
  if (way < radius)
    return Fault{FaultKind::kCcLeadIn, command.source, fmt::format("the first move of cutter compensation is {} long, less than the radius {}", way, radius)};
  active_ = true;
  compensated_moves_ = 0;
  position_ = start_uu;
  Held held = hold(command, move);
  held.end_offset = offset_of(command);
  held.start = move.start;
  held.lead_in = true;
  held_.push_back(std::move(held));
  return std::nullopt;
}

std::optional<Fault> CutterCompensation::go_on(const MotionCommand& command, const PlaneMove& move, std::vector<MotionCommand>& out) {
  const double before = held_.empty() ? at_rest_->end_offset : held_.back().end_offset;
  Held next = hold(command, move);
  next.start_offset = before;
  next.end_offset = offset_of(command);
  const OffsetCurve curve = offset_curve(move, next.start_offset, next.end_offset);
  if (move.is_arc && (curve.start_radius <= 0 || curve.end_radius <= 0))
    return Fault{FaultKind::kCcNoSolution, command.source,
                 fmt::format("the arc's radius {} is not more than the tool's {}", std::min(move.start_radius, move.end_radius), std::abs(next.end_offset))};
  ++compensated_moves_;
  if (held_.empty()) {
    start_from_rest(next, out);
  } else {
    if (!change_side(held_.back(), next))
      if (auto fault = join(held_.back(), next)) return fault;
    if (auto fault = leave_out(next)) return fault;
  }
  held_.push_back(std::move(next));
  while (static_cast<int>(held_.size()) > 1 + std::max(0, config_.most_left_out)) emit_front(out);
  return std::nullopt;
}

std::optional<Fault> CutterCompensation::lead_out(const MotionCommand& command, const PlaneMove& move, std::vector<MotionCommand>& out) {
  const double radius = std::abs(held_.empty() ? at_rest_->end_offset : held_.back().end_offset), way = length(move.end - move.start);
  if (compensated_moves_ == 0) return Fault{FaultKind::kCcNoMoves, command.source, "no move between the first and the last move of cutter compensation"};
  if (move.is_arc) return Fault{FaultKind::kCcLeadOut, command.source, "the last move of cutter compensation must be a line"};
  if (way < radius)
    return Fault{FaultKind::kCcLeadOut, command.source, fmt::format("the last move of cutter compensation is {} long, less than the radius {}", way, radius)};
  Held last = hold(command, move);
  if (held_.empty()) {
    last.start_offset = at_rest_->end_offset;
    const double side = last.start_offset * cross(at_rest_->move.end_direction, move.start_direction);
    if (side < 0) start_from_rest(last, out);
  } else {
    Held& previous = held_.back();
    last.start_offset = previous.end_offset;
    previous.end = offset_curve(previous.move, previous.start_offset, previous.end_offset).end;
    if (progress(previous.move, previous.start, previous.end) < -kBackwards)
      return Fault{FaultKind::kCcDirection, previous.command.source, "the compensated move would go backwards; the tool does not fit"};
    const Point before = previous.move.end_direction, after = move.start_direction;
    const bool outside = last.start_offset * cross(before, after) < 0 || dot(before, after) < kReversalCosine;
    if (outside && !is_shallow(dot(before, after))) round(previous, last);
  }
  emit_all(out);
  active_ = false;
  at_rest_.reset();
  out.push_back(command);
  out.back().axes |= 7u << kAxisX;
  out.back().compensation_side = 0;
  return std::nullopt;
}

// --- corners ------------------------------------------------------------------------------------------------------------

bool CutterCompensation::is_shallow(double cosine) const {
  constexpr double kUsual = 0.9998;
  return cosine >= (config_.added_arc_bp == 0 ? kUsual : config_.added_arc_bp);
}

/// The arc about a programmed corner; left of the path it turns clockwise.
PlaneMove CutterCompensation::corner_arc(Point corner, Point before, Point after, double offset) const {
  const Point from = left_of(before) * offset, to = left_of(after) * offset;
  const double turn = offset > 0 ? -1 : 1;
  return plane_arc(corner + from, corner + to, corner, angle_between(from, to, turn), turn);
}

/// Outside corner with an arc.
void CutterCompensation::round(Held& previous, Held& next) const {
  const PlaneMove arc = corner_arc(next.move.start, previous.move.end_direction, next.move.start_direction, next.start_offset);
  previous.end = arc.start;
  next.start = arc.end;
  previous.added = arc;
}

std::optional<Fault> CutterCompensation::join(Held& previous, Held& next) const {
  if (previous.lead_in) {
    join_lead_in(previous, next);
    return std::nullopt;
  }
  const Point corner = next.move.start, before = previous.move.end_direction, after = next.move.start_direction;
  const double offset = next.start_offset, cosine = dot(before, after), sine = cross(before, after);
  if (offset == 0 || (cosine > 0 && std::abs(sine) < kTangent)) {
    previous.end = next.start = corner + left_of(before) * offset;
    return std::nullopt;
  }
  const OffsetCurve a = offset_curve(previous.move, previous.start_offset, previous.end_offset);
  const OffsetCurve b = offset_curve(next.move, next.start_offset, next.end_offset);
  const bool reversal = cosine < kReversalCosine, arcs = previous.move.is_arc || next.move.is_arc;
  const std::optional<Point> crossing = !reversal ? nearest_crossing(a, b, corner) : arcs ? shared_crossing(a, b, corner) : std::nullopt;
  const bool inside = reversal ? crossing.has_value() : offset * sine > 0;
  const bool meets = crossing && (inside || is_shallow(cosine));
  if (inside && !crossing)
    return Fault{FaultKind::kCcNoIntersection, next.command.source, "the compensated paths of this move and the one before do not meet; the tool does not fit"};
  if (meets) previous.end = next.start = *crossing;
  else round(previous, next);
  return std::nullopt;
}

/// The lead-in ends beside the start of the first compensated move, outside by way of an arc.
void CutterCompensation::join_lead_in(Held& previous, Held& next) const {
  const Point before = previous.move.end_direction, after = next.move.start_direction;
  const bool outside = next.start_offset * cross(before, after) < 0 || dot(before, after) < kReversalCosine;
  if (outside && !is_shallow(dot(before, after))) return round(previous, next);
  previous.end = next.start = next.move.start + left_of(after) * next.start_offset;
}

/// Compensation changes sides where the parallel curves cross each other; otherwise along the next move.
bool CutterCompensation::change_side(Held& previous, Held& next) const {
  if (next.start_offset * next.end_offset >= 0 || previous.lead_in) return false;
  const OffsetCurve there = offset_curve(next.move, next.end_offset, next.end_offset);
  if (next.move.is_arc && (there.start_radius <= 0 || there.end_radius <= 0)) return false;
  const auto crossing = shared_crossing(offset_curve(previous.move, previous.start_offset, previous.end_offset), there, next.move.start);
  if (!crossing) return false;
  next.start_offset = next.end_offset;
  previous.end = next.start = *crossing;
  return true;
}

/// Moves that the tool does not reach, because both their neighbours' paths cut them off, are left out.
std::optional<Fault> CutterCompensation::leave_out(Held& next) {
  for (int left_out = 0; !held_.back().lead_in && progress(held_.back().move, held_.back().start, held_.back().end) < -kBackwards; ++left_out) {
    const SourceLine source = held_.back().command.source;
    if (config_.most_left_out <= 0)
      return Fault{FaultKind::kCcDirection, source, "the compensated move would go backwards; the tool does not fit"};
    const Fault stuck{FaultKind::kCcDistance, source,
                      fmt::format("the tool does not fit here, and leaving out up to Coord[].CCDistance = {} moves does not help", config_.most_left_out)};
    if (left_out == config_.most_left_out || held_.size() < 2 || held_[held_.size() - 2].lead_in) return stuck;
    const Held removed = std::move(held_.back());
    held_.pop_back();
    Held& previous = held_.back();
    previous.added.reset();
    previous.carried.insert(previous.carried.end(), removed.carried.begin(), removed.carried.end());
    next.command.axes |= removed.command.axes;
    const OffsetCurve a = offset_curve(previous.move, previous.start_offset, previous.end_offset);
    const OffsetCurve b = offset_curve(next.move, next.start_offset, next.end_offset);
    const auto crossing = nearest_crossing(a, b, next.move.start);
    if (!crossing || !shortens_both(a, b, *crossing)) return stuck;
    previous.end = next.start = *crossing;
  }
  return std::nullopt;
}

/// After a flush the tool stands at right angles to the end of the last move.
void CutterCompensation::start_from_rest(Held& next, std::vector<MotionCommand>& out) {
  const Held& last = *at_rest_;
  const Point corner = next.move.start, before = last.move.end_direction, after = next.move.start_direction;
  next.start = corner + left_of(after) * next.start_offset;
  if (length(next.start - last.end) <= kBackwards) return;
  const bool outside = next.start_offset * cross(before, after) < 0 || dot(before, after) < kReversalCosine;
  emit_added(last.command, outside ? corner_arc(corner, before, after, next.start_offset) : plane_line(last.end, next.start), out);
}

// --- what goes out ------------------------------------------------------------------------------------------------------

void CutterCompensation::emit_all(std::vector<MotionCommand>& out) {
  while (!held_.empty()) emit_front(out);
}

void CutterCompensation::emit_front(std::vector<MotionCommand>& out) {
  const Held held = std::move(held_.front());
  held_.pop_front();
  emit_move(held, out);
  if (held.added) emit_added(held.command, *held.added, out);
  for (const MotionCommand& command : held.carried) emit_carried(command, out);
}

void CutterCompensation::emit_move(const Held& held, std::vector<MotionCommand>& out) {
  MotionCommand command = held.command;
  command.axes |= 7u << kAxisX;
  command.no_blend = command.no_blend && !held.added;  // the stop of an outside corner comes after its arc
  frame_.put(command.target_uu, held.end);
  const double sweep = held.move.is_arc ? compensated_sweep(held.move, held.start, held.end) : 0;
  const double way = held.move.is_arc ? sweep * held.move.start_radius : length(held.end - held.start);
  command.kind = held.move.is_arc && way > kBackwards ? CommandKind::kCircle : CommandKind::kLinear;
  command.has_radius = false;
  command.has_center = command.kind == CommandKind::kCircle;
  if (command.has_center) {
    command.center_uu = frame_.vector(held.move.center - held.start);
    command.sweep_rad = sweep;
  }
  const bool moves = way > kBackwards || command.target_uu != position_;
  if (moves) put_out(std::move(command), out);
}

void CutterCompensation::emit_added(const MotionCommand& before, const PlaneMove& move, std::vector<MotionCommand>& out) {
  MotionCommand command = before;
  command.id = before.id + 1;
  command.added = true;
  command.kind = move.is_arc ? CommandKind::kCircle : CommandKind::kLinear;
  command.axes = 7u << kAxisX;
  command.target_uu = position_;
  frame_.put(command.target_uu, move.end);
  command.has_radius = false;
  command.has_center = move.is_arc;
  if (move.is_arc) {
    command.clockwise = move.turn < 0;
    command.center_uu = frame_.vector(move.center - move.start);
    command.sweep_rad = move.sweep_rad;
  }
  put_out(std::move(command), out);
}

void CutterCompensation::emit_carried(MotionCommand command, std::vector<MotionCommand>& out) {
  if (active_) frame_.put(command.target_uu, frame_.point(position_));
  put_out(std::move(command), out);
}

void CutterCompensation::put_out(MotionCommand command, std::vector<MotionCommand>& out) {
  position_ = command.target_uu;
  out.push_back(std::move(command));
}

}  // namespace pmac::motion
