#include "runtime/drives/silverlode/retime.h"

#include <algorithm>
#include <cmath>

namespace pmac::drives::silverlode {
namespace {

constexpr double kLeastRateSquare = 1e-8;    // a ten-thousandth of the commanded speed
constexpr int kBisections = 45;
constexpr double kSteepest = 1.4;            // change of z from sample to sample
constexpr double kTolerated = 1.0001;

class Retimer {
 public:
  Retimer(const Commanded& motion, std::span<const CountLimits> limits, std::span<const double> room) : motion_(motion), limits_(limits), room_(room) {}

  bool is_needed() const;
  Slowed slowed();

 private:
  /// Derivatives with respect to commanded time at a sample.
  double first(std::size_t axis, std::ptrdiff_t row) const { return (motion_.sample(axis, row + 1) - motion_.sample(axis, row - 1)) / (2 * motion_.period_s()); }
  double second(std::size_t axis, std::ptrdiff_t row) const {
    return (motion_.sample(axis, row + 1) - 2 * motion_.sample(axis, row) + motion_.sample(axis, row - 1)) / (motion_.period_s() * motion_.period_s());
  }

  struct Range { double low, high; bool is_empty() const { return low > high; } };
  void load(std::size_t row);
  Range next_of(double z, double next_most) const;
  double largest(double most, double next_most) const;
  double speed_bound() const;
  Slowed sampled(const std::vector<double>& z) const;

  const Commanded& motion_;
  std::span<const CountLimits> limits_;
  std::span<const double> room_;
  std::vector<double> first_, second_;       // of the loaded row
  double loaded_room_ = 1;
};

bool Retimer::is_needed() const {
  for (std::size_t a = 0; a < motion_.axes(); ++a)
    for (std::ptrdiff_t row = 0; row < static_cast<std::ptrdiff_t>(motion_.rows()); ++row)
      if (std::abs(first(a, row)) > limits_[a].speed_counts_s * kTolerated || std::abs(second(a, row)) > limits_[a].accel_counts_s2 * kTolerated) return true;
  return false;
}

void Retimer::load(std::size_t row) {
  first_.resize(motion_.axes());
  second_.resize(motion_.axes());
  loaded_room_ = room_[row];
  for (std::size_t a = 0; a < motion_.axes(); ++a) {
    first_[a] = first(a, static_cast<std::ptrdiff_t>(row));
    second_[a] = second(a, static_cast<std::ptrdiff_t>(row));
  }
}

/// z of the next sample that the accelerations allow: |p'' z + p' (next - z) / (2 period)| <= A for every axis,
/// and no jumps, to which nothing else would be in the way where p' is near 0.
Retimer::Range Retimer::next_of(double z, double next_most) const {
  Range range{z / kSteepest, std::min(next_most, z * kSteepest)};
  for (std::size_t a = 0; a < first_.size(); ++a) {
    const double slope = first_[a] / (2 * motion_.period_s()), fixed = (second_[a] - slope) * z, most = limits_[a].accel_counts_s2 * loaded_room_;
    if (slope == 0) {
      if (std::abs(fixed) > most) return {1, 0};
      continue;
    }
    const double one = (-most - fixed) / slope, other = (most - fixed) / slope;
    range.low = std::max(range.low, std::min(one, other));
    range.high = std::min(range.high, std::max(one, other));
  }
  return range;
}

double Retimer::speed_bound() const {
  double most = 1;
  for (std::size_t a = 0; a < first_.size(); ++a) {
    const double speed = std::abs(first_[a]), limit = limits_[a].speed_counts_s * std::sqrt(loaded_room_);
    if (speed > limit) most = std::min(most, limit * limit / (speed * speed));
  }
  return most;
}

/// The largest z from which some z of the next sample can be had. The ones that can are an interval from 0.
double Retimer::largest(double most, double next_most) const {
  if (!next_of(most, next_most).is_empty()) return most;
  double low = 0, high = most;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = (low + high) / 2;
    (next_of(middle, next_most).is_empty() ? high : low) = middle;
  }
  return std::max(low, kLeastRateSquare);
}

Slowed Retimer::slowed() {
  const std::size_t rows = motion_.rows();
  std::vector<double> z(rows, 1.0);
  if (rows >= 3) load(rows - 2);
  const double end = rows >= 3 ? largest(speed_bound(), 1) : 1;       // at rest anything goes; as the sample before
  for (std::size_t row = rows; row-- > 0;) {
    load(row);
    const double next = row + 1 < rows ? z[row + 1] : end;
    z[row] = largest(speed_bound(), next);
  }
  for (std::size_t row = 0; row + 1 < rows; ++row) {
    load(row);
    const Range next = next_of(z[row], z[row + 1]);
    const double wanted = next.is_empty() ? std::min(z[row], z[row + 1]) : next.high;
    z[row + 1] = std::max(wanted, kLeastRateSquare);
  }
  return sampled(z);
}

/// The motion at a rate that changes evenly between samples, sampled every servo cycle.
Slowed Retimer::sampled(const std::vector<double>& z) const {
  const double period_s = motion_.period_s();
  Slowed slower;
  for (std::size_t row = 0; row + 1 < z.size(); ++row) slower.duration_s += 2 * period_s / (std::sqrt(z[row]) + std::sqrt(z[row + 1]));
  if (slower.duration_s > kMostSlowedRows * period_s) return slower;
  double time_s = 0, wanted_s = 0;             // end of the stretch before, next sample
  for (std::size_t row = 0; row + 1 < z.size(); ++row) {
    const double rate = std::sqrt(z[row]), next_rate = std::sqrt(z[row + 1]), span_s = 2 * period_s / (rate + next_rate);
    for (; wanted_s <= time_s + span_s; wanted_s += period_s) {
      const double t = wanted_s - time_s;
      slower.commanded_s.push_back(static_cast<double>(row) * period_s + t * (rate + t * (next_rate - rate) / span_s / 2));
    }
    time_s += span_s;
  }
  slower.commanded_s.push_back(motion_.duration_s());
  std::vector<std::vector<double>> counts(motion_.axes());
  for (std::size_t a = 0; a < motion_.axes(); ++a)
    for (const double at_s : slower.commanded_s) counts[a].push_back(motion_.position(a, at_s));
  slower.motion = Commanded(motion_, std::move(counts));
  return slower;
}

}  // namespace

bool exceeds(const Commanded& motion, std::span<const CountLimits> limits) { return Retimer(motion, limits, {}).is_needed(); }

Slowed slowed_to(const Commanded& motion, std::span<const CountLimits> limits, std::span<const double> room) { return Retimer(motion, limits, room).slowed(); }

}  // namespace pmac::drives::silverlode
