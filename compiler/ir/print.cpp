// The text form of the IR: one statement a line, nested ones indented; bound names show what they are bound to.
#include <fmt/format.h>

#include <cmath>

#include "compiler/bytecode/card.h"
#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/function.h"
#include "compiler/bytecode/letters.h"
#include "compiler/ir/ir.h"

namespace pmac::compiler::ir {
namespace {

constexpr std::string_view kClassLetters[] = {"P", "Q", "M", "I", "L", "R", "C", "D", "element"};
constexpr std::string_view kAssignTexts[] = {"=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="};

std::string list(const std::vector<ExprPtr>& values) {
  std::string text;
  for (const ExprPtr& value : values) text += (text.empty() ? "" : ", ") + (value ? print(*value) : std::string("addressed"));
  return text;
}

std::string print_variable(const Variable& variable) {
  const std::string_view letter = kClassLetters[static_cast<std::size_t>(variable.variable_class)];
  const std::string name = variable.name.empty() ? std::string() : fmt::format(" '{}'", variable.name);
  if (!variable.index) return fmt::format("{}{}{}", letter, variable.number, name);
  const std::string base = variable.number ? fmt::format("{} + ", variable.number) : std::string();
  return fmt::format("{}({}{}){}", letter, base, print(*variable.index), name);
}

std::string print_element(const Element& element) {
  std::string text(element.element == bytecode::kNoElement ? std::string_view(element.pattern) : bytecode::element_info(element.element).name);
  for (const ExprPtr& index : element.indices)
    if (const std::size_t at = text.find("[]"); at != std::string::npos) text.insert(at + 1, print(*index));
  return element.address ? text + ".a" : text;
}

struct ExprPrinter {
  std::string operator()(const Number& node) const { return fmt::format("{}", node.value); }
  std::string operator()(const Text& node) const { return "\"" + node.value + "\""; }
  std::string operator()(const Variable& node) const { return print_variable(node); }
  std::string operator()(const NameUse& node) const { return node.has_arguments ? fmt::format("?{}({})", node.name, list(node.arguments)) : "?" + node.name; }
  std::string operator()(const Element& node) const { return print_element(node); }
  std::string operator()(const Unary& node) const { return fmt::format("({}{})", operator_text(node.op), print(*node.operand)); }
  std::string operator()(const Binary& node) const { return fmt::format("({} {} {})", print(*node.left), operator_text(node.op), print(*node.right)); }
  std::string operator()(const FunctionCall& node) const { return fmt::format("{}({})", bytecode::function_info(node.function).name, list(node.arguments)); }
  std::string operator()(const AddressOf& node) const { return "&" + print(*node.place); }
};

std::string axis_list(std::uint32_t mask) {
  if (mask == 0xffffffffu) return " all";
  std::string text;
  for (int axis = 0; axis < bytecode::kAxisCount; ++axis)
    if (mask >> axis & 1u) text += fmt::format(" {}", bytecode::axis_name(axis));
  return text.empty() ? " none" : text;
}

std::string print_word(const Word& word) {
  constexpr std::string_view kVectors[] = {"I", "J", "K", "II", "JJ", "KK"};
  const std::string value = print(*word.value);
  switch (word.kind) {
    case WordKind::kTarget: return fmt::format(" {} {}", bytecode::axis_name(word.index), value);
    case WordKind::kVelocity: return fmt::format(" : {}", value);
    case WordKind::kTriggerDistance: return fmt::format(" ^ {}", value);
    case WordKind::kCenter: return fmt::format(" {} {}", kVectors[word.index], value);
    default: return fmt::format(" R {}", value);
  }
}

class StmtPrinter {
 public:
  explicit StmtPrinter(const Unit& unit) : unit_(unit) {}

  void body(const Body& statements) {
    depth_ += 2;
    for (const StmtPtr& inner : statements) statement(*inner);
    depth_ -= 2;
  }
  void statement(const Stmt& stmt) { std::visit(*this, stmt.node); }

