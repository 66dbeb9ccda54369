#include "compiler/frontend/acr1000/tokens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace pmac::compiler::acr1000 {
namespace {

using Parser = grammar::Acr1000Parser;

struct ForeignCommand { std::string_view name, remedy; };
constexpr ForeignCommand kForeignCommands[] = {
#define FOREIGN_COMMAND(name, remedy) {name, remedy},
#include "compiler/frontend/acr1000/foreign_command.def"
#undef FOREIGN_COMMAND
};

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool is_hex(char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }
char upper(char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); }

/// A printable form of a character for messages.
std::string shown(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x20 && byte < 0x7f ? fmt::format("'{}'", c) : fmt::format("the byte {:02X} (hexadecimal)", byte);
}

/// Reads one line from left to right.
class LineLexer {
 public:
  LineLexer(const source::SourceManager& sources, const source::Span& line, std::vector<Token>& tokens, source::Diagnostics& diagnostics)
      : line_(line), text_(sources.text(line)), tokens_(tokens), diagnostics_(diagnostics) {}

  bool run() {
    skip_blanks();
    if (is_digit(peek())) take_while(Parser::LINE_NUMBER, is_digit);
    at_command_ = true;
    while (!failed_ && (skip_blanks(), at_ < text_.size())) word();
    return !failed_;
  }

