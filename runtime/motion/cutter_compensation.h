// Cutter radius compensation in a plane: between motion commands and the planner. Moves come in as programmed and go out beside
// their path at the distance of the tool radius: lines as parallel lines, arcs as concentric arcs. Each block's end is known only
// when the next block with motion in the plane is, so one is held back, and more where blocks may have to be left out.
//
//   programmed  ------------P            left of it, r away    ---------\        outside: an arc of radius r about P
//                            \                                           |
//                             \                                           \      inside: where the parallel curves meet
//
// Everything happens in the coordinates of the program. Source: Turbo User Manual p296-301, Turbo Software Reference CC0-2 and
// Isx99; errors as in Coord[].ErrorStatus. Decisions of this project are marked in docs/motion.md.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "runtime/motion/plane_geometry.h"

namespace pmac::motion {

struct CompensationConfig {
  double added_arc_bp = 0;           // CCAddedArcBp: cosine below which an outside corner gets an arc; 0: 0.9998
  int most_carried = 20;             // CCSize: moves without motion in the plane that are looked past
  int most_left_out = 8;             // CCDistance: moves that may be left out where the tool does not fit
  double radius_error_limit_uu = 0;  // of arcs, as in PipelineConfig
  double min_arc_len = 0;
};

class CutterCompensation {
 public:
  void configure(const CompensationConfig& config) { config_ = config; }

  /// The next command, from start_uu (programmed). What is decided by it is appended to `out`: targets of every axis, to be taken
  /// up from one to the next. An added move has the id of the one before it plus 1. Faults: the kinds kCc..., and those of arcs.
  [[nodiscard]] std::optional<runtime::Fault> add(const MotionCommand& command, const AxisVector& start_uu, std::vector<MotionCommand>& out);

  /// Motion has to come to rest before the next command is known: the last move ends at right angles to its programmed end.
  [[nodiscard]] std::optional<runtime::Fault> flush(std::vector<MotionCommand>& out);

  /// From the lead-in to the lead-out.
  bool active() const { return active_; }
  /// Forgets what is held.
  void cancel() { *this = CutterCompensation(config_); }

  CutterCompensation() = default;

 private:
  explicit CutterCompensation(const CompensationConfig& config) : config_(config) {}

  /// A move in the plane; its compensated ends are decided one after the other.
  struct Held {
    MotionCommand command;
    PlaneMove move;
    double start_offset = 0, end_offset = 0;  // left positive
    Point start, end;                         // compensated
    bool lead_in = false;
    std::optional<PlaneMove> added;           // after it, to the next one's start
    std::vector<MotionCommand> carried;       // moves without motion in the plane that follow
  };

  static Held hold(const MotionCommand& command, const PlaneMove& move);
  std::optional<runtime::Fault> check(const MotionCommand& command) const;
  runtime::Result<std::optional<PlaneMove>> plane_move(const MotionCommand& command, const AxisVector& start_uu) const;
  std::optional<runtime::Fault> carry(const MotionCommand& command, std::vector<MotionCommand>& out);
  std::optional<runtime::Fault> lead_in(const MotionCommand& command, const PlaneMove& move, const AxisVector& start_uu);
  std::optional<runtime::Fault> go_on(const MotionCommand& command, const PlaneMove& move, std::vector<MotionCommand>& out);
  std::optional<runtime::Fault> lead_out(const MotionCommand& command, const PlaneMove& move, std::vector<MotionCommand>& out);

  // corners
  std::optional<runtime::Fault> join(Held& previous, Held& next) const;
  std::optional<runtime::Fault> leave_out(Held& next);
  bool change_side(Held& previous, Held& next) const;
  void join_lead_in(Held& previous, Held& next) const;
  void start_from_rest(Held& next, std::vector<MotionCommand>& out);
  void round(Held& previous, Held& next) const;
  PlaneMove corner_arc(Point corner, Point before, Point after, double offset) const;
  bool is_shallow(double cosine) const;

  // what goes out
  void emit_front(std::vector<MotionCommand>& out);
  void emit_all(std::vector<MotionCommand>& out);
  void emit_move(const Held& held, std::vector<MotionCommand>& out);
  void emit_added(const MotionCommand& before, const PlaneMove& move, std::vector<MotionCommand>& out);
  void emit_carried(MotionCommand command, std::vector<MotionCommand>& out);
  void put_out(MotionCommand command, std::vector<MotionCommand>& out);

  CompensationConfig config_;
  bool active_ = false;
  int compensated_moves_ = 0;
  PlaneFrame frame_;
  AxisVector position_{};          // end of what has gone out
  std::deque<Held> held_;
  std::optional<Held> at_rest_;    // last move after a flush
};

}  // namespace pmac::motion
