// Statements that act on programs, motors and coordinate systems; most are on-line commands too.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>

#include "compiler/bytecode/control.h"
#include "compiler/frontend/power_pmac/lowering.h"

namespace pmac::compiler::power_pmac {
namespace {

using ir::ControlVerb;
using P = grammar::PowerPmacParser;

constexpr std::int64_t kMaxListed = 1000;

ControlVerb verb_of(std::size_t token, bool plc) {
  switch (token) {
    case P::ENABLE: return plc ? ControlVerb::kEnablePlc : ControlVerb::kEnable;
    case P::DISABLE: return plc ? ControlVerb::kDisablePlc : ControlVerb::kDisable;
    case P::PAUSE: return plc ? ControlVerb::kPausePlc : ControlVerb::kPause;
    case P::RESUME: return plc ? ControlVerb::kResumePlc : ControlVerb::kResume;
    case P::STEP: return plc ? ControlVerb::kStepPlc : ControlVerb::kStep;
    case P::ADISABLE: return ControlVerb::kAbortDisable;
    case P::DDISABLE: return ControlVerb::kDelayedDisable;
    case P::HOLD: return ControlVerb::kHold;
    case P::RUN: return ControlVerb::kRun;
    case P::HOME: return ControlVerb::kHome;
    case P::HOMEZ: return ControlVerb::kHomeZero;
    case P::KILL: return ControlVerb::kKill;
    case P::DKILL: return ControlVerb::kDelayedKill;
    default: return ControlVerb::kAbort;
  }
}

bool acts_on_motors(ControlVerb verb) {
  return verb == ControlVerb::kHome || verb == ControlVerb::kHomeZero || verb == ControlVerb::kKill || verb == ControlVerb::kDelayedKill;
}

bool is_hex(char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }

/// The character that stands at `at` behind a backslash, as in C; at moves to its last digit where it has several.
char escaped_character(std::string_view text, std::size_t& at) {
  constexpr std::string_view kLetters = "abfnrtv", kCharacters = "\a\b\f\n\r\t\v";
  const char c = text[at];
  if (const std::size_t letter = kLetters.find(c); letter != std::string_view::npos) return kCharacters[letter];
  const bool octal = c >= '0' && c <= '7';
  if (!octal && !(c == 'x' && is_hex(text[at + 1]))) return c;
  const int base = octal ? 8 : 16;
  const std::size_t first = octal ? at : at + 1;
  std::size_t end = first;
  while (end < first + (octal ? 3 : 2) && (octal ? text[end] >= '0' && text[end] <= '7' : is_hex(text[end]))) ++end;
  int value = 0;
  std::from_chars(text.data() + first, text.data() + end, value, base);
  at = end - 1;
  return static_cast<char>(value);
}

}  // namespace

std::string Lowering::string_value(const antlr4::Token& token) const {
  const std::string_view text = tree_.text_of(token);
  std::string value;
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    if (text[i] != '\\' || i + 2 >= text.size()) { value += text[i]; continue; }
    value += escaped_character(text, ++i);
  }
  return value;
}

void Lowering::add_control(ControlVerb verb, source::Span span, std::vector<ir::ExprPtr> arguments, ir::Body& out) {
  out.push_back(ir::make_stmt(span, ir::Control{verb, std::move(arguments)}));
}

/// The numbers of a range such as 1..3.
void Lowering::append_range(antlr4::Token* from, antlr4::Token* to, source::Span span, std::vector<ir::ExprPtr>& numbers) {
  const auto first = whole_number(from, kMaxListed);
  const auto last = whole_number(to, kMaxListed);
  if (first && last && *first > *last) diagnostics_.error("PM3005", span, "a range goes from the lower to the higher number");
  for (std::int64_t n = first.value_or(0); first && last && n <= *last; ++n) numbers.push_back(ir::make_number(static_cast<double>(n), span));
}

/// One expression for each number of a list such as 1..3,7; a null one where there is no list.
std::vector<ir::ExprPtr> Lowering::lower_number_list(P::NumberListContext* list) {
  std::vector<ir::ExprPtr> numbers;
  if (!list) {
    numbers.push_back(nullptr);
    return numbers;
  }
  for (P::NumberItemContext* item : list->numberItem()) {
    if (item->expression()) {
      numbers.push_back(lower_expression(item->expression()));
      numbers.back()->span = span_of(item);  // with its parentheses
    } else if (item->NAME()) numbers.push_back(std::make_unique<ir::Expr>(ir::Expr{span_of(item), ir::NameUse{text_of(token_of(item->NAME())), false, {}}}));
    else if (item->STAR()) numbers.push_back(ir::make_number(std::numeric_limits<double>::infinity(), span_of(item)));
    else if (item->NUMBER().size() == 1) numbers.push_back(lower_number(token_of(item->NUMBER(0))));
    else if (item->NUMBER().size() == 2) append_range(token_of(item->NUMBER(0)), token_of(item->NUMBER(1)), span_of(item), numbers);
  }
  return numbers;
}

