#include "runtime/drives/mcx514/script.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace pmac::drives::mcx514 {
namespace {

constexpr std::size_t kMostProblems = 100;
constexpr std::array<std::string_view, 4> kArrows = {"<-", "\xe2\x86\x90", ":=", "="};
constexpr double kLongestWait_s = 1e9;

bool is_word_char(char ch) { return std::isalnum(static_cast<unsigned char>(ch)) != 0 || ch == '_'; }

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& ch : result) ch = static_cast<char>(std::tolower(static_cast<unsigned char>(ch)));
  return result;
}

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = line_start_ = 3;
  }
  Script read();

 private:
  // Where the reader is
  bool ended() const { return at_ >= text_.size(); }
  int column() const { return static_cast<int>(at_ - line_start_) + 1; }
  void step();
  void pass_blanks();
  void pass_line();
  void problem(bool is_error, int line, int column, std::string text);
  void error(std::string text) { problem(true, line_, column(), std::move(text)); }

  // Pieces of text, at the present place
  std::string_view rest_of_line() {
    if (!line_end_ || *line_end_ < at_) line_end_ = std::min(text_.find('\n', at_), text_.size());
    return text_.substr(at_, *line_end_ - at_);
  }
  std::string_view word() const;
  std::string_view visible(std::size_t most = 24);
  bool begins_item();
  static bool has_arrow(std::string_view line);
  static bool holds_write(std::string_view line);
  bool take_arrow();

  // What a script is made of
  void read_comment();
  void read_prose();
  void read_write();
  void read_read();
  void read_wait();
  void read_wait_time(ScriptItem item);
  std::optional<std::uint16_t> read_value();
  std::optional<int> read_register(std::string_view kind);

  std::string_view text_;
  std::size_t at_ = 0, line_start_ = 0;
  std::optional<std::size_t> line_end_;   // of the line that at_ was in when it was asked for last
  int line_ = 1;
  Script script_;
};

void Reader::step() {
  if (text_[at_++] != '\n') return;
  ++line_;
  line_start_ = at_;
}

void Reader::pass_blanks() {
  while (!ended() && std::isspace(static_cast<unsigned char>(text_[at_]))) step();
}

void Reader::pass_line() {
  while (!ended() && text_[at_] != '\n') step();
}

void Reader::problem(bool is_error, int line, int column, std::string text) {
  if (script_.problems.size() < kMostProblems) script_.problems.push_back({is_error, line, column, std::move(text)});
  else if (script_.problems.size() == kMostProblems) script_.problems.push_back({true, line, column, "more problems than these; the rest is not listed"});
}

std::string_view Reader::word() const {
  std::size_t end = at_;
  while (end < text_.size() && is_word_char(text_[end])) ++end;
  return text_.substr(at_, end - at_);
}

/// The next few characters, for messages.
std::string_view Reader::visible(std::size_t most) {
  std::string_view text = rest_of_line().substr(0, most);
  while (!text.empty() && (static_cast<unsigned char>(text.back()) >= 0x80 || std::isspace(static_cast<unsigned char>(text.back())))) text.remove_suffix(1);
  return text;
}

/// WR6, WR, WRx: a register or what was meant as one.
bool is_register_like(const std::string& word) { return (word.starts_with("wr") || word.starts_with("rr")) && word.size() <= 4; }

/// A time in front of an item, as --emit=frames prints it: 0.000000 and a blank.
std::size_t time_length(std::string_view line) {
  const std::size_t end = std::min(line.find_first_not_of("0123456789."), line.size());
  const bool is_time = end > 0 && end < line.size() && line.substr(0, end).find('.') != std::string_view::npos && line[end] == ' ';
  return is_time ? end + 1 : 0;
}

bool Reader::begins_item() {
  constexpr std::size_t kLongestWord = 16;   // longer ones are none of the script's
  const std::string line = lower(rest_of_line().substr(time_length(rest_of_line())).substr(0, kLongestWord));
  const std::string first = line.substr(0, std::min(line.find_first_of(" \t\r;<=:"), line.size()));
  return is_register_like(first) || first == "wait" || first == "read";
}

bool Reader::has_arrow(std::string_view line) {
  return line.find("<-") != std::string_view::npos || line.find(kArrows[1]) != std::string_view::npos;
}

/// Something like WR6 <- 0000h, for the warning about writes that are switched off.
bool Reader::holds_write(std::string_view line) {
  const std::size_t reg = lower(line).find("wr");
  return reg != std::string_view::npos && reg + 3 < line.size() && std::isdigit(static_cast<unsigned char>(line[reg + 2])) && has_arrow(line.substr(reg));
}

bool Reader::take_arrow() {
  for (const std::string_view arrow : kArrows)
    if (text_.substr(at_).starts_with(arrow)) {
      at_ += arrow.size();
      return true;
    }
  return false;
}

/// From ; on. Lines below that look like nothing else belong to it.
void Reader::read_comment() {
  if (holds_write(rest_of_line())) problem(false, line_, column(), "a write inside a comment is not executed; give it a line of its own");
  pass_line();
  for (;;) {
    pass_blanks();
    if (ended() || text_[at_] == ';' || begins_item() || has_arrow(rest_of_line())) return;
    pass_line();
  }
}

