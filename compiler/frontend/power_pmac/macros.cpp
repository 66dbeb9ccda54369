#include "compiler/frontend/power_pmac/macros.h"

#include "compiler/frontend/power_pmac/plain_lines.h"
#include "compiler/frontend/power_pmac/plain_moves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace pmac::compiler::power_pmac {
namespace {

using Token = PreprocessorToken;
using Tokens = PreprocessorTokens;
using Kind = PreprocessorToken::Kind;

constexpr std::size_t kMaxOpenMacros = 200;         // expansions inside expansions
constexpr std::size_t kMaxProducedTokens = 200000;  // of one line
constexpr int kMaxArgumentDepth = 100;              // macro calls inside the arguments of macro calls

bool is_gap(const Token& token) { return token.kind == Kind::kBlank || token.kind == Kind::kNewline; }

/// ## stands at this place of a macro's body.
bool is_paste(const Tokens& body, std::size_t at) {
  return at + 1 < body.size() && body[at].text == "#" && body[at + 1].text == "#" && body[at].span.end == body[at + 1].span.begin;
}

Tokens trimmed(const Tokens& tokens) {
  const auto first = std::find_if_not(tokens.begin(), tokens.end(), is_gap);
  const auto last = std::find_if_not(tokens.rbegin(), std::make_reverse_iterator(first), is_gap).base();
  return {first, last};
}

}  // namespace

std::size_t skip_blanks(const Tokens& line, std::size_t at) {
  while (at < line.size() && is_gap(line[at])) ++at;
  return at;
}

// --- the table ---------------------------------------------------------------------------------------------------------------

void MacroTable::define(Macro macro) {
  const auto known = macros_.find(macro.name);
  const bool changed = known != macros_.end() && (known->second.body_text != macro.body_text || known->second.parameters != macro.parameters);
  if (changed) {
    auto& warning = diagnostics_.warning("PM1011", macro.name_span, fmt::format("macro '{}' is defined again with another text", macro.name));
    warning.notes.push_back({known->second.name_span, "the definition before is here"});
  }
  std::string name = macro.name;
  move_like_names_ = move_like_names_ || reads_as_move_word(name);
  line_like_names_ = line_like_names_ || reads_as_line_word(name);
  macros_.insert_or_assign(std::move(name), std::move(macro));
}

void MacroTable::undefine(std::string_view name) {
  if (const auto known = macros_.find(name); known != macros_.end()) macros_.erase(known);
}

bool MacroTable::is_defined(std::string_view name) const { return macros_.contains(name) || name == "__LINE__" || name == "__FILE__"; }

const Macro* MacroTable::find(std::string_view name) const {
  const auto known = macros_.find(name);
  return known == macros_.end() ? nullptr : &known->second;
}

/// The function-like macro that a name leads to, directly or as the last word of what it stands for.
const Macro* MacroTable::called_by(std::string_view name) const {
  constexpr int kMaxSteps = 20;
  const Macro* macro = find(name);
  for (int steps = 0; macro && !macro->function_like && steps < kMaxSteps; ++steps)
    macro = macro->body.empty() || macro->body.back().kind != Kind::kIdentifier ? nullptr : find(macro->body.back().text);
  return macro && macro->function_like ? macro : nullptr;
}

bool MacroTable::needs_next_line(const Tokens& line) const {
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i].kind != Kind::kIdentifier) continue;
    const std::size_t open = skip_blanks(line, i + 1);
    const bool calls = open < line.size() && line[open].text == "(" && called_by(line[i].text);
    if (!calls) continue;
    int depth = 0;
    std::size_t at = open;
    for (; at < line.size(); ++at) {
      depth += line[at].text == "(" ? 1 : line[at].text == ")" ? -1 : 0;
      if (depth == 0) break;
    }
    if (at == line.size()) return true;
    i = at;
  }
  return false;
}

// --- expansion ---------------------------------------------------------------------------------------------------------------

Tokens MacroTable::expand(const Tokens& line) {
  const bool plain = std::none_of(line.begin(), line.end(), [&](const Token& token) { return token.kind == Kind::kIdentifier && is_defined(token.text); });
  if (plain) return line;
  texts_.clear();
  produced_ = 0;
  Tokens out;
  expand_list(line, out);
  return out;
}

void MacroTable::expand_list(Tokens tokens, Tokens& out) {
  const std::size_t base = lists_.size();
  lists_.push_back({std::move(tokens), 0, nullptr});
  while (auto token = take(base)) {
    const Macro* macro = token->kind == Kind::kIdentifier && !token->locked ? find(token->text) : nullptr;
    if (macro && macro->open > 0) {
      token->locked = true;
    } else if (macro && produced_ <= kMaxProducedTokens) {
      if (lists_.size() - base > kMaxOpenMacros) too_much(*token, macro->name);
      else if (expand_name(*token, *macro, base, out)) continue;
    } else if (!macro && token->kind == Kind::kIdentifier && token->text.starts_with("__")) {
      out.push_back(built_in(*token));
      continue;
    }
    out.push_back(*token);
  }
}

