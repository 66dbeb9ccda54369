// The way into the servo stage: runs of servo-rate samples and what is made of them. A block holds the commanded positions of
// every motor in use at consecutive servo ticks; sinks take blocks, never single samples.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pmac::runtime {

/// Hop 9: servo samples of consecutive ticks.
struct SampleBlock {
  std::int64_t first_tick = 0;        // servo interrupts since the start
  double period_ms = 0;
  int count = 0;
  std::span<const int> motors;        // numbers, ascending
  std::span<const double> position_mu;// [motor][count], commanded, from home
  std::span<const double> actual_mu;  // likewise, where the motors are
  std::span<const double> home_mu;    // [motor], of home from power-on
  double time_ms(int k) const { return static_cast<double>(first_tick + k) * period_ms; }
  double at(int motor_index, int k) const { return position_mu[static_cast<std::size_t>(motor_index) * count + k]; }
  double actual_at(int motor_index, int k) const { return actual_mu[static_cast<std::size_t>(motor_index) * count + k]; }
};

/// Takes servo samples as they are made. Blocks follow each other without gap or overlap.
class SampleSink {
 public:
  virtual ~SampleSink() = default;
  virtual void take(const SampleBlock& block) = 0;
  /// It looks at nothing but the samples. False: it asks the machine as well, or is told of moves, and has to have the samples of a time
  /// before anything else happens at it.
  virtual bool takes_late() const { return true; }
};

/// Worst speed and acceleration of every motor, from first and second differences of the samples.
class MotionStatistics : public SampleSink {
 public:
  struct Row {
    int motor = 0;
    bool seen = false;
    double final_mu = 0, min_mu = 0, max_mu = 0;
    double max_speed_mu_ms = 0, max_accel_mu_ms2 = 0;
    double max_speed_at_ms = 0, max_accel_at_ms = 0;
  };
  void take(const SampleBlock& block) override;
  /// Rows of motors that were in use, by motor number.
  std::vector<Row> rows() const;

 private:
  struct State { Row row; double previous_mu = 0, before_mu = 0; };
  std::vector<State> states_;  // by motor number
};

}  // namespace pmac::runtime
