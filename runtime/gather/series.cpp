#include "runtime/gather/series.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pmac::runtime {
namespace {

/// Indices of the lowest and highest value of a curve in [first, last), appended.
void append_extremes(std::span<const double> curve, std::size_t first, std::size_t last, std::vector<std::size_t>& out) {
  std::size_t lowest = first;
  std::size_t highest = first;
  for (std::size_t i = first; i < last; ++i) {
    if (curve[i] < curve[lowest] || std::isnan(curve[lowest])) lowest = i;
    if (curve[i] > curve[highest] || std::isnan(curve[highest])) highest = i;
  }
  out.push_back(lowest);
  out.push_back(highest);
}

}  // namespace

std::vector<double> rate_of_change(std::span<const double> time, std::span<const double> value) {
  std::vector<double> rate(value.size(), 0.0);
  for (std::size_t i = 0; i < value.size() && value.size() > 1; ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = i + 1 == value.size() ? i : i + 1;
    const double duration = time[after] - time[before];
    if (duration > 0) rate[i] = (value[after] - value[before]) / duration;
  }
  return rate;
}

std::vector<std::size_t> thinned(std::span<const std::span<const double>> curves, std::size_t max_points) {
  const std::size_t size = curves.empty() ? 0 : curves[0].size();
  std::vector<std::size_t> kept(size);
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  if (size <= max_points) return kept;

  kept.assign({0, size - 1});
  const std::size_t runs = std::max<std::size_t>(1, max_points / (2 * curves.size()));
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t first = run * size / runs;
    const std::size_t last = (run + 1) * size / runs;
    for (const std::span<const double> curve : curves) append_extremes(curve, first, last, kept);
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

}  // namespace pmac::runtime