  void operator()(const Block& node) { for (const StmtPtr& inner : node.body) statement(*inner); }
  void operator()(const Assign& node) {
    const std::string_view op = kAssignTexts[static_cast<std::size_t>(node.op)];
    line(fmt::format("{} {} {}{}", node.synchronous ? "sync" : "set", print(*node.target), op, " " + list(node.values)));
  }
  void operator()(const AssignSeries& node) { line(fmt::format("set {} = {} count {} step {}", print(*node.target), print(*node.value), node.count, node.step)); }
  void operator()(const If& node) {
    for (std::size_t i = 0; i < node.branches.size(); ++i) {
      line(fmt::format("{} {}", i ? "else if" : "if", print(*node.branches[i].condition)));
      nested(*node.branches[i].body);
    }
    if (!node.otherwise) return;
    line("else");
    nested(*node.otherwise);
  }
  void operator()(const While& node) { line(fmt::format("while {}", print(*node.condition))); nested(*node.body); }
  void operator()(const DoWhile& node) { line("do"); nested(*node.body); line(fmt::format("while {}", print(*node.condition))); }
  void operator()(const Switch& node) {
    line(fmt::format("switch {}", print(*node.value)));
    std::size_t next = 0;
    for (std::size_t i = 0; i <= node.body.size(); ++i) {
      for (; next < node.cases.size() && node.cases[next].first == i; ++next)
        line(node.cases[next].value ? fmt::format("case {}", print(*node.cases[next].value)) : std::string("default"));
      if (i < node.body.size()) nested(*node.body[i]);
    }
  }
  void operator()(const Break&) { line("break"); }
  void operator()(const Continue&) { line("continue"); }
  void operator()(const Label& node) { line(fmt::format("label {}", node.number)); }
  void operator()(const Locals& node) {
    for (const LocalDeclaration& name : node.names)
      line(fmt::format("local {} L{}{}{}", name.name, name.number, name.size ? " size " + print(*name.size) : "", name.value ? " = " + print(*name.value) : ""));
  }
  void operator()(const Jump& node) {
    constexpr std::string_view kNames[] = {"goto", "gosub", "callsub"};
    line(fmt::format("{} {}{}", kNames[static_cast<std::size_t>(node.kind)], node.label ? print(*node.label) : node.name, with(node.arguments)));
  }
  void operator()(const Call& node) {
    if (node.subprogram < 0) return line(fmt::format("call {}{}", node.number ? print(*node.number) : "?" + node.name, with(node.arguments)));
    line(fmt::format("call {}{}{}", node.subprogram, node.label >= 0 ? fmt::format(" label {}", node.label) : "", with(node.arguments)));
  }
  void operator()(const Return&) { line("return"); }
  void operator()(const Stop&) { line("stop"); }
  void operator()(const CodeLine& node) {
    std::string text = "line";
    for (const LineWord& word : node.words) {
      text += fmt::format(" {} {}", bytecode::letter_name(word.letter), print(*word.value));
      if (word.velocity) text += " : " + print(*word.velocity);
      if (word.trigger) text += " ^ " + print(*word.trigger);
    }
    line(text);
    if (node.call) nested(*node.call);
  }
  void operator()(const ReadWords& node) {
    std::string text = "read";
    for (int letter = 1; letter <= bytecode::kLetterCount; ++letter)
      if (node.letters >> (letter - 1) & 1u) text += " " + bytecode::letter_name(letter);
    line(text);
  }
  void operator()(const LineCondition& node) {
    line(fmt::format("line {} flag {}", node.skip ? "unless" : "if", print(*node.flag)));
    body(node.rest);
  }
  void operator()(const SetFlag& node) { line(fmt::format("flag {} = {}", print(*node.flag), node.set ? 1 : 0)); }
  void operator()(const Cycle& node) {
    constexpr std::string_view kNames[] = {"define", "undefine", "call"};
    line(fmt::format("cycle {}{}", kNames[static_cast<std::size_t>(node.verb)], node.number ? " " + print(*node.number) : ""));
  }
  void operator()(const StepBlock& node) { line(node.begin ? "step begin" : "step end"); }
  void operator()(const SetMode& node) { line(fmt::format("mode {}", bytecode::move_mode_name(node.mode))); }
  void operator()(const SetParameter& node) { line(fmt::format("{} {}", bytecode::motion_parameter_name(node.parameter), print(*node.value))); }
  void operator()(const SetAbsInc& node) { line(fmt::format("{}{}{}", node.absolute ? "abs" : "inc", node.axes || !node.centres ? axis_list(node.axes) : "", node.centres ? " centres" : "")); }
  void operator()(const SetFrax& node) { line(fmt::format("{}frax{}{}", node.off ? "no" : "", node.secondary ? "2" : "", axis_list(node.axes))); }
  void operator()(const SetNormal& node) { line(fmt::format("normal {} {} {}{}", print(*node.vector[0]), print(*node.vector[1]), print(*node.vector[2]), node.second_set ? " second set" : "")); }
  void operator()(const Move& node) {
    std::string text = "move";
    for (const Word& word : node.words) text += print_word(word);
    line(text);
  }
  void operator()(const MoveRows& node) {
    std::size_t rows = 0;
    for (const bytecode::MoveRun& run : *node.runs) rows += run.row_count();
    line(fmt::format("moves of {} plain lines", rows));
  }
  void operator()(const Dwell& node) { line(fmt::format("dwell {}", print(*node.time_ms))); }
  void operator()(const Delay& node) { line(fmt::format("delay {}", print(*node.time_ms))); }
  void operator()(const Evaluate& node) { line(print(*node.value)); }
  void operator()(const Control& node) {
    const auto number = node.arguments.empty() || !node.arguments[0] ? std::nullopt : constant_value(*node.arguments[0]);
    std::string arguments = list(node.arguments);
    if (number && std::isinf(*number)) arguments.replace(0, 3, "all");  // inf: the list *
    line(fmt::format("{} ({})", bytecode::control_verb_name(node.verb), arguments));
  }
  void operator()(const CardAction& node) { line(fmt::format("card {} ({})", bytecode::card_verb_info(node.verb).text, list(node.arguments))); }
  void operator()(const RelayCondition& node) {
    line(fmt::format("if relay {}", print(*node.relay)));
    body(node.rest);
  }
  void operator()(const Command& node) { line(fmt::format("cmd \"{}\"{}", node.text, with(node.values))); }
  void operator()(const Send& node) { line(fmt::format("send {} \"{}\"{}", node.port, node.text, with(node.values))); }
  void operator()(const AddressCoord& node) { line(fmt::format("address coord {}", print(*node.number))); }
  void operator()(const AddressMotor& node) { line(fmt::format("address motor {}", print(*node.number))); }
  void operator()(const DefineAxis& node) {
    const bytecode::AxisDefinition& definition = node.definition;
    constexpr std::string_view kKinds[] = {"linear", "null", "inverse", "spindle"};
    std::string text = fmt::format("axis motor {} {}", definition.motor, kKinds[static_cast<std::size_t>(definition.kind)]);
    for (const bytecode::AxisTerm& term : definition.terms) text += fmt::format(" {}*{}", term.coefficient_mu_per_uu, bytecode::axis_name(term.axis));
    if (definition.offset_mu != 0) text += fmt::format(" offset {}", definition.offset_mu);
    if (definition.kind == bytecode::AxisDefinitionKind::kSpindle) text += fmt::format(" {}", definition.spindle);
    line(text);
  }
  void operator()(const DefinePointer& node) {
    const bytecode::PointerDefinition& definition = node.definition;
    constexpr std::string_view kKinds[] = {"self", "io", "user integer", "user float", "user double", "element"};
    std::string text = fmt::format("pointer M{}", definition.first_m);
    if (definition.last_m != definition.first_m) text += fmt::format("..M{}", definition.last_m);
    text += fmt::format(" {}", kKinds[static_cast<std::size_t>(definition.kind)]);
    if (node.element) text += " " + print(*node.element);
    const bool bits = definition.kind == bytecode::PointerKind::kIo || definition.kind == bytecode::PointerKind::kUserInteger || definition.has_field;
    if (!node.element && definition.kind != bytecode::PointerKind::kSelf) text += fmt::format(" ${:X}", definition.address);
    if (bits) text += fmt::format(" {}bit {} width {}", definition.is_signed ? "signed " : "", definition.start_bit, definition.width);
    line(text + (node.name.empty() ? std::string() : fmt::format(" '{}'", node.name)));
  }
  void operator()(const Globals& node) {
    for (const GlobalDeclaration& name : node.names)
      line(fmt::format("declare {}{} '{}'{}{}", kClassLetters[static_cast<std::size_t>(name.variable_class)], name.number, name.name, name.size ? " size " + print(*name.size) : "",
                       name.value ? " = " + print(*name.value) : ""));
  }
  void operator()(const SystemCommand& node) { line(fmt::format("system \"{}\"", node.text)); }
  void operator()(const Report& node) { line(fmt::format("report {} as \"{}\"", print(*node.value), node.name)); }
  void operator()(const OpenBuffer& node) { buffer(unit_.buffers[node.buffer]); }
  void operator()(const ExecuteAtOnce& node) { line("execute"); buffer(unit_.buffers[node.buffer]); }

