// The load stream: buffers and on-line commands in the order of the text.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "compiler/bytecode/control.h"
#include "compiler/frontend/power_pmac/lowering.h"

namespace pmac::compiler::power_pmac {
namespace {

using bytecode::ProgramKind;
using ir::ControlVerb;

constexpr std::int64_t kAll = -1;  // #* and &*

}  // namespace

ir::Unit Lowering::lower_file(P::FileContext* file) {
  ir::Unit unit;
  if (!file) return unit;
  for (antlr4::tree::ParseTree* child : file->children) {
    if (auto* buffer = dynamic_cast<P::BufferContext*>(child)) {
      online_ = false;
      lower_buffer(buffer, unit);
    } else if (auto* online = dynamic_cast<P::OnlineContext*>(child)) {
      online_ = true;
      if (online->CLEAR()) lower_clear(online, unit);
      else if (online->CX()) lower_at_once(online, unit);
      else lower_online(online, unit.load);
    }
  }
  return unit;
}

// --- buffers -------------------------------------------------------------------------------------------------------------

std::vector<ir::Parameter> Lowering::lower_parameters(P::ParametersContext* parameters) {
  std::vector<ir::Parameter> result;
  if (!parameters) return result;
  for (P::ParameterContext* parameter : parameters->parameter())
    if (parameter->NAME()) result.push_back({text_of(token_of(parameter->NAME())), parameter->AMPERSAND() != nullptr, span_of(parameter)});
  if (result.size() > bytecode::kMaxArguments) diagnostics_.error("PM3007", span_of(parameters), fmt::format("a subprogram has at most {} arguments", bytecode::kMaxArguments));
  return result;
}

void Lowering::lower_open_header(P::OpenHeaderContext* header, ir::Buffer& buffer) {
  if (!header || !header->kind) return;
  switch (header->kind->getType()) {
    case P::PLC: buffer.kind = ProgramKind::kPlc; break;
    case P::SUBPROG: buffer.kind = ProgramKind::kSubprog; break;
    case P::FORWARD: buffer.kind = ProgramKind::kForward; break;
    case P::INVERSE: buffer.kind = ProgramKind::kInverse; break;
    case P::ROTARY:
      buffer.kind = ProgramKind::kRotary;
      buffer.number = 0;
      if (!header->NUMBER().empty()) diagnostics_.error("PM3008", span_of(token_of(header->NUMBER(0))), "open rotary takes no number; address the coordinate system before it, as in &2 open rotary");
      return;
    default: break;
  }
  P::BufferNameContext* name = header->bufferName();
  const std::int64_t most = buffer.kind == ProgramKind::kPlc ? bytecode::kMaxPlcs - 1 : 4294967295;
  if (name && name->NAME()) buffer.name = text_of(token_of(name->NAME()));
  else if (name) buffer.number = whole_number(token_of(name->NUMBER()), most).value_or(0);
  else if (!header->NUMBER().empty()) buffer.number = whole_number(token_of(header->NUMBER(0)), bytecode::kMaxCoords - 1).value_or(0);
  if (name && buffer.kind == ProgramKind::kProg && buffer.number == 0 && buffer.name.empty()) diagnostics_.error("PM3008", span_of(name), "program numbers begin with 1; program 0 is the rotary buffer");
  buffer.name_span = span_of(name);
  buffer.parameters = lower_parameters(header->parameters());
}

void Lowering::lower_buffer(P::BufferContext* context, ir::Unit& unit) {
  ir::Buffer buffer;
  buffer.span = span_of(context->openHeader());
  buffer.close_span = context->CLOSE() ? span_of(token_of(context->CLOSE())) : buffer.span;
  lower_open_header(context->openHeader(), buffer);
  in_rotary_ = buffer.kind == ProgramKind::kRotary;
  for (antlr4::tree::ParseTree* child : context->children) {
    if (auto* statement = dynamic_cast<P::StatementContext*>(child)) lower_statement(statement, buffer.body);
    auto* entry = dynamic_cast<P::EntryPointContext*>(child);
    if (!entry || entry->exception || !entry->NAME()) continue;
    buffer.routines.push_back({text_of(token_of(entry->NAME())), span_of(entry), lower_parameters(entry->parameters()), buffer.body.size(), -1});
  }
  in_rotary_ = false;
  if (buffer.kind == ProgramKind::kRotary && !buffer.routines.empty()) diagnostics_.error("PM2052", buffer.routines.front().span, "a rotary buffer has no routines; put them into a subprogram and call that");
  const bool header_is_broken = !context->openHeader() || context->openHeader()->exception;
  if (header_is_broken) return;
  unit.load.push_back(ir::make_stmt(buffer.span, ir::OpenBuffer{unit.buffers.size()}));
  unit.buffers.push_back(std::move(buffer));
}

/// cx linear X5: statements of a buffer that the addressed coordinate system executes at once.
void Lowering::lower_at_once(P::OnlineContext* online, ir::Unit& unit) {
  if (online->exception) return;
  ir::Buffer buffer;
  buffer.number = 0;
  buffer.span = buffer.close_span = span_of(online);
  online_ = false;
  lower_statements(online->statement(), buffer.body);
  unit.load.push_back(ir::make_stmt(buffer.span, ir::ExecuteAtOnce{unit.buffers.size()}));
  unit.buffers.push_back(std::move(buffer));
}

/// clear prog 5 makes the buffer empty, like open prog 5 close.
void Lowering::lower_clear(P::OnlineContext* online, ir::Unit& unit) {
  if (online->exception) return;
  if (!online->ALL().empty()) return lower_clear_all(online, unit);
  if (!online->kind || !online->bufferName()) return;
  ir::Buffer buffer;
  buffer.span = buffer.close_span = span_of(online);
  buffer.kind = online->kind->getType() == P::PLC ? ProgramKind::kPlc : online->kind->getType() == P::SUBPROG ? ProgramKind::kSubprog : ProgramKind::kProg;
  if (online->bufferName()->NAME()) buffer.name = text_of(token_of(online->bufferName()->NAME()));
  else buffer.number = whole_number(token_of(online->bufferName()->NUMBER()), buffer.kind == ProgramKind::kPlc ? bytecode::kMaxPlcs - 1 : 4294967295).value_or(0);
  unit.load.push_back(ir::make_stmt(buffer.span, ir::OpenBuffer{unit.buffers.size()}));
  unit.buffers.push_back(std::move(buffer));
}

/// clear all buffers: empties the buffers that the file opened before it.
void Lowering::lower_clear_all(P::OnlineContext* online, ir::Unit& unit) {
  if (online->ALL().size() != 2) {
    diagnostics_.error("PM2001", span_of(online), "clear takes a buffer (clear prog 5), or all buffers");
    return;
  }
  unit.clear_all = span_of(online);
  for (std::size_t i = unit.buffers.size(); i-- > 0;) {
    ir::Buffer buffer;
    buffer.span = buffer.close_span = unit.clear_all;
    buffer.kind = unit.buffers[i].kind;
    buffer.name = unit.buffers[i].name;
    buffer.number = unit.buffers[i].number;
    unit.load.push_back(ir::make_stmt(buffer.span, ir::OpenBuffer{unit.buffers.size()}));
    unit.buffers.push_back(std::move(buffer));
  }
}

// --- on-line commands ---------------------------------------------------------------------------------------------------------

void Lowering::lower_online(P::OnlineContext* online, ir::Body& out) {
  if (online->exception || !online->start) return;
  if (online->start->getLine() != address_line_) {
    motor_list_.clear();
    coord_list_.clear();
    coord_addressed_last_ = addressed_on_line_ = false;
  }
  address_line_ = online->start->getLine();
  const source::Span span = span_of(online);
  if (online->declaration()) return lower_declaration(online->declaration(), out);
  if (online->HASH() && online->ARROW() && !online->axisDefinition()) return lower_axis_query(online, out);
  if (online->HASH() && online->ARROW()) return lower_axis_definition(online, out);
  if (online->HASH() || online->AMPERSAND() || online->COORD()) return lower_address(online, out);
  if (online->ARROW() && online->LETTER_I()) return lower_alias_query(online, out);
  if (online->ARROW()) return lower_pointer_command(online, out);
  if (online->assignment()) return lower_assignment(online->assignment(), out);
  if (online->onlineListAssignment()) return lower_series(online->onlineListAssignment(), out);
  if (online->RANGE()) return lower_variable_range(online, out);
  if (online->lvalue()) {
    ir::ExprPtr value = lower_lvalue(online->lvalue());
    const std::string name(tree_.expanded.text().substr(online->start->getStartIndex(), online->stop->getStopIndex() + 1 - online->start->getStartIndex()));
    return out.push_back(ir::make_stmt(span, ir::Report{std::move(value), name}));
  }
  if (online->CLOSE()) return;
  if (online->LIST()) return lower_list(online->listed(), span, out);
  if (online->OTHER_COMMAND() || online->ECHO() || online->ROTARY()) return lower_system_command(online, out);
  if (online->programControl()) return lower_program_control(online->programControl(), out);
  if (online->onlineJog()) return lower_online_jog(online->onlineJog(), span, out);
  if (online->COMMAND()) return lower_command(lower_case(text_of(online->start)), span, out);
  if (online->RESET()) return out.push_back(ir::make_stmt(span, ir::SystemCommand{text_of(online->single)}));
  if (online->single) return lower_command(text_of(online->single), span, out);
  if (online->ON_OUT()) {
    for (ir::ExprPtr& motor : addressed_motors(span)) {
      std::vector<ir::ExprPtr> arguments;
      arguments.push_back(std::move(motor));
      arguments.push_back(lower_data(online->data()));
      add_control(ControlVerb::kOpenLoop, span, std::move(arguments), out);
    }
    return;
  }
  for (ir::ExprPtr& coord : addressed_coords(span)) {
    std::vector<ir::ExprPtr> arguments;
    arguments.push_back(std::move(coord));
    ControlVerb verb = ControlVerb::kReportTimeBase;
    if (online->DEFINE()) verb = ControlVerb::kDefineLookahead, arguments.push_back(lower_number(token_of(online->NUMBER(0))));
    else if (online->DELETE()) verb = ControlVerb::kDeleteLookahead;
    else if (online->ON_B()) verb = ControlVerb::kBegin, arguments.push_back(lower_program_name(online->programName()));
    else if (online->data()) verb = ControlVerb::kTimeBase, arguments.push_back(lower_data(online->data()));
    add_control(verb, span, std::move(arguments), out);
  }
}

/// #1 and &1 last; lists hold for the next command of the line.
void Lowering::lower_address(P::OnlineContext* online, ir::Body& out) {
  const bool coord = online->HASH() == nullptr;
  coord_addressed_last_ = coord;
  addressed_on_line_ = true;
  const source::Span span = span_of(online);
  auto& list = coord ? coord_list_ : motor_list_;
  list.clear();
  if (!online->numberList()) return out.push_back(ir::make_stmt(span, ir::SystemCommand{coord ? "&" : "#"}));
  const auto items = online->numberList()->numberItem();
  const bool all = items.size() == 1 && items[0]->STAR();
  if (all) return list.push_back(kAll);
  std::vector<std::int64_t> numbers;
  for (ir::ExprPtr& number : lower_number_list(online->numberList())) {
    const auto value = number ? ir::constant_value(*number) : std::nullopt;
    const int most = (coord ? bytecode::kMaxCoords : bytecode::kMaxMotors) - 1;
    if (value && *value >= 0 && *value <= most && *value == static_cast<double>(static_cast<int>(*value))) {
      numbers.push_back(static_cast<std::int64_t>(*value));
      continue;
    }
    diagnostics_.error("PM3009", span, fmt::format("the number of a {} is 0 to {}", coord ? "coordinate system" : "motor", most));
    return;
  }
  if (numbers.size() > 1) { list = numbers; return; }
  if (numbers.empty()) return;
  ir::ExprPtr number = ir::make_number(static_cast<double>(numbers[0]), span);
  if (coord) out.push_back(ir::make_stmt(span, ir::AddressCoord{std::move(number)}));
  else out.push_back(ir::make_stmt(span, ir::AddressMotor{std::move(number)}));
}

/// The motors or systems that a command of this line is for: one null expression for the addressed one.
std::vector<ir::ExprPtr> Lowering::addressed(std::vector<std::int64_t>& list, source::Span span) {
  std::vector<ir::ExprPtr> numbers;
  for (const std::int64_t n : list) numbers.push_back(ir::make_number(n == kAll ? std::numeric_limits<double>::infinity() : static_cast<double>(n), span));
  if (numbers.empty()) numbers.push_back(nullptr);
  return numbers;
}

std::vector<ir::ExprPtr> Lowering::addressed_motors(source::Span span) { return addressed(motor_list_, span); }
std::vector<ir::ExprPtr> Lowering::addressed_coords(source::Span span) { return addressed(coord_list_, span); }

void Lowering::lower_axis_definition(P::OnlineContext* online, ir::Body& out) {
  const source::Span span = span_of(online);
  bytecode::AxisDefinition definition;
  if (online->numberList()) {
    const auto items = online->numberList()->numberItem();
    const bool one_number = items.size() == 1 && items[0]->NUMBER().size() == 1;
    const auto number = one_number ? whole_number(token_of(items[0]->NUMBER(0)), bytecode::kMaxMotors - 1) : std::nullopt;
    if (!one_number) diagnostics_.error("PM3009", span_of(online->numberList()), "an axis definition is for one motor");
    definition.motor = static_cast<std::int32_t>(number.value_or(0));
  }
  P::AxisDefinitionContext* right = online->axisDefinition();
  if (right->LETTER_I()) {
    definition.kind = bytecode::AxisDefinitionKind::kInverseKinematics;
  } else if (right->CODE()) {
    definition.kind = bytecode::AxisDefinitionKind::kSpindle;
    if (lower_case(text_of(right->start)) != "s") diagnostics_.error("PM2009", span_of(right->start), fmt::format("'{}' is no axis", text_of(right->start)));
    if (right->NUMBER()) definition.spindle = static_cast<std::uint8_t>(whole_number(token_of(right->NUMBER()), 1).value_or(0) + 1);
  } else {
    std::vector<std::pair<antlr4::Token*, P::AxisFactorContext*>> factors = {{right->axisTerm()->sign, right->axisTerm()->axisFactor()}};
    for (P::SignedAxisTermContext* term : right->signedAxisTerm()) factors.emplace_back(term->sign, term->axisFactor());
    for (const auto& [sign, factor] : factors) {
      const double number = factor->NUMBER() ? number_value(*factor->NUMBER()->getSymbol()) : 1.0;
      const double value = sign && text_of(sign) == "-" ? -number : number;
      const int axis = factor->axis ? axis_index(factor->axis) : 0;
      if (axis < 0) return;
      if (factor->axis) definition.terms.push_back({static_cast<std::uint8_t>(axis), value});
      else definition.offset_mu += value;
    }
    if (definition.terms.empty()) {
      if (definition.offset_mu != 0) diagnostics_.error("PM3011", span_of(right), "an axis definition names an axis, or is 0");
      definition.kind = bytecode::AxisDefinitionKind::kNull;
      definition.offset_mu = 0;
    }
  }
  out.push_back(ir::make_stmt(span, ir::DefineAxis{std::move(definition)}));
}

/// The 2 of Name(2)->...; sema adds the number of the name. -1: no index.
std::int32_t Lowering::index_of_pointer(P::ReferenceContext* reference) {
  const ir::ExprPtr named = lower_reference(reference);
  const auto* use = std::get_if<ir::NameUse>(&named->node);
  if (!use || !use->has_arguments) return -1;
  const auto index = use->arguments.size() == 1 ? ir::constant_value(*use->arguments[0]) : std::nullopt;
  if (index && *index >= 0 && *index < bytecode::kMCount) return static_cast<std::int32_t>(*index);
  diagnostics_.error("PM3004", span_of(reference), "the index of the pointer that is defined is a constant");
  return -1;
}

void Lowering::lower_pointer_command(P::OnlineContext* online, ir::Body& out) {
  const source::Span span = span_of(online);
  P::PointerTargetContext* target = online->pointedAt() ? online->pointedAt()->pointerTarget() : nullptr;
  if (!target) return lower_pointer_query(online, out);
  bytecode::PointerDefinition definition;
  if (online->LETTER_M()) {
    definition.first_m = static_cast<std::int32_t>(whole_number(token_of(online->NUMBER(0)), bytecode::kMCount - 1).value_or(0));
    const auto count = online->NUMBER().size() > 1 ? whole_number(token_of(online->NUMBER(1)), bytecode::kMCount).value_or(1) : 1;
    definition.last_m = static_cast<std::int32_t>(std::min<std::int64_t>(definition.first_m + std::max<std::int64_t>(count, 1) - 1, bytecode::kMCount - 1));
    if (count > 1 && !target->STAR()) diagnostics_.error("PM3012", span, "a range of pointers can only be made self-referenced: ->*");
    return out.push_back(lower_pointer(target, span, definition));
  }
  definition.first_m = definition.last_m = index_of_pointer(online->reference());
  ir::StmtPtr statement = lower_pointer(target, span, definition);
  auto& node = std::get<ir::DefinePointer>(statement->node);
  node.name = online->reference()->NAME() ? text_of(token_of(online->reference()->NAME())) : std::string();
  node.name_span = span_of(online->reference());
  node.size = -1;  // an existing name
  out.push_back(std::move(statement));
}

/// M5-> and Name->: answers the definition.
void Lowering::lower_pointer_query(P::OnlineContext* online, ir::Body& out) {
  std::vector<ir::ExprPtr> arguments;
  if (online->LETTER_M()) arguments.push_back(lower_number(token_of(online->NUMBER(0))));
  else arguments.push_back(lower_reference(online->reference()));
  add_control(ControlVerb::kReportPointer, span_of(online), std::move(arguments), out);
}

void Lowering::lower_series(P::OnlineListAssignmentContext* assignment, ir::Body& out) {
  ir::AssignSeries series;
  series.target = lower_variable(assignment->variable());
  series.count = whole_number(token_of(assignment->NUMBER(0)), 16384).value_or(0);
  if (assignment->NUMBER().size() > 1) series.step = whole_number(token_of(assignment->NUMBER(1)), 16384).value_or(1);
  series.value = lower_expression(assignment->expression());
  out.push_back(ir::make_stmt(span_of(assignment), std::move(series)));
}

void Lowering::lower_command(std::string_view word, source::Span span, ir::Body& out) {
  struct Row { std::string_view word; ControlVerb verb; enum { kMotor, kCoord } of; };
  constexpr Row kRows[] = {{"r", ControlVerb::kRun, Row::kCoord}, {"s", ControlVerb::kStep, Row::kCoord}, {"q", ControlVerb::kPause, Row::kCoord},
                           {"h", ControlVerb::kHold, Row::kCoord}, {"a", ControlVerb::kAbort, Row::kCoord}, {"<", ControlVerb::kRetrace, Row::kCoord},
                           {">", ControlVerb::kForward, Row::kCoord}, {"\\", ControlVerb::kQuickStop, Row::kCoord}, {"k", ControlVerb::kKill, Row::kMotor},
                           {"hm", ControlVerb::kHome, Row::kMotor}, {"hmz", ControlVerb::kHomeZero, Row::kMotor}, {"$", ControlVerb::kPhase, Row::kMotor}};
  if (lower_report(word, span, out)) return;
  const auto* row = std::find_if(std::begin(kRows), std::end(kRows), [&](const Row& r) { return r.word == word; });
  if (row == std::end(kRows)) return out.push_back(ir::make_stmt(span, ir::SystemCommand{std::string(word)}));
  for (ir::ExprPtr& number : row->of == Row::kMotor ? addressed_motors(span) : addressed_coords(span)) {
    std::vector<ir::ExprPtr> arguments;
    arguments.push_back(std::move(number));
    add_control(row->verb, span, std::move(arguments), out);
  }
}

void Lowering::lower_online_jog(P::OnlineJogContext* jog, source::Span span, ir::Body& out) {
  const std::string operation = text_of(jog->operation);
  P::JogDistanceContext* distance = jog->jogDistance();
  const bool is_return = operation == "=" && !distance;
  if (is_return) {
    for (ir::ExprPtr& motor : addressed_motors(span)) {
      std::vector<ir::ExprPtr> arguments;
      arguments.push_back(std::move(motor));
      add_control(ControlVerb::kJogReturn, span, std::move(arguments), out);
    }
    return;
  }
  const bool needs_distance = operation == "==" || operation == ":" || operation == "^";
  if (needs_distance && !distance) return void(diagnostics_.error("PM3013", span, fmt::format("j{} needs a position or distance in motor units", operation)));
  add_jogs({operation, distance, jog->trigger, span}, addressed_motors(span), out);
}

}  // namespace pmac::compiler::power_pmac
