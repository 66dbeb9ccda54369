// The vocabulary of the bytecode: names and rows made from opcode.def and function.def, and the names of the
// few enumerations that are written out in bytecode.h.
#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "compiler/bytecode/bytecode.h"
#include "compiler/bytecode/card.h"
#include "compiler/bytecode/control.h"
#include "compiler/bytecode/function.h"
#include "compiler/bytecode/opcode.h"

namespace pmac::bytecode {
namespace {

template <class Enum>
constexpr std::size_t index_of(Enum value) {
  return static_cast<std::size_t>(value);
}

constexpr std::size_t kOpcodeCount = index_of(Opcode::kCount);
constexpr std::size_t kFunctionCount = index_of(Function::kCount);

constexpr std::array<OpcodeInfo, kOpcodeCount> kOpcodes = {{
#define OPCODE(Name, text, format, meaning) {text, OperandFormat::k##format, meaning},
#include "compiler/bytecode/opcode.def"
#undef OPCODE
}};

constexpr FunctionInfo make_function(std::string_view name, std::string_view signature, std::string_view meaning) {
  const bool has_values = signature.ends_with('.');
  const bool uses_memory = signature.find_first_not_of("nN") != std::string_view::npos;
  return {name, signature, static_cast<int>(signature.size()) - (has_values ? 1 : 0), uses_memory, meaning};
}

constexpr std::array<FunctionInfo, kFunctionCount> kFunctions = {{
#define FUNCTION(Name, name, signature, meaning) make_function(name, signature, meaning),
#include "compiler/bytecode/function.def"
#undef FUNCTION
}};

constexpr std::array<CardVerbInfo, index_of(CardVerb::kCount)> kCardVerbs = {{
#define CARD_VERB(Name, text, arguments, meaning) {text, arguments, meaning},
#include "compiler/bytecode/card_verb.def"
#undef CARD_VERB
}};

constexpr CardVerbInfo kUnknownCardVerb = {"?", 0, "no such verb"};
constexpr OpcodeInfo kUnknownOpcode = {"?", OperandFormat::kNone, "no such instruction"};
constexpr FunctionInfo kUnknownFunction = {"?", "", 0, false, "no such function"};

constexpr std::array<std::string_view, kAxisCount> kAxisNames = {
    "A",  "B",  "C",  "U",  "V",  "W",  "X",  "Y",  "Z",  "AA", "BB", "CC", "DD", "EE", "FF", "GG",
    "HH", "LL", "MM", "NN", "OO", "PP", "QQ", "RR", "SS", "TT", "UU", "VV", "WW", "XX", "YY", "ZZ"};

constexpr std::array<std::string_view, index_of(MoveMode::kCount)> kMoveModeNames = {
    "linear", "rapid", "circle1", "circle2", "circle3", "circle4", "pvt", "spline"};

constexpr std::array<std::string_view, index_of(MotionParameter::kCount)> kMotionParameterNames = {
    "ta", "td", "ts", "tsd", "tm", "f", "pvt", "spline0", "spline1", "spline2", "tsel", "ccr", "ccmode"};

constexpr std::array<std::string_view, index_of(ProgramKind::kCount)> kProgramKindNames = {
    "prog", "plc", "subprog", "forward", "inverse", "rotary", "online"};

struct VerbRow { std::string_view name; int argument_count; };

// In the order of ControlVerb.
constexpr std::array<VerbRow, index_of(ControlVerb::kCount)> kVerbs = {{
    {"abort", 1}, {"begin", 2}, {"run", 1}, {"step", 1}, {"start", 2}, {"pause", 1}, {"hold", 1}, {"resume", 1},
    {"quick_stop", 1}, {"retrace", 1}, {"forward", 1}, {"enable", 1}, {"disable", 1}, {"ddisable", 1}, {"adisable", 1},
    {"time_base", 2}, {"pmatch", 1}, {"pset", 2}, {"pclr", 1}, {"pstore", 1}, {"pload", 1},
    {"pread", 2}, {"vread", 2}, {"dread", 2}, {"fread", 2}, {"tread", 2},
    {"define_lookahead", 2}, {"delete_lookahead", 1},
    {"jog+", 1}, {"jog-", 1}, {"jog/", 1}, {"jog=", 2}, {"jog:", 2}, {"jog^", 2}, {"jog==", 2}, {"jog_return", 1},
    {"jog=^", 3}, {"jog:^", 3}, {"jog^^", 3},
    {"home", 1}, {"home_also", 1}, {"homez", 1}, {"kill", 1}, {"dkill", 1}, {"phase", 1}, {"out", 2},
    {"enable_plc", 1}, {"disable_plc", 1}, {"pause_plc", 1}, {"resume_plc", 1}, {"step_plc", 1},
    {"report_position", 1}, {"report_velocity", 1}, {"report_desired", 1}, {"report_following_error", 1},
    {"report_status", 1}, {"report_coord_position", 1}, {"report_coord_velocity", 1}, {"report_coord_desired", 1},
    {"report_coord_following_error", 1}, {"report_coord_target", 1}, {"report_coord_distance_to_go", 1},
    {"report_coord_status", 1}, {"report_time_base", 1},
    {"report_axis_definition", 1}, {"report_alias", 1}, {"report_global_status", 0},
    {"report_pointer", 1}, {"sendallcmds", 0}, {"reset", 0}, {"save", 0},
}};

template <std::size_t N>
std::string_view name_at(const std::array<std::string_view, N>& names, std::size_t index) {
  return index < N ? names[index] : std::string_view("?");
}

}  // namespace

std::string_view axis_name(int axis_index) {
  return axis_index < 0 ? "?" : name_at(kAxisNames, static_cast<std::size_t>(axis_index));
}

int axis_index_from_name(std::string_view name) {
  if (name.empty() || name.size() > 2) return -1;
  std::string upper(name);
  for (char& ch : upper) ch = static_cast<char>(std::toupper(static_cast<unsigned char>(ch)));
  const auto found = std::find(kAxisNames.begin(), kAxisNames.end(), upper);
  return found == kAxisNames.end() ? -1 : static_cast<int>(found - kAxisNames.begin());
}

std::string_view move_mode_name(MoveMode mode) { return name_at(kMoveModeNames, index_of(mode)); }
std::string_view motion_parameter_name(MotionParameter parameter) {
  return name_at(kMotionParameterNames, index_of(parameter));
}
std::string_view program_kind_name(ProgramKind kind) { return name_at(kProgramKindNames, index_of(kind)); }

std::string_view control_verb_name(ControlVerb verb) {
  return index_of(verb) < kVerbs.size() ? kVerbs[index_of(verb)].name : std::string_view("?");
}

int control_argument_count(ControlVerb verb) {
  return index_of(verb) < kVerbs.size() ? kVerbs[index_of(verb)].argument_count : 0;
}

const CardVerbInfo& card_verb_info(CardVerb verb) {
  if (index_of(verb) >= kCardVerbs.size()) return kUnknownCardVerb;
  return kCardVerbs[index_of(verb)];
}

const OpcodeInfo& opcode_info(Opcode opcode) {
  if (index_of(opcode) >= kOpcodeCount) return kUnknownOpcode;
  return kOpcodes[index_of(opcode)];
}

const FunctionInfo& function_info(Function function) {
  if (index_of(function) >= kFunctionCount) return kUnknownFunction;
  return kFunctions[index_of(function)];
}

}  // namespace pmac::bytecode
