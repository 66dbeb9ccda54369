#include "compiler/frontend/power_pmac/plain_lines.h"

#include <algorithm>
#include <array>
#include <optional>

#include "compiler/bytecode/letters.h"
#include "compiler/frontend/power_pmac/plain_moves.h"
#include "compiler/frontend/power_pmac/plain_number.h"

namespace pmac::compiler::power_pmac {
namespace {

using ir::MotionParameter;
using source::Span;

constexpr std::size_t kMaxWords = 48;  // of one line; longer ones are left to the grammar

/// What a run of letters with its number is.
enum class Kind : std::uint8_t { kBlockNumber, kCode, kLetter, kMoveLetter, kFeed, kTime, kMode, kAbsInc };

struct Word {
  Kind kind;
  std::uint8_t letter;       // 1 to 26, or 0
  std::uint8_t number;       // of kTime a MotionParameter, of kMode a MoveMode, of kAbsInc 1 for abs
  double value;
  std::uint32_t begin, end;  // of letters and number
  std::uint32_t value_begin;
};

/// kind of a letter that begins a statement, and of one behind a code letter. e, o and n are left to the grammar.
Kind kind_of_letter(char letter) {
  if (letter == 'n') return Kind::kBlockNumber;
  if (letter == 'f') return Kind::kFeed;
  if (std::string_view("gthsmd").find(letter) != std::string_view::npos) return Kind::kCode;
  return std::string_view("abcuvwxyzijkr").find(letter) != std::string_view::npos ? Kind::kMoveLetter : Kind::kLetter;
}

/// Keywords by their name: with a number behind (ta10), without (linear), or with a digit that belongs to them (circle1).
struct Keyword { std::string_view name; Kind kind; std::uint8_t number; };
constexpr std::array<Keyword, 13> kKeywords = {{
    {"ta", Kind::kTime, static_cast<std::uint8_t>(MotionParameter::kTa)},
    {"td", Kind::kTime, static_cast<std::uint8_t>(MotionParameter::kTd)},
    {"ts", Kind::kTime, static_cast<std::uint8_t>(MotionParameter::kTs)},
    {"tm", Kind::kTime, static_cast<std::uint8_t>(MotionParameter::kTm)},
    {"abs", Kind::kAbsInc, 1},
    {"inc", Kind::kAbsInc, 0},
    {"linear", Kind::kMode, static_cast<std::uint8_t>(ir::MoveMode::kLinear)},
    {"rapid", Kind::kMode, static_cast<std::uint8_t>(ir::MoveMode::kRapid)},
    {"circle1", Kind::kMode, static_cast<std::uint8_t>(ir::MoveMode::kCircle1)},
    {"circle2", Kind::kMode, static_cast<std::uint8_t>(ir::MoveMode::kCircle2)},
    {"circle3", Kind::kMode, static_cast<std::uint8_t>(ir::MoveMode::kCircle3)},
    {"circle4", Kind::kMode, static_cast<std::uint8_t>(ir::MoveMode::kCircle4)},
    {"tsd", Kind::kTime, static_cast<std::uint8_t>(MotionParameter::kTsd)},
}};

bool same_word(std::string_view text, std::string_view lower_name) {
  return text.size() == lower_name.size() && std::equal(text.begin(), text.end(), lower_name.begin(), [](char a, char b) { return a == b || (is_letter(a) && (a | 0x20) == b); });
}

bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// The words of one line.
class LineWords {
 public:
  LineWords(std::string_view text, std::size_t at) : text_(text), begin_(text.data()), at_(begin_ + at), end_(begin_ + text.size()) {}

  /// False: not such a line.
  bool read() {
    while (true) {
      while (at_ < end_ && is_blank(*at_)) ++at_;
      if (at_ == end_ || !is_letter(*at_)) return read_line_end();
      if (count_ == kMaxWords || !read_word()) return false;
    }
  }
  const Word* begin() const { return words_.data(); }
  const Word* end() const { return words_.data() + count_; }
  std::size_t line_end() const { return static_cast<std::size_t>(at_ - begin_); }

 private:
  bool read_line_end() {
    if (at_ + 1 < end_ && at_[0] == '/' && at_[1] == '/') {
      at_ = std::find(at_, end_, '\n');
      if (at_ > begin_ && at_[-1] == '\\') return false;
    }
    if (at_ < end_ && *at_ == '\r') ++at_;
    if (at_ == end_ || *at_ != '\n') return false;
    ++at_;
    return true;
  }

