#include "runtime/motion/curve.h"

#include <cmath>

#include "runtime/motion/axis_vector.h"

namespace pmac::motion {
namespace {

void add_arc(const Curve& curve, double u, CurvePoint& point) {
  const double angle = u * curve.sweep_rad;
  const double c = std::cos(angle), s = std::sin(angle);
  const double rho = curve.radius + u * curve.radius_change;
  const double turn = curve.sweep_rad, grow = curve.radius_change;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t axis = static_cast<std::size_t>(curve.first_axis) + i;
    const double outward = curve.radial[i] * c + curve.tangential[i] * s;
    const double along = curve.tangential[i] * c - curve.radial[i] * s;
    point.position[axis] = curve.center[i] + u * curve.delta[axis] + rho * outward;
    point.d1[axis] = curve.delta[axis] + grow * outward + rho * turn * along;
    point.d2[axis] = 2 * grow * turn * along - rho * turn * turn * outward;
  }
}

/// From the nearer end, so that both are exact.
void evaluate_cubic(const Curve& curve, double u, CurvePoint& point) {
  for_each_axis(curve.moved, [&](std::size_t axis) {
    const double r1 = curve.rates->end[axis];
    const auto [c1, c2, c3] = cubic_coefficients(curve.delta[axis], curve.rates->start[axis], r1);
    const double w = u - 1;
    point.position[axis] = u < 0.5 ? curve.start[axis] + u * (c1 + u * (c2 + u * c3)) : curve.end[axis] + w * (r1 + w * (c2 + 3 * c3 + w * c3));
    point.d1[axis] = c1 + u * (2 * c2 + u * 3 * c3);
    point.d2[axis] = 2 * c2 + 6 * c3 * u;
  });
}

}  // namespace

std::array<double, 3> cubic_coefficients(double delta, double start_rate, double end_rate) {
  return {start_rate, 3 * delta - 2 * start_rate - end_rate, start_rate + end_rate - 2 * delta};
}

Curve pvt_curve(const AxisVector& start, const AxisVector& end, const EndRates& rates) {
  Curve curve = line(start, end);
  for (std::size_t axis = 0; axis < start.size(); ++axis)
    if (rates.start[axis] != 0 || rates.end[axis] != 0) curve.moved |= 1u << axis;
  curve.rates = std::make_shared<const EndRates>(rates);
  return curve;
}

void set_line(Curve& curve, const AxisVector& start, const AxisVector& end, std::uint32_t axes) {
  curve.start = start;
  curve.end = end;
  curve.delta.fill(0);
  curve.moved = 0;
  curve.is_arc = false;
  curve.rates.reset();
  for (std::vector<double>* of_motors : {&curve.motor_start_rate_mu, &curve.motor_end_rate_mu, &curve.motor_start_mu, &curve.motor_delta_mu}) of_motors->clear();
  for_each_axis(axes, [&](std::size_t axis) {
    curve.delta[axis] = end[axis] - start[axis];
    if (curve.delta[axis] != 0) curve.moved |= 1u << axis;
  });
}

Curve line(const AxisVector& start, const AxisVector& end) {
  Curve curve;
  set_line(curve, start, end, ~0u);
  return curve;
}

/// Curves that nobody has, for one thread.
class CurveRef::Memory {
 public:
  ~Memory() {
    while (first_) delete std::exchange(first_, first_->next);
  }
  Shared* take() { return first_ ? std::exchange(first_, first_->next) : new Shared; }
  void give_back(Shared* shared) {
    shared->next = first_;
    first_ = shared;
  }
  static Memory& here() {
    thread_local Memory memory;
    return memory;
  }

 private:
  Shared* first_ = nullptr;
};

CurveRef CurveRef::make() {
  CurveRef curve;
  curve.shared_ = Memory::here().take();
  curve.shared_->users = 1;
  return curve;
}

void CurveRef::give_back() { Memory::here().give_back(shared_); }

void evaluate(const Curve& curve, double exact_u, CurvePoint& point) {
  const double u = exact_end(exact_u);
  point.position = u < 0.5 ? curve.start : curve.end;
  if (curve.rates) return evaluate_cubic(curve, u, point);
  const AxisVector& base = point.position;
  const double offset = u < 0.5 ? u : u - 1;  // exact at both ends
  for_each_axis(curve.moved, [&](std::size_t axis) {
    point.d1[axis] = curve.delta[axis];
    point.d2[axis] = 0;
    point.position[axis] = base[axis] + offset * curve.delta[axis];
  });
  if (!curve.is_arc) return;
  add_arc(curve, u, point);
  if (u == 0) point.position = curve.start;
  if (u == 1) point.position = curve.end;
}

AxisVector derivative(const Curve& curve, double u) {
  if (!curve.is_arc && !curve.rates) return curve.delta;
  CurvePoint point;
  point.d1.fill(0);
  evaluate(curve, u, point);
  return point.d1;
}

}  // namespace pmac::motion
