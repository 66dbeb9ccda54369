#include "compiler/style/same_program.h"

#include "compiler/frontend/power_pmac/preprocessor.h"

namespace pmac::style {
namespace {

using compiler::power_pmac::Word;
using compiler::power_pmac::WordKind;
using compiler::power_pmac::WordReader;

/// Without carriage returns, and without blanks at its end.
std::string normal(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (!(text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n')) result += text[i];
  while (!result.empty() && is_blank(result.back())) result.pop_back();
  return result;
}

bool may_change_case(PieceKind kind) {
  return kind == PieceKind::kKeyword || kind == PieceKind::kLetter || kind == PieceKind::kName || kind == PieceKind::kMember;
}

bool same_spelling(std::string_view before, std::string_view after, bool is_free) {
  return before == after || (is_free && lower_case(before) == lower_case(after));
}

/// On line, `P1=5 &2` addresses a coordinate system; `P1=5&2` and `P1=5 & 2` are a bitwise and.
class AddressCheck {
 public:
  explicit AddressCheck(bool in_buffer) : in_buffer_(in_buffer) {}

  /// False where the blanks around the & before a word mean something else on both sides.
  template <class Walk>
  bool take(const Walk& left, const Walk& right) {
    const bool same = !behind_ampersand_ || (left_blank_ && !left.blank_before()) == (right_blank_ && !right.blank_before());
    behind_ampersand_ = !in_buffer_ && left.text() == "&" && !left.new_line() && !begins_command_;
    left_blank_ = left.blank_before();
    right_blank_ = right.blank_before();
    begins_command_ = left.text() == ";";
    follow_buffer(left.text());
    return same;
  }

 private:
  void follow_buffer(std::string_view word) {
    if (word.size() != 4 && word.size() != 5) return;
    const std::string keyword = lower_case(word);
    if (keyword == "open") in_buffer_ = true;
    if (keyword == "close") in_buffer_ = false;
  }

  bool in_buffer_;
  bool behind_ampersand_ = false;  // one that does not begin a command anyway
  bool left_blank_ = false;        // before the word before
  bool right_blank_ = false;
  bool begins_command_ = true;
};

// --- the text as the formatter reads it ---------------------------------------------------------------------------------------

/// The pieces that are no line ends.
class PieceWalk {
 public:
  explicit PieceWalk(const SourceText& source) : source_(source) {}

  bool next() {
    new_line_ = false;
    const std::uint32_t last_end = piece_ ? piece_->end : 0;
    while (at_ < source_.pieces.size() && source_.pieces[at_].kind == PieceKind::kNewline) ++at_, new_line_ = true;
    if (at_ == source_.pieces.size()) return false;
    piece_ = &source_.pieces[at_++];
    blank_before_ = last_end < piece_->begin;
    return true;
  }
  const Piece& piece() const { return *piece_; }
  std::string_view text() const { return source_.of(*piece_); }
  bool new_line() const { return new_line_; }
  bool blank_before() const { return blank_before_; }
  Difference difference(const std::string& what) const { return {piece_ ? piece_->begin : 0, what}; }

 private:
  const SourceText& source_;
  const Piece* piece_ = nullptr;
  std::size_t at_ = 0;
  bool new_line_ = false;
  bool blank_before_ = false;
};

/// A word behind a dot can be a macro, but no declared name.
bool is_name(const Names& names, PieceKind kind, std::string_view word) { return kind == PieceKind::kMember ? names.macros.contains(word) : names.contains(word); }

bool same_piece(const PieceWalk& left, const PieceWalk& right, const Names& names) {
  const PieceKind kind = left.piece().kind;
  if (kind != right.piece().kind || left.piece().type != right.piece().type) return false;
  if (!left.piece().is_word() || kind == PieceKind::kRaw) return normal(left.text()) == normal(right.text());
  const bool is_free = may_change_case(kind) && !is_name(names, kind, left.text()) && !is_name(names, kind, right.text());
  return same_spelling(left.text(), right.text(), is_free);
}

std::optional<Difference> compare_pieces(const SourceText& before, const SourceText& after) {
  PieceWalk left(before), right(after);
  AddressCheck addresses(before.in_buffer);
  for (bool first = true;; first = false) {
    const bool more = left.next();
    if (more != right.next()) return left.difference("a word too many or too few");
    if (!more) return std::nullopt;
    if (!same_piece(left, right, before.names)) return left.difference("'" + std::string(left.text().substr(0, 40)) + "'");
    if (!first && left.new_line() != right.new_line()) return left.difference("a line end");
    if (!addresses.take(left, right)) return left.difference("blanks around &");
  }
}

// --- the text as the compiler reads it ------------------------------------------------------------------------------------------

/// The words of a text that the preprocessor has been through.
class WordWalk {
 public:
  WordWalk(const std::string& text, const WordReader::Names& names, bool in_buffer) : text_(text), reader_(text, names, in_buffer) {}

  bool next() {
    const std::uint32_t last_end = word_.end;
    if (!reader_.next(word_)) return false;
    const std::string_view gap = std::string_view(text_).substr(last_end, word_.begin - last_end);
    new_line_ = gap.find('\n') != std::string_view::npos;
    blank_before_ = !gap.empty();
    return true;
  }
  const Word& word() const { return word_; }
  std::string_view text() const { return std::string_view(text_).substr(word_.begin, word_.end - word_.begin); }
  bool new_line() const { return new_line_; }
  bool blank_before() const { return blank_before_; }
  bool knows(std::string_view name) const { return reader_.declared().contains(name); }

 private:
  const std::string& text_;
  WordReader reader_;
  Word word_;
  bool new_line_ = false;
  bool blank_before_ = false;
};

bool same_word(const WordWalk& left, const WordWalk& right) {
  const bool is_member = left.word().kind == WordKind::kMember;
  const bool is_free = may_change_case(static_cast<PieceKind>(left.word().kind)) && (is_member || !left.knows(left.text()));
  return left.word().type == right.word().type && same_spelling(left.text(), right.text(), is_free);
}

/// Offset in the expanded text before of the first word that differs.
std::optional<std::size_t> compare_words(WordWalk left, WordWalk right, bool in_buffer) {
  AddressCheck addresses(in_buffer);
  for (bool first = true;; first = false) {
    const bool more = left.next();
    if (more != right.next()) return left.word().begin;
    if (!more) return std::nullopt;
    const bool same_line_end = first || left.new_line() == right.new_line();
    const bool same_address = addresses.take(left, right);
    if (!same_word(left, right) || !same_line_end || !same_address) return left.word().begin;
  }
}

compiler::power_pmac::ExpandedText expand(const std::string& file_name, std::string_view text) {
  source::SourceManager sources;
  source::Diagnostics ignored;
  compiler::power_pmac::Preprocessor preprocessor(sources, ignored, {});
  return preprocessor.run(sources.add_file(file_name, std::string(text)));
}

std::optional<Difference> compare_expanded(const SourceText& before, std::string_view after, const std::string& file_name, const Names& names) {
  const auto left = expand(file_name, before.text);
  const auto right = expand(file_name, after);
  const auto at = compare_words(WordWalk(left.text(), names.declared, before.in_buffer), WordWalk(right.text(), names.declared, before.in_buffer), before.in_buffer);
  if (!at) return std::nullopt;
  return Difference{left.span_of(*at, *at + 1).begin, "behind the preprocessor"};
}

}  // namespace

std::optional<Difference> find_difference(const SourceText& before, std::string_view after, const std::string& file_name, const Names& names) {
  if (auto difference = compare_pieces(before, read_source(after, names))) return difference;
  return before.has_directives ? compare_expanded(before, after, file_name, names) : std::nullopt;
}

}  // namespace pmac::style
