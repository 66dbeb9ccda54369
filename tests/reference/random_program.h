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
inline constexpr int kFirstM = 40;      // M40 .. M43
inline constexpr int kMVariables = 4;
inline constexpr int kFirstL = 20;      // L20 .. L23 of the program, by number
inline constexpr int kRow = 8;          // global Row(8)
inline constexpr int kList = 4;         // local list(4), of the program and of the subprogram

struct Expression;
struct Statement;
using ExpressionPtr = std::shared_ptr<const Expression>;
using Block = std::vector<std::shared_ptr<const Statement>>;

struct Expression {
  enum class Kind { kNumber, kLocal, kP, kQ, kComputedP, kM, kL, kRow, kList, kUnary, kBinary, kFunction } kind = Kind::kNumber;
  double number = 0;                    // kNumber
  int variable = 0;                     // kLocal: 0-3; kP, kQ, kM, kL: from kFirst...; kComputedP, kRow, kList: the index is an operand
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
  enum class Kind { kAssign, kIf, kWhile, kDo, kSwitch, kGosub, kCall, kCallsub, kBreakIf, kContinueIf } kind = Kind::kAssign;
  ExpressionPtr target, value;          // kAssign; value: also of kSwitch
  std::string text;                     // assignment operator
  std::shared_ptr<const Condition> condition;
  Block body, otherwise;
  std::vector<std::pair<int, Block>> cases;   // kSwitch, each ends with break or falls through where `falls`
  std::vector<bool> falls;
  int counter = 0;                      // kWhile, kDo: number of the loop; P{1000 + counter} bounds it
  int routine = 0;                      // kGosub: 0 or 1
  bool bare = false;                    // kIf: one assignment a branch, without braces
};

/// N3000 and on: what is done there, and where it goes on; -1: behind the last one.
struct JumpBlock {
  Block body;
  std::shared_ptr<const Condition> condition;
  int if_true = -1, otherwise = -1;
  bool computed = false;                // goto (3000 + ...)
};

struct RandomProgram {
  Block body;
  std::vector<JumpBlock> jumps;         // behind the body; the P variable kJumpCount bounds them
  std::array<Block, 2> routines;        // N1000: and N1001:; the second one calls the first one
  Block own_frame;                      // N1002:, for callsub with two arguments
  Block subprogram;                     // subprog Work(a, b, &c) with locals d and list(4)
};

RandomProgram random_program(std::uint32_t seed);

/// The program as text: open subprog ... close, open prog 1 ... close.
std::string to_script(const RandomProgram& program);

inline constexpr int kJumpCount = 999;  // P999
inline constexpr int kMostJumps = 12;

/// What the variables hold afterwards.
struct Outcome {
  bool finished = true;                 // false: more than the step limit, the variables mean nothing
  std::array<double, kPVariables> p{};
  std::array<double, kQVariables> q{};
  std::array<double, kMVariables> m{};
  std::array<double, kRow> row{};
};
Outcome execute(const RandomProgram& program);

}  // namespace pmac::reference
