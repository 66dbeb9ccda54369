// The directives of the preprocessor.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "compiler/frontend/power_pmac/preprocessor.h"

namespace pmac::compiler::power_pmac {
namespace {

using Token = PreprocessorToken;
using Kind = PreprocessorToken::Kind;

constexpr int kMaxIncludeDepth = 64;
constexpr std::array<std::string_view, 14> kDirectives{"define", "undef", "ifdef",   "ifndef", "if",      "elif", "else",
                                                       "endif",  "include", "line", "pragma", "warning", "error", "region"};

std::string text_of(const std::vector<Token>& line, std::size_t first, std::size_t last) {
  std::string text;
  for (std::size_t i = first; i < last; ++i) text += line[i].text;
  return text;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

}  // namespace

bool Preprocessor::take_directive(const Tokens& line) {
  const std::size_t first = skip_blanks(line, 0);
  if (first + 1 >= line.size() || line[first].text != "#" || line[first + 1].kind != Kind::kIdentifier) return false;
  const Token& word = line[first + 1];
  const bool known = std::find(kDirectives.begin(), kDirectives.end(), word.text) != kDirectives.end();
  if (const std::string lower = lower_case(word.text); !known && std::find(kDirectives.begin(), kDirectives.end(), lower) != kDirectives.end()) {
    if (is_active()) {
      auto& error = diagnostics_.error("PM1003", source::join(line[first].span, word.span), fmt::format("directives are written in lower case: #{}", lower));
      error.fix = source::FixIt{word.span, lower};
    }
    run_directive(lower, line, first);
    return true;
  }
  if (!known) {
    const std::vector<std::string_view> names(kDirectives.begin(), kDirectives.end());
    const source::Guess near = word.text.size() > 3 ? source::guess_word(word.text, names) : source::Guess{};
    if (near.word.empty()) return false;
    if (is_active()) {
      auto& error = diagnostics_.error("PM1003", source::join(line[first].span, word.span), fmt::format("unknown directive #{}; did you mean #{}?", word.text, near.word));
      error.fix = source::guess_fix(word.span, near);
    }
    return true;
  }
  run_directive(word.text, line, first);
  return true;
}

void Preprocessor::run_directive(std::string_view name, const Tokens& line, std::size_t first) {
  const source::Span directive = source::join(line[first].span, line[first + 1].span);
  const std::size_t at = skip_blanks(line, first + 2);
  if (name == "if" || name == "ifdef" || name == "ifndef" || name == "elif" || name == "else" || name == "endif")
    return conditional_directive(name, line, at, directive);
  if (!is_active()) return;
  if (name == "define") define_directive(line, at, directive);
  else if (name == "include") include_directive(line, at, directive);
  else if (name == "undef" && at < line.size()) macros_.erase(std::string(line[at].text));
  else if (name == "error") diagnostics_.error("PM1008", directive, "#error " + text_of(line, at, line.size()));
  else if (name == "warning") diagnostics_.warning("PM1009", directive, "#warning " + text_of(line, at, line.size()));
}

bool Preprocessor::parse_parameters(const Tokens& line, std::size_t& at, Macro& macro) {
  if (at >= line.size() || line[at].text != "(") return true;
  macro.function_like = true;
  for (++at; at < line.size(); ++at) {
    if (line[at].text == ")") return ++at, true;
    if (line[at].kind == Kind::kIdentifier) macro.parameters.emplace_back(line[at].text);
    else if (line[at].kind != Kind::kBlank && line[at].text != ",") return false;
  }
  return false;
}

void Preprocessor::define_directive(const Tokens& line, std::size_t at, const source::Span& directive) {
  if (at >= line.size() || line[at].kind != Kind::kIdentifier) {
    diagnostics_.error("PM1004", directive, "#define needs a name");
    return;
  }
  Macro macro;
  macro.name = line[at].text;
  macro.name_span = line[at].span;
  if (!parse_parameters(line, ++at, macro)) {
    diagnostics_.error("PM1004", macro.name_span, fmt::format("the parameters of macro '{}' are not closed; add )", macro.name));
    return;
  }
  std::size_t last = line.size();
  at = skip_blanks(line, at);
  while (last > at && (line[last - 1].kind == Kind::kBlank || line[last - 1].kind == Kind::kNewline)) --last;
  macro.body.assign(line.begin() + static_cast<std::ptrdiff_t>(at), line.begin() + static_cast<std::ptrdiff_t>(last));
  macro.body_text = text_of(line, at, last);
  const bool is_buffer_command = macro.name == "lookahead" && !macro.body.empty() && macro.body.front().kind == Kind::kNumber;
  if (!is_buffer_command) return store(std::move(macro));
  auto& warning = diagnostics_.warning("PM1010", directive, fmt::format("#define only makes a macro named lookahead; the lookahead buffer is made by the on-line command define lookahead {}", macro.body_text));
  warning.fix = source::FixIt{source::join(directive, line[last - 1].span), "&1 define lookahead " + macro.body_text};
}

void Preprocessor::store(Macro macro) {
  const auto known = macros_.find(macro.name);
  const bool changed = known != macros_.end() && (known->second.body_text != macro.body_text || known->second.parameters != macro.parameters);
  if (changed) {
    auto& warning = diagnostics_.warning("PM1011", macro.name_span, fmt::format("macro '{}' is defined again with another text", macro.name));
    warning.notes.push_back({known->second.name_span, "the definition before is here"});
  }
  std::string name = macro.name;
  macros_.insert_or_assign(std::move(name), std::move(macro));
}

std::optional<std::int32_t> Preprocessor::open_include(const std::string& name, const source::Span& from) {
  namespace fs = std::filesystem;
  std::vector<fs::path> candidates{fs::path(sources_.file(from.file).name).parent_path() / name};
  for (const std::string& dir : include_dirs_) candidates.push_back(fs::path(dir) / name);
  for (const fs::path& path : candidates) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) continue;
    std::ifstream stream(path, std::ios::binary);
    if (!stream) continue;
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    return sources_.add_file(path.string(), std::move(text), from);
  }
  return std::nullopt;
}

