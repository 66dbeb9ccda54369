// pmacc -E: the load stream in the form that the vendor's loader hands to its C pre-processor. Declarations are #define lines,
// initialisers are assignments, &1 is merged into the axis definitions that follow it, files are marked by #line. Comments are gone,
// groups that a conditional leaves out too, and what is included stands in place. Macros of the program stay macros.
#include "compiler/preprocessed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "compiler/compiler.h"
#include "compiler/session_state.h"

namespace pmac::compiler {
namespace {

using power_pmac::PreprocessorToken;
using power_pmac::SourceLine;
using Kind = PreprocessorToken::Kind;
using Tokens = power_pmac::PreprocessorTokens;

bool is_gap(const PreprocessorToken& token) { return token.kind == Kind::kBlank || token.kind == Kind::kNewline; }

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// The parts of a token list between commas outside of parentheses.
std::vector<Tokens> split_at_commas(const Tokens& tokens) {
  std::vector<Tokens> parts(1);
  int depth = 0;
  for (const PreprocessorToken& token : tokens) {
    depth += token.text == "(" || token.text == "[" ? 1 : token.text == ")" || token.text == "]" ? -1 : 0;
    if (token.text == "," && depth == 0) parts.emplace_back();
    else parts.back().push_back(token);
  }
  return parts;
}

class Printer {
 public:
  Printer(const source::SourceManager& sources, LoweredStream stream) : sources_(sources), stream_(std::move(stream)) {}

  std::string run(const std::vector<SourceLine>& lines) {
    for (const SourceLine& line : lines) {
      if (line.kind == SourceLine::Kind::kText) print_text(line.tokens);
      else if (line.kind == SourceLine::Kind::kDefinition) print_definition(line.tokens);
      else if (line.kind == SourceLine::Kind::kFileEnds) end_file(line.file);
    }
    return std::move(out_);
  }

 private:
  bool at_line_start() const { return out_.empty() || out_.back() == '\n'; }
  void put_line(const std::string& text) {
    if (!at_line_start()) out_ += '\n';
    out_ += text + "\n";
    line_ = -1;
  }
  void put_code(const std::string& text) {
    out_ += text + "\n";
    line_ = -1;
  }

  /// Makes the next line of the output stand for the line of the source that this token stands on.
  void synchronise(const source::Span& span) {
    constexpr int kMaxBlankLines = 8;
    const source::Place place = sources_.place(span);
    const bool near = line_ > 0 && place.file == file_ && place.line >= line_ && place.line - line_ <= kMaxBlankLines;
    if (near) out_.append(static_cast<std::size_t>(place.line - line_), '\n');
    else out_ += fmt::format("#line {} \"{}\"\n", place.line, place.file);
    file_ = place.file;
    line_ = place.line;
  }

  void print_token(const PreprocessorToken& token, std::string_view text) {
    if (token.kind == Kind::kNewline) {
      indent_.clear();
      if (at_line_start()) return;  // blank lines come by synchronise
      out_ += '\n';
      if (line_ > 0) ++line_;
      return;
    }
    if (at_line_start() && token.kind == Kind::kBlank) {
      indent_ = text;
      return;
    }
    if (at_line_start()) {
      synchronise(token.span);
      out_ += indent_;
    }
    indent_.clear();
    out_ += text;
    if (token.kind != Kind::kBlank) last_word_ = lower(text);
  }

  void print_definition(const Tokens& tokens) {
    if (!at_line_start()) out_ += '\n';
    for (const PreprocessorToken& token : tokens)
      if (token.kind != Kind::kNewline) print_token(token, token.text);
    out_ += '\n';
    if (line_ > 0) ++line_;
  }