  bool read_word() {
    const char* const first = at_;
    while (at_ < end_ && is_letter(*at_)) ++at_;
    Word& word = words_[count_++];
    word.letter = word.number = 0;
    word.begin = static_cast<std::uint32_t>(first - begin_);
    const bool known = at_ - first == 1 ? take_letter(static_cast<char>(*first | 0x20), word) : take_keyword(first, word);
    word.end = static_cast<std::uint32_t>(at_ - begin_);
    return known;
  }

  bool take_letter(char letter, Word& word) {
    if (letter == 'e' || letter == 'o') return false;
    word.kind = kind_of_letter(letter);
    word.letter = static_cast<std::uint8_t>(letter - 'a' + 1);
    return take_number(word);
  }

  bool take_keyword(const char* first, Word& word) {
    const bool is_circle = at_ - first == 6 && at_ < end_ && is_digit(*at_);
    if (is_circle) ++at_;
    const std::string_view name(first, static_cast<std::size_t>(at_ - first));
    const auto* keyword = std::find_if(kKeywords.begin(), kKeywords.end(), [&](const Keyword& k) { return same_word(name, k.name); });
    if (keyword == kKeywords.end()) return false;
    word.kind = keyword->kind;
    word.number = keyword->number;
    if (word.kind == Kind::kTime) return take_number(word);
    const char next = at_ < end_ ? *at_ : '\0';
    return is_blank(next) || next == '\r' || next == '\n';
  }

  bool take_number(Word& word) {
    while (at_ < end_ && is_blank(*at_)) ++at_;
    word.value_begin = static_cast<std::uint32_t>(at_ - begin_);
    const char* const behind = read_plain_number(at_, end_, word.value);
    if (!behind) return false;
    at_ = behind;
    return true;
  }

  std::string_view text_;
  const char* begin_;
  const char* at_;
  const char* end_;
  std::array<Word, kMaxWords> words_;
  std::size_t count_ = 0;
};

/// Makes the statements of one line.
class LineStatements {
 public:
  LineStatements(std::int32_t file, ir::Body& out) : file_(file), out_(out) {}

  /// False: the grammar must say what that is. Nothing has been put then.
  bool put(const Word* word, const Word* end, std::string_view text) {
    if (word != end && word->kind == Kind::kBlockNumber) {
      if (!is_block_number(*word, text)) return false;
      ++word;
    }
    if (word == end) return true;
    if (word->kind == Kind::kCode) return put_code_line(word, end, text);
    const Word* const first_move = std::find_if(word, end, [](const Word& w) { return w.kind == Kind::kMoveLetter; });
    const Word* const behind_moves = std::find_if(first_move, end, [](const Word& w) { return w.kind != Kind::kMoveLetter; });
    const bool feed_last = behind_moves + 1 == end && behind_moves->kind == Kind::kFeed;
    if (behind_moves != end && !feed_last) return false;
    const bool modes_first = std::all_of(word, first_move, [](const Word& w) { return w.kind == Kind::kFeed || w.kind == Kind::kTime || w.kind == Kind::kMode || w.kind == Kind::kAbsInc; });
    if (!modes_first) return false;
    for (; word != first_move; ++word) put_mode(*word);
    if (feed_last) put_mode(*behind_moves);
    put_moves(first_move, behind_moves);
    return true;
  }

 private:
  Span span(std::uint32_t begin, std::uint32_t end) const { return {file_, begin, end, -1}; }
  Span span_of(const Word& word) const { return span(word.begin, word.end); }
  ir::ExprPtr value_of(const Word& word) const { return ir::make_number(word.value, span(word.value_begin, word.end)); }

  static bool is_block_number(const Word& word, std::string_view text) {
    const std::string_view digits = text.substr(word.value_begin, word.end - word.value_begin);
    return word.value <= 4294967295.0 && std::all_of(digits.begin(), digits.end(), is_digit);
  }

  bool put_code_line(const Word* word, const Word* end, std::string_view text) {
    const bool line_words = std::none_of(word, end, [](const Word& w) { return w.letter == 0 || w.kind == Kind::kBlockNumber; });
    if (!line_words || !is_digit(text[word->value_begin])) return false;
    ir::CodeLine line;
    line.words.reserve(static_cast<std::size_t>(end - word));
    const Span whole = span(word->begin, (end - 1)->end);
    for (; word != end; ++word) line.words.push_back({word->letter, value_of(*word), nullptr, nullptr, span_of(*word)});
    out_.push_back(ir::make_stmt(whole, std::move(line)));
    return true;
  }

