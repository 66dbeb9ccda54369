// Samples of all cards at a fixed period: at 0, the period, twice the period, ..., the last one the first at or after the end. It is
// told of every stretch of time before the system goes through it, and keeps nothing.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "runtime/acr1000/card_system.h"

namespace pmac::acr1000 {

/// Where every card is at a time.
using SampleTaker = std::function<void(double time_s, std::span<const MotionPoint> cards)>;

/// The times of the samples.
class SampleClock {
 public:
  explicit SampleClock(double period_s) : period_s_(period_s) {}
  double next_s() const { return static_cast<double>(index_) * period_s_; }
  void advance() { ++index_; }
  /// There is a sample still to take for a motion that ends at end_s.
  bool is_due_until(double end_s) const { return index_ == 0 || next_s() - period_s_ < end_s - period_s_ * 1e-9; }

 private:
  double period_s_;
  std::int64_t index_ = 0;
};

class Sampler {
 public:
  /// period_s > 0.
  Sampler(const CardSystem& system, double period_s, SampleTaker taker) : system_(system), clock_(period_s), taker_(std::move(taker)) {}
  /// SystemObservers::stretch.
  void stretch(double from_s, double to_s);
  /// The run is over.
  void finish(double end_s);

 private:
  void take();
  const CardSystem& system_;
  SampleClock clock_;
  SampleTaker taker_;
  std::vector<MotionPoint> points_;
};

}  // namespace pmac::acr1000
