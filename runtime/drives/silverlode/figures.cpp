#include "runtime/drives/silverlode/figures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {

double radial_error_counts(const CircleSetup& setup, double x_counts, double y_counts) {
  const Center center = center_of(setup);
  const double x = x_counts / setup.scale_x - center.x, y = y_counts / setup.scale_y - center.y;
  return (std::hypot(x, y) - setup.radius) * std::sqrt(std::abs(setup.scale_x * setup.scale_y));
}

CircleFigures figures_of(const CircleSetup& setup, const Table& table) {
  CircleFigures figures{1e300, -1e300};
  std::array<double, 2> last{};
  execute(table, [&](std::int64_t tick, std::span<const Profile> servos) {
    for (std::size_t a = 0; a < 2; ++a) last[a] = static_cast<double>(servos[a].position) / kUnitsPerCount;
    const double error = radial_error_counts(setup, last[0], last[1]);
    figures.radial_min_counts = std::min(figures.radial_min_counts, error);
    figures.radial_max_counts = std::max(figures.radial_max_counts, error);
    figures.ticks = tick;
  });
  figures.closing_counts = std::hypot(last[0] - table.end_counts[0], last[1] - table.end_counts[1]);
  figures.time_s = static_cast<double>(figures.ticks) * kTick_s;
  return figures;
}

}  // namespace pmac::drives::silverlode
