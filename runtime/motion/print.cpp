#include "runtime/motion/print.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "runtime/motion/axis_vector.h"

namespace pmac::motion {
namespace {

constexpr const char* kAxisNames[kAxisCount] = {"A",  "B",  "C",  "U",  "V",  "W",  "X",  "Y",  "Z",  "AA", "BB",
                                                "CC", "DD", "EE", "FF", "GG", "HH", "LL", "MM", "NN", "OO", "PP",
                                                "QQ", "RR", "SS", "TT", "UU", "VV", "WW", "XX", "YY", "ZZ"};

std::string axis_words(const AxisVector& vector, std::uint32_t axes) {
  std::string text;
  for_each_axis(axes, [&](std::size_t axis) { fmt::format_to(std::back_inserter(text), " {}{}", kAxisNames[axis], vector[axis]); });
  return text.empty() ? " -" : text;
}

const char* name_of(CommandKind kind) {
  switch (kind) {
    case CommandKind::kLinear: return "linear";
    case CommandKind::kCircle: return "circle";
    case CommandKind::kDelay: return "delay";
    case CommandKind::kPvt: return "pvt";
  }
  return "?";
}

std::string circle_words(const MotionCommand& command) {
  if (command.kind != CommandKind::kCircle) return "";
  const char* sense = command.clockwise ? " cw" : " ccw";
  if (command.has_center)
    return fmt::format("{} I{} J{} K{}", sense, command.center_uu[0], command.center_uu[1], command.center_uu[2]);
  return command.has_radius ? fmt::format("{} R{}", sense, command.radius_uu) : sense;
}

std::string speed_words(const MotionCommand& command) {
  if (command.kind == CommandKind::kDelay || command.feed_uu == 0) return fmt::format("tm={}", command.move_time_ms);
  return fmt::format("{}={}", command.inverse_time ? "G93F" : "F", command.feed_uu);
}

/// Modes that are not the usual ones.
std::string mode_words(const MotionCommand& command) {
  std::string text;
  if (command.feed_axes2 != 0) {
    text += " frax2=";
    for_each_axis(command.feed_axes2, [&](std::size_t axis) { text += kAxisNames[axis]; });
  }
  if (command.transform >= 0) text += fmt::format(" tsel={}", command.transform);
  if (command.compensation_side != 0) text += fmt::format(" ccmode={} ccr={}", command.compensation_side, command.compensation_radius_uu);
  return text;
}

/// Axes that differ between the ends of the piece, and where they end.
std::uint32_t moved_axes(const PathPiece& piece) {
  std::uint32_t axes = piece.part[0].curve->moved;
  if (piece.part_count > 1) axes |= piece.part[1].curve->moved;
  return axes;
}

const char* shape_of(const PathPiece& piece) {
  if (piece.part_count > 1) return "corner";
  if (piece.part[0].curve->is_arc) return "arc";
  if (piece.part[0].curve->rates) return "pvt";
  return piece.part[0].curve->moved == 0 ? "rest" : "line";
}

std::string motor_words(const Segment& segment, double local_ms) {
  std::string text;
  for (const MotorCubic& q : segment.motor) fmt::format_to(std::back_inserter(text), " {}", q.position(local_ms));
  return text;
}

}  // namespace

std::string command_header() { return "# id line kind [circle] targets_uu F_uu|tm_ms ta_ms td_ms ts_ms tsd_ms"; }
std::string path_header() { return "# command line shape start_ms duration_ms end_uu end_velocity_uu_ms"; }
std::string segment_header() { return "# command line start_ms duration_ms end_mu[motor]"; }
std::string timed_segment_header() { return "# command line time_ms duration_ms programmed_ms rate end_rate end_mu[motor]"; }

std::string to_text(const MotionCommand& command) {
  return fmt::format("{} line {} {}{}{} {} ta={} td={} ts={} tsd={}{}{}", command.id, command.source.line, name_of(command.kind),
                     circle_words(command), axis_words(command.target_uu, command.axes), speed_words(command), command.ta_ms,
                     command.td_ms, command.ts_ms, command.tsd_ms, mode_words(command), command.no_blend ? " stop" : "");
}

std::string to_text(const PathPiece& piece) {
  const PathPoint end = evaluate(piece, piece.duration_ms);
  const std::uint32_t axes = moved_axes(piece);
  return fmt::format("{} line {} {} {} {}{} |{}{}", piece.command, piece.source.line, shape_of(piece), piece.start_ms,
                     piece.duration_ms, axis_words(end.position, axes), axis_words(end.velocity, axes),
                     piece.starts_at_rest ? " from-rest" : "");
}

std::string to_text(const Segment& segment) {
  return fmt::format("{} line {} {} {}{}", segment.command, segment.source.line, segment.start_ms, segment.duration_ms,
                     motor_words(segment, segment.duration_ms));
}

std::string to_text(const TimedSegment& segment) {
  return fmt::format("{} line {} {} {} {} {} {}{}", segment.segment.command, segment.segment.source.line, segment.start_ms,
                     segment.duration_ms, segment.segment.duration_ms, segment.rate,
                     segment.rate_at(segment.duration_ms), motor_words(segment.segment, segment.segment.duration_ms));
}

}  // namespace pmac::motion
