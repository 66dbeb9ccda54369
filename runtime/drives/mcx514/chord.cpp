#include "runtime/drives/mcx514/chord.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "runtime/drives/mcx514/line.h"

namespace pmac::drives::mcx514 {
namespace {

constexpr double kFirstLength = 2;        // pulses
constexpr double kLongest = 1 << 20;      // looked at event by event

AxisCounts rounded(const Point& p) {
  AxisCounts counts{};
  for (std::size_t i = 0; i < p.size(); ++i) counts[i] = std::llround(p[i]);
  return counts;
}

}  // namespace

ChordFinder::ChordFinder(const std::vector<Point>& points, double tolerance) : points_(points), tolerance_(tolerance) {
  s_.push_back(0);
  for (std::size_t i = 1; i < points.size(); ++i) s_.push_back(s_.back() + distance(points[i - 1], points[i]));
}

Point ChordFinder::at(double s) const {
  const auto above = std::lower_bound(s_.begin() + 1, s_.end() - 1, s);
  const auto i = static_cast<std::size_t>(above - s_.begin());
  const double length = s_[i] - s_[i - 1];
  const double share = length > 0 ? std::clamp((s - s_[i - 1]) / length, 0.0, 1.0) : 1.0;
  Point p;
  for (std::size_t k = 0; k < p.size(); ++k) p[k] = points_[i - 1][k] + share * (points_[i][k] - points_[i - 1][k]);
  return p;
}

/// Distance of a point from the stretch s0 to s1 of the curve; hint: the segment of the last answer.
double ChordFinder::distance_within(const Point& p, double s0, double s1, std::size_t& hint) const {
  double best = 1e300;
  std::size_t found = hint;
  for (std::size_t i = hint; i + 1 < points_.size() && s_[i] < s1; ++i) {
    const Point a = (s_[i] < s0) ? at(s0) : points_[i], b = (s_[i + 1] > s1) ? at(s1) : points_[i + 1];
    const double d = distance(p, nearest_on_segment(a, b, p));
    if (d < best) {
      best = d;
      found = i;
    } else if (d > best + 3 * tolerance_) {
      break;
    }
  }
  hint = found;
  return best;
}

/// Pulses to the grid point at to_s are near the curve, and the curve is near the line.
bool ChordFinder::is_good(const AxisCounts& from, double to_s) const {
  const AxisCounts to = rounded(at(to_s));
  AxisCounts finish{};
  for (std::size_t i = 0; i < to.size(); ++i) finish[i] = to[i] - from[i];
  auto hint = static_cast<std::size_t>(std::upper_bound(s_.begin(), s_.end() - 1, done_) - s_.begin());
  hint = hint > 0 ? hint - 1 : 0;
  const std::size_t first = hint;
  Line line(finish);
  Point p;
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = static_cast<double>(from[i]);
  const Point start = p;
  while (!line.done()) {
    const Event event = line.next();
    for (std::size_t i = 0; i < p.size(); ++i) p[i] += event.step[i];
    if (distance_within(p, done_, to_s, hint) > tolerance_) return false;
  }
  for (std::size_t i = first; i < points_.size() && s_[i] < to_s; ++i)
    if (s_[i] > done_ && distance(points_[i], nearest_on_segment(start, p, points_[i])) > tolerance_) return false;
  return true;
}

std::optional<AxisCounts> ChordFinder::next(const AxisCounts& from) {
  const double end = s_.back();
  if (ended_) return std::nullopt;
  double good = std::min(end, done_ + 1), bad = end;   // one pulse along the curve is always near enough
  for (double step = kFirstLength; good < end; step *= 2) {
    const double tried = std::min({end, done_ + step, done_ + kLongest});
    if (!is_good(from, tried)) {
      bad = tried;
      break;
    }
    good = tried;
    if (tried >= done_ + kLongest) {
      bad = good;
      break;
    }
  }
  while (bad - good > std::max(0.5, 0.02 * (good - done_))) {
    const double middle = (good + bad) / 2;
    (is_good(from, middle) ? good : bad) = middle;
  }
  done_ = good;
  ended_ = good >= end;
  return rounded(at(good));
}

}  // namespace pmac::drives::mcx514
