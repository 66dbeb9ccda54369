#include "compiler/style/plain_lines.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace pmac::style {
namespace {

using compiler::power_pmac::Word;
using compiler::power_pmac::WordReader;

constexpr std::string_view kLetters = "ABCUVWXYZIJKF";

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_gap(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_plain_letter(char c) { return kLetters.find(static_cast<char>(std::toupper(static_cast<unsigned char>(c)))) != std::string_view::npos; }

/// Token types as the lexer gives them.
struct Types {
  std::array<std::uint16_t, 256> of_letter{};
  std::uint16_t plus = 0, minus = 0, number = 0, semicolon = 0;
};

Types ask_lexer() {
  std::string text;
  for (const char letter : kLetters) (text += letter) += "1 ";
  text += "+-;";
  Types types;
  WordReader reader(text, {}, true);
  for (Word word; reader.next(word);) {
    const char c = text[word.begin];
    if (is_plain_letter(c)) types.of_letter[static_cast<unsigned char>(c)] = types.of_letter[static_cast<unsigned char>(std::tolower(c))] = word.type;
    else (c == '+' ? types.plus : c == '-' ? types.minus : c == ';' ? types.semicolon : types.number) = word.type;
  }
  return types;
}

const Types& types() { static const Types all = ask_lexer(); return all; }

/// Reads one line; the words are added only when the whole line is plain.
class LineReader {
 public:
  LineReader(std::string_view code, std::size_t begin, std::size_t end, std::vector<Piece>& words) : code_(code), at_(begin), end_(end), words_(words) {}

  bool read() {
    const std::size_t before = words_.size();
    skip_gap();
    bool plain = at_ < end_;
    while (plain && at_ < end_ && code_[at_] != ';') plain = read_word();
    if (plain && at_ < end_) {
      add(PieceKind::kSign, types().semicolon, at_ + 1);
      skip_gap();
      plain = at_ == end_ && words_.size() > before + 1;
    }
    if (!plain) words_.resize(before);
    return plain;
  }

 private:
  char here() const { return at_ < end_ ? code_[at_] : '\0'; }
  void skip_gap() { while (at_ < end_ && is_gap(code_[at_])) ++at_; }

  void add(PieceKind kind, std::uint16_t type, std::size_t end) {
    words_.push_back({static_cast<std::uint32_t>(at_), static_cast<std::uint32_t>(end), type, kind});
    at_ = end;
  }

  /// A letter, a sign perhaps, and a number that ends with a digit.
  bool read_word() {
    if (!is_plain_letter(here())) return false;
    add(PieceKind::kLetter, types().of_letter[static_cast<unsigned char>(here())], at_ + 1);
    skip_gap();
    if (here() == '+' || here() == '-') add(PieceKind::kSign, here() == '+' ? types().plus : types().minus, at_ + 1);
    skip_gap();
    std::size_t end = at_;
    const auto skip_digits = [&] { while (end < end_ && is_digit(code_[end])) ++end; };
    skip_digits();
    if (end < end_ && code_[end] == '.') {
      ++end;
      skip_digits();
    }
    if (end == at_ || !is_digit(code_[end - 1])) return false;
    add(PieceKind::kNumber, types().number, end);
    skip_gap();
    return at_ == end_ || here() == ';' || is_plain_letter(here());
  }

  std::string_view code_;
  std::size_t at_, end_;
  std::vector<Piece>& words_;
};

/// Nothing goes on behind a line that ends so, and the lexer waits for no name.
bool ends_statement(char last) { return last == ';' || last == ')' || last == '}' || is_digit(last); }

}  // namespace

std::vector<Piece> take_plain_lines(std::string& code) {
  std::vector<Piece> words;
  char last = '\0';            // of the lines before
  bool behind_plain = false;   // the line before is plain, and so is the state of the lexer behind it
  for (std::size_t at = 0; at < code.size();) {
    const std::size_t end = std::min(code.find('\n', at), code.size());
    const std::size_t first = std::min(code.find_first_not_of(" \t\r", at), end);
    const std::size_t before = words.size();
    if (first == end) {
      at = end + 1;
      continue;
    }
    const bool is_plain = LineReader(code, at, end, words).read();
    const bool is_taken = is_plain && (behind_plain || last == ';');
    if (is_taken) std::fill(code.begin() + static_cast<std::ptrdiff_t>(at), code.begin() + static_cast<std::ptrdiff_t>(end), ' ');
    else words.resize(before);
    behind_plain = is_taken || (is_plain && ends_statement(last));
    if (!is_taken) last = code[code.find_last_not_of(" \t\r", end - 1)];
    at = end + 1;
  }
  return words;
}

bool could_be_plain(std::string_view name) {
  for (std::size_t i = 0; i < name.size();) {
    if (!is_plain_letter(name[i++])) return false;
    const std::size_t digits = i;
    while (i < name.size() && is_digit(name[i])) ++i;
    if (i == digits && i < name.size()) return false;
  }
  return !name.empty();
}

}  // namespace pmac::style
