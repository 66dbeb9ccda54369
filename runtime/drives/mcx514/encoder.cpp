#include "runtime/drives/mcx514/encoder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "runtime/drives/mcx514/chord.h"
#include "runtime/drives/mcx514/line.h"

namespace pmac::drives::mcx514 {
namespace {

constexpr double kTolerance = 1.0;              // pulses, from the path
constexpr double kChordTolerance = 0.9;         // of lines along a curve of points, which itself is known to a few hundredths
constexpr double kShortestArc = 48;             // pulses; shorter ones become lines
constexpr std::int64_t kFastest_pps = 8'000'000, kFastestContinuous_pps = 4'000'000;

AxisCounts rounded(const Point& p) {
  AxisCounts counts{};
  for (std::size_t i = 0; i < p.size(); ++i) counts[i] = std::llround(p[i]);
  return counts;
}

Point as_point(const AxisCounts& counts) {
  Point p{};
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = static_cast<double>(counts[i]);
  return p;
}

bool too_long(const AxisCounts& from, const AxisCounts& to) {
  for (std::size_t i = 0; i < from.size(); ++i)
    if (std::abs(to[i] - from[i]) > kLargestDistance) return true;
  return false;
}

std::uint32_t moving_axes(const AxisCounts& from, const AxisCounts& to) {
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < from.size(); ++i)
    if (from[i] != to[i]) mask |= 1u << i;
  return mask;
}

}  // namespace

/// One drive command to be sent.
struct Encoder::Drive {
  std::uint8_t code = code::kLHK2;
  std::uint32_t axes = 3;
  AxisCounts finish{}, center{};                // relative
  std::array<std::size_t, 2> plane{0, 1};
  AxisCounts end{};                             // where the chip then stands
  std::uint64_t events = 0, doubles = 0;
  std::string comment;
};

Encoder::Encoder(const EncoderSetting& setting) : setting_(setting) {}

std::optional<std::string> Encoder::add(const PathItem& item) {
  const bool whole = item.kind == PathItem::Kind::kLine ? add_line(item) : item.kind == PathItem::Kind::kArc && (add_arc(item) || add_helix(item));
  if (!whole && failure_.empty()) {
    if (item.kind == PathItem::Kind::kArc) divide_arc(item);
    else add_points(item.kind == PathItem::Kind::kLine ? std::vector<Point>{item.start, item.end} : item.points, item);
  }
  ++item_;
  if (!failure_.empty()) return failure_;
  return std::nullopt;
}

// --- lines ----------------------------------------------------------------------------------------------------------------------------

/// One line from where the chip stands, if that stays within the tolerance.
bool Encoder::add_line(const PathItem& item) {
  const AxisCounts to = rounded(item.end);
  if (moving_axes(position_, to) == 0) return true;
  if (too_long(position_, to)) {
    failure_ = "a move is longer than the chip's range of 1073741823 pulses";
    return false;
  }
  const Point from_point = as_point(position_), to_point = as_point(to);
  const double start_off = distance(from_point, nearest_on_segment(item.start, item.end, from_point));
  const double end_off = distance(to_point, item.end);
  double longest = 0, sum2 = 0;
  int others = -1;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const double d = std::abs(to_point[i] - from_point[i]);
    longest = std::max(longest, d);
    sum2 += d * d;
    others += d > 0;
  }
  const double tracking = others > 0 ? 0.5 * std::sqrt(static_cast<double>(others)) * (others == 1 ? longest / std::sqrt(sum2) : 1.0) : 0.0;
  if (std::max(start_off, end_off) + tracking > kTolerance) return false;
  drive_line(to, item);
  return true;
}

