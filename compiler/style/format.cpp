// Line by line: level, blanks, spelling. Words never change their line.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/style/same_program.h"
#include "compiler/style/source_text.h"
#include "compiler/style/spacing.h"
#include "compiler/style/spelling.h"
#include "compiler/style/structure.h"
#include "compiler/style/style.h"
#include "compiler/style/trailing_comments.h"

namespace pmac::style {
namespace {

constexpr std::size_t kMaxConditionals = 200;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

std::string_view without_trailing_blanks(std::string_view text) {
  std::size_t size = text.size();
  while (size > 0 && is_blank(text[size - 1])) --size;
  const bool would_continue_line = size > 0 && size < text.size() && text[size - 1] == '\\';  // a blank behind \ keeps it from joining lines
  return would_continue_line ? text : text.substr(0, size);
}

/// CR LF where most lines of the text end so.
std::string_view majority_line_end(std::string_view text) {
  std::size_t lf = 0, crlf = 0;
  for (std::size_t at = text.find('\n'); at != std::string_view::npos; at = text.find('\n', at + 1)) ++(at > 0 && text[at - 1] == '\r' ? crlf : lf);
  return crlf > lf ? "\r\n" : "\n";
}

bool is_utf8(std::string_view text) {
  int missing = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (missing > 0) {
      if ((byte & 0xc0) != 0x80) return false;
      --missing;
    } else if (byte >= 0xf0) missing = 3;
    else if (byte >= 0xe0) missing = 2;
    else if (byte >= 0xc0) missing = 1;
    else if (byte >= 0x80) return false;
  }
  return missing == 0;
}

/// `off` of a comment // pmacc: fmt off; empty for other comments.
std::string_view switch_of(std::string_view comment) {
  constexpr std::string_view kLead = "// pmacc: fmt ";
  const std::string_view trimmed = without_trailing_blanks(comment);
  return trimmed.starts_with(kLead) ? trimmed.substr(kLead.size()) : std::string_view();
}

class Formatter {
 public:
  Formatter(const SourceText& source, const Options& options, std::vector<Problem>& problems)
      : source_(source),
        options_(options),
        problems_(problems),
        line_end_(majority_line_end(source.text)),
        utf8_(is_utf8(source.text)),
        spelling_(source),
        comments_(out_, line_end_, utf8_),
        state_{Statement(source), Structure(source, options, problems)} {}

  std::string run() {
    if (source_.text.starts_with(kByteOrderMark)) out_ = kByteOrderMark, text_begin_ = out_.size(), line_begin_ = text_begin_;
    const std::size_t count = source_.pieces.size();
    for (std::size_t first = 0; first < count;) {
      std::size_t last = first;
      while (last < count && source_.pieces[last].kind != PieceKind::kNewline) ++last;
      take_line({first, last});
      if (last < count) line_begin_ = source_.pieces[last].end;
      first = last + 1;
    }
    comments_.end_block();
    state_.structure.end_text();
    return std::move(out_);
  }

 private:
  struct Line { std::size_t first, last; };  // pieces [first, last) up to the line end
  struct State { Statement statement; Structure structure; };
  struct Conditional { State at_begin; State after_first; bool has_else; };

  const Piece& piece(std::size_t i) const { return source_.pieces[i]; }

  // --- kinds of lines -------------------------------------------------------------------------------------------------------

  void take_line(Line line) {
    follow_switch(line, "on");
    if (is_off_) take_kept_line(line, false);
    else if (line.first == line.last) take_blank_line();
    else if (has(line, PieceKind::kDirective) || has(line, PieceKind::kSkipped)) take_kept_line(line, true);
    else if (is_comment_line(line)) take_comment_line(line);
    else take_code_line(line);
    follow_switch(line, "off");
    if (line.first != line.last) state_.statement.continues() ? void() : end_statement_line();
  }

  void end_statement_line() {
    state_.structure.end_line();
    state_.statement.end_line();
  }

