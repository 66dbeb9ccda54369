// Answers to questions of command lines: positions, velocities, status words, definitions. Positions are answered in motor units from
// home and in axis units. Source: on-line commands, Software Reference Manual p62-76.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/missing.h"
#include "runtime/answer.h"
#include "runtime/value_text.h"

namespace pmac::runtime {
namespace {

using bytecode::ControlVerb;
using bytecode::ElementId;
using Kind = kinematics::MotorDefinition::Kind;

struct StatusBits { int bit, width; ElementId id; };
constexpr StatusBits kMotorBits[] = {
#define MOTOR_STATUS(bit, width, name) {bit, width, ElementId::kMotor##name},
#define COORD_STATUS(bit, width, name)
#define ANY_MOTOR_STATUS(bit, name)
#define SYS_STATUS(bit, width, name)
#include "runtime/status_bit.def"
};
constexpr StatusBits kCoordBits[] = {
#define MOTOR_STATUS(bit, width, name)
#define COORD_STATUS(bit, width, name) {bit, width, ElementId::kCoord##name},
#define ANY_MOTOR_STATUS(bit, name) {bit, 1, ElementId::kCoord##name},
#define SYS_STATUS(bit, width, name)
#include "runtime/status_bit.def"
};
constexpr StatusBits kSystemBits[] = {
#define MOTOR_STATUS(bit, width, name)
#define COORD_STATUS(bit, width, name)
#define ANY_MOTOR_STATUS(bit, name)
#define SYS_STATUS(bit, width, name) {bit, width, ElementId::kSys##name},
#include "runtime/status_bit.def"
};

std::uint64_t status_word(Machine::State& s, Runner& runner, std::span<const StatusBits> bits, int number) {
  std::uint64_t word = 0;
  for (const StatusBits& b : bits) {
    const double value = read_element_value(s, runner, {b.id, {static_cast<std::uint32_t>(number), 0, 0}});
    const double room = static_cast<double>(1u << b.width);
    const std::uint64_t part = b.width == 1 ? (value != 0 ? 1 : 0) : value > 0 && value < room ? static_cast<std::uint64_t>(value) : 0;
    word |= part << b.bit;
  }
  return word;
}

// --- axis definitions -----------------------------------------------------------------------------------------------------

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// 1000x, 8660.25x-5000y+20000, i, s, 0.
std::string definition_text(const kinematics::MotorDefinition& d, Motor::Spindle spindle) {
  if (d.kind == Kind::kInverse) return "i";
  if (d.kind == Kind::kSpindle) return spindle == Motor::Spindle::kClockOf0 ? "s0" : spindle == Motor::Spindle::kRealTime ? "s1" : "s";
  std::string text;
  for (int axis = 0; axis < bytecode::kAxisCount; ++axis) {
    const double c = d.coefficient_mu_uu[static_cast<std::size_t>(axis)];
    if (c == 0) continue;
    const std::string number = c == 1 ? "" : c == -1 ? "-" : fmt::format("{}", c);
    text += (text.empty() || number.starts_with('-') ? "" : "+") + number + lower(bytecode::axis_name(axis));
  }
  if (text.empty()) return "0";
  return d.offset_mu == 0 ? text : text + fmt::format("{:+}", d.offset_mu);
}

/// With the coordinate system where it is another one than the addressed one.
std::string axis_answer(Machine::State& s, const Runner& runner, const Motor& m) {
  const std::string text = axis_definition_text(s, m);
  const std::string where = m.coord < 0 || m.coord == runner.thread.coord || text == "0" ? "" : fmt::format("&{}", m.coord);
  return definition_answer(s, fmt::format("{}#{}", where, m.number), text);
}

// --- coordinate systems -------------------------------------------------------------------------------------------------------

/// Axis values of the axes that have motors: "X10 Y-5".
std::string axes_text(const CoordSystem& c, const AxisVector& values) {
  std::string text;
  for (int axis = 0; axis < bytecode::kAxisCount; ++axis)
    if (c.axes_with_motors() >> axis & 1u)
      text += fmt::format("{}{}{}", text.empty() ? "" : " ", bytecode::axis_name(axis), double_text(values[static_cast<std::size_t>(axis)]));
  return text;
}

/// Axis velocities per Coord[].FeedTime.
AxisVector axis_velocity(Machine::State& s, CoordSystem& c, unsigned number) {
  AxisVector velocity = c.commanded_velocity_uu_ms(s.now_ms);
  for (double& value : velocity) value *= s.elements.get(ElementId::kCoordFeedTime, number);
  return velocity;
}

std::string coord_answer(Machine::State& s, Runner& runner, ControlVerb verb, int number) {
  CoordSystem& c = s.coord(number);
  switch (verb) {
    case ControlVerb::kReportCoordPosition: return axes_text(c, c.actual_position(s.now_ms));
    case ControlVerb::kReportCoordDesired: return axes_text(c, c.commanded_position(s.now_ms));
    case ControlVerb::kReportCoordVelocity: return axes_text(c, axis_velocity(s, c, static_cast<unsigned>(number)));
    case ControlVerb::kReportCoordFollowingError: return axes_text(c, c.following_error_uu(s.now_ms));
    case ControlVerb::kReportCoordTarget: return axes_text(c, c.calculated_position());
    case ControlVerb::kReportCoordDistanceToGo: {
      AxisVector distance = c.calculated_position();
      const AxisVector now = c.commanded_position(s.now_ms);
      for (std::size_t axis = 0; axis < distance.size(); ++axis) distance[axis] -= now[axis];
      return axes_text(c, distance);
    }
    default: return fmt::format("${:016x}", status_word(s, runner, kCoordBits, number));
  }
}

std::string motor_answer(Machine::State& s, Runner& runner, ControlVerb verb, const Motor& m) {
  switch (verb) {
    case ControlVerb::kReportPosition: return double_text(m.actual_at(s.now_ms));
    case ControlVerb::kReportDesired: return double_text(m.position_at(s.now_ms));
    case ControlVerb::kReportVelocity: return double_text(m.actual_velocity_at(s.now_ms, s.period_ms()));
    case ControlVerb::kReportFollowingError: return double_text(m.following_error_mu());
    case ControlVerb::kReportAxisDefinition: return axis_answer(s, runner, m);
    default: return fmt::format("${:016x}", status_word(s, runner, kMotorBits, m.number));
  }
}

/// The number that a report is about, or -1 where there is none such.
int number_of(std::span<const double> arguments, int addressed, int count) {
  const double given = arguments.empty() || bytecode::is_missing(arguments[0]) ? addressed : arguments[0];
  return given >= 0 && given < count ? static_cast<int>(given) : -1;
}

std::string alias(const Machine::State& s, int number) {
  const bytecode::IVariable alias = bytecode::i_variable(number);
  return definition_answer(s, fmt::format("I{}", number), alias.id == bytecode::kNoElement ? "*" : element_text({alias.id, {alias.index, 0, 0}}));
}

}  // namespace

bool is_report(ControlVerb verb) {
  return verb >= ControlVerb::kReportPosition && verb <= ControlVerb::kReportGlobalStatus && verb != ControlVerb::kReportTimeBase;
}

std::string report(Machine::State& s, Runner& runner, ControlVerb verb, std::span<const double> arguments) {
  if (verb == ControlVerb::kReportGlobalStatus) return s.answer(fmt::format("${:08x}", status_word(s, runner, kSystemBits, 0))), "";
  const bool of_variable = verb == ControlVerb::kReportAlias;
  const bool of_coord = verb >= ControlVerb::kReportCoordPosition && verb <= ControlVerb::kReportCoordStatus;
  const int addressed = of_coord ? runner.thread.coord : runner.thread.motor;
  const int count = of_variable ? bytecode::kICount : of_coord ? bytecode::kMaxCoords : bytecode::kMaxMotors;
  const int number = number_of(arguments, addressed, count);
  if (number < 0) return "error #23: OUT OF RANGE NUMBER";
  if (of_variable) s.answer(alias(s, number));
  else if (of_coord) s.answer(coord_answer(s, runner, verb, number));
  else s.answer(motor_answer(s, runner, verb, s.motors[static_cast<std::size_t>(number)]));
  return "";
}

void answer_value(Machine::State& s, const std::string& name, const std::string& value) {
  s.answer(echoes_without(s, kNoNames) ? value : name + "=" + value);
}

std::string definition_answer(const Machine::State& s, const std::string& name, const std::string& definition) {
  return echoes_without(s, kNoDefinitionNames) ? definition : name + "->" + definition;
}

std::string axis_definition_text(Machine::State& s, const Motor& m) {
  if (m.coord < 0) return "0";
  const auto& definitions = s.coord(m.coord).map().definitions();
  const auto found = std::find_if(definitions.begin(), definitions.end(), [&](const auto& d) { return d.motor == m.number; });
  return found == definitions.end() ? "0" : definition_text(*found, m.spindle);
}

std::string pointer_definition_text(const Machine::State& s, int m) {
  const PointerEntry& pointer = s.pointers.at(m);
  const bool is_element = pointer.definition.kind == bytecode::PointerKind::kElement;
  return definition_text(pointer.definition, is_element ? element_text(pointer.element) : std::string());
}

}  // namespace pmac::runtime