void Encoder::drive_line(const AxisCounts& to, const PathItem& item) {
  Drive drive;
  const std::uint32_t moving = moving_axes(position_, to);
  const int count = __builtin_popcount(moving);
  const bool third_axes_rest = (moving & ~3u) == 0;
  if (count <= 2 && third_axes_rest) drive.axes = 3;
  else if (count <= 2) drive.axes = count == 2 ? moving : moving | (moving == 1u ? 2u : 1u);
  else drive.axes = moving;
  const int enabled = __builtin_popcount(drive.axes);
  drive.code = enabled == 2 ? code::kLHK2 : enabled == 3 ? code::kLHK3 : code::kLHK4;
  std::int64_t longest = 0, least = 0;
  for (std::size_t i = 0; i < to.size(); ++i) {
    drive.finish[i] = to[i] - position_[i];
    longest = std::max(longest, std::abs(drive.finish[i]));
    if (count == 2 && drive.finish[i] != 0) least = least == 0 ? std::abs(drive.finish[i]) : std::min(least, std::abs(drive.finish[i]));
  }
  drive.end = to;
  drive.events = static_cast<std::uint64_t>(longest);
  drive.doubles = static_cast<std::uint64_t>(least);
  drive.comment = "linear interpolation";
  send(std::move(drive), item);
}

void Encoder::add_points(const std::vector<Point>& points, const PathItem& item) {
  ChordFinder chords(points, kChordTolerance);
  for (std::optional<AxisCounts> to; failure_.empty() && (to = chords.next(position_));)
    if (*to != position_) drive_line(*to, item);
}

// --- arcs -----------------------------------------------------------------------------------------------------------------------------

namespace {

/// The whole centre (relative to the start of the chip) for which the chip's circle stays nearest to the arc, and how far it is from it at most.
struct BestCenter { Plane center; double off = 0; };

double distance_of_circles(const PathItem& arc, double start_x, double start_y, double cx, double cy) {
  const double r = std::hypot(start_x - cx, start_y - cy), angle = std::atan2(start_y - cy, start_x - cx), ideal = radius(arc);
  double worst = 0;
  constexpr int kLooks = 32;
  for (int i = 0; i <= kLooks; ++i) {
    const double a = angle + arc.sweep_rad * i / kLooks;
    worst = std::max(worst, std::abs(std::hypot(cx + r * std::cos(a) - arc.center[0], cy + r * std::sin(a) - arc.center[1]) - ideal));
  }
  return worst;
}

BestCenter best_center(const PathItem& arc, std::int64_t x, std::int64_t y) {
  BestCenter best{{}, 1e300};
  const std::int64_t cx = std::llround(arc.center[0]), cy = std::llround(arc.center[1]);
  for (std::int64_t dx = -1; dx <= 1; ++dx)
    for (std::int64_t dy = -1; dy <= 1; ++dy) {
      if (cx + dx == x && cy + dy == y) continue;
      const double off = distance_of_circles(arc, static_cast<double>(x), static_cast<double>(y), static_cast<double>(cx + dx), static_cast<double>(cy + dy));
      const double preferred = dx == 0 && dy == 0 ? off - 1e-9 : off;
      if (preferred < best.off) best = {{cx + dx - x, cy + dy - y}, preferred};
    }
  return best;
}

/// All pulses of an arc at once. events, doubles and end are those of the chip.
struct ArcEnd { std::uint64_t events = 0, doubles = 0; std::int64_t ax1 = 0, ax2 = 0; };

ArcEnd run_arc(const ArcSetting& setting) {
  Arc arc(setting);
  ArcEnd end;
  while (!arc.done()) {
    const Skip skip = arc.skip(std::numeric_limits<std::uint64_t>::max());
    end.events += skip.events;
    end.doubles += skip.doubles;
    end.ax1 += skip.steps[0];
    end.ax2 += skip.steps[1];
    if (skip.events > 0) continue;
    const Event event = arc.next();
    ++end.events;
    end.doubles += event.step[0] != 0 && event.step[1] != 0;
    end.ax1 += event.step[0];
    end.ax2 += event.step[1];
  }
  return end;
}

bool stays_in_plane(const PathItem& arc) {
  for (std::size_t i = 0; i < kAxes; ++i)
    if (i != arc.plane[0] && i != arc.plane[1] && std::llround(arc.end[i]) != std::llround(arc.start[i])) return false;
  return true;
}

/// Pulses of the short axis along the arc: between 2/pi and sqrt(1/2) of its length or so; the count of the chip must be near.
bool has_about_the_right_length(const PathItem& arc, std::uint64_t events) {
  const double arc_length = radius(arc) * std::abs(arc.sweep_rad);
  return std::abs(static_cast<double>(events) - 0.85 * arc_length) < 0.15 * arc_length + 4;  // an event is 0.707 to 1 pulse of length
}

}  // namespace

