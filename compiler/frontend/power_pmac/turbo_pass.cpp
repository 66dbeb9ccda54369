#include "compiler/frontend/power_pmac/turbo_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>
#include <optional>
#include <vector>

#include "compiler/frontend/power_pmac/turbo_blocks.h"

namespace pmac::compiler::power_pmac {
namespace {

using T = grammar::PowerPmacParser;

struct Spelling { std::string_view word; std::size_t first, second; std::string_view power; };
struct Only { std::string_view word, hint; };

constexpr Spelling kSpellings[] = {
#define TURBO_SPELLING(word, first, second, power) {word, first, second, power},
#define TURBO_ONLY(word, hint)
#include "compiler/frontend/power_pmac/turbo_word.def"
#undef TURBO_SPELLING
#undef TURBO_ONLY
};

constexpr Only kOnly[] = {
#define TURBO_SPELLING(word, first, second, power)
#define TURBO_ONLY(word, hint) {word, hint},
#include "compiler/frontend/power_pmac/turbo_word.def"
#undef TURBO_SPELLING
#undef TURBO_ONLY
};

template <class Row, std::size_t N>
const Row* find_row(const Row (&rows)[N], std::string_view word) {
  const auto* row = std::find_if(std::begin(rows), std::end(rows), [&](const Row& r) { return r.word == word; });
  return row == std::end(rows) ? nullptr : row;
}

constexpr double kMostVariables = 65536;  // of one letter

constexpr std::string_view kMemories[] = {"x", "y", "l", "d", "f", "dp", "tws", "twb", "twd", "twr"};

class TurboPass {
 public:
  TurboPass(TokenList& tokens, const DeclaredNames& names) : tokens_(tokens), names_(names), blocks_(tokens, names) {}

  void run() {
    for (std::size_t i = 0; i + 1 < tokens_.size(); ++i) {
      const std::size_t type = tokens_.type(i);
      if (type == T::OPEN) take_open(i);
      else if (type == T::ARROW) take_pointer(i);
      else if (type == T::CMD && tokens_.text(i + 1) == "^") take_control_character(i);
      else if (type == T::DELETE || (type == T::NAME && tokens_.text(i) == "end")) take_gather(i);
      else if (type == T::NUMBER) take_timer(i);
      else if (type == T::RANGE) take_range(i);
      else if (type == T::NAME && is_statement_word(i)) take_word(i);
      blocks_.take(i);
    }
  }

 private:
  /// A name where a statement may begin, that is no declared name and is not assigned or indexed.
  bool is_statement_word(std::size_t i) const {
    if (names_.contains(tokens_.exact_text(i))) return false;
    const std::size_t next = tokens_.type(i + 1);
    if (next == T::ASSIGN || next == T::DOT || next == T::LEFT_BRACKET || next == T::LEFT || next == T::ARROW || next == T::COMMA) return is_msr(i);
    if (i == 0) return true;
    const std::size_t before = tokens_.type(i - 1);
    return before != T::DOT && before != T::ASSIGN && before != T::COMMA && before != T::LEFT && before != T::CALL && before != T::GLOBAL && before != T::LOCAL &&
           before != T::CSGLOBAL && before != T::PTR && before != T::PROG && before != T::SUBPROG;
  }
  bool is_msr(std::size_t i) const { return tokens_.type(i + 1) == T::COMMA && tokens_.starts_line(i); }

  /// The letters of a word such as DWE100, and the number behind them.
  static std::size_t letters_of(std::string_view word) {
    return static_cast<std::size_t>(std::find_if(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; }) - word.begin());
  }

  void take_word(std::size_t i) {
    const std::string word = tokens_.text(i);
    const std::size_t letters = letters_of(word);
    const bool all_digits_behind = std::all_of(word.begin() + static_cast<std::ptrdiff_t>(letters), word.end(), [](char c) { return std::isdigit(static_cast<unsigned char>(c)); });
    if (!all_digits_behind) return;
    const std::string_view name = std::string_view(word).substr(0, letters);
    if (const Spelling* row = find_row(kSpellings, name)) return respell(i, *row, letters);
    if (const Only* row = find_row(kOnly, name)) refuse_word(i, *row);
  }

  void respell(std::size_t i, const Spelling& row, std::size_t letters) {
    std::string power = std::string(row.power) + tokens_.exact_text(i).substr(letters);
    while (power.ends_with(' ')) power.pop_back();
    const source::Span span = tokens_.span(i);
    auto* error = tokens_.error("PM2024", span, fmt::format("{} is Turbo PMAC; write {}", tokens_.exact_text(i), power));
    if (error) error->fix = source::FixIt{span, power};
    const std::size_t size = tokens_.exact_text(i).size();
    tokens_.retype(i, row.first);
    if (row.second) tokens_.insert_behind(i, row.second);
    if (size > letters) tokens_.split_number(i, letters);
  }

  void refuse_word(std::size_t i, const Only& row) {
    const std::string word(tokens_.exact_text(i));
    const std::size_t last = tokens_.last_of_line(i);
    const bool addresses = row.word == "address" || row.word == "adr";
    const bool numbered = addresses && tokens_.type(i + 1) != T::NAME && i + 2 < tokens_.size() && tokens_.type(i + 2) == T::NUMBER && tokens_.line(i + 2) == tokens_.line(i);
    auto* error = tokens_.error("PM2025", tokens_.span(i), fmt::format("{} is Turbo PMAC; in Power PMAC {}", word, row.hint));
    if (error && numbered) {
      const bool motor = tokens_.type(i + 1) == T::HASH;
      error->fix = source::FixIt{source::join(tokens_.span(i), tokens_.span(i + 2)), fmt::format("Ldata.{} = {}", motor ? "Motor" : "Coord", tokens_.exact_text(i + 2))};
    }
    tokens_.drop(i, numbered ? i + 2 : last);
  }