/// A line that is none of the script's. Before the first write it is the text around a listing; one message for lines that follow each other.
void Reader::read_prose() {
  const int line = line_, first_column = column();
  const std::string seen(visible());
  const bool is_heading = script_.items.empty() && !has_arrow(rest_of_line());
  pass_line();
  for (pass_blanks(); is_heading && !ended() && text_[at_] != ';' && !begins_item() && !has_arrow(rest_of_line()); pass_blanks()) pass_line();
  if (is_heading) problem(false, line, first_column, "the text before the first write is passed over");
  else problem(true, line, first_column, fmt::format("'{}' is no register write; write WRn <- 0000h, and begin a comment with ;", seen));
}

/// The number behind WR or RR: 0 to 7.
std::optional<int> Reader::read_register(std::string_view kind) {
  const std::string_view name = word();
  if (name.size() == 3 && lower(name).starts_with(lower(kind)) && name[2] >= '0' && name[2] <= '7') {
    at_ += 3;
    return name[2] - '0';
  }
  error(fmt::format("'{}' is no register; there are {}0 to {}7", name.empty() ? visible() : name, kind, kind));
  return std::nullopt;
}

/// Four hexadecimal digits and h.
std::optional<std::uint16_t> Reader::read_value() {
  if (ended()) {
    error("the script ends inside a write; the value is missing");
    return std::nullopt;
  }
  const std::string_view digits = word();
  std::uint16_t value = 0;
  const bool has_h = digits.size() == 5 && (digits[4] == 'h' || digits[4] == 'H');
  const std::string_view four = digits.substr(0, 4);
  const auto [end, status] = std::from_chars(four.data(), four.data() + four.size(), value, 16);
  const bool fits = has_h && status == std::errc() && end == digits.data() + 4;
  if (!fits) {
    error(fmt::format("'{}' is no value; four hexadecimal digits and h are wanted, such as 03E8h", digits.empty() ? visible() : digits));
    return std::nullopt;
  }
  at_ += digits.size();
  return value;
}

void Reader::read_write() {
  ScriptItem item;
  item.line = line_;
  item.column = column();
  const auto reg = read_register("WR");
  if (!reg) return pass_line();
  item.reg = *reg;
  pass_blanks();
  if (ended()) return problem(true, item.line, item.column, fmt::format("the script ends inside a write to WR{}", *reg));
  if (!take_arrow()) {
    error(fmt::format("WR{} is not followed by <- and a value", *reg));
    return begins_item() ? void() : pass_line();
  }
  pass_blanks();
  const auto value = read_value();
  if (!value) return ended() || begins_item() ? void() : pass_line();
  item.value = *value;
  pass_blanks();
  if (lower(word()) == "write") at_ += 5;
  script_.items.push_back(item);
}

void Reader::read_read() {
  ScriptItem item;
  item.kind = ScriptItem::Kind::kRead;
  item.line = line_;
  item.column = column();
  if (lower(word()) == "read") at_ += 4;
  pass_blanks();
  const auto reg = read_register("RR");
  if (!reg) return pass_line();
  item.reg = *reg;
  script_.items.push_back(item);
}

void Reader::read_wait_time(ScriptItem item) {
  double value = 0;
  const char* const begin = text_.data() + at_;
  const auto [end, status] = std::from_chars(begin, text_.data() + text_.size(), value);
  if (status != std::errc() || end == begin) {
    error(fmt::format("wait is followed by idle, next or a time such as 2.5 ms, not by '{}'", visible()));
    return pass_line();
  }
  at_ += static_cast<std::size_t>(end - begin);
  pass_blanks();
  const std::string unit = lower(word());
  const double scale = unit == "s" ? 1 : unit == "ms" ? 1e-3 : unit == "us" ? 1e-6 : 0;
  item.wait_s = value * scale;
  if (scale == 0) error(fmt::format("the unit of a time is us, ms or s, not '{}'", unit.empty() ? std::string(visible()) : unit));
  else if (!std::isfinite(item.wait_s) || item.wait_s < 0 || item.wait_s > kLongestWait_s) error("a wait is a time from 0 to 1e9 s");
  else script_.items.push_back(item);
  at_ += unit.size();
}

void Reader::read_wait() {
  ScriptItem item;
  item.line = line_;
  item.column = column();
  at_ += 4;
  pass_blanks();
  const std::string what = lower(word());
  if (what != "idle" && what != "next") {
    item.kind = ScriptItem::Kind::kWaitTime;
    return read_wait_time(item);
  }
  item.kind = what == "idle" ? ScriptItem::Kind::kWaitIdle : ScriptItem::Kind::kWaitNext;
  at_ += 4;
  script_.items.push_back(item);
}

Script Reader::read() {
  for (pass_blanks(); !ended(); pass_blanks()) {
    if (column() == 1 && begins_item()) at_ += time_length(rest_of_line());
    const std::string first = lower(word());
    if (text_[at_] == ';') read_comment();
    else if (is_register_like(first) && first[0] == 'w') read_write();
    else if (is_register_like(first) || first == "read") read_read();
    else if (first == "wait") read_wait();
    else read_prose();
  }
  return std::move(script_);
}

}  // namespace

Script read_script(std::string_view text) { return Reader(text).read(); }

std::string write_text(int reg, std::uint16_t value) { return fmt::format("WR{} <- {:04X}h Write", reg, value); }

}  // namespace pmac::drives::mcx514
