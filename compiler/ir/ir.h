// The program as typed statements and expressions with their places in the source: what both languages are lowered to. Lowering
// fills everything but the bindings; sema fills those (variable numbers, elements, functions, local numbers) and nothing else.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "compiler/source/source.h"

namespace pmac::compiler::ir {

using bytecode::CardVerb;
using bytecode::ControlVerb;
using bytecode::MotionParameter;
using bytecode::MoveMode;
using bytecode::VariableClass;
using bytecode::WordKind;
using source::Span;

// --- expressions ------------------------------------------------------------------------------------------------------

enum class Operator : std::uint8_t {
  kAdd, kSub, kMul, kDiv, kMod, kBitAnd, kBitOr, kBitXor, kShiftLeft, kShiftRight,
  kEqual, kNotEqual, kLess, kGreater, kLessEqual, kGreaterEqual, kNotGreater, kNotLess, kNear, kNotNear,
  kAnd, kOr,
  kNegate, kInvert, kNot,
};
std::string_view operator_text(Operator op);
bool is_comparison(Operator op);   // kEqual .. kNotNear

struct Expr;
using ExprPtr = std::unique_ptr<Expr>;

struct Number { double value = 0; };
struct Text { std::string value; };

/// P100, P(expr), a declared name, an array element. number: constant part; index: computed part added to it, or null.
struct Variable {
  VariableClass variable_class = VariableClass::kP;
  std::int64_t number = 0;
  ExprPtr index;
  std::string name;                // as written where it was a name, else empty
};

/// Name, Name(arguments): bound by sema to a Variable, a Number or a FunctionCall.
struct NameUse { std::string name; bool has_arguments = false; std::vector<ExprPtr> arguments; };

/// Motor[1].JogSpeed. pattern has [] for each index; element is bound by sema. address: the form with .a.
struct Element {
  std::string pattern;
  std::vector<ExprPtr> indices;
  bytecode::ElementId element = bytecode::kNoElement;
  bool address = false;
};

struct Unary { Operator op; ExprPtr operand; };
struct Binary { Operator op; ExprPtr left, right; };
struct FunctionCall { bytecode::Function function = bytecode::kNoFunction; std::vector<ExprPtr> arguments; };

/// &P100, &Table(0), &Sys.Cdata[40]: where the variables or bytes of a vector, matrix or text begin.
/// end, filled by sema: number behind the last variable of the declared array; 0: no such array.
struct AddressOf { ExprPtr place; std::int64_t end = 0; };

struct Expr {
  Span span;
  std::variant<Number, Text, Variable, NameUse, Element, Unary, Binary, FunctionCall, AddressOf> node;
};

ExprPtr make_number(double value, Span span);

/// Value of an expression of constants, or nullopt.
std::optional<double> constant_value(const Expr& expr);

// --- statements ---------------------------------------------------------------------------------------------------------

struct Stmt;
using StmtPtr = std::unique_ptr<Stmt>;
using Body = std::vector<StmtPtr>;

struct Block { Body body; };
struct Assign { ExprPtr target; bytecode::AssignOp op = bytecode::AssignOp::kSet; bool synchronous = false; std::vector<ExprPtr> values; };
/// I5213,15,100 = 10: count variables from target on, step apart.
struct AssignSeries { ExprPtr target; std::int64_t count = 0, step = 1; ExprPtr value; };
struct IfBranch { ExprPtr condition; StmtPtr body; };
struct If { std::vector<IfBranch> branches; StmtPtr otherwise; };
struct While { ExprPtr condition; StmtPtr body; };
struct DoWhile { StmtPtr body; ExprPtr condition; };
struct Case { ExprPtr value; Span span; std::size_t first = 0; };  // value null: default. first: index into Switch::body
struct Switch { ExprPtr value; Body body; std::vector<Case> cases; };
struct Break {};
struct Continue {};
struct Label { std::int64_t number = 0; };
struct LocalDeclaration { std::string name; Span name_span; ExprPtr size; ExprPtr value; std::int64_t number = -1; };
struct Locals { std::vector<LocalDeclaration> names; };
enum class JumpKind : std::uint8_t { kGoto, kGosub, kCallsub };
/// label: constant or computed label number; name: of a SUB: routine.
struct Jump { JumpKind kind = JumpKind::kGoto; ExprPtr label; std::string name; std::vector<ExprPtr> arguments; std::vector<bool> by_reference; };
struct Call { ExprPtr number; std::string name, routine; Span name_span; std::vector<ExprPtr> arguments; std::vector<bool> by_reference; std::int64_t subprogram = -1, label = -1; };
struct Return {};
struct Stop {};

/// A word of a line: a letter by its number (bytecode/letters.h), its value, and of axis words what follows : and ^.
struct LineWord { int letter = 0; ExprPtr value, velocity, trigger; Span span; };
/// G83 X1 Y2: words in order. call: the call, or the definition of a cycle, that the words stand behind; null: the words are all.
struct CodeLine { StmtPtr call; std::vector<LineWord> words; };
/// read(X,Y): bit n - 1 for letter n.
struct ReadWords { std::uint64_t letters = 0; };
/// cexec, cskip: the rest of the line, executed where the flag is set (skip: clear).
struct LineCondition { ExprPtr flag; bool skip = false; Body rest; };
struct SetFlag { ExprPtr flag; bool set = true; };
enum class CycleVerb : std::uint8_t { kDefine, kUndefine, kCall };
struct Cycle { CycleVerb verb = CycleVerb::kDefine; ExprPtr number; };
/// bstart, bstop.
struct StepBlock { bool begin = true; };

struct SetMode { MoveMode mode = MoveMode::kLinear; };
struct SetParameter { MotionParameter parameter = MotionParameter::kTa; ExprPtr value; };
/// abs, inc: axes is a mask; centres: R was in the list.
struct SetAbsInc { bool absolute = true; std::uint32_t axes = 0; bool centres = false; };
/// off: the axes are no feed-rate axes any more; else they are the feed-rate axes.
struct SetFrax { std::uint32_t axes = 0; bool secondary = false; bool off = false; };
/// second_set: of the axes XX YY ZZ.
struct SetNormal { ExprPtr vector[3]; bool second_set = false; };
struct Word { WordKind kind = WordKind::kTarget; int index = 0; ExprPtr value; Span span; };
struct Move { std::vector<Word> words; };
/// Plain move lines in a row (bytecode::MoveRun; file is that of the spans until code is made), with what there is to check in them:
/// the first row that moves an axis, that has a centre or radius, and that moves X Y Z (or XX YY ZZ) without one.
struct MoveRows {
  std::shared_ptr<std::vector<bytecode::MoveRun>> runs;   // code generation takes them out
  struct AxisUse { int axis; Span span; };
  std::vector<AxisUse> first_targets;
  Span first_centre, without_centre[2];
};
struct Dwell { ExprPtr time_ms; };
struct Delay { ExprPtr time_ms; };

/// A function that is called for what it does: strcpy(&P100, "on").
struct Evaluate { ExprPtr value; };

/// One verb for one thing, or for each of several: see ControlVerb. Missing arguments are nan.
struct Control { ControlVerb verb{}; std::vector<ExprPtr> arguments; };
/// What an ACR1000 program asks of its card. A missing argument is nan.
struct CardAction { CardVerb verb{}; std::vector<ExprPtr> arguments; };
/// IF n THEN ...: the rest of the line, executed where the relay is set.
struct RelayCondition { ExprPtr relay; Body rest; };
/// text: a printf format where values follow it.
struct Command { std::string text; std::vector<ExprPtr> values; };
struct Send { int port = 0; std::string text; std::vector<ExprPtr> values; };

// load stream only
struct AddressCoord { ExprPtr number; };
struct AddressMotor { ExprPtr number; };
struct DefineAxis { bytecode::AxisDefinition definition; };
/// declaration: the whole of `ptr A->..., B->...` that it stands in.
struct DefinePointer { bytecode::PointerDefinition definition; ExprPtr element; std::string name; Span name_span; int size = 0; Span declaration; };
struct GlobalDeclaration { VariableClass variable_class = VariableClass::kP; std::string name; Span name_span; ExprPtr size; ExprPtr value; std::int64_t number = -1; };
struct Globals { std::vector<GlobalDeclaration> names; };
struct Report { ExprPtr value; std::string name; };
struct SystemCommand { std::string text; };  // vers, echo 7, list prog 5: lower case, single blanks
/// cx: the buffer executes at once in the addressed coordinate system.
struct ExecuteAtOnce { std::size_t buffer = 0; };
struct OpenBuffer { std::size_t buffer = 0; };  // index into Unit::buffers: its open ... close stands here

struct Stmt {
  Span span;
  std::variant<Block, Assign, AssignSeries, Evaluate, If, While, DoWhile, Switch, Break, Continue, Label, Locals, Jump, Call, Return, Stop, CodeLine, ReadWords, LineCondition, SetFlag, Cycle, StepBlock, SetMode, SetParameter,
               SetAbsInc, SetFrax, SetNormal, Move, MoveRows, Dwell, Delay, Control, CardAction, RelayCondition, Command, Send, AddressCoord, AddressMotor, DefineAxis, DefinePointer,
               Globals, Report, SystemCommand, OpenBuffer, ExecuteAtOnce>
      node;
};

template <class Node>
StmtPtr make_stmt(Span span, Node node) { return std::make_unique<Stmt>(Stmt{span, std::move(node)}); }

// --- programs ------------------------------------------------------------------------------------------------------------

struct Parameter { std::string name; bool by_reference = false; Span span; };

/// A SUB: routine of a subprogram.
struct Routine { std::string name; Span span; std::vector<Parameter> parameters; std::size_t first = 0; std::int64_t label = -1; };

struct Buffer {
  bytecode::ProgramKind kind = bytecode::ProgramKind::kProg;
  std::int64_t number = -1;        // -1: to be assigned to its name, or the addressed coordinate system
  std::string name;
  Span name_span;                  // of its name or number
  Span span;                       // of its open line
  Span close_span;
  std::vector<Parameter> parameters;
  std::vector<Routine> routines;
  Body body;
  std::int64_t local_count = 0;    // filled by sema
};

/// One file, or one on-line text; of the ACR1000: what one card is sent.
struct Unit {
  std::int64_t card = 0;           // number and axis name of the card, else 0 and nothing
  std::string axis;
  std::vector<Buffer> buffers;
  Body load;                       // statements of the load stream, in order
  std::int64_t local_count = 0;    // L variables that they use; filled by sema
  Span clear_all;                  // a clear all buffers in it, or no place
};

// --- text form -------------------------------------------------------------------------------------------------------------

std::string print(const Unit& unit);
std::string print(const Expr& expr);

}  // namespace pmac::compiler::ir
