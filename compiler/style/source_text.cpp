// Outline and words put together, and macro calls made one piece.
#include "compiler/style/source_text.h"

#include <algorithm>

#include "compiler/style/plain_lines.h"

namespace pmac::style {
namespace {

using compiler::power_pmac::Word;
using compiler::power_pmac::WordKind;
using compiler::power_pmac::WordReader;

constexpr std::size_t kMaxCallPieces = 400;  // a macro call that is not closed before that is none

PieceKind piece_kind(WordKind kind) { return static_cast<PieceKind>(kind); }

/// A file without open ... close that has if ( or while ( at the beginning of a line: a part of a program, for #include.
bool is_fragment(std::string_view code) {
  bool found = false;
  bool at_line_start = true;
  for (std::size_t at = 0; at < code.size(); ++at) {
    if (code[at] == '\n') at_line_start = true;
    if (!is_name_part(code[at])) {
      at_line_start = at_line_start && (is_blank(code[at]) || code[at] == '\n' || code[at] == '}');
      continue;
    }
    std::size_t end = at;
    while (end < code.size() && is_name_part(code[end])) ++end;
    const std::string word = lower_case(code.substr(at, std::min<std::size_t>(end - at, 8)));
    if (word == "open" || word == "close") return false;
    const std::size_t next = code.find_first_not_of(" \t\r\n", end);
    if (at_line_start && (word == "if" || word == "while" || word == "switch") && next != std::string_view::npos && code[next] == '(') found = true;
    at_line_start = false;
    at = end - 1;
  }
  return found;
}

bool any_could_be_plain(const WordReader::Names& names) {
  return std::any_of(names.begin(), names.end(), [](const std::string& name) { return could_be_plain(name); });
}

/// Follows open and close in a row of pieces.
class BufferWatch {
 public:
  BufferWatch(const SourceText& source) : source_(source), in_buffer_(source.in_buffer) {}
  bool in_buffer() const { return in_buffer_; }
  void take(const Piece& piece) {
    if (piece.kind != PieceKind::kKeyword || piece.end - piece.begin > 5) return;
    const std::string word = lower_case(source_.of(piece));
    if (word == "open") in_buffer_ = true;
    if (word == "close") in_buffer_ = false;
  }

