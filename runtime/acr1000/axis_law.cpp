#include "runtime/acr1000/axis_law.h"

#include <algorithm>
#include <cmath>

namespace pmac::acr1000 {
namespace {

double sweep_rad(const CircleArguments& c) {
  return c.rot * (static_cast<double>(c.distance) / static_cast<double>(c.radius));
}

AxisPoint on_line(const AxisLaw& law, double u) {
  const double delta = law.end_pulses - law.start_pulses;
  return {law.start_pulses + delta * u, delta, 0};
}

AxisPoint on_circle(const AxisLaw& law, double u) {
  const double sweep = sweep_rad(law.circle), theta = sweep * u;
  const double i = static_cast<double>(law.circle.i), j = static_cast<double>(law.circle.j);
  const double c = std::cos(theta), s = std::sin(theta);
  return {centre_pulses(law) + (i * c + j * s), sweep * (j * c - i * s), -sweep * sweep * (i * c + j * s)};
}

}  // namespace

AxisPoint at(const AxisLaw& law, double u) {
  const double inside = std::clamp(u, 0.0, 1.0);
  AxisPoint point = law.is_circle ? on_circle(law, inside) : on_line(law, inside);
  if (inside == 1) point.position_pulses = law.end_pulses;
  return point;
}

double computed_end_pulses(const AxisLaw& law) { return law.is_circle ? on_circle(law, 1).position_pulses : law.end_pulses; }

double own_length_pulses(const AxisLaw& law) {
  return law.is_circle ? static_cast<double>(law.circle.distance) : std::abs(law.end_pulses - law.start_pulses);
}

double amplitude_pulses(const CircleArguments& circle) {
  return std::hypot(static_cast<double>(circle.i), static_cast<double>(circle.j));
}

double centre_pulses(const AxisLaw& law) { return law.start_pulses - static_cast<double>(law.circle.i); }

}  // namespace pmac::acr1000
