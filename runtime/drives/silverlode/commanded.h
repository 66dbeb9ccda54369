// The motion that a run commands, in counts: servo samples in, position at any time and distance from the path out.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "runtime/servo/servo.h"

namespace pmac::drives::silverlode {

/// Collects the samples of a run; memory grows with its length, 8 bytes a motor and servo cycle.
class Commanded {
 public:
  Commanded() = default;
  /// The motion of another one at other times. counts: [axis][row], equal lengths.
  Commanded(const Commanded& other, std::vector<std::vector<double>> counts);

  void take(const runtime::SampleBlock& block);

  /// All samples are there: leaves out motors that never move and the rest before and after the motion. counts_per_mu: for every motor, or
  /// one for all.
  void finish(std::span<const double> counts_per_mu);

  const std::vector<int>& motors() const { return motors_; }
  std::size_t axes() const { return counts_.size(); }
  bool moves() const { return !counts_.empty(); }
  double duration_s() const { return period_s_ * static_cast<double>(rows_ - 1); }
  double period_s() const { return period_s_; }
  /// Of the motion's begin, in the time of the run.
  double start_s() const { return start_s_; }

  /// The largest distance from 0, counts.
  double furthest(std::size_t axis) const;
  std::size_t rows() const { return rows_; }
  /// Counts of a servo cycle from the begin of the motion; at rest outside of it.
  double sample(std::size_t axis, std::ptrdiff_t row) const;
  /// Counts at a time from the begin of the motion; at rest outside of it.
  double position(std::size_t axis, double time_s) const;
  /// A measure of how much the acceleration changes at a time, over all axes; counts/s^2.
  double acceleration_step(double time_s) const;

  /// Distance of a position [axis] from the path, searched for downhill from a time of the motion.
  double distance(std::span<const double> position_counts, double time_s) const;

 private:
  double distance_to_stretch(std::span<const double> position_counts, std::ptrdiff_t row) const;

  std::vector<int> motors_;
  std::vector<std::vector<double>> counts_;   // [axis][row]
  std::size_t rows_ = 0;
  double period_s_ = 0, start_s_ = 0;
};

}  // namespace pmac::drives::silverlode
