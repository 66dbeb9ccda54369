#include "compiler/bytecode/opcode.h"
#include "compiler/bytecode/operators.h"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "compiler/bytecode/bytecode.h"

using namespace pmac::bytecode;

namespace {
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
double binary(Opcode op, double left, double right) { return apply_binary(op, left, right); }
}  // namespace

TEST_CASE("bitwise operators: signs as the manual states them", "[operators]") {
  CHECK(binary(Opcode::kBitAnd, 3, -3) == 1);
  CHECK(binary(Opcode::kBitOr, 3, -3) == -1);
  CHECK(binary(Opcode::kBitXor, 3, -3) == -2);
  CHECK(bit_not(5) == -6);
}

TEST_CASE("bitwise operators: operands are truncated toward zero and 53 bits are exact", "[operators]") {
  CHECK(binary(Opcode::kBitAnd, 7.9, 6.9) == 6);
  CHECK(binary(Opcode::kBitOr, -0.9, 0.9) == 0);
  const double mask = 562949953421312.0;  // $2000000000000
  CHECK(binary(Opcode::kBitAnd, mask + 5, mask) == mask);
}

TEST_CASE("bitwise operators: numbers that are no 64-bit integers have defined values", "[operators]") {
  CHECK(integer_from(kNan) == 0);
  CHECK(integer_from(kInf) == std::numeric_limits<std::int64_t>::max());
  CHECK(integer_from(-kInf) == std::numeric_limits<std::int64_t>::min());
  CHECK(integer_from(1e300) == std::numeric_limits<std::int64_t>::max());
  CHECK(integer_from(9223372036854775808.0) == std::numeric_limits<std::int64_t>::min());  // bit 63 of a mask
  CHECK(integer_from(-9223372036854775808.0) == std::numeric_limits<std::int64_t>::min());
  CHECK(binary(Opcode::kBitAnd, kNan, 7) == 0);
}

TEST_CASE("shifts: every count is defined", "[operators]") {
  CHECK(binary(Opcode::kShiftLeft, 1, 10) == 1024);
  CHECK(binary(Opcode::kShiftRight, -8, 1) == -4);
  CHECK(binary(Opcode::kShiftLeft, 3, -1) == 3);
  CHECK(binary(Opcode::kShiftLeft, 3, 64) == 0);
  CHECK(binary(Opcode::kShiftLeft, 1, 63) == -9223372036854775808.0);
  CHECK(binary(Opcode::kShiftRight, -3, 1e9) == -1);
  CHECK(binary(Opcode::kShiftRight, 3, kInf) == 0);
  CHECK(binary(Opcode::kShiftRight, 3, kNan) == 3);
}

TEST_CASE("modulo: floor for a positive modulus, symmetric for a negative one", "[operators]") {
  CHECK(modulo(7, 3) == 1);
  CHECK(modulo(-7, 3) == 2);
  CHECK(modulo(-3, 3) == 0);
  CHECK(modulo(5.5, 2) == 1.5);
  CHECK(modulo(350, -180) == -10);  // [-180, 180)
  CHECK(modulo(180, -180) == -180);
  CHECK(modulo(-180, -180) == -180);
  CHECK(modulo(-190, -180) == 170);
  CHECK(std::isnan(modulo(1, 0)));
  CHECK(std::isnan(modulo(kInf, 3)));
  CHECK(std::isnan(modulo(kNan, 3)));
  CHECK(std::isnan(modulo(3, kInf)));
}

TEST_CASE("modulo: the closed forms of the manual, and the range, for random operands", "[operators]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1000, 1000);
  for (int i = 0; i < 2000; ++i) {
    const double a = any(random);
    const double b = std::abs(any(random)) + 0.01;
    const double floored = a - b * std::floor(a / b);
    const double symmetric = a - 2 * b * std::floor((a + b) / (2 * b));
    CHECK(modulo(a, b) == Approx(floored).margin(1e-9));
    CHECK(modulo(a, -b) == Approx(symmetric).margin(1e-9));
    CHECK((modulo(a, b) >= 0 && modulo(a, b) < b));
    CHECK((modulo(a, -b) >= -b && modulo(a, -b) < b));
  }
}

TEST_CASE("modulo: the result never reaches the modulus", "[operators]") {
  CHECK(modulo(-1e-20, 1) < 1);
  CHECK(modulo(-1e-20, 1) >= 0);
}

TEST_CASE("division follows IEEE", "[operators]") {
  CHECK(binary(Opcode::kDiv, 1, 0) == kInf);
  CHECK(binary(Opcode::kDiv, -1, 0) == -kInf);
  CHECK(std::isnan(binary(Opcode::kDiv, 0, 0)));
  CHECK(binary(Opcode::kDiv, 7, 2) == 3.5);
}

TEST_CASE("comparisons: nan equals nothing", "[operators]") {
  for (const Opcode op : {Opcode::kEqual, Opcode::kLess, Opcode::kLessEqual, Opcode::kNear}) {
    CHECK(binary(op, kNan, kNan) == 0);
    CHECK(binary(op, 1, kNan) == 0);
  }
  CHECK(binary(Opcode::kNotEqual, kNan, kNan) == 1);
  CHECK(binary(Opcode::kLessEqual, 2, 2) == 1);
  CHECK(binary(Opcode::kLess, 2, 2) == 0);
}

TEST_CASE("approximately equal is closer than one half", "[operators]") {
  CHECK(binary(Opcode::kNear, 10, 10.499) == 1);
  CHECK(binary(Opcode::kNear, 10, 10.5) == 0);
  CHECK(binary(Opcode::kNear, 10, 9.501) == 1);
}

TEST_CASE("assignments use the operators", "[operators]") {
  CHECK(apply_assignment(AssignOp::kSet, 5, 3) == 3);
  CHECK(apply_assignment(AssignOp::kAdd, 5, 3) == 8);
  CHECK(apply_assignment(AssignOp::kSub, 5, 3) == 2);
  CHECK(apply_assignment(AssignOp::kMul, 5, 3) == 15);
  CHECK(apply_assignment(AssignOp::kDiv, 6, 4) == 1.5);
  CHECK(apply_assignment(AssignOp::kMod, -7, 3) == 2);
  CHECK(apply_assignment(AssignOp::kAnd, 6, 3) == 2);
  CHECK(apply_assignment(AssignOp::kOr, 6, 3) == 7);
  CHECK(apply_assignment(AssignOp::kXor, 6, 3) == 5);
  CHECK(apply_assignment(AssignOp::kShiftLeft, 6, 3) == 48);
  CHECK(apply_assignment(AssignOp::kShiftRight, 6, 1) == 3);
}