std::vector<ir::ExprPtr> Lowering::lower_plc_list(P::PlcListContext* list) {
  std::vector<ir::ExprPtr> numbers;
  for (P::PlcItemContext* item : list->plcItem()) {
    const source::Span span = span_of(item);
    if (item->NAME()) numbers.push_back(lower_program_named(token_of(item->NAME())));
    else if (item->STAR()) numbers.push_back(ir::make_number(std::numeric_limits<double>::infinity(), span));
    else if (item->expression()) numbers.push_back(lower_expression(item->expression()));
    else if (item->NUMBER().size() == 1) numbers.push_back(lower_number(token_of(item->NUMBER(0))));
    else if (item->NUMBER().size() == 2) append_range(token_of(item->NUMBER(0)), token_of(item->NUMBER(1)), span, numbers);
  }
  return numbers;
}

ir::ExprPtr Lowering::lower_program_name(P::ProgramNameContext* name) {
  if (!name) return nullptr;
  return name->NUMBER() ? lower_number(token_of(name->NUMBER())) : lower_program_named(token_of(name->NAME()));
}

ir::ExprPtr Lowering::lower_program_named(antlr4::Token* name) {
  return std::make_unique<ir::Expr>(ir::Expr{span_of(name), ir::NameUse{text_of(name), false, {}}});
}

void Lowering::lower_program_control(P::ProgramControlContext* control, ir::Body& out) {
  const source::Span span = span_of(control);
  if (control->JOG()) return lower_jog(control->jogAction(), span, out);
  if (control->BEGIN() || control->START()) return lower_start(control, out);
  if (control->CMD() || control->SEND()) return lower_text_out(control, out);
  if (control->SENDALLCMDS()) return add_control(ControlVerb::kSendAllCommands, span, {}, out);
  ControlVerb verb = ControlVerb::kPmatch;
  if (control->LH()) {
    const std::string direction = text_of(control->direction);
    verb = direction == "<" ? ControlVerb::kRetrace : direction == ">" ? ControlVerb::kForward : ControlVerb::kQuickStop;
  } else if (control->JOGRET()) {
    verb = control->data() ? ControlVerb::kJogToAndKeep : ControlVerb::kJogReturn;
  } else if (control->kind) {
    verb = verb_of(control->kind->getType(), control->PLC() != nullptr);
  }
  std::vector<ir::ExprPtr> numbers;
  if (control->plcList()) numbers = lower_plc_list(control->plcList());
  else if (!control->numberList() && online_) numbers = acts_on_motors(verb) ? addressed_motors(span) : addressed_coords(span);
  else numbers = lower_number_list(control->numberList());
  for (ir::ExprPtr& number : numbers) {
    const bool more_homes = verb == ControlVerb::kHome && &number != &numbers.back();
    std::vector<ir::ExprPtr> arguments;
    arguments.push_back(std::move(number));
    if (control->data()) arguments.push_back(lower_data(control->data()));
    add_control(more_homes ? ControlVerb::kHomeAlso : verb, span, std::move(arguments), out);
  }
}

/// cmd "&1 b%dr", n and send1 "%f", value.
void Lowering::lower_text_out(P::ProgramControlContext* control, ir::Body& out) {
  if (!control->STRING()) return;
  std::string text = string_value(*control->STRING()->getSymbol());
  std::vector<ir::ExprPtr> values;
  for (P::ArgumentContext* argument : control->argument()) values.push_back(lower_argument(argument));
  const source::Span span = span_of(control);
  if (control->CMD()) return out.push_back(ir::make_stmt(span, ir::Command{std::move(text), std::move(values)}));
  const auto port = control->NUMBER() ? whole_number(token_of(control->NUMBER()), 7).value_or(0) : 0;
  out.push_back(ir::make_stmt(span, ir::Send{static_cast<int>(port), std::move(text), std::move(values)}));
}

/// The coordinate systems that an item of begin or start names: 3 in start3:500, 1 to 3 in start1..3:500. None: the addressed ones.
std::vector<ir::ExprPtr> Lowering::started_coords(P::StartItemContext* item) {
  std::vector<ir::ExprPtr> coords;
  if (item->NUMBER().size() == 2) append_range(token_of(item->NUMBER(0)), token_of(item->NUMBER(1)), span_of(item), coords);
  else if (item->NUMBER().size() == 1) coords.push_back(lower_number(token_of(item->NUMBER(0))));
  else if (online_) coords = addressed_coords(span_of(item));
  else coords.push_back(nullptr);
  return coords;
}