  void print_text(const Tokens& tokens) {
    for (std::size_t i = 0; i < tokens.size();) {
      if (is_replaced(tokens[i].span)) {
        ++i;
        continue;
      }
      if (!tokens[i].span.valid() || is_gap(tokens[i])) {
        print_token(tokens[i], tokens[i].text);
        ++i;
        continue;
      }
      while (const Edit* edit = next_edit(tokens[i].span)) {
        if (edit->kind == Edit::Kind::kDeclaration || edit->kind == Edit::Kind::kPointers) {
          i = replace(tokens, i, *edit);
          break;
        }
        insert(*edit, tokens[i].span);
      }
      if (i < tokens.size() && !is_gap(tokens[i]) && !next_is_edit(tokens[i].span)) {
        print_word(tokens, i);
        ++i;
      }
    }
  }

  /// Belongs to a declaration that began on a line before.
  bool is_replaced(const source::Span& span) const {
    const auto until = replaced_until_.find(span.file);
    return until != replaced_until_.end() && span.begin < until->second;
  }

  bool next_is_edit(const source::Span& span) const {
    const auto edits = stream_.edits.find(span.file);
    const auto at = next_.find(span.file);
    const std::size_t next = at == next_.end() ? 0 : at->second;
    return edits != stream_.edits.end() && next < edits->second.size() && edits->second[next].begin <= span.begin;
  }
  const Edit* next_edit(const source::Span& span) { return next_is_edit(span) ? &stream_.edits[span.file][next_[span.file]++] : nullptr; }

  void insert(const Edit& edit, const source::Span& at) {
    if (edit.kind == Edit::Kind::kInline) {
      if (at_line_start()) synchronise(at);
      out_ += edit.lines.front();
      return;
    }
    for (const std::string& line : edit.lines) put_line(line);
    last_word_.clear();  // the ) of an open line is no condition
  }

  void end_file(std::int32_t file) {
    const auto edits = stream_.edits.find(file);
    if (edits != stream_.edits.end())
      for (std::size_t& next = next_[file]; next < edits->second.size(); ++next) insert(edits->second[next], {});
    if (!at_line_start()) out_ += '\n';
    line_ = -1;
  }

  /// A declaration: its #define lines, and its initialisers as assignments where it stood. Returns the first token behind it.
  std::size_t replace(const Tokens& tokens, std::size_t begin, const Edit& edit) {
    std::size_t end = begin;
    replaced_until_[tokens[begin].span.file] = edit.end;
    while (end < tokens.size() && tokens[end].span.begin < edit.end) ++end;
    const bool is_body = !edit.names.empty() && edit.names.front().letter == 'L' && stands_as_body();
    const Tokens inside(tokens.begin() + static_cast<std::ptrdiff_t>(std::min(begin + 1, end)), tokens.begin() + static_cast<std::ptrdiff_t>(end));
    for (const std::string& line : edit.lines) put_line(line);
    for (const LoweredName& name : edit.names) put_line(name.define());
    const std::vector<std::string> assignments = edit.kind == Edit::Kind::kPointers ? pointers(inside, edit) : initialisers(inside, edit);
    if (assignments.empty() && !is_body) return behind_semicolon(tokens, end);
    if (edit.kind == Edit::Kind::kPointers) {
      for (const std::string& definition : assignments) {
        synchronise(tokens[begin].span);
        put_code(definition);
      }
      return behind_semicolon(tokens, end);
    }
    synchronise(tokens[begin].span);
    out_ += fmt::format(fmt::runtime(is_body ? "{{ {} }}" : "{}"), fmt::join(assignments, "; "));
    const bool took_lines = std::any_of(inside.begin(), inside.end(), [](const PreprocessorToken& t) { return t.kind == Kind::kNewline; });
    if (took_lines && !at_line_start()) {
      out_ += '\n';
      line_ = -1;
    }
    return end;
  }

  static std::size_t behind_semicolon(const Tokens& tokens, std::size_t at) {
    const std::size_t next = power_pmac::skip_blanks(tokens, at);
    return next < tokens.size() && tokens[next].text == ";" ? next + 1 : at;
  }

  /// Behind a condition, else or do the declaration is the one statement that belongs to it.
  bool stands_as_body() const { return last_word_ == ")" || last_word_ == "else" || last_word_ == "do"; }

