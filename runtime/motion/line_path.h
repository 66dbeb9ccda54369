// The short way through hops 5 to 8 for what a part program mostly is: plain lines one after the other with the same feed rate and ramps,
// segmented, without lookahead, motors a linear map of the axes. From the target of a line straight to timed segments, without the values
// that the stages hand to one another:
//
//     MotionCommand -> Move -> Join -> PathPiece -> MotorNode -> Segment -> TimedSegment      pipeline.h
//     target        ------------------- LinePath ---------------------->  TimedSegment
//
// It takes over where the stages stand and leaves them where they would stand; every number is made by the same operations in the same
// order, so that segments and times are the same to the last bit. What it does not do (see add()) the stages do.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "runtime/motion/planner.h"
#include "runtime/motion/segmenter.h"
#include "runtime/motion/timeline.h"
#include "runtime/motion/timings.h"

namespace pmac::motion {

class LinePath {
 public:
  static constexpr std::size_t kMostAxes = 8, kMostMotors = 8, kNarrow = 4;
  /// [entry of an axis]; unused entries are 0.
  struct alignas(32) Point : std::array<double, kMostAxes> {};

  /// What it works on; all of it outlives the line path.
  struct Stages {
    const PipelineConfig& config;
    const MotorKinematics& kinematics;
    Planner& planner;
    Segmenter& segmenter;
    Timings& timings;
    Timeline& timeline;
    double sequence_ms;     // programmed time 0
  };

  /// From where the stages stand, for lines that have everything but id, source, axes and target in common with `like`. Nothing where they
  /// are not such lines, or the last line added is none.
  static std::optional<LinePath> open(const Stages& stages, const MotionCommand& like);

  /// Index of an axis in Point, -1: not one that lines here may name.
  int entry_of(int axis) const { return entry_of_[static_cast<std::size_t>(axis)]; }
  /// Where the last line ends.
  const Point& end() const { return line_[pending_].end; }
  /// The next line. False, and nothing has changed: one that the stages have to take (no length, too long, blended along the path, no room
  /// for a blend, a target that is not finite).
  bool add(const Point& target, std::uint64_t id, SourceLine source);
  /// Lines that are through with their times known, in order, until the owner takes them.
  struct Ended { std::uint64_t id; double start_ms, end_ms, length_uu; TimeRule rule; };
  std::vector<Ended>& ended() { return ended_; }
  /// Until then a command is known beyond the one that executes; as Pipeline::enough_until_ms(1).
  double known_until_ms() const { return stages_.timings.ahead_until_ms(1); }
  double horizon_ms() const { return stages_.timeline.end_ms(); }

  /// The stages stand where the lines have led to.
  void close();

  /// At least so long is every line, ms.
  double shortest_ms() const { return room_ms_; }

 private:
  struct Line {
    std::uint64_t id = 0;
    SourceLine source;
    Point start{}, end{}, delta{};
    double time_ms = 0, per_ms = 0, length_uu = 0;        // per_ms: 1 / time_ms
    Point velocity_uu_ms{}, direction{};
    double speed_uu_ms = 0;
    TimeRule rule = TimeRule::kFeed;
  };
  struct Part { std::size_t line = 0; std::array<double, 4> u{}; };
  struct Piece { std::size_t owner = 0; double start_ms = 0, duration_ms = 0; int part_count = 0; std::array<Part, 2> part; };
  struct Node {
    double time_ms = 0;
    std::uint64_t command = 0;
    SourceLine source;
    Point position_mu{}, velocity_mu_ms{};   // [motor]
  };
  struct Term { std::size_t motor = 0, axis = 0; double coefficient = 0; };
  struct Blend { bool possible = false, is_steady = false, is_whole = false; Ramp ramp; };

  LinePath(const Stages& stages, const MotionCommand& like) : stages_(stages), like_(like) {}
  bool takes_axes();
  bool takes_planner();
  bool takes_segmenter();
  bool takes_timings();
  template <std::size_t kWidth>
  bool add_line(const Point& target, std::uint64_t id, SourceLine source);
  template <std::size_t kWidth>
  bool set_time(Line& line) const;
  template <std::size_t kWidth>
  void set_speed(Line& line) const;
  template <std::size_t kWidth>
  Blend blend_into(const Line& next) const;
  template <std::size_t kWidth>
  void cruise_until(double time_ms);
  template <std::size_t kWidth>
  void corner(std::size_t next, const Ramp& ramp, const RampParts& parts);
  template <std::size_t kWidth>
  void walk();
  template <std::size_t kWidth>
  void evaluate_at(double d, Point& position, Point& velocity) const;
  template <std::size_t kWidth>
  void add_node(double local_ms, double time_ms);
  template <std::size_t kWidth>
  void push_segment(const Node& from, const Node& to);
  void begin_line(const Line& next, const Ramp& ramp);
  void know_sync(double time_ms);
  void know_start(double time_ms);
  void cover(double from_ms, double start_ms, double duration_ms);
  CurveRef curve_of(const Line& line) const;
  void return_planner(const CurveRef& last);
  void return_segmenter(const CurveRef& last);
  double nominal_end_ms() const { return nominal_start_ms_ + line_[pending_].time_ms; }

  Stages stages_;
  MotionCommand like_;
  std::uint32_t axes_ = 0;
  std::size_t axis_count_ = 0, motor_count_ = 0;
  std::array<int, kAxisCount> entry_of_{};
  std::array<std::size_t, kMostAxes> axis_of_{};
  Point feeds_{};                                // 1: counts for the feed rate
  std::array<Term, kMostMotors * kMostAxes> term_{};
  std::size_t term_count_ = 0;
  Point offset_mu_{}, scale_mu_uu_{};            // [motor]; the second where is_diagonal_
  bool is_diagonal_ = false;                     // a motor for each axis, in the same order
  bool is_narrow_ = false;                       // no more than kNarrow of either
  double feed_uu_ = 0, room_ms_ = 0;             // feed rate in effect; half of both ramps of a line
  Ramp entry_, exit_;
  RampParts entry_parts_;

  // planner
  std::array<Line, 3> line_;
  std::size_t pending_ = 0, previous_ = 1;       // which of them are the last one and the one before it
  double nominal_start_ms_ = 0, entry_total_ms_ = 0, clock_ms_ = 0;
  std::size_t added_ = 0;
  // segmenter
  std::array<Node, 3> node_;
  std::size_t open_ = 0, before_ = 0;            // the last node, and the one before it, from which no segment has been made yet
  double origin_ms_ = 0;
  std::int64_t next_grid_ = 1;
  Piece piece_;                                  // the last one
  bool piece_made_ = false, end_is_open_ = false;
  // timings: how many of its records have a known place
  std::size_t syncs_known_ = 0, starts_known_ = 0;
  std::vector<Ended> ended_;
};

}  // namespace pmac::motion