std::optional<ArcSetting> Encoder::fitting_arc(const PathItem& item) const {
  const std::size_t a = item.plane[0], b = item.plane[1];
  const BestCenter best = best_center(item, position_[a], position_[b]);
  ArcSetting setting;
  setting.center = best.center;
  setting.finish = {std::llround(item.end[a]) - position_[a], std::llround(item.end[b]) - position_[b]};
  setting.clockwise = item.sweep_rad < 0;
  const bool in_range = std::max({std::abs(setting.center.ax1), std::abs(setting.center.ax2), std::abs(setting.finish.ax1), std::abs(setting.finish.ax2)}) <= kLargestDistance;
  const bool at_center = setting.finish.ax1 == setting.center.ax1 && setting.finish.ax2 == setting.center.ax2;
  if (best.off + 0.5 > kTolerance || !in_range || at_center || radius(item) * std::abs(item.sweep_rad) < kShortestArc) return std::nullopt;
  return setting;
}

bool Encoder::add_arc(const PathItem& item) {
  if (!stays_in_plane(item)) return false;
  const auto setting = fitting_arc(item);
  if (!setting) return false;
  const ArcEnd end = run_arc(*setting);
  Drive drive;
  drive.end = position_;
  drive.end[item.plane[0]] += end.ax1;
  drive.end[item.plane[1]] += end.ax2;
  if (!has_about_the_right_length(item, end.events) || distance(as_point(drive.end), item.end) > kTolerance + 0.5) return false;
  drive.code = setting->clockwise ? code::kCHKCW : code::kCHKCCW;
  drive.plane = item.plane;
  drive.axes = 1u << item.plane[0] | 1u << item.plane[1];
  drive.center[item.plane[0]] = setting->center.ax1;
  drive.center[item.plane[1]] = setting->center.ax2;
  drive.finish[item.plane[0]] = setting->finish.ax1;
  drive.finish[item.plane[1]] = setting->finish.ax2;
  drive.events = end.events;
  drive.doubles = end.doubles;
  drive.comment = setting->clockwise ? "CW circular interpolation driving" : "CCW circular interpolation driving";
  send(std::move(drive), item);
  return true;
}

/// A circle of X and Y with Z, U or both along, where the chip's even spreading over the events is near enough to the helix.
bool Encoder::add_helix(const PathItem& item) {
  if (item.plane != std::array<std::size_t, 2>{0, 1} || stays_in_plane(item) || std::abs(item.sweep_rad) < 0.1) return false;
  const auto setting = fitting_arc(item);
  if (!setting) return false;
  Drive drive;
  drive.plane = item.plane;
  drive.axes = 3;
  const ArcEnd end = run_arc(*setting);
  drive.end = {position_[0] + end.ax1, position_[1] + end.ax2, position_[2], position_[3]};
  for (std::size_t i = 2; i < kAxes; ++i) {
    drive.finish[i] = std::llround(item.end[i]) - position_[i];
    drive.end[i] += drive.finish[i];
    if (drive.finish[i] == 0) continue;
    drive.axes |= 1u << i;
    // The events of an octant lie evenly along its short axis, not along the angle: 0.042 of an octant apart at most.
    const double uneven = 0.042 * std::abs(static_cast<double>(drive.finish[i])) * (M_PI / 4) / std::abs(item.sweep_rad);
    if (uneven + 0.5 > kTolerance || std::abs(drive.finish[i]) > static_cast<std::int64_t>(end.events)) return false;
  }
  if (!has_about_the_right_length(item, end.events) || distance(as_point(drive.end), item.end) > kTolerance + 0.5) return false;
  drive.code = setting->clockwise ? code::kHLCW : code::kHLCCW;
  drive.center = {setting->center.ax1, setting->center.ax2, 0, 0};
  drive.finish[0] = setting->finish.ax1;
  drive.finish[1] = setting->finish.ax2;
  drive.events = end.events;
  drive.doubles = end.doubles;
  drive.comment = setting->clockwise ? "CW helical interpolation driving" : "CCW helical interpolation driving";
  send(std::move(drive), item);
  return true;
}

