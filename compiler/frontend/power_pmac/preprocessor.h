// The preprocessor of Power PMAC projects: comments, #define and #undef (also function-like), #if #ifdef #ifndef #elif #else
// #endif, #include. It works like that of C, by whole identifiers and case-sensitively, and keeps for every byte of its output
// the place it came from. Only '#' followed by the name of a directive begins a directive: #1j+ and #*k are motor commands.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compiler/source/source.h"

namespace pmac::compiler::power_pmac {

/// Text without comments and macros. Line ends are kept, so that statements still end with their line.
class ExpandedText {
 public:
  /// Appends text. exact: its bytes are the bytes from span.begin on; otherwise every byte belongs to the whole span.
  void append(std::string_view text, const source::Span& span, bool exact);
  const std::string& text() const { return text_; }
  /// Place of bytes [begin, end) of the text.
  source::Span span_of(std::size_t begin, std::size_t end) const;

 private:
  struct Segment { std::size_t begin; source::Span span; bool exact; };
  source::Span span_at(std::size_t offset) const;
  std::string text_;
  std::vector<Segment> segments_;
};

/// A piece of a line: an identifier, a number, a string, blanks or one other character.
struct PreprocessorToken {
  enum class Kind : std::uint8_t { kIdentifier, kNumber, kString, kBlank, kNewline, kOther };
  Kind kind;
  std::string_view text;
  source::Span span;
};

struct Macro {
  std::string name;
  bool function_like = false;
  std::vector<std::string> parameters;
  std::vector<PreprocessorToken> body;
  source::Span name_span;
  std::string body_text;
};

class Preprocessor {
 public:
  Preprocessor(source::SourceManager& sources, source::Diagnostics& diagnostics, std::vector<std::string> include_dirs);

  /// Expands a file that the source manager knows. Macros stay known for the next file.
  ExpandedText run(std::int32_t file);
  /// As -D name=text.
  void define(const std::string& name, const std::string& text);
  const std::map<std::string, Macro, std::less<>>& macros() const { return macros_; }

 private:
  using Tokens = std::vector<PreprocessorToken>;
  struct Conditional { bool active; bool taken; bool parent_active; bool seen_else; source::Span span; };

  void run_file(std::int32_t file);
  Tokens next_line(std::int32_t file, std::size_t& cursor);
  bool begins_turbo_comment(std::string_view text, std::size_t at) const;
  void report_turbo_comment(std::int32_t file, std::size_t at);
  void check_swallowed_program(std::string_view comment, const source::Span& span);
  bool take_directive(const Tokens& line);
  void run_directive(std::string_view name, const Tokens& line, std::size_t first);
  void define_directive(const Tokens& line, std::size_t at, const source::Span& directive);
  bool parse_parameters(const Tokens& line, std::size_t& at, Macro& macro);
  void store(Macro macro);
  void include_directive(const Tokens& line, std::size_t at, const source::Span& directive);
  void conditional_directive(std::string_view name, const Tokens& line, std::size_t at, const source::Span& directive);
  bool evaluate_condition(const Tokens& line, std::size_t at, const source::Span& directive);
  void emit_line(Tokens line, std::int32_t file, std::size_t& cursor);
  bool needs_next_line(const Tokens& line) const;
  void expand(const Tokens& in, std::vector<const Macro*>& active, Tokens& out);
  std::size_t expand_call(const Tokens& in, std::size_t at, const Macro& macro, std::vector<const Macro*>& active, Tokens& out);
  std::optional<std::vector<Tokens>> read_arguments(const Tokens& in, std::size_t& at) const;
  PreprocessorToken from_macro(const PreprocessorToken& token, const Macro& macro, const source::Span& use);
  bool is_active() const { return conditionals_.empty() || conditionals_.back().active; }
  std::optional<std::int32_t> open_include(const std::string& name, const source::Span& from);

  source::SourceManager& sources_;
  source::Diagnostics& diagnostics_;
  std::vector<std::string> include_dirs_;
  std::map<std::string, Macro, std::less<>> macros_;
  std::vector<Conditional> conditionals_;
  ExpandedText* out_ = nullptr;
  bool turbo_file_ = false;   // the file at hand has the comments of Turbo PMAC
  int include_depth_ = 0;
  int argument_depth_ = 0;    // calls inside the arguments of calls, at the moment
  std::size_t produced_ = 0;  // tokens made for the current line: stops explosive macros
};

/// Tokens of a text; comments must have been blanked before. span: place of the text.
std::vector<PreprocessorToken> split_tokens(std::string_view text, const source::Span& span);

/// Index of the first token from `at` on that is no blank.
std::size_t skip_blanks(const std::vector<PreprocessorToken>& line, std::size_t at);

/// Value of a #if expression over tokens without macros (unknown identifiers are 0), or nullopt when it is malformed.
std::optional<long long> evaluate_if(const std::vector<PreprocessorToken>& tokens);

}  // namespace pmac::compiler::power_pmac
