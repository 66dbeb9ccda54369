#include "runtime/gather/series.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

using namespace pmac::runtime;

TEST_CASE("rate of change: exact for a parabola inside, one-sided at the ends", "[gather]") {
  std::vector<double> time, value;
  for (int k = 0; k < 5; ++k) {
    time.push_back(0.5 * k);
    value.push_back(3 * time.back() * time.back());
  }
  const std::vector<double> rate = rate_of_change(time, value);
  CHECK(rate[2] == Approx(6 * 1.0));
  CHECK(rate[3] == Approx(6 * 1.5));
  CHECK(rate[0] == Approx((0.75 - 0) / 0.5));
  CHECK(rate_of_change(std::vector<double>{1}, std::vector<double>{2}) == std::vector<double>{0});
  CHECK(rate_of_change(std::vector<double>{1, 1}, std::vector<double>{2, 3}) == std::vector<double>{0, 0});
  CHECK(rate_of_change({}, {}).empty());
}

TEST_CASE("thinning: short curves are kept whole", "[gather]") {
  const std::vector<double> curve = {1, 2, 3};
  const std::array<std::span<const double>, 1> curves = {curve};
  CHECK(thinned(curves, 10) == std::vector<std::size_t>{0, 1, 2});
  CHECK(thinned({}, 10).empty());
}

TEST_CASE("thinning: single spikes of every curve and both ends survive", "[gather]") {
  std::vector<double> a(100000, 0.0), b(100000);
  for (std::size_t i = 0; i < b.size(); ++i) b[i] = std::sin(static_cast<double>(i) * 0.001);
  a[12345] = 7;
  a[54321] = -7;
  b[77777] = 3;
  b[5] = std::nan("");
  const std::array<std::span<const double>, 2> curves = {a, b};
  const std::vector<std::size_t> kept = thinned(curves, 4000);
  CHECK(kept.size() <= 4002);
  CHECK(kept.front() == 0);
  CHECK(kept.back() == 99999);
  CHECK(std::is_sorted(kept.begin(), kept.end()));
  for (const std::size_t spike : {12345, 54321, 77777}) CHECK(std::binary_search(kept.begin(), kept.end(), spike));
}