  /// OPEN PLC 5 CLEAR, also with CLEAR on the next line.
  void take_open(std::size_t i) {
    std::size_t at = i + 1;
    while (at + 1 < tokens_.size() && tokens_.line(at) == tokens_.line(i) && tokens_.type(at) != T::OPEN && tokens_.text(at) != "clear") ++at;
    if (tokens_.text(at) != "clear" || (tokens_.type(at) != T::NAME && tokens_.type(at) != T::CLEAR)) return;
    auto* error = tokens_.error("PM2026", tokens_.span(at), "open empties the buffer by itself; there is no clear in it");
    if (error) error->fix = source::FixIt{tokens_.span(at), ""};
    tokens_.drop(at, at);
  }

  /// M133->X:$0000C0,13,1
  void take_pointer(std::size_t i) {
    if (i < 2 || i + 2 >= tokens_.size() || tokens_.type(i + 2) != T::COLON || tokens_.line(i + 2) != tokens_.line(i)) return;
    const std::string memory = tokens_.text(i + 1);
    if (std::find(std::begin(kMemories), std::end(kMemories), memory) == std::end(kMemories)) return;
    const std::size_t last = tokens_.last_of_line(i);
    const std::size_t first = tokens_.starts_line(i - 1) ? i - 1 : i - 2;
    tokens_.error("PM2023", source::join(tokens_.span(first), tokens_.span(last)),
                  fmt::format("{}: is memory of Turbo PMAC; in Power PMAC a pointer names an element (Motor[1].DesVelZero) or I/O address (u.io:$address.bit.width)", tokens_.exact_text(i + 1)));
    tokens_.retype(i + 1, T::STAR);
    tokens_.drop(i + 2, last);
  }

  /// CMD^K
  void take_control_character(std::size_t i) {
    const std::size_t last = tokens_.line(i + 2) == tokens_.line(i) ? i + 2 : i + 1;
    tokens_.error("PM2025", source::join(tokens_.span(i), tokens_.span(last)), "control characters are no commands of Power PMAC; send the command's text: cmd \"#*k\" kills, cmd \"&*a\" aborts all");
    tokens_.drop(i, last);
  }

  /// P465..496=0
  void take_range(std::size_t i) {
    if (i < 2 || tokens_.type(i - 1) != T::NUMBER || tokens_.type(i + 1) != T::NUMBER || tokens_.type(i + 2) != T::ASSIGN) return;
    const std::size_t letter = tokens_.type(i - 2);
    if (letter != T::VAR && letter != T::LETTER_M && letter != T::LETTER_I) return;
    const double first = std::strtod(tokens_.text(i - 1).c_str(), nullptr), last = std::strtod(tokens_.text(i + 1).c_str(), nullptr);
    const std::string power = fmt::format("{}{},{}", tokens_.exact_text(i - 2), first, last - first + 1);
    const source::Span span = source::join(tokens_.span(i - 2), tokens_.span(i + 1));
    auto* error = tokens_.error("PM2024", span, fmt::format("a range of variables is Turbo PMAC; write the first one and how many: {}", power));
    if (error && last >= first && last < kMostVariables) error->fix = source::FixIt{span, power};
    tokens_.drop(i, i + 1);
  }

  /// DELETE GATHER, END GATHER
  void take_gather(std::size_t i) {
    const std::string what = tokens_.text(i + 1);
    if (what != "gather" && what != "trace" && what != "gat") return;
    tokens_.error("PM2025", source::join(tokens_.span(i), tokens_.span(i + 1)), "gathering is not set up by commands in Power PMAC; the elements Gather.Enable, Gather.Items and Gather.Addr[] do it");
    tokens_.drop(i, i + 1);
  }

  /// ... * 8388608 / I10: milliseconds of the countdown timers I5111 and on.
  void take_timer(std::size_t i) {
    const bool idiom = tokens_.text(i) == "8388608" && i + 3 < tokens_.size() && tokens_.text(i + 1) == "/" && tokens_.type(i + 2) == T::LETTER_I && tokens_.text(i + 3) == "10";
    if (idiom) tokens_.warning("PM7001", source::join(tokens_.span(i), tokens_.span(i + 3)), "the timers of Turbo PMAC (I5111 and on, in servo cycles) do not count here; Sys.CdTimer[n] counts down in milliseconds, and Sys.Time counts seconds");
  }

  TokenList& tokens_;
  const DeclaredNames& names_;
  TurboBlocks blocks_;
};

}  // namespace

std::unique_ptr<antlr4::TokenSource> repair_turbo(antlr4::TokenSource& lexer, const TokenText& text, const DeclaredNames& names, source::Diagnostics* diagnostics) {
  TokenList tokens(lexer, text, diagnostics);
  TurboPass(tokens, names).run();
  return std::make_unique<antlr4::ListTokenSource>(tokens.finish());
}

}  // namespace pmac::compiler::power_pmac