/// Two halves, or lines where it is short.
void Encoder::divide_arc(const PathItem& item) {
  const double arc_length = radius(item) * std::abs(item.sweep_rad);
  if (arc_length < 2 * kShortestArc || !stays_in_plane(item)) {
    std::vector<Point> points{item.start};
    sample_curve([&](double share) { return arc_point(item, share); }, 0, 1, 0.02, points);
    return add_points(points, item);
  }
  // The halves meet near the middle, at the grid point that is nearest to the arc, so that no error is carried on.
  double best_share = 0.5, best_off = 1e300;
  const int looks = static_cast<int>(std::min(24.0, arc_length / 4));
  for (int i = -looks; i <= looks; ++i) {
    const double share = 0.5 + i / arc_length;
    const Point p = arc_point(item, share);
    const double off = distance(p, as_point(rounded(p)));
    if (off >= best_off) continue;
    best_off = off;
    best_share = share;
  }
  PathItem first = item, second = item;
  first.end = second.start = arc_point(item, best_share);
  first.sweep_rad = best_share * item.sweep_rad;
  second.sweep_rad = item.sweep_rad - first.sweep_rad;
  second.start_angle_rad = item.start_angle_rad + first.sweep_rad;
  first.duration_s = best_share * item.duration_s;
  second.duration_s = item.duration_s - first.duration_s;
  for (const PathItem& half : {first, second})
    if (failure_.empty() && !add_arc(half) && failure_.empty()) divide_arc(half);
}

// --- writes ---------------------------------------------------------------------------------------------------------------------------

std::int64_t Encoder::speed_for(const Drive& drive, const PathItem& item) const {
  const double share = item.duration_s > 0 ? std::min(1.0, distance(as_point(drive.end), as_point(position_)) / std::max(1e-9, length(item))) : 0;
  const bool is_line = drive.code >= code::kLHK2 && drive.code <= code::kLHK4;
  double pps = item.speed_pps;
  if (setting_.keep_duration && item.duration_s > 0) {
    const double duration_s = is_line ? share * item.duration_s : item.duration_s;
    const double lengths = static_cast<double>(drive.events) + 0.414 * static_cast<double>(drive.doubles);
    if (duration_s > 0) pps = lengths / duration_s;
  } else if (__builtin_popcount(drive.axes) == 4 && is_line) {   // no constant vector speed: the speed of the longest axis
    pps *= static_cast<double>(drive.events) / std::max(1.0, distance(as_point(drive.end), as_point(position_)));
  }
  return std::max<std::int64_t>(1, std::llround(pps));
}

void Encoder::line(const std::string& text) { lines_.push_back({seconds(chip_.now()), text}); }

void Encoder::write(int reg, std::uint16_t value, const std::string& comment) {
  line(write_text(reg, value) + (comment.empty() ? "" : " ; " + comment));
  chip_.write(reg, value, {static_cast<int>(lines_.size()), 1});
}