/// The next token of the lists above base; used-up lists go, and their macros may expand again.
std::optional<Token> MacroTable::take(std::size_t base) {
  while (lists_.size() > base) {
    List& top = lists_.back();
    if (top.at < top.tokens.size()) return top.tokens[top.at++];
    if (top.macro) --top.macro->open;
    lists_.pop_back();
  }
  return std::nullopt;
}

bool MacroTable::parenthesis_follows(std::size_t base) const {
  for (std::size_t i = lists_.size(); i > base; --i) {
    const List& list = lists_[i - 1];
    const std::size_t at = skip_blanks(list.tokens, list.at);
    if (at < list.tokens.size()) return list.tokens[at].text == "(";
  }
  return false;
}

/// False where the name is no call: it stays as it is.
bool MacroTable::expand_name(const Token& name, const Macro& macro, std::size_t base, Tokens& out) {
  Call call{{}, name.span};
  if (macro.function_like) {
    if (!parenthesis_follows(base)) return false;
    auto read = read_call(name, macro, base, out);
    if (!read) return true;
    call = std::move(*read);
  }
  Tokens result = substitute(macro, call);
  if (produced_ > kMaxProducedTokens) {
    too_much(name, macro.name);
    return true;
  }
  ++macro.open;
  lists_.push_back({std::move(result), 0, &macro});
  return true;
}

/// Arguments of a call, the tokens between parentheses and commas. nullopt: reported, and what was read is in out.
std::optional<MacroTable::Call> MacroTable::read_call(const Token& name, const Macro& macro, std::size_t base, Tokens& out) {
  Call call{{Tokens()}, name.span};
  Tokens read{name};
  int depth = 0;
  for (bool closed = false; !closed;) {
    const auto token = take(base);
    if (!token) break;
    read.push_back(*token);
    const std::string_view text = token->text;
    if (text == ")" && --depth == 0) {
      closed = true;
    } else if (text == "," && depth == 1) {
      call.arguments.emplace_back();
    } else if (depth > 0) {
      call.arguments.back().push_back(*token);
      if (token->kind == Kind::kNewline) call.arguments.back().back() = {Kind::kBlank, " ", token->span};
    }
    if (text == "(") ++depth;
  }
  separate_variadic(macro, call.arguments);
  const std::size_t wanted = std::max<std::size_t>(1, macro.parameters.size());
  if (depth > 0 || call.arguments.size() != wanted) {
    const std::string problem = depth > 0 ? fmt::format("the call of macro '{}' is not closed; add )", macro.name)
                                          : fmt::format("macro '{}' takes {} argument(s)", macro.name, macro.parameters.size());
    diagnostics_.error("PM1013", name.span, problem).notes.push_back({macro.name_span, "defined here"});
  } else if (argument_depth_ >= kMaxArgumentDepth) {
    diagnostics_.error("PM1012", name.span, fmt::format("calls of macro '{}' are nested too deep in their arguments", macro.name));
    produced_ = kMaxProducedTokens + 1;
  } else {
    const Token& close = read.back();
    if (name.span.expansion < 0 && close.span.expansion < 0) call.use = source::join(name.span, close.span);
    return call;
  }
  out.insert(out.end(), read.begin(), read.end());
  return std::nullopt;
}

/// What is given for ... is one argument, with its commas.
void MacroTable::separate_variadic(const Macro& macro, std::vector<Tokens>& arguments) const {
  if (!macro.variadic) return;
  if (arguments.size() + 1 == macro.parameters.size()) arguments.emplace_back();
  while (arguments.size() > macro.parameters.size()) {
    Tokens last = std::move(arguments.back());
    arguments.pop_back();
    Tokens& joined = arguments.back();
    const source::Span place = last.empty() ? source::Span{} : last.front().span;
    joined.push_back({Kind::kOther, ",", place});
    joined.insert(joined.end(), last.begin(), last.end());
  }
}

const Tokens* MacroTable::argument_of(const Macro& macro, const Token& token, const std::vector<Tokens>& arguments) const {
  if (token.kind != Kind::kIdentifier || arguments.empty()) return nullptr;
  const auto parameter = std::find(macro.parameters.begin(), macro.parameters.end(), token.text);
  return parameter == macro.parameters.end() ? nullptr : &arguments[static_cast<std::size_t>(parameter - macro.parameters.begin())];
}

