// A text as the formatter sees it: a row of pieces with nothing but blanks between them. Words are cut by the compiler's lexer;
// comments, directives, macro calls and place-holders are pieces as they stand.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/frontend/power_pmac/word_reader.h"
#include "compiler/style/style.h"

namespace pmac::style {

enum class PieceKind : std::uint8_t {
  kKeyword, kLetter, kName, kMember, kNumber, kString, kPointer, kSign,  // words, see WordKind
  kRaw,        // a macro call with its arguments, a place-holder $(NAME): one operand, kept byte by byte
  kComment,
  kDirective,  // with its continued lines
  kSkipped,    // a line of #if 0
  kNewline
};

struct Piece {
  std::uint32_t begin = 0, end = 0;  // bytes of the text
  std::uint16_t type = 0;            // of a word, from the grammar
  PieceKind kind = PieceKind::kSign;
  bool is_word() const { return kind <= PieceKind::kRaw; }
};

struct SourceText {
  std::string_view text;
  std::vector<Piece> pieces;
  Names names;               // those given, and all of the text itself
  std::set<std::string, std::less<>> shared;  // those that other files of the project may use
  bool in_buffer = false;    // a fragment that is included inside open ... close
  bool has_directives = false;

  std::string_view of(const Piece& piece) const { return text.substr(piece.begin, piece.end - piece.begin); }
  bool spans_lines(const Piece& piece) const { return of(piece).find('\n') != std::string_view::npos; }
};

/// When to read plain lines in the short way of plain_lines.h: where it pays, or as a test wants it.
enum class PlainLines : std::uint8_t { kInLongTexts, kAlways, kNever };

/// The text outlives the result.
SourceText read_source(std::string_view text, const Names& names, PlainLines plain_lines = PlainLines::kInLongTexts);

/// Pieces of everything but words, and the text with blanks in their place.
struct Outline {
  std::vector<Piece> pieces;  // comments, directives, skipped lines, line ends
  std::string code;
  std::map<std::string, bool, std::less<>> macros;
};
Outline read_outline(std::string_view text);

bool is_blank(char c);
bool is_name_part(char c);
std::string lower_case(std::string_view text);

}  // namespace pmac::style