  void follow_switch(Line line, std::string_view position) {
    for (std::size_t i = line.first; i < line.last; ++i)
      if (piece(i).kind == PieceKind::kComment && switch_of(source_.of(piece(i))) == position) is_off_ = position == "off";
  }

  bool has(Line line, PieceKind kind) const {
    for (std::size_t i = line.first; i < line.last; ++i)
      if (piece(i).kind == kind) return true;
    return false;
  }

  bool is_comment_line(Line line) const {
    for (std::size_t i = line.first; i < line.last; ++i)
      if (piece(i).kind != PieceKind::kComment) return false;
    return true;
  }

  /// One blank line is kept of many, none at the begin and end of the text.
  void take_blank_line() {
    comments_.end_block();
    blank_pending_ = true;
  }

  void begin_output_line() {
    if (blank_pending_ && out_.size() > text_begin_) {
      comments_.end_block();
      out_ += line_end_;
    }
    blank_pending_ = false;
  }

  /// Byte by byte as it stands, but for the line ends. trim: blanks at the end go.
  void take_kept_line(Line line, bool trim) {
    comments_.end_block();
    begin_output_line();
    const std::size_t end = line.last < source_.pieces.size() ? piece(line.last).begin : source_.text.size();
    const std::string_view bytes = source_.text.substr(line_begin_, end - line_begin_);
    append_kept(trim ? without_trailing_blanks(bytes) : bytes, out_);
    out_ += line_end_;
    follow_words(line);
  }

  void follow_words(Line line) {
    for (std::size_t i = line.first; i < line.last; ++i) {
      if (piece(i).kind == PieceKind::kDirective) follow_directive(source_.of(piece(i)));
      if (piece(i).is_word()) follow_word(i);
    }
  }

  /// Comments of one line stand as deep as what follows them; those of several lines stay where they are.
  void take_comment_line(Line line) {
    comments_.end_block();
    for (std::size_t i = line.first; i < line.last; ++i)
      if (source_.spans_lines(piece(i))) return take_kept_line(line, true);
    begin_output_line();
    std::string text;
    for (std::size_t i = line.first; i < line.last; ++i) {
      if (i > line.first && piece(i).begin > piece(i - 1).end) text += ' ';
      text += without_trailing_blanks(source_.of(piece(i)));
    }
    out_.append(comment_indent(line), ' ');
    out_ += text;
    out_ += line_end_;
  }

  std::size_t comment_indent(Line line) {
    if (state_.statement.continues()) return continued_indent(line);
    const Piece* next = next_word(line.last);
    const bool ends_block = !next || source_.of(*next) == "}" || lower_case(source_.of(*next)) == "close";
    return indent_of(ends_block ? state_.structure.level_inside() : state_.structure.level_of_line(*next));
  }

  /// First word behind a line, over comments and blank lines.
  const Piece* next_word(std::size_t from) {
    next_word_ = std::max(next_word_, from);
    while (next_word_ < source_.pieces.size() && !piece(next_word_).is_word()) ++next_word_;
    return next_word_ < source_.pieces.size() ? &piece(next_word_) : nullptr;
  }

  // --- code -------------------------------------------------------------------------------------------------------------------

  void take_code_line(Line line) {
    begin_output_line();
    const bool has_trailing_comment = piece(line.last - 1).kind == PieceKind::kComment && !source_.spans_lines(piece(line.last - 1));
    const Line code_line{line.first, has_trailing_comment ? line.last - 1 : line.last};
    std::string code = begins_with_long_comment(line) ? leading_blanks(line) : std::string(line_indent(line), ' ');
    const bool several_lines = append_code(code_line, code);
    const std::string_view comment = has_trailing_comment ? without_trailing_blanks(source_.of(piece(line.last - 1))) : std::string_view();
    if (several_lines) {
      comments_.end_block();
      if (has_trailing_comment) code.append("  ").append(comment);
      comments_.add_line(std::move(code), statement_indent_);
    } else if (has_trailing_comment) {
      comments_.add_line(std::move(code), statement_indent_, comment, column_of(piece(line.last - 1).begin));
    } else {
      comments_.add_line(std::move(code), statement_indent_);
    }
  }

