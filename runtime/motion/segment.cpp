#include "runtime/motion/segment.h"

namespace pmac::motion {

GrowthSums far_growth_sums(double growth, double t) {
  const double w = std::sqrt(std::abs(growth)), half = std::sin(w * t / 2), half_h = std::sinh(w * t / 2);
  if (growth < 0) return {std::sin(w * t) / w, 2 * half * half / -growth};
  return {std::sinh(w * t) / w, 2 * half_h * half_h / growth};
}

double time_between(double rate0, double rate1, double d, double growth) {
  constexpr double kNear = 0.01;   // series up to here: the next term is below 1e-15 of the sum
  const double y = d / (rate0 + rate1), z = growth * y * y;
  if (std::abs(z) <= kNear) return 2 * y * (1 + z * (1 / 3. + z * (1 / 5. + z * (1 / 7. + z * (1 / 9. + z * (1 / 11. + z * (1 / 13.)))))));
  const double w = std::sqrt(std::abs(growth));
  return 2 * (growth > 0 ? std::atanh(w * y) : std::atan(w * y)) / w;
}

}  // namespace pmac::motion