  void title(std::string_view text) { line(text); }
  std::string take() { return std::move(out_); }

 private:
  static std::string with(const std::vector<ExprPtr>& arguments) { return arguments.empty() ? std::string() : " (" + list(arguments) + ")"; }
  void line(std::string_view text) { out_ += std::string(static_cast<std::size_t>(depth_), ' ') + std::string(text) + "\n"; }
  void nested(const Stmt& stmt) {
    depth_ += 2;
    statement(stmt);
    depth_ -= 2;
  }
  void buffer(const Buffer& open) {
    line(fmt::format("{} {}{} locals {}", bytecode::program_kind_name(open.kind), open.number, open.name.empty() ? "" : fmt::format(" '{}'", open.name), open.local_count));
    std::size_t next = 0;
    for (std::size_t i = 0; i <= open.body.size(); ++i) {
      for (; next < open.routines.size() && open.routines[next].first == i; ++next) line(fmt::format("  routine {} label {}", open.routines[next].name, open.routines[next].label));
      if (i == open.body.size()) break;
      depth_ += 2;
      statement(*open.body[i]);
      depth_ -= 2;
    }
  }

  const Unit& unit_;
  std::string out_;
  int depth_ = 0;
};

}  // namespace

std::string print(const Expr& expr) { return std::visit(ExprPrinter{}, expr.node); }

std::string print(const Unit& unit) {
  StmtPrinter printer(unit);
  if (!unit.axis.empty()) printer.title(fmt::format("card {} '{}'", unit.card, unit.axis));
  for (const StmtPtr& statement : unit.load) printer.statement(*statement);
  return printer.take();
}

}  // namespace pmac::compiler::ir
