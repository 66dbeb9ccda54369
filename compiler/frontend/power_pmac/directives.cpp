// The directives of the preprocessor.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "compiler/frontend/power_pmac/preprocessor.h"

namespace pmac::compiler::power_pmac {
namespace {

using Token = PreprocessorToken;
using Kind = PreprocessorToken::Kind;

constexpr std::size_t kMaxIncludes = 10000;             // of one file of the command line
constexpr std::size_t kMaxIncludeBytes = 256u << 20;    // of one included file
constexpr std::array<std::string_view, 15> kDirectives{"define",  "undef", "ifdef",  "ifndef",  "if",    "elif",   "else",     "endif",
                                                       "include", "line",  "pragma", "warning", "error", "region", "endregion"};

std::string text_of(const std::vector<Token>& line, std::size_t first, std::size_t last) {
  std::string text;
  for (std::size_t i = first; i < last; ++i) text += line[i].text;
  text.erase(std::find_if(text.rbegin(), text.rend(), [](unsigned char c) { return !std::isspace(c); }).base(), text.end());
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
  if (name == "define") return define_directive(line, at, directive);
  if (!is_active()) return;
  if (name == "include") include_directive(line, at, directive);
  else if (name == "undef") undef_directive(line, at, directive);
  else if (name == "line") line_directive(line, at, directive);
  else if (name == "error") diagnostics_.error("PM1008", directive, "#error " + text_of(line, at, line.size()));
  else if (name == "warning") diagnostics_.warning("PM1009", directive, "#warning " + text_of(line, at, line.size()));
  else if (name == "pragma") diagnostics_.warning("PM1014", directive, "#pragma has no effect");
}

/// (a, b), (a, ...), (); at stands on the parenthesis and ends behind the closing one.
bool Preprocessor::parse_parameters(const Tokens& line, std::size_t& at, Macro& macro) {
  if (at >= line.size() || line[at].text != "(") return true;
  macro.function_like = true;
  bool name_wanted = true;
  for (++at; at < line.size(); ++at) {
    const Token& token = line[at];
    const bool dots = token.text == "." && at + 2 < line.size() && line[at + 1].text == "." && line[at + 2].text == ".";
    if (token.text == ")") return ++at, !name_wanted || macro.parameters.empty();
    if (token.kind == Kind::kBlank) continue;
    if (token.text == "," && !name_wanted && !macro.variadic) {
      name_wanted = true;
    } else if (name_wanted && (token.kind == Kind::kIdentifier || dots)) {
      name_wanted = false;
      macro.variadic = dots;
      macro.parameters.emplace_back(dots ? "__VA_ARGS__" : token.text);
      at += dots ? 2 : 0;
    } else {
      return false;
    }
  }
  return false;
}

std::optional<Macro> Preprocessor::read_definition(const Tokens& line, std::size_t at, const source::Span& directive) {
  if (at >= line.size() || line[at].kind != Kind::kIdentifier) {
    if (is_active()) diagnostics_.error("PM1004", directive, "#define needs a name");
    return std::nullopt;
  }
  Macro macro;
  macro.name = line[at].text;
  macro.name_span = line[at].span;
  if (!parse_parameters(line, ++at, macro)) {
    if (is_active()) diagnostics_.error("PM1004", macro.name_span, fmt::format("the parameters of macro '{}' are not names between commas, closed by )", macro.name));
    return std::nullopt;
  }
  std::size_t last = line.size();
  at = skip_blanks(line, at);
  while (last > at && (line[last - 1].kind == Kind::kBlank || line[last - 1].kind == Kind::kNewline)) --last;
  macro.body.assign(line.begin() + static_cast<std::ptrdiff_t>(at), line.begin() + static_cast<std::ptrdiff_t>(last));
  macro.body_text = text_of(line, at, last);
  return macro;
}

void Preprocessor::define_directive(const Tokens& line, std::size_t at, const source::Span& directive) {
  auto macro = read_definition(line, at, directive);
  if (!macro) return;
  list_definition(*macro, is_active());
  if (!is_active()) return;
  const bool is_buffer_command = macro->name == "lookahead" && !macro->body.empty() && macro->body.front().kind == Kind::kNumber;
  if (is_buffer_command) {
    const std::string text = macro->body_text;
    auto& warning = diagnostics_.warning("PM1010", directive, fmt::format("#define only makes a macro named lookahead; the lookahead buffer is made by the on-line command define lookahead {}", text));
    warning.fix = source::FixIt{source::join(directive, macro->body.back().span), "&1 define lookahead " + text};
    return;
  }
  record(SourceLine::Kind::kDefinition, line, directive.file);
  macros_.define(std::move(*macro));
}

void Preprocessor::list_definition(const Macro& macro, bool active) {
  std::string parameters;
  for (const std::string& parameter : macro.parameters) parameters += (parameters.empty() ? "(" : ", ") + (parameter == "__VA_ARGS__" ? std::string("...") : parameter);
  if (macro.function_like) parameters += parameters.empty() ? "()" : ")";
  definitions_.push_back({macro.name, std::move(parameters), macro.body_text, macro.name_span, active});
}

void Preprocessor::undef_directive(const Tokens& line, std::size_t at, const source::Span& directive) {
  if (at >= line.size() || line[at].kind != Kind::kIdentifier) {
    diagnostics_.error("PM1004", directive, "#undef needs a name");
    return;
  }
  record(SourceLine::Kind::kDefinition, line, directive.file);
  macros_.undefine(line[at].text);
}

/// #line 12 "file": what follows is shown as line 12 and on of that file.
void Preprocessor::line_directive(const Tokens& line, std::size_t at, const source::Span& directive) {
  const Tokens words = macros_.expand({line.begin() + static_cast<std::ptrdiff_t>(at), line.end()});
  const std::size_t first = skip_blanks(words, 0);
  int number = 0;
  const bool has_number = first < words.size() && words[first].kind == Kind::kNumber;
  const std::string_view digits = has_number ? words[first].text : std::string_view();
  const bool valid = has_number && std::from_chars(digits.data(), digits.data() + digits.size(), number).ec == std::errc();
  const std::size_t name = skip_blanks(words, first + 1);
  const bool names_file = name < words.size() && words[name].kind == Kind::kString && words[name].text.size() >= 2;
  if (!valid || (name < words.size() && !names_file)) {
    diagnostics_.error("PM1015", directive, "#line needs a number, and may have a file name in quotation marks");
    return;
  }
  const std::string file = names_file ? std::string(words[name].text.substr(1, words[name].text.size() - 2)) : std::string();
  sources_.add_line_marker(directive.file, line.back().span.end, number, file);
}

std::optional<std::int32_t> Preprocessor::open_include(const std::string& name, const source::Span& from) {
  namespace fs = std::filesystem;
  std::vector<fs::path> candidates{fs::path(sources_.file(from.file).name).parent_path() / name};
  for (const std::string& dir : include_dirs_) candidates.push_back(fs::path(dir) / name);
  for (const fs::path& path : candidates) {
    std::error_code error;
    if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > kMaxIncludeBytes) continue;
    std::ifstream stream(path, std::ios::binary);
    if (!stream) continue;
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    return sources_.add_file(path.string(), std::move(text), from);
  }
  return std::nullopt;
}

void Preprocessor::include_directive(const Tokens& line, std::size_t at, const source::Span& directive) {
  if (at < line.size() && line[at].kind == Kind::kIdentifier) {
    const Tokens expanded = macros_.expand({line.begin() + static_cast<std::ptrdiff_t>(at), line.end()});
    const std::size_t first = skip_blanks(expanded, 0);
    const bool is_name = first < expanded.size() && (expanded[first].kind == Kind::kString || expanded[first].text == "<");
    if (is_name) return include_directive(expanded, first, directive);
  }
  std::string name = at < line.size() ? std::string(line[at].text) : std::string();
  if (name == "<") name = text_of(line, at, line.size());
  const std::size_t close = name.size() < 3 ? std::string::npos : name.find_last_of(name.front() == '<' ? ">" : "\"");
  if (close == std::string::npos || close < 2 || (name.front() != '"' && name.front() != '<')) {
    diagnostics_.error("PM1005", directive, "#include needs a file name in quotation marks");
    return;
  }
  name = name.substr(1, close - 1);
  std::replace(name.begin(), name.end(), '\\', '/');
  include_file(name, source::Span{directive.file, line[at].span.begin, line[at].span.end, -1});
}

void Preprocessor::include_file(const std::string& name, const source::Span& place) {
  if (includes_stopped_) return;
  includes_stopped_ = include_depth_ >= max_include_depth_ || include_count_ >= kMaxIncludes;
  if (includes_stopped_) {
    const std::string problem = include_depth_ >= max_include_depth_ ? fmt::format("#include is nested more than {} deep; does the file include itself?", max_include_depth_)
                                                                  : fmt::format("more than {} files are included", kMaxIncludes);
    diagnostics_.error("PM1006", place, problem);
    return;
  }
  const auto file = open_include(name, place);
  if (!file) {
    diagnostics_.error("PM1005", place, fmt::format("cannot find the file \"{}\"", name));
    return;
  }
  ++include_count_;
  ++include_depth_;
  run_file(*file);
  --include_depth_;
}

void Preprocessor::conditional_directive(std::string_view name, const Tokens& line, std::size_t at, const source::Span& directive) {
  if (name == "if" || name == "ifdef" || name == "ifndef") {
    const bool parent = is_active();
    bool active = false;
    if (parent && name == "if") active = evaluate_condition(line, at, directive);
    else if (parent && at < line.size() && line[at].kind == Kind::kIdentifier) active = macros_.is_defined(line[at].text) == (name == "ifdef");
    else if (parent) diagnostics_.error("PM1007", directive, fmt::format("#{} needs a name", name));
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

/// defined NAME and defined(NAME) as 1 and 0, and everything else expanded.
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
    const bool known = name < line.size() && macros_.is_defined(line[name].text);
    tokens.push_back({Kind::kNumber, known ? "1" : "0", line[i].span});
    i = parenthesis ? skip_blanks(line, name + 1) : name;
    const bool closed = !parenthesis || (i < line.size() && line[i].text == ")");
    const bool named = name < line.size() && line[name].kind == Kind::kIdentifier;
    if (named && closed) continue;
    diagnostics_.error("PM1007", directive, "this condition cannot be evaluated: defined needs a name");
    return false;
  }
  const IfValue value = evaluate_if(macros_.expand(tokens));
  if (!value.problem.empty()) diagnostics_.error("PM1007", directive, "this condition cannot be evaluated: " + value.problem);
  return value.problem.empty() && value.value != 0;
}

}  // namespace pmac::compiler::power_pmac