void Encoder::write_data(std::int64_t value, std::uint16_t command, const std::string& comment) {
  const auto bits = static_cast<std::uint32_t>(value);
  write(6, static_cast<std::uint16_t>(bits & 0xffff), comment);
  write(7, static_cast<std::uint16_t>(bits >> 16));
  write(0, command);
}

void Encoder::pause(double seconds) {
  if (running_) line("wait idle");
  chip_.run_until_idle();
  running_ = false;
  line(fmt::format("wait {} s", seconds));
  chip_.run_until(chip_.now() + time_from_seconds(seconds));
}

/// Waits as needed, and writes mode and speed where they change.
void Encoder::prepare(const Drive& drive, std::int64_t speed_pps) {
  const int enabled = __builtin_popcount(drive.axes);
  const bool is_helix = drive.code == code::kHLCW || drive.code == code::kHLCCW;
  const unsigned vector = enabled == 2 || is_helix ? 0x40u : enabled == 3 ? 0x80u : 0u;
  const auto mode = static_cast<std::uint16_t>(drive.axes | vector);
  const bool goes_on = running_ && setting_.continuous && mode == mode_ && speed_pps == speed_pps_ && speed_pps <= kFastestContinuous_pps && !is_helix;
  if (running_) line(goes_on ? "wait next" : "wait idle");
  if (goes_on) chip_.run_until_next();
  else chip_.run_until_idle();
  if (mode != mode_) {
    std::string axes;
    for (std::size_t i = 0; i < kAxes; ++i)
      if ((drive.axes >> i & 1u) != 0) axes += (axes.empty() ? "" : ", ") + std::string(1, kAxisNames[i]);
    write(6, mode, axes + (vector == 0 ? "" : " at constant vector speed"));
    write(0, 0x0000 | code::kIPM);
  }
  const auto main_axis = static_cast<std::uint16_t>(0x100u << __builtin_ctz(drive.axes));
  if (speed_pps != speed_pps_ || mode != mode_) {
    write_data(speed_pps, main_axis | code::kSV, fmt::format("initial speed {} pulses/s", speed_pps));
    write_data(speed_pps, main_axis | code::kDV, "drive speed");
  }
  mode_ = mode;
  speed_pps_ = speed_pps;
}

void Encoder::send(Drive drive, const PathItem& item) {
  const std::int64_t speed_pps = speed_for(drive, item);
  if (speed_pps > kFastest_pps) {
    failure_ = fmt::format("the path runs at {} pulses/s; the chip's limit is {}", speed_pps, kFastest_pps);
    return;
  }
  prepare(drive, speed_pps);
  const auto axis_bit = [](std::size_t axis) { return static_cast<std::uint16_t>(0x100u << axis); };
  const bool is_line = drive.code >= code::kLHK2 && drive.code <= code::kLHK4;
  if (!is_line)
    for (const std::size_t axis : drive.plane) write_data(drive.center[axis], axis_bit(axis) | code::kCP, fmt::format("centre {} {}", kAxisNames[axis], drive.center[axis]));
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    if ((drive.axes >> axis & 1u) != 0) write_data(drive.finish[axis], axis_bit(axis) | code::kTP, fmt::format("finish {} {}", kAxisNames[axis], drive.finish[axis]));
  if (drive.code == code::kHLCW || drive.code == code::kHLCCW) write(0, drive.code == code::kHLCW ? code::kHLPCW : code::kHLPCCW, "helical calculation");
  write(0, drive.code, drive.comment);
  position_ = drive.end;
  events_ += drive.events;
  items_.push_back(item_);
  running_ = true;
  for (const Problem& problem : chip_.problems())
    if (problem.is_error && failure_.empty()) failure_ = fmt::format("frame {}: {}", problem.line, problem.text);
}

void Encoder::finish() {
  if (running_) line("wait idle");
  chip_.run_until_idle();
  running_ = false;
}

}  // namespace pmac::drives::mcx514