  std::string text_of(const Tokens& tokens) {
    std::string text;
    for (std::size_t i = 0; i < tokens.size(); ++i) text += tokens[i].kind == Kind::kNewline ? std::string(" ") : word_text(tokens, i);
    const std::size_t first = text.find_first_not_of(' ');
    return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(' ') - first + 1);
  }

  std::vector<std::string> initialisers(const Tokens& inside, const Edit& edit) {
    const std::vector<Tokens> parts = split_at_commas(inside);
    std::vector<std::string> assignments;
    for (std::size_t i = 0; i < edit.names.size(); ++i) {
      if (edit.fallbacks[i].empty()) continue;
      std::string value = edit.fallbacks[i];
      if (parts.size() == edit.names.size()) {
        const auto equals = std::find_if(parts[i].begin(), parts[i].end(), [](const PreprocessorToken& t) { return t.text == "="; });
        if (equals != parts[i].end()) value = text_of({equals + 1, parts[i].end()});
      }
      assignments.push_back((edit.names[i].array ? edit.names[i].variable() : edit.names[i].name) + " = " + value);
    }
    return assignments;
  }

  std::vector<std::string> pointers(const Tokens& inside, const Edit& edit) {
    const std::vector<Tokens> parts = split_at_commas(inside);
    std::vector<std::string> definitions;
    for (std::size_t i = 0; i < edit.names.size() && i < parts.size(); ++i) {
      auto arrow = parts[i].begin();
      while (arrow + 1 < parts[i].end() && !(arrow->text == "-" && (arrow + 1)->text == ">")) ++arrow;
      const LoweredName& name = edit.names[i];
      const std::string range = name.pointers > 1 ? fmt::format("{},{}", name.variable(), name.pointers) : name.variable();
      definitions.push_back((name.array ? range : name.name) + text_of({arrow, parts[i].end()}));
    }
    return definitions;
  }

  void print_word(const Tokens& tokens, std::size_t at) { print_token(tokens[at], word_text(tokens, at)); }

  /// A token of the source as it must stand in the output: a member with the name of a macro in another case, which means the same;
  /// an array without its index as its first variable.
  std::string word_text(const Tokens& tokens, std::size_t at) const {
    const PreprocessorToken& token = tokens[at];
    if (token.kind != Kind::kIdentifier || !stream_.names.contains(token.text)) return std::string(token.text);
    const bool member = at > 0 && tokens[at - 1].text == ".";
    if (member) return other_case(std::string(token.text));
    const auto array = stream_.arrays.find(std::string(token.text));
    const std::size_t next = power_pmac::skip_blanks(tokens, at + 1);
    const bool indexed = next < tokens.size() && tokens[next].text == "(";
    return array != stream_.arrays.end() && !indexed ? array->second.variable() : std::string(token.text);
  }

  std::string other_case(std::string text) const {
    for (char& c : text) {
      c = static_cast<char>(std::isupper(static_cast<unsigned char>(c)) ? std::tolower(c) : std::toupper(c));
      if (!stream_.names.contains(text)) break;
    }
    return text;
  }

  const source::SourceManager& sources_;
  LoweredStream stream_;
  std::map<std::int32_t, std::size_t> next_;  // edit by file
  std::map<std::int32_t, std::uint32_t> replaced_until_;  // by file
  std::string out_, file_, indent_;
  std::string last_word_;   // of the code, in small letters
  int line_ = -1;   // of the source, that the line of the output stands for; -1: unknown
};

}  // namespace

std::string emit_preprocessed(Session& session, const std::vector<InputFile>& files) {
  Session::State& state = session.state();
  state.frontend.record_lines();
  const std::vector<ir::Unit> units = state.analyse(files, false);
  if (state.diagnostics.has_errors()) return {};
  std::string out;
  for (const auto& [name, text] : state.options.defines) out += fmt::format("#define {} {}\n", name, text.empty() ? "1" : text);
  return out + Printer(state.sources, lower_declarations(units, state.project.names, state.sources)).run(state.frontend.recorded_lines());
}

}  // namespace pmac::compiler
