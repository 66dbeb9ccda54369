// Hop 9: timed segments in a row, evaluated at ascending times.
#pragma once

#include <span>
#include <vector>

#include "runtime/motion/ring.h"
#include "runtime/motion/segment.h"

namespace pmac::motion {

class Timeline {
 public:
  /// Nothing but rest at position_mu.
  void reset(std::vector<double> position_mu, double time_ms);
  /// The motors stand here until the next segment (and from its start where that begins).
  void set_rest(std::vector<double> position_mu);

  /// Starts at or after the end of the one before.
  void push(TimedSegment&& segment);
  /// The same, run through at its programmed rate, to be filled in but for its times: nothing is known of what stands in it.
  Segment& extend(double start_ms, double duration_ms);
  /// So much programmed time stays known behind the last sample, for retracing.
  void keep_history(double programmed_ms) { history_ms_ = programmed_ms; }
  /// Forgets segments that sample() has passed and that are no history either.
  void prune();
  /// The earliest time that sample() and peek() may be asked for, and the one from which amount_ms of programmed time lead to time_ms
  /// (the earliest where there is less).
  double oldest_ms() const { return known_.empty() ? end_ms_ : known_.front().timed.start_ms; }
  double history_start_ms(double time_ms, double amount_ms) const;

  double end_ms() const { return end_ms_; }
  double sampled_ms() const { return sampled_ms_; }
  /// Programmed time of the segments that begin at or after time_ms.
  double programmed_after(double time_ms) const;
  /// Until when programmed_after() stays at amount_ms or more; -inf if it does not.
  double programmed_until_ms(double amount_ms) const;
  SourceLine source_at(double time_ms) const;

  /// See Pipeline::sample().
  void sample(std::span<const double> time_ms, std::span<double> position_mu, std::span<double> velocity_mu_ms);
  /// Stands where sample() at this time would leave it.
  void pass(double time_ms);

  /// Positions at one time that has not been pruned.
  void peek(double time_ms, std::span<double> position_mu) const;

 private:
  void stand_at(double time_ms);
  static bool are_few(const TimedSegment& segment, std::span<const double> time_ms, std::size_t first);
  static std::size_t sample_few(const TimedSegment& segment, std::span<const double> time_ms, std::size_t first, std::span<double> position_mu);
  std::size_t segment_until(const TimedSegment& segment, std::span<const double> time_ms, std::size_t first) const;
  std::size_t rest_until(std::span<const double> time_ms, std::size_t first);
  void sample_segment(const TimedSegment& segment, std::span<const double> time_ms, std::size_t first, std::size_t last,
                      std::span<double> position_mu, std::span<double> velocity_mu_ms) const;
  void sample_rest(std::span<const double> time_ms, std::size_t first, std::size_t last, std::span<double> position_mu,
                   std::span<double> velocity_mu_ms) const;

  struct Known { TimedSegment timed; double programmed_ms; };   // programmed_ms: of all segments before it
  std::size_t first_ending_after(double time_ms) const;
  void note_end();

  Ring<Known> known_;
  bool end_is_noted_ = true;        // rest_mu_ and end_velocity_mu_ms_ are those of the end of known_
  double programmed_end_ms_ = 0;
  double history_ms_ = 0;           // programmed time that prune() leaves
  std::size_t cursor_ = 0;          // first segment that ends after the last sample
  double end_ms_ = 0;
  double sampled_ms_ = 0;
  std::vector<double> rest_mu_;     // after the last segment
  std::vector<double> end_velocity_mu_ms_;  // at its end: not zero where the motion goes on in a segment to come
};

}  // namespace pmac::motion
