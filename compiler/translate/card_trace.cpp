#include "compiler/translate/card_trace.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "compiler/bytecode/card.h"
#include "compiler/bytecode/bytecode.h"
#include "compiler/bytecode/opcode.h"

namespace pmac::compiler::translate {
namespace {

using bytecode::CardVerb;
using bytecode::Opcode;

/// A program with its conditions flattened: where the relay of a condition is clear, the way goes on at `otherwise`.
struct FlatStep {
  const ir::Stmt* statement = nullptr;
  const ir::Expr* relay = nullptr;
  std::size_t otherwise = 0;
  std::int64_t line = -1;
};

struct FlatProgram {
  std::vector<FlatStep> steps;
  std::map<std::int64_t, std::size_t> lines;
};

void flatten(const ir::Body& body, std::int64_t& line, FlatProgram& out) {
  for (const ir::StmtPtr& statement : body) {
    if (const auto* label = std::get_if<ir::Label>(&statement->node)) {
      line = label->number;
      out.lines[line] = out.steps.size();
    } else if (const auto* condition = std::get_if<ir::RelayCondition>(&statement->node)) {
      const std::size_t at = out.steps.size();
      out.steps.push_back({statement.get(), condition->relay.get(), 0, line});
      flatten(condition->rest, line, out);
      out.steps[at].otherwise = out.steps.size();
    } else {
      out.steps.push_back({statement.get(), nullptr, 0, line});
    }
  }
}

FlatProgram flatten(const ir::Body& body) {
  FlatProgram program;
  std::int64_t line = -1;
  flatten(body, line, program);
  return program;
}

/// Everything that the further way of a card depends on.
struct State {
  std::map<std::int64_t, double> parameters;
  std::set<std::int64_t> relays;
  double vel = 0, acc = 0, dec = 0, stp = 0;
  bool operator<(const State& o) const { return std::tie(parameters, relays, vel, acc, dec, stp) < std::tie(o.parameters, o.relays, o.vel, o.acc, o.dec, o.stp); }
};

class Tracer {
 public:
  Tracer(const ir::Unit& unit, const TraceRules& rules, source::Diagnostics& diagnostics) : unit_(unit), rules_(rules), diagnostics_(diagnostics) { trace_.axis = unit.axis; }

  CardTrace run(const std::vector<std::int64_t>& relays_set) {
    state_.relays.insert(relays_set.begin(), relays_set.end());
    execute(flatten(unit_.load), 0);
    return std::move(trace_);
  }

 private:
  enum class Next { kGoOn, kJumped, kEnd };

  void execute(const FlatProgram& program, std::size_t begin);
  Next perform(const FlatStep& step, const FlatProgram& program, std::size_t& at, std::vector<std::size_t>& calls);
  Next jump(const ir::Jump& node, const source::Span& span, const FlatProgram& program, std::size_t& at, std::vector<std::size_t>& calls);
  Next card(const ir::CardAction& node, const FlatStep& step, std::vector<std::size_t>& calls);
  void motion(const ir::CardAction& node, const FlatStep& step);
  void run_stored(double first_line, const source::Span& span);
  bool relay(std::int64_t number, const source::Span& span);
  double value(const ir::Expr& expr) const;
  bool repeats(const FlatStep& step, std::size_t target, std::size_t depth);
  void leave_out(const source::Span& span, const std::string& what) {
    if (told_.insert({span.file, span.begin}).second) diagnostics_.warning("ACR-W10", span, what);
  }

