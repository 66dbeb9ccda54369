// Numbers for pictures: derivatives of sampled positions, and fewer points that look the same.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace pmac::runtime {

/// d value / d time at every sample by central differences, one-sided at the ends. Equal sizes; 0 where time stands still.
std::vector<double> rate_of_change(std::span<const double> time, std::span<const double> value);

/// Indices, ascending, of about max_points samples that keep the shape of the curves: the first and last sample, and from
/// each of equal runs of samples the lowest and the highest value of every curve. All samples if there are no more than
/// max_points. Curves have equal sizes; nan is passed over.
std::vector<std::size_t> thinned(std::span<const std::span<const double>> curves, std::size_t max_points);

}  // namespace pmac::runtime