  void put_mode(const Word& word) {
    switch (word.kind) {
      case Kind::kFeed: return out_.push_back(ir::make_stmt(span_of(word), ir::SetParameter{MotionParameter::kFeed, value_of(word)}));
      case Kind::kTime: return out_.push_back(ir::make_stmt(span_of(word), ir::SetParameter{static_cast<MotionParameter>(word.number), value_of(word)}));
      case Kind::kMode: return out_.push_back(ir::make_stmt(span_of(word), ir::SetMode{static_cast<ir::MoveMode>(word.number)}));
      default: return out_.push_back(ir::make_stmt(span_of(word), ir::SetAbsInc{word.number == 1, 0xffffffffu, false}));
    }
  }

  static ir::WordKind kind_of(char letter) { return letter == 'R' ? ir::WordKind::kRadius : letter >= 'I' && letter <= 'K' ? ir::WordKind::kCenter : ir::WordKind::kTarget; }

  /// A repeated letter begins a new block.
  void put_moves(const Word* word, const Word* end) {
    std::uint32_t seen = 0;
    const Word* first = word;
    for (const Word* at = word; at != end; ++at) {
      const std::uint32_t bit = 1u << at->letter;
      if (seen & bit) put_move(first, at), first = at, seen = 0;
      seen |= bit;
    }
    if (first != end) put_move(first, end);
  }

  void put_move(const Word* word, const Word* end) {
    ir::Move move;
    move.words.reserve(static_cast<std::size_t>(end - word));
    const Span whole = span(word->begin, (end - 1)->end);
    for (; word != end; ++word) {
      const char letter = static_cast<char>('A' + word->letter - 1);
      const ir::WordKind kind = kind_of(letter);
      const int index = kind == ir::WordKind::kRadius ? 0 : kind == ir::WordKind::kCenter ? letter - 'I' : bytecode::axis_index_from_name(std::string(1, letter));
      move.words.push_back({kind, index, value_of(*word), span_of(*word)});
    }
    out_.push_back(ir::make_stmt(whole, std::move(move)));
  }

  std::int32_t file_;
  ir::Body& out_;
};

/// What follows could assign to the last word (M5 and = 3 on the next line), or otherwise belong to it.
bool may_go_on(std::string_view text, std::size_t at) {
  const std::size_t next = text.find_first_not_of(" \t\r\n", at);
  return next != std::string_view::npos && !is_letter(text[next]) && text[next] != '}' && text[next] != '/';
}

}  // namespace

bool is_plain_line(std::string_view text, std::size_t at, std::size_t& end) {
  LineWords words(text, at);
  ir::Body body;
  const bool plain = words.read() && words.begin() != words.end() && LineStatements(0, body).put(words.begin(), words.end(), text);
  end = words.line_end();
  return plain;
}

PlainLines read_plain_lines(std::string_view text, std::size_t at, std::int32_t file) {
  PlainLines result;
  result.end = result.tried = at;
  LineStatements statements(file, result.body);
  struct Place { std::size_t lines, end, statements; };
  Place last{0, at, 0}, first_move{0, at, 0};  // before the last line that is not blank; before the moves at the end
  std::size_t moves = 0;
  while (true) {
    LineWords words(text, result.end);
    const Place here{result.lines, result.end, result.body.size()};
    result.tried = result.end;
    if (!words.read() || !statements.put(words.begin(), words.end(), text)) break;
    result.end = words.line_end();
    ++result.lines;
    if (words.begin() == words.end()) continue;
    last = here;
    std::size_t move_end = 0;
    if (words.begin()->kind != Kind::kMoveLetter || !is_plain_move(text, here.end, move_end)) moves = 0;
    else if (++moves == 1) first_move = here;
    if (moves > kMinPlainMoves) {
      last = first_move;
      break;
    }
  }
  if (moves <= kMinPlainMoves && !may_go_on(text, result.end)) return result;
  result.lines = last.lines;
  result.end = last.end;
  result.body.resize(last.statements);
  return result;
}

bool reads_as_line_word(std::string_view name) {
  if (name.empty() || !is_letter(name[0])) return false;
  if (name.size() == 1 || is_digit(name[1])) return true;
  return std::any_of(kKeywords.begin(), kKeywords.end(), [&](const Keyword& keyword) {
    const bool begins = same_word(name.substr(0, keyword.name.size()), keyword.name);
    return begins && (name.size() == keyword.name.size() || is_digit(name[keyword.name.size()]));
  });
}

}  // namespace pmac::compiler::power_pmac
