#include "compiler/style/structure.h"

#include <fmt/format.h>

namespace pmac::style {
namespace {

constexpr std::size_t kMaxFrames = 1000;
constexpr std::size_t kMaxParentheses = 1000;
constexpr std::size_t kMaxProblems = 20;

bool is_turbo_word(std::string_view word) { return word == "endif" || word == "endwhile" || word == "endi" || word == "endw"; }

}  // namespace

// --- levels -------------------------------------------------------------------------------------------------------------------

/// Number of frames that are left when the next word is a plain statement: an if that waits for its else then has none.
std::size_t Structure::settled_size() const {
  std::size_t size = frames_.size();
  bool completed = false;
  for (; size > 0; --size) {
    const Frame& frame = frames_[size - 1];
    const bool ends = is_done(frame) || (completed && frame.kind != Kind::kBrace && frame.stage == Stage::kBody);
    if (!ends) break;
    completed = true;
  }
  return size;
}

int Structure::level_above(std::size_t size) const {
  if (size == 0) return in_open_ && indent_buffers_ ? 1 : 0;
  const Frame& frame = frames_[size - 1];
  return frame.level + 1 + (frame.kind == Kind::kBrace && frame.in_case ? 1 : 0);
}

int Structure::level_of_line(const Piece& first) const {
  const std::string_view text = source_->of(first);
  if (first.kind == PieceKind::kKeyword) return level_of_keyword(lower_case(text));
  if (text == "}") return level_of_closing_brace();
  const std::size_t size = settled_size();
  const bool opens_body = text == "{" && size > 0 && frames_[size - 1].kind != Kind::kBrace;
  if (opens_body) return frames_[size - 1].level;
  if (size == 0 && is_label(first)) return 0;
  return level_above(size);
}

bool Structure::is_label(const Piece& first) const {
  const std::size_t colon = source_->text.find_first_not_of("0123456789 \t", first.end);
  return first.kind == PieceKind::kLetter && lower_case(source_->of(first)) == "n" && colon != std::string_view::npos && source_->text[colon] == ':';
}

int Structure::level_of_keyword(std::string_view keyword) const {
  if (keyword == "open" || keyword == "close") return 0;
  if (keyword == "else") {
    for (std::size_t i = frames_.size(); i > 0 && frames_[i - 1].kind != Kind::kBrace; --i)
      if (frames_[i - 1].kind == Kind::kIf && (frames_[i - 1].stage == Stage::kDone || in_statement_)) return frames_[i - 1].level;
  }
  if (keyword == "while" && waiting_do()) return waiting_do()->level;
  const std::size_t size = settled_size();
  const bool in_switch = size > 0 && frames_[size - 1].kind == Kind::kBrace && frames_[size - 1].is_switch;
  if (in_switch && (keyword == "case" || keyword == "default")) return frames_[size - 1].level + 1;
  if (keyword == "sub" && size == 0) return 0;
  return level_above(size);
}

/// The do whose body is complete, perhaps by the end of an if.
const Structure::Frame* Structure::waiting_do() const {
  std::size_t size = frames_.size();
  while (size > 0 && frames_[size - 1].kind == Kind::kIf && frames_[size - 1].stage == Stage::kDone) --size;
  const bool body_done = size > 0 && frames_[size - 1].kind == Kind::kDo && (size < frames_.size() || frames_[size - 1].stage == Stage::kAwaitsWhile);
  return body_done ? &frames_[size - 1] : nullptr;
}

int Structure::level_of_closing_brace() const {
  for (std::size_t i = frames_.size(); i > 0; --i)
    if (frames_[i - 1].kind == Kind::kBrace) return frames_[i - 1].level;
  return level_inside();
}

// --- words --------------------------------------------------------------------------------------------------------------------

void Structure::take(const Piece& word, Role role, const Statement& statement, int line_level) {
  check_parentheses(word, role);
  if (role == Role::kClose && statement.depth() <= 1) return end_header();
  if (statement.depth() > 0 && role != Role::kSemicolon && role != Role::kOpenBrace && role != Role::kCloseBrace) return;
  switch (role) {
    case Role::kKeyword: return take_keyword(word, lower_case(source_->of(word)), line_level);
    case Role::kOpenBrace: return open_brace(word, line_level);
    case Role::kCloseBrace: return close_brace(word);
    case Role::kSemicolon:
      if (in_statement_ || (top() && top()->kind != Kind::kBrace && top()->stage == Stage::kBody)) complete_statement();
      return;
    case Role::kOpen: if (top() && top()->stage == Stage::kHeader && top()->kind != Kind::kBrace) return; break;
    case Role::kLabelColon: in_statement_ = false; return;
    default: break;
  }
  take_plain();
  if (word.kind == PieceKind::kName && is_turbo_word(lower_case(source_->of(word))) && !source_->names.contains(source_->of(word)))
    report(word, "PM2008", fmt::format("'{}' is a word of Turbo PMAC; Power PMAC closes what if and while carry with }}", source_->of(word)));
}

void Structure::take_keyword(const Piece& word, std::string_view keyword, int line_level) {
  if (keyword == "if") return take_control(word, Kind::kIf, line_level);
  if (keyword == "while") return take_while_of_do() ? void() : take_control(word, Kind::kWhile, line_level);
  if (keyword == "do") return take_control(word, Kind::kDo, line_level);
  if (keyword == "switch") return take_control(word, Kind::kSwitch, line_level);
  if (keyword == "else") return take_else(word, line_level);
  if (keyword == "case" || keyword == "default") return take_case();
  if (keyword == "open" || keyword == "close") {
    take_close(word);
    in_open_ = keyword == "open";
    return;
  }
  take_plain();
}

void Structure::take_plain() {
  if (in_statement_) return;
  settle();
  in_statement_ = true;
}

void Structure::take_control(const Piece& word, Kind kind, int line_level) {
  if (in_statement_) complete_statement();
  settle();
  push({kind, kind == Kind::kDo ? Stage::kBody : Stage::kHeader, false, false, line_level, word});
}

void Structure::take_else(const Piece& word, int line_level) {
  if (in_statement_) complete_statement();
  const bool belongs_to_if = top() && top()->kind == Kind::kIf && top()->stage == Stage::kDone;
  if (belongs_to_if) {
    line_level = top()->level;
    frames_.pop_back();
  }
  push({Kind::kElse, Stage::kBody, false, false, line_level, word});
}

/// The while behind the body of a do is the end of it, not another loop.
bool Structure::take_while_of_do() {
  if (in_statement_) complete_statement();
  while (top() && top()->kind == Kind::kIf && top()->stage == Stage::kDone) {
    frames_.pop_back();
    complete_statement();
  }
  if (!top() || top()->stage != Stage::kAwaitsWhile) return false;
  top()->stage = Stage::kHeader;
  return true;
}

void Structure::take_case() {
  if (in_statement_) complete_statement();
  settle();
  if (top() && top()->kind == Kind::kBrace && top()->is_switch) top()->in_case = true;
}

void Structure::take_close(const Piece& word) {
  for (const Frame& frame : frames_)
    if (frame.kind == Kind::kBrace) {
      report(word, "PM2007", fmt::format("missing }} before '{}'", source_->of(word)));
      break;
    }
  frames_.clear();
  in_statement_ = false;
}

void Structure::open_brace(const Piece& word, int line_level) {
  if (in_statement_) complete_statement();
  if (!top() || top()->kind == Kind::kBrace || is_done(*top())) settle();
  const bool is_body = top() && top()->kind != Kind::kBrace;
  const bool is_switch = is_body && top()->kind == Kind::kSwitch;
  if (is_body) {
    top()->stage = Stage::kBody;
    line_level = top()->level;
  }
  push({Kind::kBrace, Stage::kBody, is_switch, false, line_level, word});
}

void Structure::close_brace(const Piece& word) {
  while (top() && top()->kind != Kind::kBrace) frames_.pop_back();
  if (!top()) return report(word, "PM2003", "this } closes nothing; remove it, or add the missing {");
  frames_.pop_back();
  complete_statement();
}

/// The parentheses behind if, while or switch are closed.
void Structure::end_header() {
  if (!top() || top()->kind == Kind::kBrace || top()->stage != Stage::kHeader) return;
  if (top()->kind != Kind::kDo) top()->stage = Stage::kBody;
  else {
    frames_.pop_back();
    complete_statement();
  }
}

/// A statement is complete, and with it those that carry it: up to one that may go on with else or while.
void Structure::complete_statement() {
  in_statement_ = false;
  while (top() && top()->kind != Kind::kBrace && top()->stage == Stage::kBody) {
    if (top()->kind == Kind::kIf) { top()->stage = Stage::kDone; return; }
    if (top()->kind == Kind::kDo) { top()->stage = Stage::kAwaitsWhile; return; }
    frames_.pop_back();
  }
}

void Structure::settle() {
  while (top() && is_done(*top())) {
    frames_.pop_back();
    complete_statement();
  }
}

void Structure::end_line() {
  if (in_statement_) complete_statement();
}

void Structure::end_text() {
  if (!parentheses_.empty()) report(parentheses_.back(), "PM2002", fmt::format("this {} is never closed", source_->of(parentheses_.back())));
  for (const Frame& frame : frames_)
    if (frame.kind == Kind::kBrace) return report(frame.word, "PM2007", "this { is never closed; add }");
}

// --- problems -------------------------------------------------------------------------------------------------------------------

void Structure::push(Frame frame) {
  if (frames_.size() == kMaxFrames) report(frame.word, "PM2010", "blocks are nested too deep");
  if (frames_.size() < kMaxFrames) frames_.push_back(frame);
}

void Structure::check_parentheses(const Piece& word, Role role) {
  const bool ends_statement = role == Role::kSemicolon || role == Role::kOpenBrace || role == Role::kCloseBrace;
  if (role == Role::kOpen || role == Role::kOpenBracket) {
    if (parentheses_.size() == kMaxParentheses) report(word, "PM2010", "parentheses are nested too deep");
    else parentheses_.push_back(word);
  }
  else if (role == Role::kClose && parentheses_.empty()) report(word, "PM2001", fmt::format("this {} closes nothing", source_->of(word)));
  else if (role == Role::kClose) parentheses_.pop_back();
  else if (ends_statement && !parentheses_.empty()) {
    report(parentheses_.back(), "PM2002", fmt::format("this {} is not closed before '{}'", source_->of(parentheses_.back()), source_->of(word)));
    parentheses_.clear();
  }
}

void Structure::report(const Piece& piece, std::string code, std::string message) {
  if (problems_->size() < kMaxProblems) problems_->push_back({piece.begin, piece.end - piece.begin, std::move(code), std::move(message)});
}

}  // namespace pmac::style
