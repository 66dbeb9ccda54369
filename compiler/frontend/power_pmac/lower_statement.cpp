// Statements of buffers: assignments, flow control, calls, declarations.
#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "compiler/bytecode/control.h"
#include "compiler/frontend/power_pmac/lowering.h"

namespace pmac::compiler::power_pmac {
namespace {

using bytecode::AssignOp;

AssignOp assign_operator(std::string_view text) {
  switch (text[0]) {
    case '+': return AssignOp::kAdd;
    case '-': return AssignOp::kSub;
    case '*': return AssignOp::kMul;
    case '/': return AssignOp::kDiv;
    case '%': return AssignOp::kMod;
    case '&': return AssignOp::kAnd;
    case '|': return AssignOp::kOr;
    case '^': return AssignOp::kXor;
    case '<': return AssignOp::kShiftLeft;
    case '>': return AssignOp::kShiftRight;
    default: return AssignOp::kSet;
  }
}

std::optional<bytecode::PointerKind> io_kind(std::string_view text) {
  const bool user = text.find("user") != std::string_view::npos;
  switch (text[0]) {
    case 'u': case 's': case 'i': return user ? bytecode::PointerKind::kUserInteger : bytecode::PointerKind::kIo;
    case 'f': return user ? std::optional(bytecode::PointerKind::kUserFloat) : std::nullopt;
    case 'd': return user ? std::optional(bytecode::PointerKind::kUserDouble) : std::nullopt;
    default: return std::nullopt;
  }
}

/// The numbers of u.io:$A0000C.12.1 behind the colon.
std::vector<std::uint64_t> dotted_numbers(std::string_view text) {
  std::vector<std::uint64_t> numbers;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('.', at), text.size());
    const bool hex = text[at] == '$';
    std::uint64_t value = 0;
    std::from_chars(text.data() + at + (hex ? 1 : 0), text.data() + end, value, hex ? 16 : 10);
    numbers.push_back(value);
    at = end + 1;
  }
  return numbers;
}

}  // namespace

void Lowering::lower_statements(const std::vector<P::StatementContext*>& statements, ir::Body& out) {
  for (P::StatementContext* statement : statements) lower_statement(statement, out);
}

/// A misspelt control word that the token pass took for what was meant.
void Lowering::check_control_word(const antlr4::Token* word) {
  const std::size_t type = word->getType();
  const std::string_view meant = type == P::IF ? "if" : type == P::WHILE ? "while" : type == P::SWITCH ? "switch" : "";
  const std::string text = text_of(word);
  if (meant.empty() || lower_case(text) == meant) return;
  diagnostics_.error("PM2008", span_of(word), fmt::format("unknown word '{}'; did you mean '{}'?", text, meant)).fix = source::FixIt{span_of(word), std::string(meant)};
}

void Lowering::lower_statement(P::StatementContext* statement, ir::Body& out) {
  if (!statement || statement->exception) return;
  const source::Span span = span_of(statement);
  if (in_rotary_) check_rotary(statement);
  if (auto* block = statement->block()) return out.push_back(lower_block(block));
  check_control_word(statement->start);
  if (auto* branch = statement->ifStatement()) return out.push_back(lower_if(branch));
  if (auto* loop = statement->whileStatement()) {
    ir::ExprPtr condition = lower_condition(loop->condition());
    return out.push_back(ir::make_stmt(span, ir::While{std::move(condition), lower_body(loop->body())}));
  }
  if (auto* loop = statement->doStatement()) {
    ir::StmtPtr body = lower_body(loop->body());
    return out.push_back(ir::make_stmt(span, ir::DoWhile{std::move(body), lower_condition(loop->condition())}));
  }
  if (auto* selection = statement->switchStatement()) return out.push_back(lower_switch(selection));
  if (auto* label = statement->label()) return lower_label(label, out);
  if (auto* declaration = statement->declaration()) return lower_declaration(declaration, out);
  if (auto* line = statement->motionLine()) return lower_motion_line(line, out);
  if (statement->PLAIN_MOVES()) return lower_plain_moves(statement, out);
  if (auto* code = statement->codeLine()) return lower_code_line(code, out);
  if (auto* assignment = statement->assignment()) return lower_assignment(assignment, out);
  if (auto* call = statement->callStatement()) {
    ir::NameUse use{text_of(call->start), true, lower_arguments(call->arguments())};
    return out.push_back(ir::make_stmt(span, ir::Evaluate{std::make_unique<ir::Expr>(ir::Expr{span, std::move(use)})}));
  }
  if (auto* simple = statement->simpleStatement()) return lower_simple(simple, out);
  if (statement->onlineInBuffer()) diagnostics_.error("PM2013", span, "this is an on-line command; it cannot stand in a program buffer (close is missing before it?)");
}

