// The types of hops 5 to 9 of a move's way: what the line asked for, the blended path, segments, timed segments. Each is filled
// once by its stage and carries the source line. Units are in the names: _uu axis user units, _mu motor units, _ms, _uu_ms
// axis units per millisecond, _mu_ms, _mu_ms2.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "runtime/fault.h"

namespace pmac::motion {

using bytecode::kAxisCount;
using bytecode::SourceLine;
using AxisVector = std::array<double, kAxisCount>;  // one value an axis, by axis index

enum class CommandKind : std::uint8_t { kLinear, kCircle, kDelay, kPvt };

/// Hop 5: one blendable move as the line asked for it. (Rapid moves, dwells and jogs end a sequence and are the coordinate
/// system's own; they never reach the path stages.)
struct MotionCommand {
  std::uint64_t id = 0;                 // ascending; comes back in MoveTiming
  CommandKind kind = CommandKind::kLinear;
  SourceLine source;
  std::uint32_t axes = 0;               // mask of the axes named in the block (1 << axis index)
  AxisVector target_uu{};               // absolute end point of the axes in `axes`
  std::uint32_t feed_axes = 0;          // mask of the feed-rate axes (frax)
  std::uint32_t feed_axes2 = 0;         // mask of the secondary set (frax2)
  // circle only
  bool clockwise = false;               // circle1/circle3: right-handed about `normal`
  bool second_set = false;              // circle3/circle4 on XX YY ZZ
  std::array<double, 3> normal{0, 0, -1};
  bool has_center = false, has_radius = false;
  std::array<double, 3> center_uu{};    // of has_center: vector from the start point to the centre
  double radius_uu = 0;                 // of has_radius: > 0 arc up to 180 degrees, < 0 the long way
  double sweep_rad = 0;                 // > 0: the arc's angle, where the points alone do not tell (compensated arcs)
  // speed and time
  double feed_uu = 0;                   // axis units per feed_time_ms, > 0; 0: move_time_ms counts
  double move_time_ms = 0;              // tm, or the time of a delay; >= 0
  double feed_time_ms = 1000;
  double alt_feed_uu = 1;               // AltFeedRate, 0: off
  bool inverse_time = false;            // InvTimeMode: feed_uu is moves per feed time
  double ta_ms = 0, td_ms = 0, ts_ms = 0, tsd_ms = 0;  // negative: rates, see reference in ramp.h
  bool no_blend = false;                // stop at the end of this move
  AxisVector start_velocity_uu_ms{}, end_velocity_uu_ms{};  // pvt only; the time is move_time_ms
  // modes that stages before the planner act on
  int transform = -1;                   // selected matrix Tdata[transform]; -1: none
  int compensation_side = 0;            // ccmode: 0 off, 1 left, 2 right
  double compensation_radius_uu = 0;    // ccr
  bool added = false;                   // put in by cutter compensation
  bytecode::MoveMode mode = bytecode::MoveMode::kLinear;  // in force at the block, for reports
};

/// Limits of one motor that programmed moves respect. 0: off, for the inverse ones.
struct MotorLimits {
  double max_speed_mu_ms = 0;           // 0: off
  double inv_amax_ms2_mu = 0;
  double inv_dmax_ms2_mu = 0;
  double inv_jmax_ms3_mu = 0;
  double min_position_mu = -std::numeric_limits<double>::infinity(), max_position_mu = std::numeric_limits<double>::infinity();  // lookahead only
};

enum class FineInterpolation : std::uint8_t { kThrough, kBspline };
enum class RampRule : std::uint8_t { kPower, kTurbo };

/// Velocities through a kinematic routine. axis_uu_ms in, motor_mu_ms ([motor]) out.
struct RoutineRates { const AxisVector& axis_uu_ms; double* motor_mu_ms; };

/// Motor positions of an axis position. Either a linear map, or a routine called once a segment.
struct MotorMap {
  /// Motor numbers served, in the order of every per-motor array.
  std::vector<int> motors;
  /// Row-major [motor][kAxisCount] coefficients (mu/uu) and [motor] offsets; used where !inverse.
  std::vector<double> matrix_mu_uu;
  std::vector<double> offset_mu;
  /// Kinematic routine: axis_uu[kAxisCount] -> motor_mu[motors.size()]. Returns the reason where it has no solution.
  std::function<std::optional<runtime::Fault>(const AxisVector& axis_uu, double* motor_mu, SourceLine source)> inverse;
  /// The same with velocities; where inverse is set.
  std::function<std::optional<runtime::Fault>(const AxisVector& axis_uu, const RoutineRates& rates, double* motor_mu, SourceLine source)> inverse_rates;
};

/// Set-up of one coordinate system's pipeline, constant while a sequence runs.
struct PipelineConfig {
  double segment_time_ms = 0;           // SegMoveTime; 0: unsegmented, motors follow the axes' exact polynomials
  FineInterpolation fine = FineInterpolation::kThrough;
  RampRule ramp_rule = RampRule::kPower;
  bool lookahead = false;               // segmented only
  bool limit_jerk = false;              // lookahead keeps InvJmax as well
  int lookahead_segments = 0;           // LHDistance
  double history_ms = 0;                // programmed time behind the last sample that stays known, for retracing
  double servo_period_ms = 0.44274211;  // at which limits are counted where the path's velocity steps; 0: stop there
  double radius_error_limit_uu = 0;     // 0: off
  double min_arc_len = 0;               // semicircles; 0: 2^-20
  double max_circle_accel = 0;          // uu per feed_time^2; 0: off
  double max_feed_uu = 0;               // MaxFeedRate, 0: off
  double corner_blend_bp = 0;           // cosine; 0: off
  double corner_dwell_bp = 0;           // cosine; 0: off
  double added_dwell_ms = 0;            // at corners of corner_dwell_bp
  double no_corner_bp = 0;              // cosine above which the next three leave a corner alone; 0: off
  double corner_radius_uu = 0;          // least radius of a blend's path; 0: off
  double corner_error_uu = 0;           // largest distance of a blend from its corner; 0: off
  double corner_accel_uu_ms2 = 0;       // largest acceleration of a blend; 0: off
  bool jerk_limit_unsegmented = false;  // InvJmax acts on unsegmented S-curve ramps
  bool note_governing = false;          // say of every move which limits held it back
  std::vector<MotorLimits> limits;      // [motor], as MotorMap::motors
  MotorMap map;
};

/// What the time of a block comes from. kSegment: a delay of at least one segment; kOwnTime: delay, pvt, spline.
enum class TimeRule : std::uint8_t {
  kFeed, kMoveTime, kInverseTime, kSecondFeedAxes, kAltFeedRate, kMaxFeedRate, kMaxCirAccel, kRamps, kMotorSpeed, kSegment, kOwnTime
};
/// What held a move back for a part of its time. kProgram: nothing, it runs as programmed; kLookahead: no limit is used up, but a stop
/// or a step ahead is prepared; kJog*: speed and ramps of a rapid move or jog.
enum class GoverningLimit : std::uint8_t { kProgram, kMaxSpeed, kInvAmax, kLookahead, kJogSpeed, kJogRamp };
struct GoverningShare { GoverningLimit limit; int motor; double time_ms; };  // motor -1: none

/// When a command was executed. Times in the pipeline's own time.
struct MoveTiming {
  std::uint64_t id = 0;
  double sync_ms = 0;                   // its synchronous assignments are due: start of the blend into it, then the next segment boundary
  double start_ms = 0, end_ms = 0;      // a blended corner counts at mid-blend
  double length_uu = 0;                 // along the path, over the axes that counted for the feed rate; 0 for a delay
  TimeRule rule = TimeRule::kFeed;
  std::vector<GoverningShare> governed = {};  // longest first; only with PipelineConfig::note_governing
};

/// The synchronous assignments of a command are due; known as soon as the blend into it is committed, before its end is.
struct SyncTime { std::uint64_t id = 0; double time_ms = 0; };

}  // namespace pmac::motion
