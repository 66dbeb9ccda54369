#include <catch2/catch.hpp>
#include <set>

#include "compiler/bytecode/bytecode.h"
#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/function.h"
#include "compiler/bytecode/opcode.h"

using namespace pmac::bytecode;

TEST_CASE("axis names: 32 of them, found in either case", "[bytecode]") {
  // Index by name: reference of the axis definition masks, X = bit 6, C = bit 2, ZZ = bit 31.
  CHECK(axis_index_from_name("X") == 6);
  CHECK(axis_index_from_name("c") == 2);
  CHECK(axis_index_from_name("zz") == 31);
  CHECK(axis_index_from_name("II") == -1);
  CHECK(axis_index_from_name("") == -1);
  CHECK(axis_index_from_name("XYZ") == -1);
  for (int axis = 0; axis < kAxisCount; ++axis) CHECK(axis_index_from_name(axis_name(axis)) == axis);
  CHECK(axis_name(32) == "?");
  CHECK(axis_name(-1) == "?");
}

TEST_CASE("opcodes: each has a text of its own", "[bytecode]") {
  std::set<std::string_view> texts;
  for (int op = 0; op < static_cast<int>(Opcode::kCount); ++op) texts.insert(opcode_info(static_cast<Opcode>(op)).text);
  CHECK(texts.size() == static_cast<std::size_t>(Opcode::kCount));
  CHECK(opcode_info(Opcode::kLoopIfTrue).text == "loop.true");
  CHECK(opcode_info(static_cast<Opcode>(60000)).text == "?");
}

TEST_CASE("functions: argument counts are those of the table", "[bytecode]") {
  CHECK(function_info(Function::kAtan2d).name == "atan2d");
  CHECK(function_info(Function::kAtan2d).argument_count == 2);
  CHECK(function_info(Function::kMadd).argument_count == 3);
}

TEST_CASE("elements: found by name in any case, every one of them", "[bytecode]") {
  CHECK(find_element("motor[].JOGSPEED") == ElementId::kMotorJogSpeed);
  CHECK(find_element("Sys.ServoPeriod") == ElementId::kSysServoPeriod);
  CHECK(find_element("Motor.JogSpeed") == kNoElement);
  CHECK(find_element("") == kNoElement);
  for (int id = 0; id < static_cast<int>(ElementId::kCount); ++id) {
    const auto element = static_cast<ElementId>(id);
    CHECK(find_element(element_info(element).name) == element);
  }
}

TEST_CASE("elements: a board that is another name for a structure", "[bytecode]") {
  CHECK(find_element("PowerBrick[].Chan[].OutCtrl") == ElementId::kGate3ChanOutCtrl);
  CHECK(find_element("acc24e2a[].pwmperiod") == find_element("Gate1[].PwmPeriod"));
  CHECK(find_element("Acc68E[].DataReg[]") == ElementId::kGateIoDataReg);
  CHECK(find_element("Acc99[].DataReg[]") == kNoElement);
}

TEST_CASE("elements: as many index ranges as brackets in the name", "[bytecode]") {
  for (int id = 0; id < static_cast<int>(ElementId::kCount); ++id) {
    const ElementInfo& info = element_info(static_cast<ElementId>(id));
    int brackets = 0;
    for (const char ch : info.name) brackets += ch == '[' ? 1 : 0;
    INFO(info.name);
    CHECK(info.index_count() == brackets);
  }
  CHECK(element_info(ElementId::kSysServoPeriod).default_value == 0.44274211);
}

TEST_CASE("I variables that are another name for an element", "[bytecode]") {
  CHECK(i_variable(123).id == ElementId::kMotorHomeVel);         // User's Manual p560
  CHECK(i_variable(123).index == 1);
  CHECK(i_variable(5198).id == ElementId::kCoordMaxFeedRate);
  CHECK(i_variable(5198).index == 1);
  CHECK(i_variable(8010).id == ElementId::kSysServoPeriod);
  CHECK(i_variable(3222).index == 32);
  CHECK(i_variable(3322).id == kNoElement);                      // there is no motor 33
  CHECK(i_variable(8200).id == kNoElement);
  for (int number = 0; number < kICount; ++number) {
    const IVariable alias = i_variable(number);
    if (alias.id == kNoElement) continue;
    INFO(number << " " << element_info(alias.id).name);
    CHECK(element_info(alias.id).access == ElementAccess::kSaved);
    CHECK((element_info(alias.id).index_counts[0] == 0 || alias.index < static_cast<std::uint32_t>(element_info(alias.id).index_counts[0])));
  }
}

TEST_CASE("names of the small enumerations", "[bytecode]") {
  CHECK(move_mode_name(MoveMode::kCircle2) == "circle2");
  CHECK(motion_parameter_name(MotionParameter::kTsd) == "tsd");
  CHECK(motion_parameter_name(MotionParameter::kCcMode) == "ccmode");
  CHECK(program_kind_name(ProgramKind::kInverse) == "inverse");
  CHECK(control_verb_name(ControlVerb::kJogReturn) == "jog_return");
  CHECK(control_argument_count(ControlVerb::kJogTo) == 2);
  CHECK(control_argument_count(ControlVerb::kAbort) == 1);
  CHECK(control_verb_name(ControlVerb::kSave) == "save");
  CHECK(control_argument_count(ControlVerb::kSave) == 0);
}
