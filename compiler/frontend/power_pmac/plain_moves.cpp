#include "compiler/frontend/power_pmac/plain_moves.h"

#include <algorithm>
#include <array>

#include "compiler/frontend/power_pmac/plain_number.h"

namespace pmac::compiler::power_pmac {
namespace {

using bytecode::MoveRun;
using ir::WordKind;

constexpr std::uint8_t kNoWord = 0xff;

/// Word codes by letter: one letter, and the same letter twice.
struct LetterCodes {
  std::array<std::uint8_t, 26> one{}, two{};
};

LetterCodes make_letter_codes() {
  LetterCodes codes;
  for (char letter = 'A'; letter <= 'Z'; ++letter) {
    const auto at = static_cast<std::size_t>(letter - 'A');
    const std::string_view centres = "IJK";
    const std::size_t centre = centres.find(letter);
    const auto code_of = [&](const std::string& name, int centre_index) {
      if (name == "R") return bytecode::move_word_code(WordKind::kRadius, 0);
      if (centre != std::string_view::npos) return bytecode::move_word_code(WordKind::kCenter, centre_index);
      const int axis = bytecode::axis_index_from_name(name);
      return axis < 0 ? kNoWord : bytecode::move_word_code(WordKind::kTarget, axis);
    };
    codes.one[at] = code_of(std::string(1, letter), static_cast<int>(centre));
    codes.two[at] = code_of(std::string(2, letter), static_cast<int>(centre) + 3);
  }
  return codes;
}

const LetterCodes& letter_codes() {
  static const LetterCodes codes = make_letter_codes();
  return codes;
}

std::size_t letter_index(char c) { return static_cast<std::size_t>((c | 0x20) - 'a'); }

/// Reads the words of one line, left to right.
class LineReader {
 public:
  LineReader(const char* at, const char* end) : at_(at), end_(end), codes_(letter_codes()) {}

  enum class Step { kWord, kLineEnd, kNotPlain };

  /// The next word, or what stands there instead. After kLineEnd at() is behind the line end.
  Step next() {
    while (at_ < end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
    if (at_ == end_ || !is_letter(*at_)) return line_end();
    word_begin_ = at_;
    if (!read_letters() || !read_number()) return at_ = word_begin_, Step::kNotPlain;
    return Step::kWord;
  }

  const char* at() const { return at_; }
  const char* word_begin() const { return word_begin_; }
  std::uint8_t code() const { return code_; }
  double value() const { return value_; }

 private:
  Step line_end() {
    if (at_ + 1 < end_ && at_[0] == '/' && at_[1] == '/') at_ = std::find(at_, end_, '\n');
    if (at_ < end_ && *at_ == '\r') ++at_;
    if (at_ == end_) return Step::kNotPlain;  // a last line without its end is left to the grammar
    if (*at_ != '\n') return Step::kNotPlain;
    ++at_;
    return Step::kLineEnd;
  }

  bool read_letters() {
    const std::size_t letter = letter_index(*at_++);
    const bool twice = at_ < end_ && is_letter(*at_);
    if (twice && letter_index(*at_) != letter) return false;
    code_ = twice ? codes_.two[letter] : codes_.one[letter];
    at_ += twice;
    return code_ != kNoWord;
  }

  bool read_number() {
    while (at_ < end_ && *at_ == ' ') ++at_;
    at_ = read_plain_number(at_, end_, value_);
    return at_ != nullptr;
  }

  const char* at_;
  const char* end_;
  const char* word_begin_ = nullptr;
  const LetterCodes& codes_;
  std::uint8_t code_ = 0;
  double value_ = 0;
};

/// What a row is made of, so that a repeated word is noticed: it begins a second move, which is not plain.
class SeenWords {
 public:
  bool add(std::uint8_t code) {
    const std::uint64_t bit = std::uint64_t{1} << (code & 31);
    std::uint64_t& set = bytecode::move_word_kind(code) == WordKind::kTarget ? targets : others_;
    const std::uint64_t own = bytecode::move_word_kind(code) == WordKind::kRadius ? std::uint64_t{1} << 40 : bit;
    const bool fresh = (set & own) == 0;
    set |= own;
    return fresh;
  }
  bool has_centre(int set) const { return (others_ >> 40) != 0 || (others_ & (set == 0 ? 0x07u : 0x38u)) != 0; }
  bool any_centre() const { return others_ != 0; }

  std::uint64_t targets = 0;

 private:
  std::uint64_t others_ = 0;
};

std::uint64_t axis_bits(std::initializer_list<const char*> names) {
  std::uint64_t bits = 0;
  for (const char* name : names) bits |= std::uint64_t{1} << bytecode::axis_index_from_name(name);
  return bits;
}

/// Collects rows, and where they first do what sema asks for.
class RowCollector {
 public:
  RowCollector(std::string_view text, std::int32_t file) : text_(text), file_(file), planes_{axis_bits({"X", "Y", "Z"}), axis_bits({"XX", "YY", "ZZ"})} {
    rows_.runs = std::make_shared<std::vector<MoveRun>>();
  }