ir::StmtPtr Lowering::lower_body(P::BodyContext* body) {
  ir::Block block;
  if (body) lower_statement(body->statement(), block.body);
  return ir::make_stmt(span_of(body), std::move(block));
}

ir::StmtPtr Lowering::lower_block(P::BlockContext* block) {
  ir::Block result;
  lower_statements(block->statement(), result.body);
  return ir::make_stmt(span_of(block), std::move(result));
}

ir::StmtPtr Lowering::lower_if(P::IfStatementContext* statement) {
  ir::If result;
  ir::ExprPtr condition = lower_condition(statement->condition());
  result.branches.push_back({std::move(condition), lower_body(statement->body())});
  for (P::ElsePartContext* part = statement->elsePart(); part; part = part->elsePart()) {
    if (part->ELSE_IF()) {
      ir::ExprPtr else_condition = lower_condition(part->condition());
      result.branches.push_back({std::move(else_condition), lower_body(part->body())});
    } else if (part->ELSE()) {
      result.otherwise = lower_body(part->body());
    }
  }
  return ir::make_stmt(span_of(statement), std::move(result));
}

ir::StmtPtr Lowering::lower_switch(P::SwitchStatementContext* statement) {
  ir::Switch result;
  result.value = lower_expression(statement->expression());
  for (antlr4::tree::ParseTree* child : statement->children) {
    if (auto* inner = dynamic_cast<P::StatementContext*>(child)) lower_statement(inner, result.body);
    auto* label = dynamic_cast<P::CaseLabelContext*>(child);
    if (!label || label->exception) continue;
    ir::ExprPtr value = label->expression() ? lower_expression(label->expression()) : nullptr;
    result.cases.push_back({std::move(value), span_of(label), result.body.size()});
  }
  return ir::make_stmt(span_of(statement), std::move(result));
}

void Lowering::lower_label(P::LabelContext* label, ir::Body& out) {
  const auto number = whole_number(token_of(label->NUMBER()), 4294967295);
  const bool is_block_number = label->COLON() == nullptr;
  if (number && !is_block_number) out.push_back(ir::make_stmt(span_of(label), ir::Label{*number}));
}

void Lowering::lower_assignment(P::AssignmentContext* assignment, ir::Body& out) {
  ir::Assign result;
  result.target = lower_lvalue(assignment->lvalue());
  if (assignment->step) {
    const std::string text = text_of(assignment->step);
    result.op = assign_operator(text);
    result.synchronous = text.ends_with('=');
    result.values.push_back(ir::make_number(1, span_of(assignment->step)));
  } else {
    const std::string text = text_of(assignment->operation);
    result.op = text == "=" || text == "==" ? AssignOp::kSet : assign_operator(text);
    result.synchronous = text.ends_with("==");
    for (P::ExpressionContext* value : assignment->expression()) result.values.push_back(lower_expression(value));
  }
  out.push_back(ir::make_stmt(span_of(assignment), std::move(result)));
}

void Lowering::lower_simple(P::SimpleStatementContext* statement, ir::Body& out) {
  const source::Span span = span_of(statement);
  if (statement->BREAK()) return out.push_back(ir::make_stmt(span, ir::Break{}));
  if (statement->CONTINUE()) return out.push_back(ir::make_stmt(span, ir::Continue{}));
  if (statement->RETURN()) return out.push_back(ir::make_stmt(span, ir::Return{}));
  if (statement->STOP()) return out.push_back(ir::make_stmt(span, ir::Stop{}));
  if (statement->GOTO() || statement->GOSUB() || statement->CALLSUB()) return out.push_back(with_words(lower_jump(statement), statement->lineWord()));
  if (statement->CALL()) return out.push_back(with_words(lower_call(statement), statement->lineWord()));
  if (statement->READ()) return out.push_back(lower_read(statement));
  if (statement->BSTART() || statement->BSTOP()) return out.push_back(ir::make_stmt(span, ir::StepBlock{statement->BSTART() != nullptr}));
  if (lower_flags_and_cycles(statement, out)) return;
  if (statement->DWELL()) return out.push_back(ir::make_stmt(span, ir::Dwell{lower_data(statement->data(0))}));
  if (statement->DELAY()) return out.push_back(ir::make_stmt(span, ir::Delay{lower_data(statement->data(0))}));
  if (statement->PSET()) return lower_pset(statement, out);
  if (statement->programControl()) return lower_program_control(statement->programControl(), out);
  const bool bias = statement->PCLR() || statement->PSTORE() || statement->PLOAD();
  if (bias) {
    if (statement->axisList()) diagnostics_.error("PM2053", span_of(statement->axisList()), fmt::format("{} acts on all axes; it takes no list", lower_case(text_of(statement->start))));
    const auto verb = statement->PCLR() ? ir::ControlVerb::kPclr : statement->PSTORE() ? ir::ControlVerb::kPstore : ir::ControlVerb::kPload;
    std::vector<ir::ExprPtr> arguments;
    arguments.push_back(nullptr);
    return add_control(verb, span, std::move(arguments), out);
  }
  if (statement->PREAD() || statement->VREAD() || statement->DREAD() || statement->FREAD() || statement->TREAD()) return lower_axis_query(statement, out);
  not_supported(span, lower_case(text_of(statement->start)));
}