 private:
  const SourceText& source_;
  bool in_buffer_;
};

/// Puts the words of the code between the pieces of the outline and those of plain lines, and notes the names that are declared.
/// False where a plain line turns out to be none, outside of a buffer or by a name.
bool merge_words(const std::vector<Piece>& outline, const std::string& code, const std::vector<Piece>& plain, SourceText& source) {
  WordReader::Names known = source.names.declared;
  for (const auto& [name, takes_arguments] : source.names.macros) known.insert(name);
  if (!plain.empty() && any_could_be_plain(known)) return false;
  WordReader reader(code, known, source.in_buffer);
  std::vector<Piece>& pieces = source.pieces;
  pieces.clear();
  pieces.reserve(outline.size() + plain.size());
  auto next_plain = plain.begin();
  auto next = outline.begin();
  BufferWatch watch(source);
  bool plain_in_buffer = true;
  const auto add_until = [&](std::uint32_t begin) {
    while (true) {
      const bool has_plain = next_plain != plain.end() && next_plain->begin < begin;
      const bool has_other = next != outline.end() && next->begin < begin;
      if (!has_plain && !has_other) return;
      const bool plain_first = has_plain && (!has_other || next_plain->begin < next->begin);
      plain_in_buffer = plain_in_buffer && (!plain_first || watch.in_buffer());
      pieces.push_back(plain_first ? *next_plain++ : *next++);
    }
  };
  for (Word word; reader.next(word);) {
    add_until(word.begin);
    pieces.push_back({word.begin, word.end, word.type, piece_kind(word.kind)});
    watch.take(pieces.back());
  }
  add_until(static_cast<std::uint32_t>(-1));
  if (!plain_in_buffer || (!plain.empty() && any_could_be_plain(reader.declared()))) return false;
  source.names.declared.insert(reader.declared().begin(), reader.declared().end());
  source.shared = reader.shared();
  return true;
}

/// The words of a text, in the short way where that is right.
void read_words(const Outline& outline, PlainLines plain_lines, SourceText& source) {
  constexpr std::size_t kLongText = 200000;
  const bool try_plain = plain_lines == PlainLines::kAlways || (plain_lines == PlainLines::kInLongTexts && source.text.size() >= kLongText);
  if (try_plain) {
    std::string code = outline.code;
    const std::vector<Piece> plain = take_plain_lines(code);
    if (merge_words(outline.pieces, code, plain, source)) return;
  }
  merge_words(outline.pieces, outline.code, {}, source);
}

/// Names of open prog Name and sub: name, which no declaration lists.
void note_program_names(SourceText& source) {
  std::string before;
  for (const Piece& piece : source.pieces) {
    if (!piece.is_word()) continue;
    const bool names_program = before == "prog" || before == "plc" || before == "subprog" || before == "sub:";
    if (names_program && piece.kind == PieceKind::kName) {
      source.names.declared.emplace(source.of(piece));
      source.shared.emplace(source.of(piece));
    }
    if (piece.kind == PieceKind::kKeyword) before = lower_case(source.of(piece));
    else if (before == "sub" && source.of(piece) == ":") before = "sub:";
    else before.clear();
  }
}

/// Index behind the parenthesis that closes the one at open, or 0.
std::size_t end_of_call(const SourceText& source, std::size_t open, bool on_one_line) {
  int depth = 0;
  for (std::size_t i = open; i < source.pieces.size() && i < open + kMaxCallPieces; ++i) {
    const Piece& piece = source.pieces[i];
    if (piece.kind == PieceKind::kDirective || piece.kind == PieceKind::kSkipped || (on_one_line && piece.kind == PieceKind::kNewline)) return 0;
    if (piece.kind != PieceKind::kSign) continue;
    if (source.of(piece) == "(") ++depth;
    if (source.of(piece) == ")" && --depth == 0) return i + 1;
  }
  return 0;
}

/// Where the piece at hand begins a macro call or a place-holder: index behind it, otherwise 0.
std::size_t raw_end(const SourceText& source, std::size_t at) {
  const Piece& piece = source.pieces[at];
  if (at + 1 >= source.pieces.size() || source.of(source.pieces[at + 1]) != "(") return 0;
  if (piece.kind == PieceKind::kSign && source.of(piece) == "$" && piece.end == source.pieces[at + 1].begin) return end_of_call(source, at + 1, true);
  if (piece.kind != PieceKind::kName) return 0;
  const auto macro = source.names.macros.find(source.of(piece));
  return macro != source.names.macros.end() && macro->second ? end_of_call(source, at + 1, false) : 0;
}

void join_raw_pieces(SourceText& source) {
  std::size_t kept = 0;
  for (std::size_t at = 0; at < source.pieces.size();) {
    Piece piece = source.pieces[at];
    const std::size_t end = raw_end(source, at);
    if (end) piece = {piece.begin, source.pieces[end - 1].end, 0, PieceKind::kRaw};
    source.pieces[kept++] = piece;
    at = end ? end : at + 1;
  }
  source.pieces.resize(kept);
}

}  // namespace

SourceText read_source(std::string_view text, const Names& names, PlainLines plain_lines) {
  const Outline outline = read_outline(text);
  SourceText source{text, {}, names, {}, is_fragment(outline.code), false};
  for (const auto& [name, takes_arguments] : outline.macros) source.names.macros[name] |= takes_arguments;
  read_words(outline, plain_lines, source);
  source.has_directives = std::any_of(outline.pieces.begin(), outline.pieces.end(), [](const Piece& p) { return p.kind == PieceKind::kDirective; });
  note_program_names(source);
  join_raw_pieces(source);
  return source;
}

void collect_names(std::string_view text, Names& names) {
  SourceText source = read_source(text, names);
  names.declared = std::move(source.shared);
  names.macros = std::move(source.names.macros);
}

}  // namespace pmac::style
