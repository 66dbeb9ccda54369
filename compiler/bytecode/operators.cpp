// The operators that need more than one line, and the two entry points by opcode and by assignment.
#include "compiler/bytecode/operators.h"

#include <limits>

#include "compiler/bytecode/bytecode.h"
#include "compiler/bytecode/opcode.h"

namespace pmac::bytecode {
namespace {

constexpr double kTwoTo63 = 9223372036854775808.0;
constexpr double kTwoTo64 = 18446744073709551616.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Number of bits to shift by, 0 to 64.
int shift_count(double count) {
  if (!(count >= 1.0)) return 0;
  return count >= 64.0 ? 64 : static_cast<int>(count);
}

double positive_modulo(double left, double right) {
  double rest = std::fmod(left, right);
  if (rest < 0) rest += right;
  return rest >= right ? 0.0 : rest + 0.0;  // + 0.0: no negative zero
}

double symmetric_modulo(double left, double half) {
  const double range = 2 * half;
  double rest = std::fmod(left, range);
  if (rest >= half) rest -= range;
  if (rest < -half) rest += range;
  return rest + 0.0;
}

}  // namespace

std::int64_t integer_from(double value) {
  if (value > -kTwoTo63 && value < kTwoTo63) return static_cast<std::int64_t>(value);
  if (std::isnan(value)) return 0;
  if (value >= kTwoTo63 && value < kTwoTo64) return static_cast<std::int64_t>(static_cast<std::uint64_t>(value));
  return value < 0 ? std::numeric_limits<std::int64_t>::min() : std::numeric_limits<std::int64_t>::max();
}

double modulo(double left, double right) {
  if (!std::isfinite(left) || !std::isfinite(2 * right) || right == 0) return kNan;
  return right > 0 ? positive_modulo(left, right) : symmetric_modulo(left, -right);
}

double shift_left(double left, double count) {
  const int bits = shift_count(count);
  if (bits == 64) return 0;
  return static_cast<double>(static_cast<std::int64_t>(static_cast<std::uint64_t>(integer_from(left)) << bits));
}

double shift_right(double left, double count) {
  const int bits = shift_count(count);
  const std::int64_t value = integer_from(left);
  return static_cast<double>(value >> (bits == 64 ? 63 : bits));   // cppcheck-suppress shiftTooManyBitsSigned ; C++20 says what it is
}

double apply_binary(Opcode op, double left, double right) {
  switch (op) {
    case Opcode::kAdd: return left + right;
    case Opcode::kSub: return left - right;
    case Opcode::kMul: return left * right;
    case Opcode::kDiv: return left / right;
    case Opcode::kMod: return modulo(left, right);
    case Opcode::kBitAnd: return bit_and(left, right);
    case Opcode::kBitOr: return bit_or(left, right);
    case Opcode::kBitXor: return bit_xor(left, right);
    case Opcode::kShiftLeft: return shift_left(left, right);
    case Opcode::kShiftRight: return shift_right(left, right);
    case Opcode::kEqual: return left == right ? 1 : 0;
    case Opcode::kNotEqual: return left != right ? 1 : 0;
    case Opcode::kLess: return left < right ? 1 : 0;
    case Opcode::kLessEqual: return left <= right ? 1 : 0;
    case Opcode::kNear: return is_near(left, right) ? 1 : 0;
    default: return kNan;
  }
}

double apply_assignment(AssignOp op, double current, double value) {
  switch (op) {
    case AssignOp::kSet: return value;
    case AssignOp::kAdd: return current + value;
    case AssignOp::kSub: return current - value;
    case AssignOp::kMul: return current * value;
    case AssignOp::kDiv: return current / value;
    case AssignOp::kMod: return modulo(current, value);
    case AssignOp::kAnd: return bit_and(current, value);
    case AssignOp::kOr: return bit_or(current, value);
    case AssignOp::kXor: return bit_xor(current, value);
    case AssignOp::kShiftLeft: return shift_left(current, value);
    case AssignOp::kShiftRight: return shift_right(current, value);
    case AssignOp::kCount: break;
  }
  return kNan;
}

}  // namespace pmac::bytecode