 private:
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }
  /// The next character that is no blank, `ahead` of them further on, without going there.
  char look(std::size_t ahead = 0) const {
    for (std::size_t i = at_; i < text_.size(); ++i)
      if (!is_blank(text_[i]) && ahead-- == 0) return text_[i];
    return '\0';
  }
  char take() {
    skip_blanks();
    return text_[at_++];
  }
  source::Span from(std::size_t begin) const {
    return {line_.file, line_.begin + static_cast<std::uint32_t>(begin), line_.begin + static_cast<std::uint32_t>(std::max(at_, begin)), -1};
  }
  void put(std::size_t type, std::string text, std::size_t begin) { tokens_.push_back({type, std::move(text), from(begin)}); }
  void fail(const char* code, std::size_t begin, std::string message) {
    failed_ = true;
    diagnostics_.error(code, from(begin), std::move(message));
  }

  template <class Predicate>
  std::string run_of(Predicate belongs) {
    std::string text;
    while (belongs(look())) text += take();
    return text;
  }
  template <class Predicate>
  void take_while(std::size_t type, Predicate belongs) {
    const std::size_t begin = at_;
    std::string text = run_of(belongs);
    put(type, std::move(text), begin);
  }

  void word() {
    if (at_command_ && (is_letter(peek()))) return command();
    at_command_ = false;
    if (hexadecimal_ && is_hex(peek())) return take_while(Parser::BARE_HEX, is_hex);
    if (is_digit(peek())) return take_while(Parser::NUMBER, is_digit);
    switch (peek()) {
      case '"': return string();
      case '&': return prefixed_hex();
      case 'P': return parameter();
      default: return is_letter(peek()) ? argument_word() : sign();
    }
  }

  // --- where a command may begin ------------------------------------------------------------------------------------------------

  void command() {
    at_command_ = false;
    if (upper(peek()) == 'P' && is_digit(look(1))) return parameter();
    const std::size_t begin = at_;
    if (upper(look()) == 'I' && upper(look(1)) == 'F') {
      take(), take();
      return put(Parser::IF, "IF", begin);
    }
    if (key() == "REM") return remark();
    for (const CommandSpelling& row : command_spellings())
      if (row.key == key()) return spelled(row, begin);
    unknown(begin);
  }

  /// The three letters here, in capitals.
  std::string key() const {
    std::string letters;
    for (std::size_t i = 0; i < 3 && is_letter(look(i)); ++i) letters += upper(look(i));
    return letters;
  }

  void remark() {
    const std::size_t begin = at_;
    at_ = text_.size();
    put(Parser::REMARK, std::string(text_.substr(begin)), begin);
  }

  /// Takes as many letters as the spelling of the row goes on with.
  void spelled(const CommandSpelling& row, std::size_t begin) {
    const std::string letters = all_letters();
    const auto differ = std::mismatch(letters.begin(), letters.end(), row.spelling.begin(), row.spelling.end()).first;
    const auto length = static_cast<std::size_t>(differ - letters.begin());
    if (const ForeignCommand* foreign = foreign_of(letters, length)) return refuse_foreign(*foreign, begin);
    for (std::size_t i = 0; i < length; ++i) take();
    put(row.type, std::string(row.spelling), begin);
    hexadecimal_ = row.type == Parser::POK || row.type == Parser::PEE;
    const char next = look();
    const bool starts_argument = !is_letter(next) || next == 'P' || (hexadecimal_ && is_hex(next));
    const bool small_parameter = next == 'p' && is_digit(look(1));  // has a message of its own
    if (starts_argument || small_parameter) return;
    run_of(is_letter);
    fail("ACR-E02", begin, fmt::format("'{}' is no spelling of {}; the first three letters are enough, those that follow have to be right", letters, row.spelling));
  }

  std::string all_letters() const {
    std::string letters;
    for (std::size_t i = 0; is_letter(look(i)); ++i) letters += upper(look(i));
    return letters;
  }

  /// The command of another card that the letters are, if it says more than the spelling that was found.
  static const ForeignCommand* foreign_of(const std::string& letters, std::size_t longer_than) {
    const auto* row = std::find_if(std::begin(kForeignCommands), std::end(kForeignCommands), [&](const ForeignCommand& f) { return f.name == letters && f.name.size() > longer_than; });
    return row == std::end(kForeignCommands) ? nullptr : row;
  }

  void refuse_foreign(const ForeignCommand& foreign, std::size_t begin) {
    run_of(is_letter);
    fail("ACR-E01", begin, fmt::format("{} is not part of the documented ACR1000 subset{}{}", foreign.name, foreign.remedy.empty() ? "" : "; ", foreign.remedy));
  }

  void unknown(std::size_t begin) {
    const std::string letters = run_of(is_letter);
    std::string capitals = letters;
    std::transform(capitals.begin(), capitals.end(), capitals.begin(), upper);
    if (const ForeignCommand* foreign = foreign_of(capitals, 0)) return refuse_foreign(*foreign, begin);
    if (capitals == "P") return fail("ACR-E05", begin, "a parameter is P and its number: P30");
    std::vector<std::string_view> names;
    for (const CommandSpelling& row : command_spellings()) names.push_back(row.spelling), names.push_back(row.key);
    const source::Guess guess = source::guess_word(capitals, names);
    failed_ = true;
    auto& error = diagnostics_.error("ACR-E01", from(begin), fmt::format("no command begins with '{}'{}", letters.substr(0, 24), guess.word.empty() ? std::string() : fmt::format("; did you mean {}?", guess.word)));
    if (!guess.word.empty()) error.fix = source::FixIt{from(begin), std::string(guess.word), source::FixSafety::kSuggestion, {}};
  }

  // --- arguments ------------------------------------------------------------------------------------------------------------------

  void parameter() {
    const std::size_t begin = at_;
    const bool capital = take() == 'P';
    const std::string digits = run_of(is_digit);
    if (!capital) return fail("ACR-E05", begin, fmt::format("a parameter has a capital P: P{}", digits));
    if (digits.empty()) return fail("ACR-E05", begin, "a parameter is P and its number: P30");
    put(Parser::PARAMETER, digits, begin);
  }

  void prefixed_hex() {
    const std::size_t begin = at_;
    take();
    const bool marked = upper(look()) == 'H';
    if (marked) take();
    const std::string digits = marked ? run_of(is_hex) : std::string();
    if (digits.empty()) return fail("ACR-E02", begin, "a hexadecimal number is &H and digits 0-9 A-F: &H3E8");
    put(Parser::HEX_NUMBER, digits, begin);
  }

  void string() {
    const std::size_t begin = at_;
    const std::size_t end = text_.find('"', at_ + 1);
    at_ = end == std::string_view::npos ? text_.size() : end + 1;
    if (end == std::string_view::npos) return fail("ACR-E14", begin, "the text has no end; put a quote behind it");
    put(Parser::STRING, std::string(text_.substr(begin + 1, end - begin - 1)), begin);
  }

  /// THEN, or letters that mean nothing here.
  void argument_word() {
    const std::size_t begin = at_;
    if (key() == "THE") {
      for (int i = 0; i < 3; ++i) take();
      if (upper(look()) == 'N') take();
      put(Parser::THEN, "THEN", begin);
      at_command_ = true;
      return;
    }
    if (peek() == 'p' && is_digit(look(1))) return parameter();
    if (key() == "REM") return fail("ACR-E02", begin, "REM is a command of its own; put a : before it");
    put(Parser::STRANGE, run_of(is_letter), begin);
  }

  void sign() {
    struct Sign { char c; std::size_t type; };
    static constexpr Sign kSigns[] = {{'+', Parser::PLUS}, {'-', Parser::MINUS}, {'*', Parser::STAR}, {'/', Parser::SLASH}, {',', Parser::COMMA},
                                      {'=', Parser::EQUALS}, {':', Parser::COLON}, {'(', Parser::LEFT}, {')', Parser::RIGHT}};
    const std::size_t begin = at_;
    const char c = take();
    for (const Sign& row : kSigns) {
      if (row.c != c) continue;
      if (c == ':') at_command_ = true, hexadecimal_ = false;
      return put(row.type, std::string(1, c), begin);
    }
    if (c == '.') return fail("ACR-E02", begin, "numbers are whole: there is no decimal point");
    fail("ACR-E02", begin, fmt::format("{} means nothing to the card", shown(c)));
  }

  source::Span line_;
  std::string_view text_;
  std::vector<Token>& tokens_;
  source::Diagnostics& diagnostics_;
  std::size_t at_ = 0;
  bool at_command_ = false, hexadecimal_ = false, failed_ = false;
};

}  // namespace

const std::vector<CommandSpelling>& command_spellings() {
  static const std::vector<CommandSpelling> rows = {
#define COMMAND(Token, key, spelling, usage) {grammar::Acr1000Parser::Token, key, spelling, usage},
#include "compiler/frontend/acr1000/command.def"
#undef COMMAND
  };
  return rows;
}

std::string_view usage_of(std::size_t type) {
  for (const CommandSpelling& row : command_spellings())
    if (row.type == type) return row.usage;
  return {};
}

bool lex_line(const source::SourceManager& sources, const source::Span& line, std::vector<Token>& tokens, source::Diagnostics& diagnostics) {
  return LineLexer(sources, line, tokens, diagnostics).run();
}

}  // namespace pmac::compiler::acr1000
