// The contract between the compiler and the runtime: what a compiled module holds. The compiler fills a Module once; the
// runtime executes it and never changes it. verify() proves that a module is safe to execute, so that a damaged or hostile
// object file is an error and never a crash. Sources: the variable classes, calls and statements are those of Power PMAC
// script (User's Manual p501-676); the encoding is our own.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pmac::bytecode {

// --- vocabulary ---------------------------------------------------------------------------------------------------------
// The enumerators stand in opcode.h, function.h, element.h and control.h, so that a new row makes only its users compile again.

enum class Opcode : std::uint16_t;
enum class Function : std::uint16_t;
enum class ElementId : std::uint16_t;
enum class ControlVerb : std::uint16_t;
enum class CardVerb : std::uint16_t;
inline constexpr auto kNoFunction = static_cast<Function>(0xffff);
inline constexpr auto kNoElement = static_cast<ElementId>(0xffff);

enum class VariableClass : std::uint8_t { kP, kQ, kM, kI, kL, kR, kC, kD, kElement };

inline constexpr int kPCount = 65536;
inline constexpr int kQCount = 8192;
inline constexpr int kMCount = 16384;
inline constexpr int kICount = 16384;
inline constexpr int kLCount = 8192;
inline constexpr int kCCount = 64;
inline constexpr int kDCount = 128;
inline constexpr int kAxisCount = 32;
inline constexpr int kMaxMotors = 33;
inline constexpr int kMaxCoords = 17;
inline constexpr int kMaxPlcs = 32;
inline constexpr int kMaxArguments = 16;       // of one call
inline constexpr int kMaxElementIndices = 3;
inline constexpr int kMaxFrameSize = 16384;    // registers of one frame
inline constexpr int kMaxOutgoing = 8192;      // R variables of one frame
inline constexpr int kFirstKinematicLocal = 320;

/// Names of the 32 axes by axis index: A B C U V W X Y Z AA BB ... ZZ.
std::string_view axis_name(int axis_index);
/// Axis index of a name in either case, or -1.
int axis_index_from_name(std::string_view name);

enum class MoveMode : std::uint8_t { kLinear, kRapid, kCircle1, kCircle2, kCircle3, kCircle4, kPvt, kSpline, kCount };
std::string_view move_mode_name(MoveMode mode);

/// Parameters of SetMotion. kFeed is F, kPvtTime the number of pvt, kTsel the number of tsel and so on.
enum class MotionParameter : std::uint8_t { kTa, kTd, kTs, kTsd, kTm, kFeed, kPvtTime, kSplineTime0, kSplineTime1, kSplineTime2,
                                            kTsel, kCcRadius, kCcMode, kCount };
std::string_view motion_parameter_name(MotionParameter parameter);

/// Kinds of words in a move block. kTarget, kVelocity (pvt) and kTriggerDistance carry an axis index; kCenter carries
/// 0-2 for I J K and 3-5 for II JJ KK; kRadius carries 0.
enum class WordKind : std::uint8_t { kTarget, kVelocity, kTriggerDistance, kCenter, kRadius, kCount };

enum class AssignOp : std::uint8_t { kSet, kAdd, kSub, kMul, kDiv, kMod, kAnd, kOr, kXor, kShiftLeft, kShiftRight, kCount };
/// current (op)= value, with the operators' own semantics (integers for the bitwise ones).
double apply_assignment(AssignOp op, double current, double value);
/// r[b] op r[c] of the arithmetic, bitwise and comparison instructions (kAdd .. kNear).
double apply_binary(Opcode op, double left, double right);

// --- what a module holds -----------------------------------------------------------------------------------------------

struct Instruction {
  Opcode op;
  std::uint16_t a;
  std::int32_t imm;  // or b (low half) and c (high half)
  std::uint16_t b() const { return static_cast<std::uint16_t>(static_cast<std::uint32_t>(imm) & 0xffffu); }
  std::uint16_t c() const { return static_cast<std::uint16_t>(static_cast<std::uint32_t>(imm) >> 16); }
  static Instruction with_bc(Opcode op, unsigned a, unsigned b, unsigned c = 0) {
    return {op, static_cast<std::uint16_t>(a), static_cast<std::int32_t>((c << 16) | (b & 0xffffu))};
  }
  static Instruction with_imm(Opcode op, unsigned a, std::int32_t imm) { return {op, static_cast<std::uint16_t>(a), imm}; }
  bool operator==(const Instruction&) const = default;
};
static_assert(sizeof(Instruction) == 8);