void Preprocessor::include_directive(const Tokens& line, std::size_t at, const source::Span& directive) {
  std::string name = at < line.size() ? std::string(line[at].text) : std::string();
  if (name == "<") name = text_of(line, at, line.size());
  if (name.size() < 2 || (name.front() != '"' && name.front() != '<')) {
    diagnostics_.error("PM1005", directive, "#include needs a file name in quotation marks");
    return;
  }
  name = name.substr(1, name.find_last_of("\">") - 1);
  std::replace(name.begin(), name.end(), '\\', '/');
  if (include_depth_ >= kMaxIncludeDepth) {
    diagnostics_.error("PM1006", directive, fmt::format("#include is nested more than {} deep; does the file include itself?", kMaxIncludeDepth));
    return;
  }
  const auto file = open_include(name, line[at].span);
  if (!file) {
    diagnostics_.error("PM1005", line[at].span, fmt::format("cannot find the file \"{}\"", name));
    return;
  }
  ++include_depth_;
  run_file(*file);
  --include_depth_;
}

void Preprocessor::conditional_directive(std::string_view name, const Tokens& line, std::size_t at, const source::Span& directive) {
  if (name == "if" || name == "ifdef" || name == "ifndef") {
    const bool parent = is_active();
    bool active = false;
    if (parent && name == "if") active = evaluate_condition(line, at, directive);
    else if (parent && at < line.size()) active = macros_.contains(line[at].text) == (name == "ifdef");
    conditionals_.push_back({parent && active, active, parent, false, directive});
    return;
  }
  if (conditionals_.empty()) {
    diagnostics_.error("PM1007", directive, fmt::format("#{} without #if", name));
    return;
  }
  Conditional& top = conditionals_.back();
  if (name == "endif") return conditionals_.pop_back();
  if (top.seen_else) diagnostics_.error("PM1007", directive, fmt::format("#{} after #else", name));
  const bool wanted = name == "else" || (top.parent_active && !top.taken && evaluate_condition(line, at, directive));
  top.seen_else = name == "else";
  top.active = top.parent_active && !top.taken && wanted;
  top.taken = top.taken || wanted;
}

bool Preprocessor::evaluate_condition(const Tokens& line, std::size_t at, const source::Span& directive) {
  Tokens tokens;
  for (std::size_t i = at; i < line.size(); ++i) {
    if (line[i].text != "defined") {
      tokens.push_back(line[i]);
      continue;
    }
    std::size_t name = skip_blanks(line, i + 1);
    const bool parenthesis = name < line.size() && line[name].text == "(";
    if (parenthesis) name = skip_blanks(line, name + 1);
    const bool known = name < line.size() && macros_.contains(line[name].text);
    tokens.push_back({Kind::kNumber, known ? "1" : "0", line[i].span});
    i = parenthesis ? skip_blanks(line, name + 1) : name;
  }
  Tokens expanded;
  std::vector<const Macro*> active;
  produced_ = 0;
  expand(tokens, active, expanded);
  const auto value = evaluate_if(expanded);
  if (!value) diagnostics_.error("PM1007", directive, "this #if condition cannot be evaluated");
  return value.value_or(0) != 0;
}

}  // namespace pmac::compiler::power_pmac