/// pread, vread(X,Y): axis values of the coordinate system to D variables.
void Lowering::lower_axis_query(P::SimpleStatementContext* statement, ir::Body& out) {
  using Verb = ir::ControlVerb;
  const Verb verb = statement->PREAD() ? Verb::kPread : statement->VREAD() ? Verb::kVread : statement->DREAD() ? Verb::kDread : statement->FREAD() ? Verb::kFread : Verb::kTread;
  const source::Span span = span_of(statement);
  std::vector<ir::ExprPtr> arguments;
  arguments.push_back(nullptr);
  bool centres = false;
  arguments.push_back(statement->axisList() ? ir::make_number(axis_mask(statement->axisList(), &centres), span) : nullptr);
  if (centres) diagnostics_.error("PM2009", span, "R is no axis");
  add_control(verb, span, std::move(arguments), out);
}

ir::StmtPtr Lowering::lower_jump(P::SimpleStatementContext* statement) {
  ir::Jump jump;
  jump.kind = statement->GOTO() ? ir::JumpKind::kGoto : statement->GOSUB() ? ir::JumpKind::kGosub : ir::JumpKind::kCallsub;
  P::LabelNumberContext* label = statement->labelNumber();
  if (label && label->NAME()) jump.name = text_of(token_of(label->NAME()));
  else if (label && label->NUMBER()) jump.label = lower_number(token_of(label->NUMBER()));
  else jump.label = lower_expression(label ? label->expression() : nullptr);
  jump.arguments = lower_arguments(statement->arguments());
  return ir::make_stmt(span_of(statement), std::move(jump));
}

ir::StmtPtr Lowering::lower_call(P::SimpleStatementContext* statement) {
  ir::Call call;
  P::CallTargetContext* target = statement->callTarget();
  call.name_span = span_of(target);
  if (target && target->NAME()) {
    call.name = text_of(token_of(target->NAME()));
    call.routine = text_of(token_of(target->MEMBER()));
  } else {
    call.number = target && target->NUMBER() ? lower_number(token_of(target->NUMBER())) : lower_expression(target ? target->expression() : nullptr);
  }
  call.arguments = lower_arguments(statement->arguments());
  return ir::make_stmt(span_of(statement), std::move(call));
}

void Lowering::lower_declaration(P::DeclarationContext* declaration, ir::Body& out) {
  const source::Span span = span_of(declaration);
  if (!online_ && !declaration->pointerDeclarator().empty())
    return void(diagnostics_.error("PM2013", span, "pointers are defined outside of program buffers; write ptr before open"));
  for (P::PointerDeclaratorContext* pointer : declaration->pointerDeclarator()) {
    bytecode::PointerDefinition definition;
    definition.first_m = definition.last_m = -1;
    definition.name = text_of(token_of(pointer->NAME()));
    ir::StmtPtr statement = lower_pointer(pointer->pointerTarget(), span_of(pointer), definition);
    auto& node = std::get<ir::DefinePointer>(statement->node);
    node.name = definition.name;
    node.name_span = span_of(token_of(pointer->NAME()));
    node.declaration = span;
    if (pointer->NUMBER()) node.size = static_cast<int>(whole_number(token_of(pointer->NUMBER()), bytecode::kMCount).value_or(0));
    out.push_back(std::move(statement));
  }
  if (!declaration->kind) return;
  const auto sizes = [&](P::DeclaratorContext* d) { return d->LEFT() && !d->expression().empty() ? lower_expression(d->expression(0)) : nullptr; };
  const auto values = [&](P::DeclaratorContext* d) { return d->ASSIGN() && !d->expression().empty() ? lower_expression(d->expression().back()) : nullptr; };
  if (declaration->kind->getType() == P::LOCAL) {
    ir::Locals locals;
    for (P::DeclaratorContext* d : declaration->declarator())
      if (d->NAME()) locals.names.push_back({text_of(token_of(d->NAME())), span_of(token_of(d->NAME())), sizes(d), values(d), -1});
    return out.push_back(ir::make_stmt(span, std::move(locals)));
  }
  ir::Globals globals;
  const auto variable_class = declaration->kind->getType() == P::GLOBAL ? ir::VariableClass::kP : ir::VariableClass::kQ;
  for (P::DeclaratorContext* d : declaration->declarator())
    if (d->NAME()) globals.names.push_back({variable_class, text_of(token_of(d->NAME())), span_of(token_of(d->NAME())), sizes(d), values(d), -1});
  out.push_back(ir::make_stmt(span, std::move(globals)));
}

