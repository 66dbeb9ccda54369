// The geometry of one move in axis space, without time: a straight line of all its axes, or an arc of three of them (helix and
// spiral included) with the others running along. The parameter u goes from 0 at the start to 1 at the end.
//
//   line    p(u) = start + u * delta
//   pvt     a cubic of u in every axis, with given rates at both ends
//   arc     as a line in every axis outside the plane, and in the plane
//           p(u) = center + (radius + u * radius_change) * (radial cos(u * sweep) + tangential sin(u * sweep))
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "runtime/motion/types.h"

namespace pmac::motion {

/// Axis indices of the two circle sets.
inline constexpr int kAxisX = 6, kAxisXX = 29;

/// What a pvt curve has besides its ends: derivatives with respect to u there.
struct EndRates { AxisVector start{}, end{}; };

struct Curve {
  AxisVector start{}, end{};    // every axis, also those that do not move
  AxisVector delta{};           // of the part that is linear in u; for an arc its component along the normal
  std::uint32_t moved = 0;      // axes that change (1 << axis index)
  bool is_arc = false;
  int first_axis = kAxisX;      // of the three circle axes
  std::array<double, 3> center{}, radial{}, tangential{};  // the last two are unit vectors
  std::shared_ptr<const EndRates> rates;                 // pvt only
  std::vector<double> motor_start_rate_mu, motor_end_rate_mu;  // the same of the motors, where the next two are given
  std::vector<double> motor_start_mu, motor_delta_mu;  // unsegmented: motors go straight from end to end; else empty
  double radius = 0, radius_change = 0, sweep_rad = 0;
};

/// A curve that parts of the path share. Its memory comes from curves that have been dropped before. For one thread at a time.
class CurveRef {
 public:
  CurveRef() = default;
  CurveRef(const CurveRef& other) : shared_(other.shared_) { if (shared_) ++shared_->users; }
  CurveRef(CurveRef&& other) noexcept : shared_(std::exchange(other.shared_, nullptr)) {}
  CurveRef& operator=(CurveRef other) noexcept {
    std::swap(shared_, other.shared_);
    return *this;
  }
  ~CurveRef() { if (shared_ && --shared_->users == 0) give_back(); }
  /// A curve to be filled in, by set_line() to begin with.
  static CurveRef make();
  /// As long as nobody else has it.
  Curve& fill() { return shared_->curve; }

  const Curve& operator*() const { return shared_->curve; }
  const Curve* operator->() const { return &shared_->curve; }
  explicit operator bool() const { return shared_ != nullptr; }
  bool operator==(const CurveRef& other) const { return shared_ == other.shared_; }

 private:
  struct Shared { Curve curve; int users = 0; Shared* next = nullptr; };
  class Memory;
  void give_back();

  Shared* shared_ = nullptr;
};

/// Replaces `curve` by a straight line; `moved` are the axes that differ, all of them among `axes`.
void set_line(Curve& curve, const AxisVector& start, const AxisVector& end, std::uint32_t axes);
Curve line(const AxisVector& start, const AxisVector& end);

/// The cubic with these derivatives (uu per u) at its ends.
Curve pvt_curve(const AxisVector& start, const AxisVector& end, const EndRates& rates);

/// Coefficients of u, u^2, u^3 of the cubic that covers delta with these rates at its ends.
std::array<double, 3> cubic_coefficients(double delta, double start_rate, double end_rate);

/// Position and derivatives with respect to u. Derivatives are written for moved axes only; the others keep what they were.
struct CurvePoint { AxisVector position, d1, d2; };
void evaluate(const Curve& curve, double u, CurvePoint& point);

/// A parameter that misses 0 or 1 by rounding is 0 or 1: sums of ramp integrals do.
inline double exact_end(double u) {
  constexpr double kRounding = 1e-14;
  return std::abs(u - 1) < kRounding ? 1 : std::abs(u) < kRounding ? 0 : u;
}

/// First derivative with respect to u at u, of every axis.
AxisVector derivative(const Curve& curve, double u);

}  // namespace pmac::motion
