// Lines of letter-number words: code letters, the words behind calls, read, the flags and canned cycles of CNC programs.
#include <fmt/format.h>

#include "compiler/bytecode/letters.h"
#include "compiler/frontend/power_pmac/lowering.h"

namespace pmac::compiler::power_pmac {

ir::LineWord Lowering::lower_line_word(P::LineWordContext* word) {
  ir::LineWord result{bytecode::letter_number(text_of(word->start)), lower_data(word->data(0)), nullptr, nullptr, span_of(word)};
  if (word->velocity) result.velocity = lower_data(word->velocity);
  if (word->trigger) result.trigger = lower_data(word->trigger);
  return result;
}

void Lowering::check_word_count(const std::vector<ir::LineWord>& words, source::Span span) {
  if (words.size() > bytecode::kMaxLineWords) diagnostics_.error("PM2051", span, fmt::format("a line has at most {} words", bytecode::kMaxLineWords));
}

void Lowering::lower_code_line(P::CodeLineContext* line, ir::Body& out) {
  ir::CodeLine result;
  const source::Span first = source::join(span_of(line->start), span_of(line->data()));
  result.words.push_back({bytecode::letter_number(text_of(line->start)), lower_data(line->data()), nullptr, nullptr, first});
  for (P::LineWordContext* word : line->lineWord()) result.words.push_back(lower_line_word(word));
  check_word_count(result.words, span_of(line));
  out.push_back(ir::make_stmt(span_of(line), std::move(result)));
}

ir::StmtPtr Lowering::with_words(ir::StmtPtr statement, const std::vector<P::LineWordContext*>& words) {
  if (words.empty()) return statement;
  const source::Span span = source::join(statement->span, span_of(words.back()));
  ir::CodeLine line;
  for (P::LineWordContext* word : words) line.words.push_back(lower_line_word(word));
  check_word_count(line.words, span);
  line.call = std::move(statement);
  return ir::make_stmt(span, std::move(line));
}

/// X1 Y2 L3: the words that are no axes are for a canned cycle.
ir::StmtPtr Lowering::lower_move_with_words(P::MoveContext* move) {
  ir::CodeLine line;
  for (P::MoveWordContext* word : move->moveWord()) {
    const auto add = [&](antlr4::ParserRuleContext* rule, P::DataContext* value) {
      line.words.push_back({bytecode::letter_number(text_of(rule->start)), lower_data(value), nullptr, nullptr, span_of(rule)});
    };
    if (auto* axis = word->axisWord()) {
      add(axis, axis->data(0));
      if (axis->velocity) line.words.back().velocity = lower_data(axis->velocity);
      if (axis->trigger) line.words.back().trigger = lower_data(axis->trigger);
    } else if (auto* vector = word->vectorWord()) {
      add(vector, vector->data());
    } else if (auto* radius = word->radiusWord()) {
      add(radius, radius->data());
    }
  }
  for (P::LineWordContext* word : move->lineWord()) line.words.push_back(lower_line_word(word));
  check_word_count(line.words, span_of(move));
  return ir::make_stmt(span_of(move), std::move(line));
}

ir::StmtPtr Lowering::lower_read(P::SimpleStatementContext* statement) {
  ir::ReadWords read;
  for (P::ReadLetterContext* letter : statement->readLetter()) {
    const std::string text = text_of(letter->start);
    const int number = bytecode::letter_number(text);
    const bool is_block_number = lower_case(text) == "n";
    if (number == 0 || is_block_number) {
      diagnostics_.error("PM3091", span_of(letter), fmt::format("'{}' cannot be read; read takes the letters A to Z and AA to ZZ, without N", text));
      continue;
    }
    read.letters |= std::uint64_t{1} << (number - 1);
  }
  return ir::make_stmt(span_of(statement), read);
}

/// False: another statement.
bool Lowering::lower_flags_and_cycles(P::SimpleStatementContext* statement, ir::Body& out) {
  const source::Span span = span_of(statement);
  P::DataContext* data = statement->data().empty() ? nullptr : statement->data(0);
  if (statement->CSET() || statement->CCLR()) {
    out.push_back(ir::make_stmt(span, ir::SetFlag{lower_data(data), statement->CSET() != nullptr}));
  } else if (statement->CEXEC() || statement->CSKIP()) {
    ir::LineCondition line{lower_data(data), statement->CSKIP() != nullptr, {}};
    lower_statements(statement->statement(), line.rest);
    out.push_back(ir::make_stmt(span, std::move(line)));
  } else if (statement->CDEF()) {
    out.push_back(with_words(ir::make_stmt(span, ir::Cycle{ir::CycleVerb::kDefine, lower_data(data)}), statement->lineWord()));
  } else if (statement->CUNDEF()) {
    out.push_back(ir::make_stmt(span, ir::Cycle{ir::CycleVerb::kUndefine, nullptr}));
  } else if (statement->CCALL() && data) {
    ir::Call call;
    call.name_span = span_of(data);
    call.number = lower_data(data);
    out.push_back(with_words(ir::make_stmt(span, std::move(call)), statement->lineWord()));
  } else if (statement->CCALL()) {
    out.push_back(with_words(ir::make_stmt(span, ir::Cycle{ir::CycleVerb::kCall, nullptr}), statement->lineWord()));
  } else {
    return false;
  }
  return true;
}

/// A rotary buffer executes while it is being filled: nothing in it can be jumped to. User's Manual p659-662.
void Lowering::check_rotary(P::StatementContext* statement) {
  const auto refuse = [&](antlr4::ParserRuleContext* where, std::string_view what) { diagnostics_.error("PM2052", span_of(where), fmt::format("a rotary buffer has no {}; put them into a subprogram and call that", what)); };
  if (auto* label = statement->label(); label && label->COLON()) refuse(label, "labels");
  if (auto* simple = statement->simpleStatement(); simple && (simple->GOTO() || simple->GOSUB() || simple->CALLSUB())) refuse(simple, "goto, gosub or callsub");
  if (auto* selection = statement->switchStatement()) refuse(selection, "switch");
  auto* branch = statement->ifStatement();
  const bool has_else = branch && branch->elsePart() && (branch->elsePart()->ELSE() || branch->elsePart()->ELSE_IF());
  if (has_else) refuse(branch, "else");
  const bool is_conditional = branch || statement->whileStatement() || statement->doStatement();
  const bool one_line = !statement->start || !statement->stop || statement->start->getLine() == statement->stop->getLine();
  if (is_conditional && !one_line) diagnostics_.error("PM2052", span_of(statement->start), "in a rotary buffer an if or while stands on one line with what it governs");
}

}  // namespace pmac::compiler::power_pmac
