// The motions of several cards, joined to the moves of one path. Pulses and seconds.
//
//   X  MOV 0        CIRCLE 1,R,Xs-Xc,Ys-Yc,d        line, or arc about (Xc, Yc), or for what is neither the axes' own laws
//   Y  MOV 20000    CIRCLE 1,R,Ys-Yc,-(Xs-Xc),d
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "compiler/translate/card_trace.h"

namespace pmac::compiler::translate {

/// The speed of the master over one move: up or down at once or with a ramp, steady, and to rest or not. Source: docs/acr1000.md.
struct MasterTimes {
  double length = 0;                   // D
  double entry_speed = 0, speed = 0, exit_speed = 0;
  double start_s = 0, steady_s = 0, end_s = 0;  // times of the three phases
  bool forced_stop = false;
  double total_s() const { return start_s + steady_s + end_s; }
  /// Distance of the master at a time.
  double at(double time_s) const;
};

/// One axis of a move: its positions, and the law of a CIRCLE.
struct AxisPart {
  double from = 0, to = 0;
  bool is_circle = false;
  double direction = 1, radius = 1, i = 0, j = 0, distance = 0;
  double own_length() const;
  /// Where the axis is when the share u of the move is done.
  double at(double u) const;
};

enum class PathKind : std::uint8_t { kStand, kLine, kArc, kOther };

struct PathMove {
  PathKind kind = PathKind::kLine;
  std::vector<AxisPart> axes;          // one a card
  std::array<std::size_t, 2> plane{};  // of kArc: cards that are right and up where the arc is looked at
  bool clockwise = true;               // of kArc, seen so
  MasterTimes times;
  source::Span span;
  std::string place;                   // "line 60", or "file line 3"
};

struct CardPath {
  std::string axis;
  double start = 0;
};

struct PathOptions { double vel_unit = 1, ramp_unit = 1; };

MasterTimes master_times(double length, double entry_speed, const CardMotion& motion, const PathOptions& options);

/// The moves of cards whose motions belong together one by one. What cannot be one path is an error ACR-E16.
std::vector<PathMove> merge(const std::vector<CardTrace>& traces, const std::vector<CardPath>& cards, const PathOptions& options, source::Diagnostics& diagnostics);

}  // namespace pmac::compiler::translate
