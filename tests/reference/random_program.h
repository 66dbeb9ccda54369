// Random structured programs with a second, slow meaning: each is a tree that can be printed as Power PMAC script and can be
// executed by walking over it. The walk uses nothing of the compiler or interpreter; what operators mean is written out here
// once more from the reference (operators: Software Reference Manual p58-59).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pmac::reference {

inline constexpr int kLocals = 4;       // of the program: a b c d
inline constexpr int kFirstP = 100;     // P100 .. P107
inline constexpr int kPVariables = 8;
inline constexpr int kFirstQ = 20;      // Q20 .. Q23
inline constexpr int kQVariables = 4;

struct Expression;
struct Statement;
using ExpressionPtr = std::shared_ptr<const Expression>;
using Block = std::vector<std::shared_ptr<const Statement>>;

struct Expression {
  enum class Kind { kNumber, kLocal, kP, kQ, kComputedP, kUnary, kBinary, kFunction } kind = Kind::kNumber;
  double number = 0;                    // kNumber
  int variable = 0;                     // kLocal: 0-3; kP, kQ: from kFirst...
  std::string text;                     // operator or function name
  std::vector<ExpressionPtr> operands;
};

struct Condition {
  enum class Kind { kCompare, kValue, kAnd, kOr, kNot } kind = Kind::kValue;
  std::string text;                     // comparator
  std::vector<ExpressionPtr> values;
  std::vector<std::shared_ptr<const Condition>> operands;
};

struct Statement {
  enum class Kind { kAssign, kIf, kWhile, kDo, kSwitch, kGosub, kCall, kBreakIf, kContinueIf } kind = Kind::kAssign;
  ExpressionPtr target, value;          // kAssign; value: also of kSwitch
  std::string text;                     // assignment operator
  std::shared_ptr<const Condition> condition;
  Block body, otherwise;
  std::vector<std::pair<int, Block>> cases;   // kSwitch, each ends with break or falls through where `falls`
  std::vector<bool> falls;
  int counter = 0;                      // kWhile, kDo: number of the loop; P{1000 + counter} bounds it
  int routine = 0;                      // kGosub: 0 or 1
};

struct RandomProgram {
  Block body;
  std::array<Block, 2> routines;        // N1000: and N1001:
  Block subprogram;                     // subprog Work(a, b, &c) with a local d
};

RandomProgram random_program(std::uint32_t seed);

/// The program as text: open subprog ... close, open prog 1 ... close.
std::string to_script(const RandomProgram& program);

/// What the variables hold afterwards.
struct Outcome {
  bool finished = true;                 // false: more than the step limit, the variables mean nothing
  std::array<double, kPVariables> p{};
  std::array<double, kQVariables> q{};
};
Outcome execute(const RandomProgram& program);

}  // namespace pmac::reference
