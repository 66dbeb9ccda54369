// Expressions and conditions.
#include <algorithm>
#include <cmath>

#include "compiler/bytecode/function.h"
#include "compiler/bytecode/opcode.h"
#include "compiler/codegen/program_writer.h"

namespace pmac::compiler::codegen {
namespace {

using bytecode::Opcode;
using ir::Operator;
using ir::VariableClass;

struct ClassOpcodes { Opcode load, store; };

ClassOpcodes opcodes_of(VariableClass variable_class) {
  switch (variable_class) {
    case VariableClass::kQ: return {Opcode::kLoadQ, Opcode::kStoreQ};
    case VariableClass::kM: return {Opcode::kLoadM, Opcode::kStoreM};
    case VariableClass::kI: return {Opcode::kLoadI, Opcode::kStoreI};
    case VariableClass::kC: return {Opcode::kLoadC, Opcode::kStoreC};
    case VariableClass::kD: return {Opcode::kLoadD, Opcode::kStoreD};
    default: return {Opcode::kLoadP, Opcode::kStoreP};
  }
}

struct BinaryCode { Opcode op; bool swap = false; bool invert = false; };

BinaryCode binary_code(Operator op) {
  switch (op) {
    case Operator::kAdd: return {Opcode::kAdd};
    case Operator::kSub: return {Opcode::kSub};
    case Operator::kMul: return {Opcode::kMul};
    case Operator::kDiv: return {Opcode::kDiv};
    case Operator::kMod: return {Opcode::kMod};
    case Operator::kBitAnd: return {Opcode::kBitAnd};
    case Operator::kBitOr: return {Opcode::kBitOr};
    case Operator::kBitXor: return {Opcode::kBitXor};
    case Operator::kShiftLeft: return {Opcode::kShiftLeft};
    case Operator::kShiftRight: return {Opcode::kShiftRight};
    case Operator::kNotEqual: return {Opcode::kNotEqual};
    case Operator::kLess: return {Opcode::kLess};
    case Operator::kGreater: return {Opcode::kLess, true};
    case Operator::kLessEqual: return {Opcode::kLessEqual};
    case Operator::kGreaterEqual: return {Opcode::kLessEqual, true};
    case Operator::kNotGreater: return {Opcode::kLess, true, true};
    case Operator::kNotLess: return {Opcode::kLess, false, true};
    case Operator::kNear: return {Opcode::kNear};
    case Operator::kNotNear: return {Opcode::kNear, false, true};
    default: return {Opcode::kEqual};
  }
}

bool is_plain_local(const ir::Expr& expr) {
  const auto* variable = std::get_if<ir::Variable>(&expr.node);
  return variable && variable->variable_class == VariableClass::kL && !variable->index;
}

bool is_condition(const ir::Expr& expr) {
  if (const auto* unary = std::get_if<ir::Unary>(&expr.node)) return unary->op == Operator::kNot;
  const auto* binary = std::get_if<ir::Binary>(&expr.node);
  return binary && (binary->op == Operator::kAnd || binary->op == Operator::kOr);
}

}  // namespace

ProgramWriter::Register ProgramWriter::value(const ir::Expr& expr) {
  if (is_plain_local(expr)) return static_cast<Register>(std::get<ir::Variable>(expr.node).number);
  const Register destination = take();
  value_into(expr, destination);
  return destination;
}

void ProgramWriter::load_number(double number, Register destination) {
  const bool small = std::abs(number) < 1e9 && number == std::floor(number) && !(number == 0 && std::signbit(number));
  if (small) emit_imm(Opcode::kLoadInt, destination, static_cast<std::int64_t>(number));
  else emit_imm(Opcode::kLoadConst, destination, tables_.constant(number));
}

/// The computed number of a variable: constant part plus index.
ProgramWriter::Register ProgramWriter::index_of(const ir::Variable& variable) {
  const Register number = take();
  value_into(*variable.index, number);
  if (variable.number == 0) return number;
  const Register base = take();
  load_number(static_cast<double>(variable.number), base);
  emit_abc(Opcode::kAdd, number, number, base);  // Arr(i) is P(8192+i), cut to an integer when it is used
  return number;
}

void ProgramWriter::load_variable(const ir::Variable& variable, Register destination) {
  if (variable.index) {
    if (variable.variable_class == VariableClass::kR) outgoing(255);
    const Register number = index_of(variable);
    emit_abc(Opcode::kLoadIndexed, destination, number, static_cast<Register>(variable.variable_class));
  } else if (variable.variable_class == VariableClass::kL) {
    if (destination != static_cast<Register>(variable.number)) emit_abc(Opcode::kMove, destination, static_cast<Register>(variable.number));
  } else if (variable.variable_class == VariableClass::kR) {
    emit_abc(Opcode::kMove, destination, outgoing(variable.number));
  } else {
    emit_imm(opcodes_of(variable.variable_class).load, destination, variable.number);
  }
}

void ProgramWriter::store_variable(const ir::Variable& variable, Register source) {
  if (variable.index) {
    if (variable.variable_class == VariableClass::kR) outgoing(255);
    const Register number = index_of(variable);
    emit_abc(Opcode::kStoreIndexed, source, number, static_cast<Register>(variable.variable_class));
  } else if (variable.variable_class == VariableClass::kL) {
    if (source != static_cast<Register>(variable.number)) emit_abc(Opcode::kMove, static_cast<Register>(variable.number), source);
  } else if (variable.variable_class == VariableClass::kR) {
    emit_abc(Opcode::kMove, outgoing(variable.number), source);
  } else {
    emit_imm(opcodes_of(variable.variable_class).store, source, variable.number);
  }
}

void ProgramWriter::store(const ir::Expr& target, Register source) {
  if (const auto* variable = std::get_if<ir::Variable>(&target.node)) return store_variable(*variable, source);
  if (const auto* element = std::get_if<ir::Element>(&target.node)) emit_imm(Opcode::kStoreElement, source, element_ref(*element));
}

bytecode::ElementRef ProgramWriter::make_element_ref(const ir::Element& element) {
  bytecode::ElementRef ref;
  ref.id = element.element;
  ref.address = element.address;
  for (std::size_t i = 0; i < element.indices.size() && i < bytecode::kMaxElementIndices; ++i) {
    const auto constant = ir::constant_value(*element.indices[i]);
    if (constant) ref.index[i] = {false, static_cast<std::uint32_t>(*constant)};
    else ref.index[i] = {true, value(*element.indices[i])};
  }
  return ref;
}

void ProgramWriter::binary_into(const ir::Binary& node, Register destination) {
  const BinaryCode code = binary_code(node.op);
  const Register left = value(*node.left);
  const Register right = value(*node.right);
  emit_abc(code.op, destination, code.swap ? right : left, code.swap ? left : right);
  if (code.invert) emit_abc(Opcode::kLogicalNot, destination, destination);
}

void ProgramWriter::value_into(const ir::Expr& expr, Register destination) {
  const Register before = next_;
  if (const auto constant = ir::constant_value(expr)) {
    load_number(*constant, destination);
  } else if (const auto* variable = std::get_if<ir::Variable>(&expr.node)) {
    load_variable(*variable, destination);
  } else if (const auto* element = std::get_if<ir::Element>(&expr.node)) {
    emit_imm(Opcode::kLoadElement, destination, element_ref(*element));
  } else if (is_condition(expr)) {
    condition_into(expr, destination);
  } else if (const auto* unary = std::get_if<ir::Unary>(&expr.node)) {
    emit_abc(unary->op == Operator::kInvert ? Opcode::kBitNot : Opcode::kNeg, destination, value(*unary->operand));
  } else if (const auto* binary = std::get_if<ir::Binary>(&expr.node)) {
    binary_into(*binary, destination);
  } else if (const auto* call = std::get_if<ir::FunctionCall>(&expr.node)) {
    call_into(*call, destination);
  } else if (const auto* address = std::get_if<ir::AddressOf>(&expr.node)) {
    address_into(*address, destination);
  } else if (const auto* text = std::get_if<ir::Text>(&expr.node)) {
    emit_imm(Opcode::kLoadText, destination, tables_.string(text->value));
  }
  next_ = before;
}

/// Arguments in consecutive registers; the values of a format go the way of FormatValue.
void ProgramWriter::call_into(const ir::FunctionCall& call, Register destination) {
  const bytecode::FunctionInfo& info = bytecode::function_info(call.function);
  const auto count = static_cast<std::size_t>(info.argument_count);
  const Register first = take(static_cast<unsigned>(count));
  for (std::size_t i = 0; i < std::min(count, call.arguments.size()); ++i) value_into(*call.arguments[i], first + static_cast<Register>(i));
  std::vector<const ir::Expr*> values;
  for (std::size_t i = count; i < call.arguments.size(); ++i) values.push_back(call.arguments[i].get());
  format_values(values);
  emit_abc(info.uses_memory ? Opcode::kMemoryFunction : Opcode::kFunction, destination, static_cast<Register>(call.function), first);
}

/// All values are computed before the first FormatValue: they may contain formats of their own.
void ProgramWriter::format_values(const std::vector<const ir::Expr*>& values) {
  std::vector<Register> registers;
  for (const ir::Expr* expr : values) registers.push_back(value(*expr));
  for (const Register r : registers) emit_imm(Opcode::kFormatValue, r, 0);
}

void ProgramWriter::address_into(const ir::AddressOf& address, Register destination) {
  if (const auto* element = std::get_if<ir::Element>(&address.place->node)) {
    emit_imm(Opcode::kLoadByteAddress, destination, element_ref(*element));
    return;
  }
  const auto* variable = std::get_if<ir::Variable>(&address.place->node);
  if (!variable) return;
  if (variable->variable_class == VariableClass::kR) outgoing(255);
  const Register number = variable->index ? index_of(*variable) : take();
  if (!variable->index) load_number(static_cast<double>(variable->number), number);
  emit_abc(Opcode::kLoadAddress, destination, number, static_cast<Register>(variable->variable_class));
  if (address.end > 0) emit_imm(Opcode::kLimitAddress, destination, address.end);
}

/// 1 or 0 of a condition with && || !.
void ProgramWriter::condition_into(const ir::Expr& expr, Register destination) {
  Target otherwise;
  load_number(0, destination);
  branch(expr, false, otherwise);
  load_number(1, destination);
  place(otherwise);
}

/// Goes to target if the condition is as sense says, else on with the next instruction.
void ProgramWriter::branch(const ir::Expr& condition, bool sense, Target& target) {
  const Register before = next_;
  if (const auto* unary = std::get_if<ir::Unary>(&condition.node); unary && unary->op == Operator::kNot) return branch(*unary->operand, !sense, target);
  const auto* binary = std::get_if<ir::Binary>(&condition.node);
  if (binary && (binary->op == Operator::kAnd || binary->op == Operator::kOr)) {
    const bool decided_by_left = (binary->op == Operator::kOr) == sense;  // one side is enough
    if (decided_by_left) {
      branch(*binary->left, sense, target);
      branch(*binary->right, sense, target);
      return;
    }
    Target past;
    branch(*binary->left, !sense, past);
    branch(*binary->right, sense, target);
    place(past);
    return;
  }
  if (const auto constant = ir::constant_value(condition)) {
    if ((*constant != 0) == sense) jump_to(Opcode::kJump, 0, target);
    return;
  }
  const Register tested = value(condition);
  jump_to(sense ? Opcode::kJumpIfTrue : Opcode::kJumpIfFalse, tested, target);
  next_ = before;
}

}  // namespace pmac::compiler::codegen
