// The scalar functions of script expressions. Degree functions reduce the angle exactly, so that sind(180) is 0 and
// cosd(60) is 0.5; domain errors give nan and never stop a program (Users Manual p550).
#include <cmath>
#include <limits>
#include <numbers>

#include "compiler/bytecode/function.h"
#include "runtime/interpreter/interpreter.h"

namespace pmac::runtime {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// An angle as quarter turns and a rest in [-45, 45] degrees.
struct ReducedAngle { int quarter; double rest_deg; };

ReducedAngle reduce(double angle_deg) {
  const double turn_deg = std::fmod(angle_deg, 360.0);
  const double quarter = std::rint(turn_deg / 90.0);
  return {static_cast<int>(quarter) & 3, turn_deg - 90.0 * quarter};
}

double sine_of_rest(double rest_deg) {
  if (std::abs(rest_deg) == 30.0) return std::copysign(0.5, rest_deg);
  return std::sin(rest_deg * kRadPerDeg);
}

double sine_deg(double angle_deg) {
  if (!std::isfinite(angle_deg)) return std::numeric_limits<double>::quiet_NaN();
  const ReducedAngle angle = reduce(angle_deg);
  const bool is_cosine = (angle.quarter & 1) != 0;
  const double value = is_cosine ? std::cos(angle.rest_deg * kRadPerDeg) : sine_of_rest(angle.rest_deg);
  return (angle.quarter & 2) != 0 ? 0.0 - value : value;
}

double cosine_deg(double angle_deg) {
  if (!std::isfinite(angle_deg)) return std::numeric_limits<double>::quiet_NaN();
  const ReducedAngle angle = reduce(angle_deg);
  const bool is_sine = (angle.quarter & 1) != 0;
  const double value = is_sine ? sine_of_rest(angle.rest_deg) : std::cos(angle.rest_deg * kRadPerDeg);
  return angle.quarter == 1 || angle.quarter == 2 ? 0.0 - value : value;
}

double tangent_deg(double angle_deg) {
  if (std::fmod(std::abs(angle_deg), 180.0) == 45.0) return std::copysign(1.0, angle_deg);
  if (std::fmod(std::abs(angle_deg), 180.0) == 135.0) return -std::copysign(1.0, angle_deg);
  return sine_deg(angle_deg) / cosine_deg(angle_deg);
}

double sign_of(double x) {
  if (std::isnan(x)) return x;
  return x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0;
}

double fifth_root(double x) { return std::copysign(std::pow(std::abs(x), 0.2), x); }

double seed_generator(double seed, Host& host) {
  host.seed_random(seed);
  return seed;
}

}  // namespace

double apply_function(bytecode::Function function, std::span<const double> arguments, Host& host) {
  using bytecode::Function;
  const double x = arguments[0];
  switch (function) {
    case Function::kAbs: return std::abs(x);
    case Function::kAcos: return std::acos(x);
    case Function::kAcosd: return std::acos(x) * kDegPerRad;
    case Function::kAcosh: return std::acosh(x);
    case Function::kAsin: return std::asin(x);
    case Function::kAsind: return std::asin(x) * kDegPerRad;
    case Function::kAsinh: return std::asinh(x);
    case Function::kAtan: return std::atan(x);
    case Function::kAtand: return std::atan(x) * kDegPerRad;
    case Function::kAtanh: return std::atanh(x);
    case Function::kAtan2: return std::atan2(x, arguments[1]);
    case Function::kAtan2d: return std::atan2(x, arguments[1]) * kDegPerRad;
    case Function::kCbrt: return std::cbrt(x);
    case Function::kCeil: return std::ceil(x);
    case Function::kCos: return std::cos(x);
    case Function::kCosd: return cosine_deg(x);
    case Function::kCosh: return std::cosh(x);
    case Function::kExp: return std::exp(x);
    case Function::kExp2: return std::exp2(x);
    case Function::kFloor: return std::floor(x);
    case Function::kInt: return std::floor(x);
    case Function::kIsNan: return std::isnan(x) ? 1.0 : 0.0;
    case Function::kLn: return std::log(x);
    case Function::kLog: return std::log(x);
    case Function::kLog10: return std::log10(x);
    case Function::kLog2: return std::log2(x);
    case Function::kMadd: return x * arguments[1] + arguments[2];
    case Function::kPow: return std::pow(x, arguments[1]);
    case Function::kQnrt: return fifth_root(x);
    case Function::kQrrt: return std::sqrt(std::sqrt(x));
    case Function::kRandx: return host.random(x);
    case Function::kRem: return std::fmod(x, arguments[1]);
    case Function::kRint: return std::nearbyint(x);
    case Function::kRnd: return std::round(x);
    case Function::kSeed: return seed_generator(x, host);
    case Function::kSgn: return sign_of(x);
    case Function::kSin: return std::sin(x);
    case Function::kSind: return sine_deg(x);
    case Function::kSinh: return std::sinh(x);
    case Function::kSqrt: return std::sqrt(x);
    case Function::kTan: return std::tan(x);
    case Function::kTand: return tangent_deg(x);
    case Function::kTanh: return std::tanh(x);
    default: break;  // functions of addresses: InterpreterCore::memory_function
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace pmac::runtime
