// Where a motor's profile first passes a position: for triggers.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "runtime/motion/profile.h"

namespace pmac::motion {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Real zeros of a + b d + c d^2 inside (low, high), ascending.
int zeros_between(double a, double b, double c, double low, double high, std::array<double, 2>& zeros) {
  int count = 0;
  const auto add = [&](double d) {
    if (d > low && d < high) zeros[static_cast<std::size_t>(count++)] = d;
  };
  if (c == 0) {
    if (b != 0) add(-a / b);
    return count;
  }
  const double root2 = b * b - 4 * a * c;
  if (root2 < 0) return 0;
  const double q = -(b + std::copysign(std::sqrt(root2), b)) / 2;
  add(q / c);
  if (q != 0) add(a / q);
  if (count == 2 && zeros[0] > zeros[1]) std::swap(zeros[0], zeros[1]);
  return count;
}

}  // namespace

double MotorProfile::first_time_at(double position_mu, double from_ms) const {
  double side = 0;   // of the position at from_ms: -1 below, 1 above
  for (int i = piece_at(from_ms); i < count_; ++i) {
    const Piece& piece = pieces_[static_cast<std::size_t>(i)];
    const auto left = [&](double d) {
      return piece.position + d * (piece.velocity + d * (piece.half_accel + d * piece.sixth_jerk)) - position_mu;
    };
    const double start = std::max(0.0, from_ms - piece.start_ms);
    const double end = i + 1 < count_ ? pieces_[static_cast<std::size_t>(i) + 1].start_ms - piece.start_ms : kNever;
    if (side == 0) side = left(start) < 0 ? -1 : 1;
    if (left(start) * side <= 0) return piece.start_ms + start;
    if (end == kNever) return piece.velocity * side < 0 ? piece.start_ms - left(0) / piece.velocity : kNever;  // at rest, or at speed for ever
    std::array<double, 2> turns{};
    const int count = zeros_between(piece.velocity, 2 * piece.half_accel, 3 * piece.sixth_jerk, start, end, turns);
    double low = start;
    for (int k = 0; k <= count; ++k) {
      double high = k < count ? turns[static_cast<std::size_t>(k)] : end;
      if (left(high) * side <= 0) {
        for (double middle = (low + high) / 2; middle > low && middle < high; middle = (low + high) / 2) (left(middle) * side > 0 ? low : high) = middle;
        return piece.start_ms + high;
      }
      low = high;
    }
  }
  return kNever;
}

}  // namespace pmac::motion
