#include "compiler/frontend/power_pmac/turbo_blocks.h"

#include <fmt/format.h>

#include <algorithm>

namespace pmac::compiler::power_pmac {
namespace {

using T = grammar::PowerPmacParser;

constexpr std::size_t kMostOpen = 1000;  // more will be refused as nested too deep

source::Span end_of(source::Span span) {
  span.begin = span.end;
  return span;
}

source::Span begin_of(source::Span span) {
  span.end = span.begin;
  return span;
}

}  // namespace

bool TurboBlocks::is_word(std::size_t i, std::initializer_list<const char*> words) const {
  if (tokens_.type(i) != T::NAME || names_.contains(tokens_.exact_text(i))) return false;
  const std::string word = tokens_.text(i);
  return std::any_of(words.begin(), words.end(), [&](const char* other) { return word == other; });
}

/// END IF, in two words.
bool TurboBlocks::is_split_end(std::size_t i) const {
  const std::size_t next = tokens_.type(i + 1);
  return is_word(i, {"end"}) && !tokens_.starts_line(i + 1) && (next == T::IF || next == T::WHILE) && tokens_.type(i + 2) != T::LEFT;
}

void TurboBlocks::take(std::size_t i) {
  end_single_lines(i);
  if (is_split_end(i)) {
    const bool is_loop = tokens_.type(i + 1) == T::WHILE;
    take_end(i, i + 1, is_loop);
    return tokens_.drop(i + 1, i + 1);
  }
  switch (tokens_.type(i)) {
    case T::OPEN: return take_buffer_begin(i);
    case T::CLOSE: return open_.clear();
    case T::LEFT_BRACE: return open_.push_back({});
    case T::RIGHT_BRACE: return leave_braces();
    case T::IF: case T::WHILE: return take_header(i);
    case T::ELSE: return take_else(i);
    default: break;
  }
  if (is_word(i, {"endif", "endi", "end_if"})) take_end(i, i, false);
  else if (is_word(i, {"endwhile", "endw", "end_while"})) take_end(i, i, true);
}

void TurboBlocks::take_buffer_begin(std::size_t i) {
  open_.clear();
  has_ends_ = false;
  for (std::size_t at = i + 1; at < tokens_.size() && tokens_.type(at) != T::CLOSE && tokens_.type(at) != T::OPEN && !has_ends_; ++at)
    has_ends_ = is_word(at, {"endif", "endi", "end_if", "endwhile", "endw", "end_while"}) || is_split_end(at);
}

void TurboBlocks::leave_braces() {
  while (!open_.empty() && open_.back().begin != TokenList::kNone) open_.pop_back();
  if (!open_.empty()) open_.pop_back();
}

/// A condition with its statement on the same line needs no ENDIF: it is over with the line, unless ELSE goes on.
void TurboBlocks::end_single_lines(std::size_t i) {
  if (!tokens_.starts_line(i) || tokens_.type(i) == T::ELSE) return;
  const auto is_over = [&](const Header& header) {
    return header.begin != TokenList::kNone && header.last + 1 < i && tokens_.line(header.last + 1) == tokens_.line(header.last) && header.elses.empty();
  };
  while (!open_.empty() && is_over(open_.back())) open_.pop_back();
}

void TurboBlocks::take_header(std::size_t i) {
  if (tokens_.type(i + 1) != T::LEFT) return;
  const std::size_t right = tokens_.closing_parenthesis(i + 1);
  if (right == TokenList::kNone) return;
  take_condition(i + 1, right);
  const std::size_t last = join_conditions(i + 1, right);
  const bool is_loop = tokens_.type(i) == T::WHILE;
  if (is_loop && is_word(last + 1, {"wait"})) {
    auto* error = tokens_.error("PM2021", tokens_.span(last + 1), "WAIT is Turbo PMAC; an empty block waits: while (...) {}");
    if (error) error->fix = source::FixIt{tokens_.span(last + 1), "{}"};
    tokens_.retype(last + 1, T::LEFT_BRACE);
    tokens_.insert_behind(last + 1, T::RIGHT_BRACE);
    return;
  }
  const std::size_t next = tokens_.type(last + 1);
  if (has_ends_ && open_.size() < kMostOpen && next != T::LEFT_BRACE && next != T::SEMICOLON) open_.push_back({is_loop, i, last, {}});
}

/// Inside of one pair of parentheses: = compares, AND and OR join. Returns the closing one.
std::size_t TurboBlocks::take_condition(std::size_t left, std::size_t right) {
  for (std::size_t i = std::max(left + 1, conditions_end_); i < right; ++i) {
    if (tokens_.type(i) == T::ASSIGN) {
      auto* error = tokens_.error("PM2011", tokens_.span(i), "a condition compares with ==; a single = assigns");
      if (error) error->fix = source::FixIt{tokens_.span(i), "=="};
      tokens_.retype(i, T::SYNC_ASSIGN);
    } else if (is_word(i, {"and", "or"})) {
      source::Diagnostic* error = nullptr;
      take_logic_word(i, &error);
    }
  }
  conditions_end_ = std::max(conditions_end_, right);
  return right;
}

void TurboBlocks::take_logic_word(std::size_t i, source::Diagnostic** error) {
  const char* power = tokens_.text(i) == "and" ? "&&" : "||";
  *error = tokens_.error("PM2022", tokens_.span(i), fmt::format("{} is Turbo PMAC; conditions are joined by {}", tokens_.exact_text(i), power));
  if (*error) (*error)->fix = source::FixIt{tokens_.span(i), power};
  tokens_.retype(i, literal_type(power));
}

/// (a) AND (b), also with AND on the next line: one more pair of parentheses goes round all. Returns the last closing one.
std::size_t TurboBlocks::join_conditions(std::size_t left, std::size_t right) {
  std::size_t last = right;
  std::vector<std::size_t> words;
  while (is_word(last + 1, {"and", "or"}) && tokens_.type(last + 2) == T::LEFT) {
    const std::size_t closing = tokens_.closing_parenthesis(last + 2);
    if (closing == TokenList::kNone) break;
    words.push_back(last + 1);
    last = take_condition(last + 2, closing);
  }
  for (std::size_t n = 0; n < words.size(); ++n) {
    source::Diagnostic* error = nullptr;
    take_logic_word(words[n], &error);
    if (!error || !error->fix || n > 0) continue;
    error->fix->also.push_back({begin_of(tokens_.span(left)), "("});
    error->fix->also.push_back({end_of(tokens_.span(last)), ")"});
  }
  if (!words.empty()) {
    tokens_.insert_before(left, T::LEFT);
    tokens_.insert_behind(last, T::RIGHT);
  }
  return last;
}

void TurboBlocks::take_else(std::size_t i) {
  if (!has_ends_) return;
  const auto header = std::find_if(open_.rbegin(), open_.rend(), [](const Header& h) { return h.begin == TokenList::kNone || !h.is_loop; });
  if (header == open_.rend() || header->begin == TokenList::kNone) return;
  if (tokens_.type(i + 1) == T::LEFT_BRACE) return;
  const bool single_line = !tokens_.starts_line(i + 1) && tokens_.type(i + 1) != T::IF;
  if (!single_line) return header->elses.push_back(i);
  close_before_else(*header, i);
  open_.erase(std::next(header).base(), open_.end());
}

/// ELSE with its statement on the same line is the end of a block without ENDIF.
void TurboBlocks::close_before_else(const Header& header, std::size_t i) {
  const bool was_block = tokens_.starts_line(header.last + 1);
  if (!was_block) return;
  auto* error = tokens_.error("PM2021", tokens_.span(i), "the lines before ELSE are a block of Turbo PMAC; it stands in braces: if (...) { ... } else ...");
  if (error) {
    error->fix = source::FixIt{tokens_.span(i), "} else"};
    error->fix->also.push_back({end_of(tokens_.span(header.last)), " {"});
  }
  tokens_.insert_behind(header.last, T::LEFT_BRACE);
  tokens_.insert_before(i, T::RIGHT_BRACE);
}

/// The end word stands from token i to last.
void TurboBlocks::take_end(std::size_t i, std::size_t last, bool is_loop) {
  const source::Span span = source::join(tokens_.span(i), tokens_.span(last));
  const std::string word = last > i ? tokens_.exact_text(i) + " " + tokens_.exact_text(last) : tokens_.exact_text(i);
  while (!open_.empty() && open_.back().begin != TokenList::kNone && open_.back().is_loop != is_loop) open_.pop_back();
  if (open_.empty() || open_.back().begin == TokenList::kNone) {
    tokens_.error("PM2021", span, fmt::format("{} is Turbo PMAC, and closes nothing here", word));
    return tokens_.drop(i, i);
  }
  const Header header = open_.back();
  open_.pop_back();
  auto* error = tokens_.error("PM2021", span, fmt::format("{} is Turbo PMAC; the block stands in braces: {} (...) {{ ... }}", word, is_loop ? "while" : "if"));
  if (error) {
    error->fix = source::FixIt{span, "}"};
    error->fix->also.push_back({end_of(tokens_.span(header.last)), " {"});
    for (const std::size_t at : header.elses) error->fix->also.push_back({tokens_.span(at), "} else {"});
  }
  tokens_.retype(i, T::RIGHT_BRACE);
  tokens_.insert_behind(header.last, T::LEFT_BRACE);
  for (const std::size_t at : header.elses) {
    tokens_.insert_before(at, T::RIGHT_BRACE);
    tokens_.insert_behind(at, T::LEFT_BRACE);
  }
}

}  // namespace pmac::compiler::power_pmac