  /// The words that were put since the last row, as a row of that line; false: they are no plain move, and are taken back.
  void begin_row() {
    const bool full = rows_.runs->empty() || rows_.runs->back().row_count() == bytecode::kMaxRunRows || run().words.size() + 64 > bytecode::kMaxRunWords;
    if (full) begin_run();
    seen_ = {};
  }
  bool put(const LineReader& word) {
    if (!seen_.add(word.code())) return false;
    run().words.push_back(word.code());
    run().values.push_back(word.value());
    return true;
  }
  void take_back() {
    run().words.resize(run().first_word.back());
    run().values.resize(run().first_word.back());
  }
  void end_row(const char* line_begin, const char* first_word, const char* end, int line) {
    MoveRun& r = run();
    const std::ptrdiff_t column = first_word - line_begin + 1;
    r.first_word.push_back(static_cast<std::uint32_t>(r.words.size()));
    r.line.push_back(static_cast<std::uint32_t>(line));
    r.column.push_back(static_cast<std::uint8_t>(column < 256 ? column : 0));
    note(first_word, end);
  }

  ir::MoveRows finish() {
    if (!rows_.runs->empty() && run().row_count() == 0) rows_.runs->pop_back();
    if (!rows_.runs->empty()) shrink();
    return std::move(rows_);
  }

 private:
  MoveRun& run() { return rows_.runs->back(); }

  void begin_run() {
    if (!rows_.runs->empty()) shrink();
    MoveRun& r = rows_.runs->emplace_back();
    r.file = file_;
    r.first_word.push_back(0);
  }

  void shrink() {
    MoveRun& r = run();
    r.first_word.shrink_to_fit();
    r.words.shrink_to_fit();
    r.values.shrink_to_fit();
    r.line.shrink_to_fit();
    r.column.shrink_to_fit();
  }

  void note(const char* begin, const char* end) {
    const std::uint64_t fresh = seen_.targets & ~noted_targets_;
    const bool uncentred[2] = {(seen_.targets & planes_[0]) != 0 && !seen_.has_centre(0), (seen_.targets & planes_[1]) != 0 && !seen_.has_centre(1)};
    const bool nothing_new = fresh == 0 && (!seen_.any_centre() || rows_.first_centre.valid()) && (!uncentred[0] || rows_.without_centre[0].valid()) &&
                             (!uncentred[1] || rows_.without_centre[1].valid());
    if (nothing_new) return;
    const source::Span span{file_, static_cast<std::uint32_t>(begin - text_.data()), static_cast<std::uint32_t>(end - text_.data()), -1};
    noted_targets_ |= fresh;
    for (int axis = 0; axis < bytecode::kAxisCount; ++axis)
      if ((fresh >> axis) & 1) rows_.first_targets.push_back({axis, span});
    if (seen_.any_centre() && !rows_.first_centre.valid()) rows_.first_centre = span;
    for (int set = 0; set < 2; ++set)
      if (uncentred[set] && !rows_.without_centre[set].valid()) rows_.without_centre[set] = span;
  }

  std::string_view text_;
  std::int32_t file_;
  std::uint64_t planes_[2];
  ir::MoveRows rows_;
  SeenWords seen_;
  std::uint64_t noted_targets_ = 0;
};

}  // namespace

bool is_plain_move(std::string_view text, std::size_t at, std::size_t& end) {
  LineReader reader(text.data() + at, text.data() + text.size());
  SeenWords seen;
  for (bool first = true;; first = false) {
    const LineReader::Step step = reader.next();
    end = static_cast<std::size_t>(reader.at() - text.data());
    if (step == LineReader::Step::kLineEnd) return !first;
    const bool fits = step == LineReader::Step::kWord && (!first || bytecode::move_word_kind(reader.code()) == WordKind::kTarget) && seen.add(reader.code());
    if (!fits) return false;
  }
}

PlainMoveLines count_plain_moves(std::string_view text, std::size_t at, std::size_t most) {
  PlainMoveLines lines{at, 0};
  for (std::size_t end = at; lines.count < most && is_plain_move(text, lines.end, end); ++lines.count) lines.end = end;
  return lines;
}

ir::MoveRows read_plain_moves(std::string_view text, std::size_t at, std::int32_t file, int first_line, std::size_t& end) {
  RowCollector rows(text, file);
  const char* const text_end = text.data() + text.size();
  const char* line = text.data() + at;
  for (int number = first_line;; ++number) {
    LineReader reader(line, text_end);
    rows.begin_row();
    const char* first_word = nullptr;
    const char* last_end = nullptr;
    LineReader::Step step = reader.next();
    bool fits = step == LineReader::Step::kWord && bytecode::move_word_kind(reader.code()) == WordKind::kTarget;
    for (; fits && step == LineReader::Step::kWord; step = reader.next()) {
      if (!first_word) first_word = reader.word_begin();
      fits = rows.put(reader);
      last_end = reader.at();
    }
    if (!fits || step != LineReader::Step::kLineEnd) {
      rows.take_back();
      break;
    }
    rows.end_row(line, first_word, last_end, number);
    line = reader.at();
  }
  end = static_cast<std::size_t>(line - text.data());
  return rows.finish();
}

bool reads_as_move_word(std::string_view name) {
  if (name.empty() || !is_letter(name[0])) return false;
  const bool twice = name.size() > 1 && is_letter(name[1]) && letter_index(name[0]) == letter_index(name[1]);
  const std::size_t letters = twice ? 2 : 1;
  const auto& codes = letter_codes();
  const std::size_t letter = letter_index(name[0]);
  if ((twice ? codes.two : codes.one)[letter] == kNoWord) return false;
  return name.size() == letters || is_digit(name[letters]);
}

}  // namespace pmac::compiler::power_pmac