  bool begins_with_long_comment(Line line) const { return piece(line.first).kind == PieceKind::kComment && source_.spans_lines(piece(line.first)); }

  std::string leading_blanks(Line line) const { return std::string(source_.text.substr(line_begin_, piece(line.first).begin - line_begin_)); }

  std::size_t column_of(std::size_t offset) const { return end_column(source_.text.substr(line_begin_, offset - line_begin_), 0, utf8_); }

  std::size_t indent_of(int level) const { return static_cast<std::size_t>(level * options_.indent); }

  /// Blanks before a line of code; notes where its statement stands.
  std::size_t line_indent(Line line) {
    if (state_.statement.continues()) return continued_indent(line);
    const Piece* word = first_word(line);
    line_level_ = word ? state_.structure.level_of_line(*word) : 0;
    statement_indent_ = indent_of(line_level_);
    statement_column_ = column_of(piece(line.first).begin);
    return statement_indent_;
  }

  /// A line that continues a statement moves with the statement's first line and stands at least one level behind it.
  std::size_t continued_indent(Line line) const {
    const std::size_t column = column_of(piece(line.first).begin);
    const bool closes = source_.of(piece(line.first)) == ")" || source_.of(piece(line.first)) == "]";
    const std::size_t least = statement_indent_ + (closes ? 0 : static_cast<std::size_t>(options_.indent));
    const std::size_t behind = column > statement_column_ ? column - statement_column_ : 0;
    return std::max(least, statement_indent_ + behind);
  }

  const Piece* first_word(Line line) const {
    for (std::size_t i = line.first; i < line.last; ++i)
      if (piece(i).is_word()) return &piece(i);
    return nullptr;
  }

  /// Appends the pieces of a line; true if one of them goes over several lines.
  bool append_code(Line line, std::string& code) {
    bool several_lines = false;
    const bool kept = source_.of(piece(line.first)) == ";";  // a comment in the manner of Turbo PMAC, most likely
    for (std::size_t i = line.first; i < line.last; ++i) {
      const Role role = role_of(i);
      if (i > line.first) append_blanks(i, role, kept, code);
      if (kept || !piece(i).is_word() || piece(i).kind == PieceKind::kRaw) append_kept(source_.of(piece(i)), code);
      else spelling_.append(i, code);
      if (piece(i).is_word()) take_word(i, role);
      several_lines = several_lines || source_.spans_lines(piece(i));
    }
    return several_lines;
  }

  /// Blanks between a piece and the one before it.
  void append_blanks(std::size_t i, Role role, bool kept, std::string& code) const {
    const std::string_view written = source_.text.substr(piece(i - 1).end, piece(i).begin - piece(i - 1).end);
    const bool beside_comment = piece(i).kind == PieceKind::kComment || piece(i - 1).kind == PieceKind::kComment;
    if (kept) code += written;
    else if (beside_comment ? !written.empty() : blanks_between(source_, state_.statement, piece(i), role, !written.empty())) code += ' ';
  }

  Role role_of(std::size_t i) const {
    if (!piece(i).is_word()) return Role::kNone;
    const bool blank_before = i > 0 && piece(i - 1).end < piece(i).begin;
    const bool glued_behind = i + 1 < source_.pieces.size() && piece(i + 1).begin == piece(i).end && piece(i + 1).is_word();
    return state_.statement.role_of(piece(i), blank_before, glued_behind);
  }

  void take_word(std::size_t i, Role role) {
    state_.structure.take(piece(i), role, state_.statement, line_level_);
    state_.statement.take(piece(i), role);
  }

  void follow_word(std::size_t i) { take_word(i, role_of(i)); }

  /// Text as it stands, with the line ends of the file.
  void append_kept(std::string_view bytes, std::string& out) const {
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t end = bytes.find('\n', at);
      if (end == std::string_view::npos) {
        out += bytes.substr(at);
        return;
      }
      out += bytes.substr(at, end - at - (end > at && bytes[end - 1] == '\r' ? 1 : 0));
      out += line_end_;
      at = end + 1;
    }
  }