/// The body with arguments in place, between blanks: what stands next to it stays a token of its own.
Tokens MacroTable::substitute(const Macro& macro, const Call& call) {
  std::vector<std::optional<Tokens>> expanded(call.arguments.size());
  const Token blank{Kind::kBlank, " ", call.use};
  Tokens result{blank};
  const Tokens& body = macro.body;
  for (std::size_t i = 0; i < body.size() && produced_ <= kMaxProducedTokens; ++i) {
    const std::size_t next = skip_blanks(body, i + 1);
    const Tokens* argument = argument_of(macro, body[i], call.arguments);
    const bool stringized = macro.function_like && body[i].text == "#" && next < body.size() && argument_of(macro, body[next], call.arguments);
    if (is_paste(body, i)) {
      const std::size_t operand = skip_blanks(body, i + 2);
      Tokens right;
      if (operand < body.size()) {
        const Tokens* raw = argument_of(macro, body[operand], call.arguments);
        if (raw) right = trimmed(*raw);
        else append_body_token(macro, operand, call, right);
      }
      paste(right, result, call.use);
      i = std::max(operand, i + 1);
    } else if (stringized) {
      result.push_back(text_of(trimmed(*argument_of(macro, body[next], call.arguments)), call.use));
      i = next;
    } else if (argument && is_paste(body, next)) {
      const Tokens raw = trimmed(*argument);
      if (raw.empty()) result.push_back(blank);
      result.insert(result.end(), raw.begin(), raw.end());
      produced_ += raw.size();
    } else if (argument) {
      auto& whole = expanded[static_cast<std::size_t>(argument - call.arguments.data())];
      if (!whole) {
        ++argument_depth_;
        expand_list(*argument, whole.emplace());
        --argument_depth_;
      }
      produced_ += whole->size();
      if (produced_ <= kMaxProducedTokens) result.insert(result.end(), whole->begin(), whole->end());
    } else {
      append_body_token(macro, i, call, result);
    }
  }
  result.push_back(blank);
  return result;
}

void MacroTable::append_body_token(const Macro& macro, std::size_t at, const Call& call, Tokens& result) {
  const Token& token = macro.body[at];
  Token made = token;
  made.span = call.use;
  ++produced_;
  if (call.use.expansion >= 0) {
    made.span.expansion = sources_.add_expansion(macro.name, token.span, call.use.expansion);
  } else {
    macro.expansions.resize(macro.body.size(), -1);
    std::int32_t& known = macro.expansions[at];
    if (known < 0) known = sources_.add_expansion(macro.name, token.span);
    made.span.expansion = known;
  }
  result.push_back(made);
}

/// Joins the last token of the result with the first one on the right.
void MacroTable::paste(const Tokens& right, Tokens& result, const source::Span& use) {
  std::string text;
  source::Span span = use;
  while (result.size() > 1 && result.back().kind == Kind::kBlank && result[result.size() - 2].kind != Kind::kBlank) result.pop_back();
  if (!result.empty() && !is_gap(result.back())) {
    text = result.back().text;
    span = result.back().span;
    result.pop_back();
  }
  if (!right.empty()) text += right.front().text;
  const Tokens joined = split_tokens(keep(std::move(text)), span);
  for (Token token : joined) {
    token.span = span;
    token.locked = joined.size() > 1;  // 1 ## X is the one token 1X to C, and no macro
    result.push_back(token);
    ++produced_;
  }
  if (right.empty()) return;
  result.insert(result.end(), right.begin() + 1, right.end());
}

/// #argument: its text as a string; quotation marks and backslashes inside of strings are escaped.
Token MacroTable::text_of(const Tokens& argument, const source::Span& span) {
  std::string text = "\"";
  for (const Token& token : argument) {
    const bool escape = token.kind == Kind::kString;
    for (const char c : is_gap(token) ? std::string_view(" ") : token.text) {
      if (escape && (c == '"' || c == '\\')) text += '\\';
      text += c;
    }
  }
  ++produced_;
  return {Kind::kString, keep(text + "\""), span};
}

Token MacroTable::built_in(const Token& name) {
  if (name.text != "__LINE__" && name.text != "__FILE__") return name;
  const source::Place place = sources_.place(name.span);
  const bool line = name.text == "__LINE__";
  return {line ? Kind::kNumber : Kind::kString, keep(line ? fmt::format("{}", place.line) : fmt::format("\"{}\"", place.file)), name.span};
}

std::string_view MacroTable::keep(std::string text) { return texts_.emplace_back(std::move(text)); }

void MacroTable::too_much(const Token& token, std::string_view name) {
  diagnostics_.error("PM1012", token.span, fmt::format("macro '{}' expands to too much text", name));
  produced_ = kMaxProducedTokens + 1;
}

}  // namespace pmac::compiler::power_pmac