  const ir::Unit& unit_;
  const TraceRules& rules_;
  source::Diagnostics& diagnostics_;
  CardTrace trace_;
  State state_;
  const ir::Buffer* stored_ = nullptr;
  bool waited_ = false, over_ = false;
  std::size_t steps_ = 0;
  std::set<std::pair<std::int32_t, std::uint32_t>> told_;
  std::set<std::tuple<std::size_t, std::size_t, State>> passed_;  // target of a way back, depth, state
};

double Tracer::value(const ir::Expr& expr) const {
  if (const auto* number = std::get_if<ir::Number>(&expr.node)) return number->value;
  if (const auto* variable = std::get_if<ir::Variable>(&expr.node)) {
    const auto at = state_.parameters.find(variable->number);
    return at == state_.parameters.end() ? 0 : at->second;
  }
  if (const auto* unary = std::get_if<ir::Unary>(&expr.node)) return -value(*unary->operand);
  const auto* binary = std::get_if<ir::Binary>(&expr.node);
  if (!binary) return 0;
  const double left = value(*binary->left), right = value(*binary->right);
  switch (binary->op) {
    case ir::Operator::kAdd: return left + right;
    case ir::Operator::kSub: return left - right;
    case ir::Operator::kMul: return left * right;
    case ir::Operator::kDiv: return left / right;
    default: return bytecode::apply_binary(Opcode::kBitOr, left, right);
  }
}

bool Tracer::relay(std::int64_t number, const source::Span& span) {
  if (number == rules_.busy_relay) {
    waited_ = true;
    return false;
  }
  if (!state_.relays.contains(number)) leave_out(span, fmt::format("relay {} is asked here; the translation takes it as it is set so far, and a changing input is not carried over", number));
  return state_.relays.contains(number);
}

/// A way back to a state in which the card has been there before: everything from now on is a repetition.
bool Tracer::repeats(const FlatStep& step, std::size_t target, std::size_t depth) {
  if (passed_.insert({target, depth, state_}).second) return false;
  leave_out(step.statement->span, "from here the program repeats itself for ever; it is carried over up to here");
  return true;
}

void Tracer::motion(const ir::CardAction& node, const FlatStep& step) {
  CardMotion motion;
  const auto argument = [&](std::size_t i) { return value(*node.arguments[i]); };
  motion.kind = node.verb == CardVerb::kCircle ? CardMotionKind::kCircle : node.verb == CardVerb::kMoveBy ? CardMotionKind::kMoveBy : CardMotionKind::kMoveTo;
  if (motion.kind != CardMotionKind::kCircle) motion.target = argument(0);
  else motion.direction = argument(0), motion.radius = argument(1), motion.i = argument(2), motion.j = argument(3), motion.distance = argument(4);
  const auto parameter = [&](std::int64_t number) { return state_.parameters.contains(number) ? state_.parameters.at(number) : 0; };
  motion.master_length = parameter(28);
  motion.end_point = parameter(29);
  motion.vel = state_.vel, motion.acc = state_.acc, motion.dec = state_.dec, motion.stp = state_.stp;
  motion.waited = std::exchange(waited_, false);
  motion.span = step.statement->span;
  motion.line = step.line;
  if (motion.kind == CardMotionKind::kCircle && (std::abs(motion.direction) != 1 || motion.radius <= 0 || motion.distance < 0))
    return void(diagnostics_.error("ACR-E10", motion.span, "this CIRCLE gets a direction, radius or distance that cannot be"));
  trace_.motions.push_back(motion);
}

void Tracer::run_stored(double first_line, const source::Span& span) {
  if (!stored_) return;
  const FlatProgram program = flatten(stored_->body);
  std::size_t begin = 0;
  if (!std::isnan(first_line)) {
    const auto at = program.lines.find(static_cast<std::int64_t>(first_line));
    if (at == program.lines.end()) return void(diagnostics_.error("ACR-E07", span, fmt::format("line {} is not stored", first_line)));
    begin = at->second;
  }
  passed_.clear();
  execute(program, begin);
}

Tracer::Next Tracer::card(const ir::CardAction& node, const FlatStep& step, std::vector<std::size_t>& calls) {
  const source::Span span = step.statement->span;
  switch (node.verb) {
    case CardVerb::kVel: state_.vel = value(*node.arguments[0]); break;
    case CardVerb::kAcc: state_.acc = value(*node.arguments[0]); break;
    case CardVerb::kDec: state_.dec = value(*node.arguments[0]); break;
    case CardVerb::kStp: state_.stp = value(*node.arguments[0]); break;
    case CardVerb::kMoveTo:
    case CardVerb::kMoveBy:
    case CardVerb::kCircle: motion(node, step); break;
    case CardVerb::kSetRelay: state_.relays.insert(static_cast<std::int64_t>(value(*node.arguments[0]))), leave_out(span, "SET is not carried over: a relay has no counterpart"); break;
    case CardVerb::kClearRelay: state_.relays.erase(static_cast<std::int64_t>(value(*node.arguments[0]))), leave_out(span, "CLR is not carried over: a relay has no counterpart"); break;
    case CardVerb::kPrint: leave_out(span, "PRINT is not carried over"); break;
    case CardVerb::kPoke:
    case CardVerb::kPeek: leave_out(span, "the card's memory is not carried over"); break;
    case CardVerb::kReturn:
      if (calls.empty()) return diagnostics_.error("ACR-E08", span, "RET without a GSB is reached here"), Next::kEnd;
      break;
    case CardVerb::kCall:
      if (calls.size() >= 250) return diagnostics_.error("ACR-E08", span, "subroutines are nested too deep here"), Next::kEnd;
      break;
    case CardVerb::kMissingLine: return diagnostics_.error("ACR-E07", span, fmt::format("this branch to line {} is taken, and the line is not stored", value(*node.arguments[0]))), Next::kEnd;
    case CardVerb::kHalt: return Next::kEnd;
    case CardVerb::kNew: stored_ = nullptr; break;
    case CardVerb::kRun: run_stored(value(*node.arguments[0]), span); break;
    default: break;
  }
  return Next::kGoOn;
}

Tracer::Next Tracer::jump(const ir::Jump& node, const source::Span&, const FlatProgram& program, std::size_t& at, std::vector<std::size_t>& calls) {
  const auto target = program.lines.find(static_cast<std::int64_t>(value(*node.label)));
  if (target == program.lines.end()) return Next::kEnd;
  if (node.kind == ir::JumpKind::kGosub) calls.push_back(at + 1);
  const bool back = target->second <= at;
  if (back && node.kind == ir::JumpKind::kGoto && repeats(program.steps[at], target->second, calls.size())) return over_ = true, Next::kEnd;
  at = target->second;
  return Next::kJumped;
}

Tracer::Next Tracer::perform(const FlatStep& step, const FlatProgram& program, std::size_t& at, std::vector<std::size_t>& calls) {
  const ir::Stmt& statement = *step.statement;
  if (step.relay) {
    if (relay(static_cast<std::int64_t>(value(*step.relay)), step.relay->span)) return Next::kGoOn;
    at = step.otherwise;
    return Next::kJumped;
  }
  if (const auto* action = std::get_if<ir::CardAction>(&statement.node)) return card(*action, step, calls);
  if (const auto* assign = std::get_if<ir::Assign>(&statement.node)) state_.parameters[std::get<ir::Variable>(assign->target->node).number] = value(*assign->values[0]);
  if (const auto* go = std::get_if<ir::Jump>(&statement.node)) return jump(*go, statement.span, program, at, calls);
  if (const auto* open = std::get_if<ir::OpenBuffer>(&statement.node)) stored_ = &unit_.buffers[open->buffer];
  if (std::holds_alternative<ir::Send>(statement.node)) leave_out(statement.span, "PRINT is not carried over");
  if (std::holds_alternative<ir::SystemCommand>(statement.node)) diagnostics_.error("ACR-E16", statement.span, "a fast move block is not carried over; write it as VEL, P28, P29 and MOV or CIRCLE");
  if (std::holds_alternative<ir::Stop>(statement.node)) return Next::kEnd;
  if (!std::holds_alternative<ir::Return>(statement.node)) return Next::kGoOn;
  at = calls.back();
  calls.pop_back();
  return Next::kJumped;
}

void Tracer::execute(const FlatProgram& program, std::size_t begin) {
  std::vector<std::size_t> calls;
  for (std::size_t at = begin; at < program.steps.size() && !over_;) {
    if (++steps_ > rules_.max_steps || trace_.motions.size() > rules_.max_motions)
      return over_ = true, void(diagnostics_.error("ACR-E16", program.steps[at].statement->span, "the program goes on for longer than a translation can follow"));
    switch (perform(program.steps[at], program, at, calls)) {
      case Next::kGoOn: ++at; break;
      case Next::kJumped: break;
      case Next::kEnd: return;
    }
  }
}

}  // namespace

CardTrace trace_card(const ir::Unit& unit, const TraceRules& rules, const std::vector<std::int64_t>& relays_set, source::Diagnostics& diagnostics) {
  return Tracer(unit, rules, diagnostics).run(relays_set);
}

}  // namespace pmac::compiler::translate