  // --- conditional text -------------------------------------------------------------------------------------------------------

  /// #else goes on from where #if stood; #endif from where the first branch ended.
  void follow_directive(std::string_view directive) {
    if (directive.starts_with("#if")) begin_conditional(directive);
    else if (conditionals_.empty()) return;
    else if (directive.starts_with("#el")) begin_other_branch();
    else if (directive.starts_with("#endif")) end_conditional();
  }

  void begin_conditional(std::string_view directive) {
    if (conditionals_.size() < kMaxConditionals) conditionals_.push_back({state_, state_, false});
    else if (problems_.empty()) problems_.push_back({static_cast<std::size_t>(directive.data() - source_.text.data()), directive.size(), "PM2010", "#if is nested too deep"});
  }

  void begin_other_branch() {
    Conditional& top = conditionals_.back();
    if (!top.has_else) top.after_first = state_;
    top.has_else = true;
    state_ = top.at_begin;
  }

  void end_conditional() {
    if (conditionals_.back().has_else) state_ = conditionals_.back().after_first;
    conditionals_.pop_back();
  }

  const SourceText& source_;
  const Options& options_;
  std::vector<Problem>& problems_;
  std::string_view line_end_;
  bool utf8_;
  std::string out_;
  Spelling spelling_;
  TrailingComments comments_;
  State state_;
  std::vector<Conditional> conditionals_;
  std::size_t text_begin_ = 0;        // behind the byte-order mark
  std::size_t line_begin_ = 0;        // offset of the line at hand
  std::size_t next_word_ = 0;         // index: no word stands between the line at hand and it
  std::size_t statement_column_ = 0;  // of the first line of the statement, as read
  std::size_t statement_indent_ = 0;  // and as written
  int line_level_ = 0;
  bool blank_pending_ = false;
  bool is_off_ = false;
};

/// Comments that are not closed, of the pieces.
void check_comments(const SourceText& source, std::vector<Problem>& problems) {
  if (source.pieces.empty() || source.pieces.back().kind != PieceKind::kComment) return;
  const Piece& last = source.pieces.back();
  const std::string_view text = source.of(last);
  const bool open = text.starts_with("/*") && (text.size() < 4 || !text.ends_with("*/"));
  if (open) problems.push_back({last.begin, 2, "PM1001", "comment is not closed; add */"});
}

/// Every byte stays in its encoding, which must be one that keeps ASCII.
void check_encoding(std::string_view text, std::vector<Problem>& problems) {
  const bool is_utf16 = text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
  if (is_utf16) problems.push_back({0, 2, "PM2017", "this file is UTF-16; save it as UTF-8 to have it formatted"});
}

/// Words that are longer than any program's cost time with the square of their length.
void check_long_words(std::string_view text, std::vector<Problem>& problems) {
  constexpr std::size_t kLongestWord = 1000;
  std::size_t length = 0;
  for (std::size_t i = 0; i < text.size() && problems.empty(); ++i) {
    length = is_name_part(text[i]) ? length + 1 : 0;
    if (length == kLongestWord) problems.push_back({i + 1 - length, 1, "PM2010", "this word is too long"});
  }
}

}  // namespace

Formatted format(std::string_view text, const std::string& file_name, const Names& names, const Options& options) {
  Formatted result;
  check_encoding(text, result.problems);
  check_long_words(text, result.problems);
  if (!result.problems.empty()) return result;
  const SourceText source = read_source(text, names);
  check_comments(source, result.problems);
  std::string formatted = Formatter(source, options, result.problems).run();
  if (!result.problems.empty()) return result;
  if (const auto difference = find_difference(source, formatted, file_name, names))
    result.problems.push_back({difference->offset, 1, "PM2016", fmt::format("formatting would change what the program means here ({}); the file is left as it is", difference->what)});
  else result.text = std::move(formatted);
  return result;
}

}  // namespace pmac::style
