// Source text and what is said about it. A SourceManager owns the files and remembers macro expansions; a Span names a
// piece of text; a Diagnostic is one message with its place, notes and an optional repair. Only format.h prints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace pmac::source {

/// Bytes [begin, end) of a file. Where the text came out of a macro, this is the use of the macro in the file, and
/// expansion says where in its definition the text stands.
struct Span {
  std::int32_t file = -1;  // -1: no place
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::int32_t expansion = -1;
  bool valid() const { return file >= 0; }
  bool operator==(const Span&) const = default;
};

/// From the begin of first to the end of last; first alone where they lie in different files.
Span join(const Span& first, const Span& last);

/// Line and column count from 1; the column counts bytes.
struct LineColumn { int line = 0; int column = 0; };

/// Text that a macro put in place: the macro, and the span inside its definition (of no file for -D and built-in macros).
/// parent: the expansion that the use of the macro stands in, -1: none.
struct Expansion { std::string macro; Span definition; std::int32_t parent = -1; };

/// A place as messages show it: #line changes file and line.
struct Place { std::string_view file; int line = 0; int column = 0; };

struct File {
  std::string name;
  std::string text;
  Span included_from;                      // no place for a file of the command line
  std::vector<std::uint32_t> line_starts;  // byte offset of each line
  struct LineMarker { std::uint32_t offset; int line; std::string name; };
  std::vector<LineMarker> line_markers;    // ascending: from offset on, lines are shown as line and on of name
};

class SourceManager {
 public:
  /// Takes a file in; CR LF and a byte-order mark stay as they are, UTF-16 becomes UTF-8. Returns its index.
  std::int32_t add_file(std::string name, std::string text, Span included_from = {});
  std::int32_t add_expansion(std::string macro, Span definition, std::int32_t parent = -1);
  /// From the line at offset on, lines of the file are shown as line and on of name (empty: the name as before).
  void add_line_marker(std::int32_t file, std::uint32_t offset, int line, const std::string& name);

  const File& file(std::int32_t index) const { return files_[static_cast<std::size_t>(index)]; }
  std::size_t file_count() const { return files_.size(); }
  const Expansion& expansion(std::int32_t index) const { return expansions_[static_cast<std::size_t>(index)]; }

  LineColumn line_column(std::int32_t file, std::uint32_t offset) const;
  /// The begin of a valid span, as messages show it.
  Place place(const Span& span) const;
  /// Text of a line without its line end.
  std::string_view line_text(std::int32_t file, int line) const;
  std::string_view text(const Span& span) const;

 private:
  std::deque<File> files_;  // views into a file stay good
  std::vector<Expansion> expansions_;
};

enum class Severity : std::uint8_t { kNote, kWarning, kError };

struct Note { Span span; std::string message; };

/// Whether a repair keeps or restores what was certainly meant (pmacc --fix applies it), or is a guess for a person to judge.
enum class FixSafety : std::uint8_t { kSafe, kSuggestion };

struct Edit { Span span; std::string replacement; };

/// Replace the text of span, an empty span inserts; and do the other edits with it: all or none.
struct FixIt {
  Span span;
  std::string replacement;
  FixSafety safety = FixSafety::kSafe;
  std::vector<Edit> also = {};
};

struct Diagnostic {
  Severity severity = Severity::kError;
  std::string code;     // "PM2011": never changes its meaning
  Span span;
  std::string message;
  std::vector<Note> notes;
  std::optional<FixIt> fix;
  std::string_view group = {};  // of a warning: its name, from the table of messages
};

/// Looks at each diagnostic before it is kept.
class DiagnosticFilter {
 public:
  virtual ~DiagnosticFilter() = default;
  /// False: leave it out. May change the severity and the group.
  virtual bool accept(Diagnostic& diagnostic) = 0;
};

/// Collects diagnostics in the order they are found; drops repetitions at the same place and errors beyond the limit.
class Diagnostics {
 public:
  Diagnostic& report(Diagnostic diagnostic);
  Diagnostic& error(std::string code, Span span, std::string message);
  Diagnostic& warning(std::string code, Span span, std::string message);

  bool has_errors() const { return error_count_ > 0; }
  std::size_t error_count() const { return error_count_; }
  std::size_t warning_count() const { return warning_count_; }
  /// Errors that were not kept because the limit was reached.
  std::size_t dropped_count() const { return dropped_count_; }
  void set_error_limit(std::size_t limit) { error_limit_ = limit; }
  /// Kept by the caller, and longer than this object; null: everything is given as it comes.
  void set_filter(DiagnosticFilter* filter) { filter_ = filter; }
  const std::deque<Diagnostic>& all() const { return all_; }
  /// Hands over what was collected and starts again with none; filter and limit stay.
  std::vector<Diagnostic> take();

 private:
  std::deque<Diagnostic> all_;
  std::set<std::tuple<std::int32_t, std::uint32_t, std::string>> seen_;  // file, offset, code and message
  Diagnostic ignored_;
  std::size_t error_count_ = 0;
  std::size_t warning_count_ = 0;
  std::size_t dropped_count_ = 0;
  std::size_t limited_count_ = 0;  // errors that count for the limit
  std::size_t error_limit_ = 100;
  DiagnosticFilter* filter_ = nullptr;
};

/// Messages that files in the language of Turbo PMAC have by the hundred: they do not use up the error limit.
bool is_repetitive(std::string_view code);

/// The candidate nearest to a misspelt word, case ignored, or empty if none is near.
std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& candidates);

/// A guess at a misspelt word. It is certain when it is one step away (a letter wrong, missing, too many, or two swapped, in a word
/// of at least four letters) and no other candidate is.
struct Guess { std::string_view word; bool certain = false; };
Guess guess_word(std::string_view word, const std::vector<std::string_view>& candidates);

/// Replace what stands at span by the guess; safe where the guess is certain.
inline FixIt guess_fix(Span span, const Guess& guess) { return {span, std::string(guess.word), guess.certain ? FixSafety::kSafe : FixSafety::kSuggestion, {}}; }

}  // namespace pmac::source
