// Hop 5 to 6: commands -> path pieces over programmed time. Each move has a nominal interval at constant speed, and the
// intervals follow one another; ramps and blends are centred on their ends, so a sequence lasts exactly
// T_a/2 + sum of TM + T_d/2. One move is held back: its end is decided when the next one, or the end, is known.
//
//   nominal       |<---- TM 1 ---->|<------ TM 2 ------>|
//   speed      ./-----------------\_____________________\.
//             T_a                 T_b                   T_d
#pragma once

#include <initializer_list>
#include <vector>

#include "runtime/motion/join.h"
#include "runtime/motion/move.h"
#include "runtime/motion/path.h"

namespace pmac::motion {

/// Where a move begins: known as soon as it has been added. Times are programmed time of the sequence.
struct MoveBegin {
  std::uint64_t id = 0;
  SourceLine source;
  double sync_ms = 0;    // start of the blend into it
  double start_ms = 0;   // mid-blend
  double length_uu = 0;
  TimeRule rule = TimeRule::kFeed;
};
/// Where a move ends: known when its successor has been added or the sequence ended.
struct MoveEnd { std::uint64_t id = 0; double end_ms = 0; };

struct PlannerOutput {
  std::vector<PathPiece> pieces;
  std::vector<MoveBegin> begins;
  std::vector<MoveEnd> ends;
};

class Planner {
 public:
  /// At rest at start_uu; start_motor_mu is used unsegmented only. The context's referents must outlive the planner.
  void reset(const AxisVector& start_uu, std::vector<double> start_motor_mu);

  /// The next move: appends what is now decided of the move before, and its own beginning.
  /// What stands in `move` afterwards is of no meaning.
  void add(Move& move, const PipelineConfig& config, PlannerOutput& out);
  /// The move held back comes to rest.
  void end_sequence(PlannerOutput& out);

  /// Where a rule asks for a stop before this move: how long it waits there (see Join::by_rule).
  std::optional<double> stop_by_rule_ms(const Move& next, const PipelineConfig& config) const;

  bool at_rest() const { return !has_pending_; }
  const AxisVector& position() const { return position_; }
  const std::vector<double>& motor_position() const { return motor_position_; }
  /// Programmed time at which the sequence ended, from its start. Valid at rest.
  double end_ms() const { return clock_ms_; }

 private:
  friend class LinePath;   // does the same for plain lines
  void begin(Move& move, const PipelineConfig& config, PlannerOutput& out);
  void stop(PlannerOutput& out);
  void wait(const Move& next, double duration_ms, PlannerOutput& out);
  void pass_over(const Move& move, PlannerOutput& out);
  void blend(const Join& join, const Move& next, PlannerOutput& out);
  void blend_along_path(const Join& join, const Move& next, PlannerOutput& out);
  void blend_corner(const Join& join, const Move& next, PlannerOutput& out);
  void cruise_until(double time_ms, PlannerOutput& out);
  void emit(const Move& owner, double start_ms, double duration_ms, std::initializer_list<PathPart> parts, PlannerOutput& out);
  double nominal_end_ms() const { return nominal_start_ms_ + pending_.time_ms; }
  void hold_back(Move& move);

  Move pending_;
  bool has_pending_ = false;
  double nominal_start_ms_ = 0;   // of pending_
  double entry_total_ms_ = 0;     // length of the ramp or blend into pending_
  double clock_ms_ = 0;           // pieces are complete up to here
  bool rest_before_ = true;       // the next piece starts at rest
  bool step_before_ = false;      // the next piece starts with a step in velocity
  AxisVector position_{};
  std::vector<double> motor_position_;
};

}  // namespace pmac::motion