/// Place in a source file. file indexes Module::files, -1: none. line and column count from 1, 0: none.
struct SourceLine { std::int32_t file = -1; std::int32_t line = 0; std::int32_t column = 0; bool operator==(const SourceLine&) const = default; };

/// From this instruction on (until the next entry) the source is this line.
struct LineEntry { std::uint32_t pc; SourceLine source; bool operator==(const LineEntry&) const = default; };

struct LabelEntry { std::uint32_t number; std::uint32_t pc; bool operator==(const LabelEntry&) const = default; };

/// kOnline is a load script: what the load stream does outside buffers, executed when the module is loaded.
enum class ProgramKind : std::uint8_t { kProg, kPlc, kSubprog, kForward, kInverse, kRotary, kOnline, kCount };
std::string_view program_kind_name(ProgramKind kind);

struct Program {
  ProgramKind kind = ProgramKind::kProg;
  std::uint32_t number = 0;            // prog, PLC or subprogram number; coordinate system of forward and inverse
  std::string name;                    // declared name, or empty
  std::uint32_t local_count = 0;       // L variables of the frame; registers [0, local_count)
  std::uint32_t frame_size = 0;        // >= local_count; the registers of the frame
  std::uint32_t outgoing_count = 0;    // R variables that it writes or reads: registers [frame_size, frame_size + outgoing_count)
  std::vector<Instruction> code;       // never falls off the end: last is Return, Stop, Jump, Loop or GotoLabel
  std::vector<LineEntry> lines;        // ascending pc
  std::vector<LabelEntry> labels;      // ascending number; N labels and SUB: routines
  SourceLine source;                   // of its open
  bool operator==(const Program&) const = default;
};

/// An element with its indices: constants, or the value of register `reg` of the frame where is_register.
struct ElementRef {
  struct Index { bool is_register = false; std::uint32_t value = 0; bool operator==(const Index&) const = default; };
  ElementId id{};
  Index index[kMaxElementIndices]{};
  bool address = false;                // "Element.a": its address, for Gather.Addr[]; encoded as a number by the runtime
  bool operator==(const ElementRef&) const = default;
};

/// What a synchronous assignment stores to. number_register: 0xffff, or the register whose truncated value is the number
/// (read when the line is calculated). For kElement, element indexes Module::element_refs.
struct SyncTarget {
  VariableClass variable_class = VariableClass::kP;
  std::int32_t number = 0;
  std::uint16_t number_register = 0xffff;
  std::uint32_t element = 0;
  AssignOp op = AssignOp::kSet;
  bool operator==(const SyncTarget&) const = default;
};

/// Constant call target: subprogram number, label number or -1 for its top.
struct CallTarget { std::uint32_t subprogram = 0; std::int64_t label = -1; bool operator==(const CallTarget&) const = default; };

/// #motor->...: one entry of the axis definition table.
struct AxisTerm { std::uint8_t axis = 0; double coefficient_mu_per_uu = 0; bool operator==(const AxisTerm&) const = default; };
enum class AxisDefinitionKind : std::uint8_t { kLinear, kNull, kInverseKinematics, kSpindle, kCount };
struct AxisDefinition {
  std::int32_t motor = -1;             // -1: the addressed motor
  AxisDefinitionKind kind = AxisDefinitionKind::kLinear;
  std::uint8_t spindle = 0;            // of kSpindle: 0 S, 1 S0, 2 S1
  std::vector<AxisTerm> terms;         // of kLinear
  double offset_mu = 0;
  bool operator==(const AxisDefinition&) const = default;
};

