// pmac-run --check-limits: the worst speed, acceleration, jerk and position of every motor against the limits that hold for what it
// does, from first, second and third differences of the servo samples. Nothing is stored but the last three samples of each motor.
#pragma once

#include <deque>
#include <functional>
#include <vector>

#include "runtime/servo/activity.h"
#include "runtime/servo/servo.h"

namespace pmac::runtime {

/// Values up to so many times the limit keep it.
inline constexpr double kSpeedRoom = 1.001, kAccelRoom = 1.001, kJerkRoom = 1.05;

struct WorstValue {
  double value = 0;                                        // magnitude
  double limit = std::numeric_limits<double>::infinity();  // that held for it
  double time_ms = 0;
  bytecode::SourceLine source;
  double share() const { return value / limit; }
};

/// Where a motor was nearest to a position limit, or furthest beyond it.
struct WorstPosition {
  double value_mu = 0, limit_mu = 0;
  double room_mu = std::numeric_limits<double>::infinity();  // < 0: beyond; infinite: no limits
  double time_ms = 0;
  bytecode::SourceLine source;
};

class LimitCheck : public SampleSink {
 public:
  /// Asked with the time of a sample of the block that has just been made.
  using Ask = std::function<MotorActivity(int motor, double time_ms)>;

  struct Row {
    int motor = 0;
    WorstValue speed, accel, jerk;       // mu/ms, mu/ms^2, mu/ms^3
    WorstPosition position;
    bool keeps_limits() const;
  };

  explicit LimitCheck(Ask ask) : ask_(std::move(ask)) {}
  void take(const SampleBlock& block) override;
  bool takes_late() const override { return false; }
  /// The path's own acceleration steps there (MachineObservers::jerk_join): no jerk is noted of the samples around it. Ascending.
  void excuse_jerk(int coord, double time_ms) { joins_.push_back({coord, time_ms}); }
  /// Motors that were in use, by number. The run is over.
  std::vector<Row> rows();

 private:
  struct State {
    Row row;
    bool seen = false;
    double p1 = 0, p2 = 0, p3 = 0;       // the last samples from power-on, the newest first
    MotorActivity now, before;           // before: what it did until since_change samples ago
    int since_change = 0;
    bool is_braking = false;
    WorstValue braking;                  // of the deceleration that is not over yet
    double speed = 0;                    // mu/ms, signed, up to the newest sample
  };
  void begin_block(State& s, int motor, const SampleBlock& block);
  void take_sample(State& s, double position_mu, double time_ms, double period_ms);
  void take_acceleration(State& s, double accel, double speed_before, double time_ms);
  void take_position(State& s, double position_mu, double time_ms);
  void end_braking(State& s);
  void note(const State& s, WorstValue& worst, double value, double limit, double time_ms) const;
  bool all_rest(int coord) const;
  bool spans_join(int coord, double from_ms, double to_ms) const;

  Ask ask_;
  std::vector<State> states_;            // by motor number
  struct Join { int coord; double time_ms; };
  std::deque<Join> joins_;
};

}  // namespace pmac::runtime