/// The numbers of .12.1 behind an element or *i.
std::vector<std::uint64_t> Lowering::bit_numbers(P::PointerTargetContext* target) {
  std::vector<std::uint64_t> numbers;
  for (antlr4::tree::TerminalNode* bit : target->NUMBER()) {
    const std::string text = text_of(token_of(bit));
    for (const std::uint64_t n : dotted_numbers(std::string_view(text).substr(text.starts_with('.') ? 1 : 0))) numbers.push_back(n);
  }
  return numbers;
}

/// *d and *f hold a double, *i.16 an integer of 16 bits, *u.16 one without sign.
void Lowering::set_self_format(P::PointerTargetContext* target, bytecode::PointerDefinition& definition) {
  const std::string letter = lower_case(text_of(token_of(target->SELF_FORMAT())));
  const std::vector<std::uint64_t> numbers = bit_numbers(target);
  const bool is_real = letter == "d" || letter == "f";
  const std::uint64_t width = numbers.empty() ? 32 : numbers.back();
  const bool valid = is_real ? numbers.empty() : numbers.size() <= 1 && width >= 1 && width <= 32;
  if (!valid) return void(diagnostics_.error("PM3004", span_of(target), "a variable of its own is *, *d, or *i.width and *u.width with a width of 1 to 32 bits"));
  definition.has_field = !is_real;
  definition.is_signed = letter == "i" || letter == "s";
  definition.width = static_cast<std::uint8_t>(width);
}

ir::StmtPtr Lowering::lower_pointer(P::PointerTargetContext* target, source::Span span, bytecode::PointerDefinition definition) {
  ir::DefinePointer result;
  result.definition = std::move(definition);
  if (target && target->IO_POINTER()) {
    const std::string text = lower_case(text_of(token_of(target->IO_POINTER())));
    const auto kind = io_kind(text);
    const std::size_t colon = text.find_first_of(":.", 2);
    const auto numbers = colon == std::string::npos ? std::vector<std::uint64_t>() : dotted_numbers(std::string_view(text).substr(colon + 1));
    const std::uint64_t start = numbers.size() > 1 ? numbers[1] : 0;
    const std::uint64_t width = numbers.size() > 2 ? numbers[2] : numbers.size() == 2 ? 1 : 32;
    const bool valid = kind && !numbers.empty() && numbers.size() <= 3 && numbers[0] <= 0xffffffffu && start < 32 && width >= 1 && start + width <= 32;
    if (!valid) {
      diagnostics_.error("PM3004", span_of(target), "a pointer is u.io:$address.start.width, with start and width inside 32 bits");
      return ir::make_stmt(span, std::move(result));
    }
    result.definition.kind = *kind;
    result.definition.is_signed = text[0] == 's' || text[0] == 'i';
    result.definition.address = static_cast<std::uint32_t>(numbers[0]);
    result.definition.start_bit = static_cast<std::uint8_t>(start);
    result.definition.width = static_cast<std::uint8_t>(width);
  } else if (target && target->SELF_FORMAT()) {
    set_self_format(target, result.definition);
  } else if (target && target->reference()) {
    result.definition.kind = bytecode::PointerKind::kElement;
    result.element = lower_reference(target->reference());
    const std::vector<std::uint64_t> numbers = bit_numbers(target);
    result.definition.has_field = !numbers.empty();
    const std::uint64_t start = numbers.empty() ? 0 : numbers[0];
    const std::uint64_t width = numbers.size() > 1 ? numbers[1] : numbers.empty() ? 32 : 1;
    if (start + width > 32 || width == 0) diagnostics_.error("PM3004", span_of(target), "the bits of a pointer lie inside 32 bits");
    else result.definition.start_bit = static_cast<std::uint8_t>(start), result.definition.width = static_cast<std::uint8_t>(width);
  }
  return ir::make_stmt(span, std::move(result));
}

}  // namespace pmac::compiler::power_pmac