/// begin1:500, begin:500, start1,2:500, start3:500,4:501; on line also start500 and startMain.
void Lowering::lower_start(P::ProgramControlContext* control, ir::Body& out) {
  const ControlVerb verb = control->BEGIN() ? ControlVerb::kBegin : ControlVerb::kStart;
  const auto items = control->startItem();
  const bool number_is_program = online_ && items.size() == 1 && items[0]->NUMBER().size() == 1 && !items[0]->programName();
  std::vector<ir::ExprPtr> coords;   // that wait for their program
  for (P::StartItemContext* item : items) {
    const source::Span span = span_of(item);
    if (number_is_program || item->NAME()) coords = online_ ? addressed_coords(span) : std::vector<ir::ExprPtr>();
    else for (ir::ExprPtr& coord : started_coords(item)) coords.push_back(std::move(coord));
    if (item->NAME() && coords.empty()) coords.push_back(nullptr);
    const bool has_program = number_is_program || item->NAME() || item->programName();
    if (!has_program) continue;
    for (ir::ExprPtr& coord : coords) {
      std::vector<ir::ExprPtr> arguments;
      arguments.push_back(std::move(coord));
      arguments.push_back(number_is_program ? lower_number(token_of(item->NUMBER(0))) : item->NAME() ? lower_program_named(token_of(item->NAME())) : lower_program_name(item->programName()));
      add_control(verb, source::join(span_of(control->start), span), std::move(arguments), out);
    }
    coords.clear();
  }
  if (coords.empty() || items.empty()) return;
  const std::string word = lower_case(text_of(control->start));
  diagnostics_.error("PM3006", span_of(items.back()), fmt::format("{} needs the program too, as in {}1:500 or {}1,2:500", word, word, word));
}

void Lowering::lower_jog(P::JogActionContext* jog, source::Span span, ir::Body& out) {
  if (!jog) return;
  add_jogs({text_of(jog->operation), jog->jogDistance(), jog->trigger, span}, lower_number_list(jog->numberList()), out);
}

/// The verb of a jog; nullopt, and an error: there is none with these parts.
std::optional<ControlVerb> Lowering::jog_verb(const Jog& jog) {
  struct Row { std::string_view operation; ControlVerb plain, until_trigger; };
  constexpr auto kNone = ControlVerb::kCount;
  constexpr Row kRows[] = {{"+", ControlVerb::kJogPlus, kNone}, {"-", ControlVerb::kJogMinus, kNone}, {"/", ControlVerb::kJogStop, kNone},
                           {"=", ControlVerb::kJogTo, ControlVerb::kJogToTrigger}, {"==", ControlVerb::kJogToAndKeep, kNone},
                           {":", ControlVerb::kJogBy, ControlVerb::kJogByTrigger}, {"^", ControlVerb::kJogByActual, ControlVerb::kJogByActualTrigger}};
  for (const Row& row : kRows) {
    if (row.operation != jog.operation) continue;
    if (!jog.trigger) return row.plain;
    if (row.until_trigger != kNone) return row.until_trigger;
  }
  diagnostics_.error("PM3013", jog.span, "a jog until trigger is j={position}^{distance}, j:{distance}^{distance} or j^{distance}^{distance}");
  return std::nullopt;
}

/// One jog for each motor of a list, on line and in programs.
void Lowering::add_jogs(const Jog& jog, std::vector<ir::ExprPtr> motors, ir::Body& out) {
  const std::optional<ControlVerb> verb = jog_verb(jog);
  if (!verb) return;
  for (ir::ExprPtr& motor : motors) {
    std::vector<ir::ExprPtr> arguments;
    arguments.push_back(std::move(motor));
    if (jog.distance) arguments.push_back(jog.distance->data() ? lower_data(jog.distance->data()) : nullptr);
    if (jog.trigger) arguments.push_back(lower_data(jog.trigger));
    add_control(*verb, jog.span, std::move(arguments), out);
  }
}

void Lowering::lower_pset(P::SimpleStatementContext* statement, ir::Body& out) {
  const auto axes = statement->PSET_AXIS();
  const auto values = statement->data();
  for (std::size_t i = 0; i < std::min(axes.size(), values.size()); ++i) {
    const source::Span span = source::join(span_of(token_of(axes[i])), span_of(values[i]));
    std::vector<ir::ExprPtr> arguments;
    arguments.push_back(ir::make_number(axis_index(token_of(axes[i])), span));
    arguments.push_back(lower_data(values[i]));
    add_control(ControlVerb::kPset, span, std::move(arguments), out);
  }
}

}  // namespace pmac::compiler::power_pmac