/// M variable definitions of section "pointer variables".
enum class PointerKind : std::uint8_t { kSelf, kIo, kUserInteger, kUserFloat, kUserDouble, kElement, kCount };
struct PointerDefinition {
  std::int32_t first_m = 0, last_m = 0;  // a range is allowed for kSelf
  PointerKind kind = PointerKind::kSelf;
  bool is_signed = false;
  std::uint32_t address = 0;             // I/O address or byte offset into user memory
  std::uint8_t start_bit = 0, width = 32;// of kIo, kUserInteger; of kElement where has_field
  bool has_field = false;
  std::uint32_t element = 0;             // of kElement: index into element_refs, constant indices only
  std::string name;                      // declared name, or empty
  bool operator==(const PointerDefinition&) const = default;
};

/// A declared name, for on-line commands that use names, for logs and for --emit=symbols.
enum class SymbolKind : std::uint8_t { kGlobal, kCsGlobal, kPointer, kProg, kPlc, kSubprog, kMacro, kCount };
struct Symbol {
  SymbolKind kind = SymbolKind::kGlobal;
  std::string name;
  std::uint32_t number = 0;              // P, Q, M or buffer number
  std::uint32_t size = 0;                // elements of an array, 0: scalar
  std::string text;                      // of kMacro
  bool operator==(const Symbol&) const = default;
};

/// Consecutive plain move lines (axis letters and numbers, nothing computed): what a part program mostly is, without an instruction a word.
/// Row r is the block of words first_word[r] .. first_word[r + 1] and stands at line line[r], column column[r] of a file.
struct MoveRun {
  std::int32_t file = -1;
  std::vector<std::uint32_t> first_word;   // ascending; the last entry is words.size()
  std::vector<std::uint8_t> words;         // move_word_code()
  std::vector<double> values;              // of the words
  std::vector<std::uint32_t> line;
  std::vector<std::uint8_t> column;        // 0: not known (255 and further right)
  std::size_t row_count() const { return line.size(); }
  SourceLine source(std::size_t row) const { return {file, static_cast<std::int32_t>(line[row]), column[row]}; }
  bool operator==(const MoveRun&) const = default;
};
inline constexpr std::size_t kMaxRunRows = 16384;
inline constexpr std::size_t kMaxRunWords = 65536;
/// A word of a MoveRun: kind in the upper three bits, axis or vector index in the lower five.
constexpr std::uint8_t move_word_code(WordKind kind, int index) { return static_cast<std::uint8_t>((static_cast<int>(kind) << 5) | index); }
constexpr WordKind move_word_kind(std::uint8_t code) { return static_cast<WordKind>(code >> 5); }
constexpr int move_word_index(std::uint8_t code) { return code & 31; }

struct Module {
  std::vector<std::string> files;
  std::vector<double> constants;
  std::vector<std::string> strings;
  std::vector<ElementRef> element_refs;
  std::vector<SyncTarget> sync_targets;
  std::vector<CallTarget> call_targets;
  std::vector<AxisDefinition> axis_definitions;
  std::vector<PointerDefinition> pointer_definitions;
  std::vector<Symbol> symbols;
  std::vector<MoveRun> move_runs;
  std::vector<Program> programs;                  // buffers in order of their open, and load scripts
  std::vector<std::uint32_t> load_order;          // indices of kOnline programs, in order
  bool operator==(const Module&) const = default;
};

// --- what can be done with a module --------------------------------------------------------------------------------------

/// First reason why the module is not safe to execute, or empty. Checks every operand of every instruction: registers below
/// frame_size (outgoing ones below frame_size + outgoing_count where the row allows them), variable numbers, table indices,
/// forward and backward targets, argument counts, labels ascending and in range, no fall-through past the end, kOnline-only
/// instructions in kOnline programs only, sizes within the k... limits above.
std::string verify(const Module& module);

/// Stable text form: tables, then programs with pc, instruction text and operands, source line at the right. (--emit=bytecode)
std::string disassemble(const Module& module);

/// Source of an instruction; SourceLine{} if the table has none.
SourceLine source_of(const Program& program, std::uint32_t pc);

/// The label of that number, or nullptr.
const LabelEntry* find_label(const Program& program, std::int64_t number);

/// "file:line" of a source line, or "<no source>".
std::string to_string(const Module& module, SourceLine source);

}  // namespace pmac::bytecode
