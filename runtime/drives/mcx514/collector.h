// From what a run tells (path pieces, samples, complete moves) to the path as lines, arcs and points in pulses, in the order in which it was
// moved. A programmed move is made of its path pieces; what has none (rapid moves, jogs, home searches) of the servo samples between its
// start and its end.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runtime/drives/drive.h"
#include "runtime/drives/mcx514/path_item.h"
#include "runtime/machine.h"
#include "runtime/motion/path.h"

namespace pmac::drives::mcx514 {

struct CollectedPath {
  std::vector<PathItem> items;       // in order of time; each begins where the one before ends, but for motions that were cut short
  std::vector<int> motors;           // by chip axis, ascending
  std::array<double, kAxes> origin_mu{};   // motor positions that are pulse 0
  double end_s = 0;
  std::vector<std::string> notes;    // motion that is not in the items, a sentence each
};

class Collector {
 public:
  explicit Collector(DriveContext context) : context_(std::move(context)) {}

  void take(int coord, const motion::PathPiece& piece);
  void take(const runtime::SampleBlock& block);
  void take(const runtime::MoveRecord& move) { records_.push_back(move); }

  /// Everything has been taken. The path, or why one chip cannot follow it.
  std::variant<CollectedPath, std::string> finish();

 private:
  struct Group { std::uint64_t command = 0; bytecode::SourceLine source; std::vector<motion::PathPiece> pieces; };
  struct Sample { double time_ms; Point at; };

  void process(const runtime::MoveRecord& move);
  void process_ready(double known_until_ms);
  void add_group(const Group& group, const runtime::MoveRecord& move);
  void add_part(const Group& group, int coord, std::size_t first, std::size_t last, PathItem& item);
  void slow_down(const runtime::MoveRecord& move, bytecode::SourceLine source);
  void add_samples(const runtime::MoveRecord& move);
  void add_item(PathItem item, const runtime::MoveRecord& move, double share_start, double share_end);
  std::optional<Point> pulses(int coord, const motion::AxisVector& axis_uu);
  double speed(int coord, const motion::PathPiece& piece);
  bool make_arc(int coord, const motion::Curve& curve, double u0, double u1, PathItem& item);
  std::size_t slot(int motor);
  Point relative(std::span<const double> motor_mu, std::span<const int> motors);
  void fail(std::string why) { if (failure_.empty()) failure_ = std::move(why); }

  DriveContext context_;
  std::map<int, std::deque<Group>> groups_;          // by coordinate system
  std::deque<runtime::MoveRecord> records_;
  std::deque<Sample> samples_;
  std::vector<int> slots_;                           // motor of each axis, in order of its first movement
  std::map<int, double> base_mu_;                    // of every motor seen, at its first sample
  std::vector<double> motor_mu_;
  CollectedPath path_;
  std::string failure_;
  double last_end_ms_ = 0;
  std::string last_who_;
};

}  // namespace pmac::drives::mcx514
