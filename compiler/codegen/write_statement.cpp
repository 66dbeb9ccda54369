// Statements.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "compiler/bytecode/card.h"
#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/missing.h"
#include "compiler/bytecode/opcode.h"
#include "compiler/codegen/program_writer.h"

namespace pmac::compiler::codegen {
namespace {

using bytecode::AssignOp;
using bytecode::Opcode;
using ir::VariableClass;

Opcode opcode_of(AssignOp op) {
  switch (op) {
    case AssignOp::kSub: return Opcode::kSub;
    case AssignOp::kMul: return Opcode::kMul;
    case AssignOp::kDiv: return Opcode::kDiv;
    case AssignOp::kMod: return Opcode::kMod;
    case AssignOp::kAnd: return Opcode::kBitAnd;
    case AssignOp::kOr: return Opcode::kBitOr;
    case AssignOp::kXor: return Opcode::kBitXor;
    case AssignOp::kShiftLeft: return Opcode::kShiftLeft;
    case AssignOp::kShiftRight: return Opcode::kShiftRight;
    default: return Opcode::kAdd;
  }
}

}  // namespace

void ProgramWriter::body(const ir::Body& statements) {
  for (const ir::StmtPtr& inner : statements) statement(*inner);
}

void ProgramWriter::statement(const ir::Stmt& statement) {
  const Register before = next_;
  place_source(statement.span);
  std::visit([&](const auto& node) { write(node, statement.span); }, statement.node);
  next_ = before;
}

void ProgramWriter::write(const ir::Block& node, const source::Span&) { body(node.body); }

// --- assignments ------------------------------------------------------------------------------------------------------------

void ProgramWriter::assign(const ir::Expr& target, AssignOp op, const ir::Expr& right) {
  const auto* variable = std::get_if<ir::Variable>(&target.node);
  const bool local = variable && variable->variable_class == VariableClass::kL && !variable->index;
  if (op == AssignOp::kSet) {
    if (local) value_into(right, static_cast<Register>(variable->number));
    else store(target, value(right));
    return;
  }
  const Register current = value(target);
  const Register other = value(right);
  const Register result = local ? current : take();
  emit_abc(opcode_of(op), result, current, other);
  if (!local) store(target, result);
}

void ProgramWriter::assign_synchronously(const ir::Assign& node) {
  bytecode::SyncTarget target;
  target.op = node.op;
  if (const auto* element = std::get_if<ir::Element>(&node.target->node)) {
    target.variable_class = VariableClass::kElement;
    target.element = static_cast<std::uint32_t>(element_ref(*element));
  } else if (const auto* variable = std::get_if<ir::Variable>(&node.target->node)) {
    target.variable_class = variable->variable_class;
    if (variable->index) target.number_register = static_cast<std::uint16_t>(index_of(*variable));
    else target.number = static_cast<std::int32_t>(variable->number);
  }
  const Register right = value(*node.values.front());
  emit_imm(Opcode::kSyncStore, right, tables_.sync_target(target));
}

/// Sys.CdTimer[3]=1,2,3: consecutive elements. Where the index is a local (Table[L0]=1,2), a copy of it counts.
void ProgramWriter::assign_elements(const ir::Assign& node) {
  const auto& first = std::get<ir::Element>(node.target->node);
  bytecode::ElementRef ref = make_element_ref(first);
  bytecode::ElementRef::Index& index = ref.index[first.indices.size() - 1];
  const Register one = index.is_register ? take() : Register{};
  if (index.is_register) {
    const Register number = take();
    emit_abc(Opcode::kMove, number, static_cast<Register>(index.value));
    load_number(1, one);
    index.value = number;
  }
  for (const ir::ExprPtr& expr : node.values) {
    emit_imm(Opcode::kStoreElement, value(*expr), tables_.element(ref));
    if (index.is_register) emit_abc(Opcode::kAdd, static_cast<Register>(index.value), static_cast<Register>(index.value), one);
    else ++index.value;
  }
}

/// A(3)=1,2,3: consecutive variables from the first on.
void ProgramWriter::assign_list(const ir::Assign& node) {
  if (std::holds_alternative<ir::Element>(node.target->node)) return assign_elements(node);
  const auto& first = std::get<ir::Variable>(node.target->node);
  const Register number = first.index ? index_of(first) : take();
  if (!first.index) load_number(static_cast<double>(first.number), number);
  const Register one = take();
  load_number(1, one);
  const Register right = take();
  for (const ir::ExprPtr& expr : node.values) {
    value_into(*expr, right);
    emit_abc(Opcode::kStoreIndexed, right, number, static_cast<Register>(first.variable_class));
    emit_abc(Opcode::kAdd, number, number, one);
  }
}

/// Sema has warned: a load stream that sets what the machine itself reports.
static bool is_left_out(const ir::Expr& target) {
  const auto* element = std::get_if<ir::Element>(&target.node);
  return element && bytecode::element_info(element->element).access == bytecode::ElementAccess::kStatus;
}

void ProgramWriter::write(const ir::Assign& node, const source::Span&) {
  if (is_left_out(*node.target)) return;
  if (node.synchronous) assign_synchronously(node);
  else if (node.values.size() > 1) assign_list(node);
  else assign(*node.target, node.op, *node.values.front());
}

void ProgramWriter::write(const ir::AssignSeries& node, const source::Span&) {
  const auto* first = std::get_if<ir::Variable>(&node.target->node);
  if (!first || first->index) return;
  const Register right = value(*node.value);
  for (std::int64_t i = 0; i < node.count; ++i) {
    ir::Variable one{first->variable_class, first->number + i * node.step, nullptr, {}};
    store_variable(one, right);
  }
}

void ProgramWriter::write(const ir::Locals& node, const source::Span&) {
  for (const ir::LocalDeclaration& name : node.names)
    if (name.value) value_into(*name.value, static_cast<Register>(name.number));
}

void ProgramWriter::write(const ir::Globals& node, const source::Span&) {
  const Register first = next_;
  for (const ir::GlobalDeclaration& name : node.names) {
    if (name.value) store_variable(ir::Variable{name.variable_class, name.number, nullptr, {}}, value(*name.value));
    next_ = first;
  }
}

// --- flow ---------------------------------------------------------------------------------------------------------------------

void ProgramWriter::write(const ir::If& node, const source::Span&) {
  Target end;
  for (std::size_t i = 0; i < node.branches.size(); ++i) {
    Target next;
    if (i > 0) place_source(node.branches[i].condition->span);
    branch(*node.branches[i].condition, false, next);
    statement(*node.branches[i].body);
    const bool last = i + 1 == node.branches.size() && !node.otherwise;
    if (!last) jump_to(Opcode::kJump, 0, end);
    place(next);
  }
  if (node.otherwise) statement(*node.otherwise);
  place(end);
}

/// The first test does not count as a jump-back; the test behind the body does, each time it is true. A PLC program never gets to
/// the second test: its scan ends behind the body, and the next scan begins with the first test.
void ProgramWriter::write(const ir::While& node, const source::Span& span) {
  Target top, test, end;
  const auto first_test = static_cast<std::int64_t>(code_.size());
  branch(*node.condition, false, end);
  top.pc = static_cast<std::int64_t>(code_.size());
  loops_.push_back({&test, &end});
  statement(*node.body);
  loops_.pop_back();
  place_source(span);
  place(test);
  if (may_scan_) emit_imm(Opcode::kScanLoop, 0, first_test);
  branch(*node.condition, true, top);
  place(end);
}

void ProgramWriter::write(const ir::DoWhile& node, const source::Span&) {
  Target top, test, end;
  top.pc = static_cast<std::int64_t>(code_.size());
  loops_.push_back({&test, &end});
  statement(*node.body);
  loops_.pop_back();
  place_source(node.condition->span);
  place(test);
  branch(*node.condition, true, top);
  place(end);
}

void ProgramWriter::write(const ir::Switch& node, const source::Span&) {
  const Register selector = take();
  value_into(*node.value, selector);
  const Register compared = take();
  load_number(0, compared);
  emit_abc(Opcode::kBitOr, selector, selector, compared);  // cuts to an integer
  std::vector<Target> starts(node.cases.size());
  Target end;
  Target* otherwise = &end;
  for (std::size_t i = 0; i < node.cases.size(); ++i) {
    if (!node.cases[i].value) {
      otherwise = &starts[i];
      continue;
    }
    load_number(ir::constant_value(*node.cases[i].value).value_or(0), compared);
    emit_abc(Opcode::kEqual, compared, selector, compared);
    jump_to(Opcode::kJumpIfTrue, compared, starts[i]);
  }
  jump_to(Opcode::kJump, 0, *otherwise);
  loops_.push_back({nullptr, &end});
  std::size_t next = 0;
  for (std::size_t i = 0; i <= node.body.size(); ++i) {
    for (; next < node.cases.size() && node.cases[next].first == i; ++next) place(starts[next]);
    if (i < node.body.size()) statement(*node.body[i]);
  }
  loops_.pop_back();
  place(end);
}

void ProgramWriter::write(const ir::Break&, const source::Span&) {
  if (!loops_.empty()) jump_to(Opcode::kJump, 0, *loops_.back().breaks);
}

void ProgramWriter::write(const ir::Continue&, const source::Span&) {
  for (auto loop = loops_.rbegin(); loop != loops_.rend(); ++loop)
    if (loop->continues) return jump_to(Opcode::kJump, 0, *loop->continues);
}

void ProgramWriter::write(const ir::Label& node, const source::Span&) { labels_.emplace(node.number, code_.size()); }

void ProgramWriter::write(const ir::Jump& node, const source::Span& span) {
  pass_arguments(node.arguments);
  const auto constant = ir::constant_value(*node.label);
  const auto label = static_cast<std::int64_t>(constant.value_or(0));
  const bool is_goto = node.kind == ir::JumpKind::kGoto;
  const bool is_callsub = node.kind == ir::JumpKind::kCallsub;
  const bool backward_goto = is_goto && labels_.contains(label);
  if (constant && !backward_goto) {
    const Opcode op = is_goto ? Opcode::kJump : is_callsub ? Opcode::kCallsub : Opcode::kGosub;
    label_jumps_.push_back({emit_imm(op, 0, 0), label, span});
  } else {
    const Opcode op = is_goto ? Opcode::kGotoLabel : is_callsub ? Opcode::kCallsubLabel : Opcode::kGosubLabel;
    emit_imm(op, value(*node.label), 0);
  }
  take_results(node.arguments, node.by_reference);
}

void ProgramWriter::pass_arguments(const std::vector<ir::ExprPtr>& arguments) {
  std::vector<Register> values;
  for (const ir::ExprPtr& argument : arguments) values.push_back(value(*argument));
  for (std::size_t i = 0; i < values.size(); ++i) emit_abc(Opcode::kMove, outgoing(static_cast<std::int64_t>(i)), values[i]);
}

void ProgramWriter::take_results(const std::vector<ir::ExprPtr>& arguments, const std::vector<bool>& by_reference) {
  for (std::size_t i = 0; i < by_reference.size(); ++i) {
    if (!by_reference[i]) continue;
    const Register result = take();
    emit_abc(Opcode::kMove, result, outgoing(static_cast<std::int64_t>(i)));
    store(*arguments[i], result);
  }
}

void ProgramWriter::write(const ir::Call& node, const source::Span&) {
  pass_arguments(node.arguments);
  if (node.subprogram >= 0) emit_imm(Opcode::kCall, 0, tables_.call_target({static_cast<std::uint32_t>(node.subprogram), node.label}));
  else emit_imm(Opcode::kCallComputed, value(*node.number), 0);
  take_results(node.arguments, node.by_reference);
}

void ProgramWriter::write(const ir::Return&, const source::Span&) { emit_imm(Opcode::kReturn, 0, 0); }
void ProgramWriter::write(const ir::Stop&, const source::Span&) { emit_imm(Opcode::kStop, 0, 0); }

// --- motion -----------------------------------------------------------------------------------------------------------------------

void ProgramWriter::write(const ir::SetMode& node, const source::Span&) { emit_imm(Opcode::kSetMode, static_cast<Register>(node.mode), 0); }

void ProgramWriter::write(const ir::SetParameter& node, const source::Span&) {
  emit_abc(Opcode::kSetMotion, value(*node.value), static_cast<Register>(node.parameter));
}

void ProgramWriter::write(const ir::SetAbsInc& node, const source::Span&) {
  emit_imm(node.absolute ? Opcode::kSetAbs : Opcode::kSetInc, node.centres ? 1 : 0, static_cast<std::int32_t>(node.axes));
}

void ProgramWriter::write(const ir::SetFrax& node, const source::Span&) {
  emit_imm(node.off ? Opcode::kClearFrax : Opcode::kSetFrax, node.secondary ? 1 : 0, static_cast<std::int32_t>(node.axes));
}

void ProgramWriter::write(const ir::SetNormal& node, const source::Span&) {
  const Register first = take(3);
  for (Register i = 0; i < 3; ++i) value_into(*node.vector[i], first + i);
  emit_imm(Opcode::kSetNormal, first, node.second_set ? 1 : 0);
}

void ProgramWriter::write(const ir::Move& node, const source::Span&) {
  for (const ir::Word& word : node.words) {
    const Register before = next_;
    emit_abc(Opcode::kAxisWord, value(*word.value), static_cast<Register>(word.index), static_cast<Register>(word.kind));
    next_ = before;
  }
  emit_imm(Opcode::kBlockEnd, 0, 0);
}

/// A row counter, and for each run a loop over its rows:  load.int t,0  row.words t,run  block.end  row.loop t
void ProgramWriter::write(const ir::MoveRows& node, const source::Span& span) {
  const Register row = take();
  const bytecode::SourceLine first = tables_.line(span);
  const std::int64_t shown_further = first.line - static_cast<std::int64_t>(node.runs->front().line.front());  // #line
  for (bytecode::MoveRun& run : *node.runs) {
    run.file = first.file;
    for (std::uint32_t& line : run.line) line = static_cast<std::uint32_t>(std::max<std::int64_t>(0, line + shown_further));
    const auto pc = static_cast<std::uint32_t>(code_.size());
    if (!lines_.empty() && lines_.back().pc == pc) lines_.pop_back();
    lines_.push_back({pc, run.source(0)});
    tables_.module().move_runs.push_back(std::move(run));
    emit_imm(Opcode::kLoadInt, row, 0);
    const std::size_t begin = emit_imm(Opcode::kRowWords, row, static_cast<std::int64_t>(tables_.module().move_runs.size()) - 1);
    emit_imm(Opcode::kBlockEnd, 0, 0);
    emit_imm(Opcode::kRowLoop, row, static_cast<std::int64_t>(begin));
  }
  node.runs->clear();
}

void ProgramWriter::write(const ir::Dwell& node, const source::Span&) { emit_imm(Opcode::kDwell, value(*node.time_ms), 0); }
void ProgramWriter::write(const ir::Delay& node, const source::Span&) { emit_imm(Opcode::kDelay, value(*node.time_ms), 0); }

// --- programs, motors, the load stream -------------------------------------------------------------------------------------------

void ProgramWriter::write(const ir::Control& node, const source::Span&) {
  const auto count = static_cast<unsigned>(bytecode::control_argument_count(node.verb));
  const Register first = take(count);
  for (Register i = 0; i < count; ++i) {
    const ir::Expr* argument = i < node.arguments.size() ? node.arguments[i].get() : nullptr;
    const auto* number = argument ? std::get_if<ir::Number>(&argument->node) : nullptr;
    if (number && std::isinf(number->value)) load_number(bytecode::all_of_them(), first + i);   // the list *
    else if (argument) value_into(*argument, first + i);
    else load_number(bytecode::missing_argument(), first + i);
  }
  emit_abc(Opcode::kControl, static_cast<Register>(node.verb), first, count);
}

void ProgramWriter::write(const ir::CardAction& node, const source::Span&) {
  const auto count = static_cast<unsigned>(bytecode::card_verb_info(node.verb).argument_count);
  const Register first = take(count);
  for (Register i = 0; i < count; ++i) {
    const ir::Expr* argument = i < node.arguments.size() ? node.arguments[i].get() : nullptr;
    if (argument) value_into(*argument, first + i);
    else load_number(std::numeric_limits<double>::quiet_NaN(), first + i);
  }
  emit_abc(Opcode::kCard, static_cast<Register>(node.verb), first, count);
}

void ProgramWriter::write(const ir::RelayCondition& node, const source::Span&) {
  const Register set = take();
  emit_abc(Opcode::kRelayTest, set, value(*node.relay));
  Target end;
  jump_to(Opcode::kJumpIfFalse, set, end);
  body(node.rest);
  place(end);
}

void ProgramWriter::write(const ir::Evaluate& node, const source::Span&) { value_into(*node.value, take()); }

static std::vector<const ir::Expr*> pointers(const std::vector<ir::ExprPtr>& values) {
  std::vector<const ir::Expr*> all;
  for (const ir::ExprPtr& value : values) all.push_back(value.get());
  return all;
}

void ProgramWriter::write(const ir::Command& node, const source::Span&) {
  format_values(pointers(node.values));
  emit_imm(Opcode::kCommand, 0, tables_.string(node.text));
}

void ProgramWriter::write(const ir::Send& node, const source::Span&) {
  format_values(pointers(node.values));
  emit_imm(Opcode::kSend, static_cast<Register>(node.port), tables_.string(node.text));
}

/// &1 that is addressed already needs no code: it stands before every axis definition in what pmacc -E prints.
void ProgramWriter::write(const ir::AddressCoord& node, const source::Span&) {
  const auto number = ir::constant_value(*node.number);
  if (number && addressed_coord_ == number) return;
  addressed_coord_ = number;
  emit_imm(Opcode::kAddressCoord, value(*node.number), 0);
}
void ProgramWriter::write(const ir::AddressMotor& node, const source::Span&) { emit_imm(Opcode::kAddressMotor, value(*node.number), 0); }

void ProgramWriter::write(const ir::DefineAxis& node, const source::Span&) {
  auto& table = tables_.module().axis_definitions;
  table.push_back(node.definition);
  emit_imm(Opcode::kDefineAxis, 0, static_cast<std::int64_t>(table.size()) - 1);
}

void ProgramWriter::write(const ir::DefinePointer& node, const source::Span&) {
  bytecode::PointerDefinition definition = node.definition;
  definition.name = node.name;
  if (node.element)
    if (const auto* element = std::get_if<ir::Element>(&node.element->node)) definition.element = static_cast<std::uint32_t>(element_ref(*element));
  auto& table = tables_.module().pointer_definitions;
  table.push_back(std::move(definition));
  emit_imm(Opcode::kDefinePointer, 0, static_cast<std::int64_t>(table.size()) - 1);
}

void ProgramWriter::write(const ir::Report& node, const source::Span&) {
  const auto* element = std::get_if<ir::Element>(&node.value->node);
  if (element) emit_imm(Opcode::kReportElement, value(*node.value), element_ref(*element));
  else emit_imm(Opcode::kReport, value(*node.value), tables_.string(node.name));
}

void ProgramWriter::write(const ir::SystemCommand& node, const source::Span&) { emit_imm(Opcode::kSystemCommand, 0, tables_.string(node.text)); }
void ProgramWriter::write(const ir::ExecuteAtOnce& node, const source::Span&) { emit_imm(Opcode::kExecuteProgram, 0, static_cast<std::int64_t>(first_program_ + node.buffer)); }
void ProgramWriter::write(const ir::OpenBuffer& node, const source::Span&) { emit_imm(Opcode::kInstallProgram, 0, static_cast<std::int64_t>(first_program_ + node.buffer)); }

}  // namespace pmac::compiler::codegen
