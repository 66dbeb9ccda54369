#include "runtime/tool/console.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <regex>

#include "compiler/source/closing_marks.h"

namespace pmac::tool {
namespace {

constexpr char kAck = 0x06, kEndOfInput = 0x04;
constexpr std::size_t kLongestLine = 1 << 20;
constexpr std::size_t kLongestBuffer = 64u << 20;  // bytes from open to close
constexpr std::size_t kLongestOwnLine = 200;  // of wait and its kind
constexpr int kPaceMs = 10;

double wall_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Lines of standard input; in between, it says when there is none yet.
class LineReader {
 public:
  enum class Got { kLine, kNothing, kEnd };

  /// Waits at most timeout_ms for a line (-1: for as long as it takes).
  Got next(std::string& line, int timeout_ms) {
    while (!take(line)) {
      if (ended_) return Got::kEnd;
      pollfd input{STDIN_FILENO, POLLIN, 0};
      const int ready = ::poll(&input, 1, timeout_ms);
      if (ready == 0) return Got::kNothing;
      if (ready < 0) return Got::kNothing;  // a signal
      char bytes[65536];
      const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
      if (count <= 0) ended_ = true;
      else text_.append(bytes, static_cast<std::size_t>(count));
    }
    return Got::kLine;
  }

 private:
  /// The next line of what was read; the last one needs no line end, Ctrl-D ends the input.
  bool take(std::string& line) {
    const std::size_t end = text_.find_first_of("\n\x04", searched_);
    if (end == std::string::npos && (!ended_ || text_.empty())) {
      text_.resize(std::min(text_.size(), kLongestLine + 1));  // more of a line that will be refused is not kept
      searched_ = text_.size();
      return false;
    }
    searched_ = 0;
    line = text_.substr(0, end);
    if (end != std::string::npos && text_[end] == kEndOfInput) {
      ended_ = true;
      text_.clear();
      if (line.empty()) return false;
    } else {
      text_.erase(0, end == std::string::npos ? end : end + 1);
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
  }

  std::string text_;
  std::size_t searched_ = 0;  // no line ends before this place
  bool ended_ = false;
};

/// What a line does to buffers: the words open and close outside of comments and texts.
struct BufferWords { bool opens = false, closes = false; };

bool is_word_part(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }

/// Texts and comments of a line, asked for from its beginning to its end.
class Noise {
 public:
  explicit Noise(std::string_view line) : line_(line), marks_(line) {}

  /// Behind the text, comment or single character that stands at `at`.
  std::size_t behind(std::size_t at) {
    const std::string_view rest = line_.substr(at);
    if (rest.starts_with("//")) return line_.size();
    if (rest.starts_with("/*") && comments_close_) return behind_comment(at);
    return rest.front() == '"' ? marks_.end_of(at) : at + 1;
  }

 private:
  std::size_t behind_comment(std::size_t at) {
    const std::size_t end = line_.find("*/", at + 2);
    comments_close_ = end != std::string_view::npos;  // otherwise no later one does
    return comments_close_ ? end + 2 : at + 1;
  }

  std::string_view line_;
  source::ClosingMarks marks_;
  bool comments_close_ = true;
};

bool is_word(std::string_view word, std::string_view wanted) {
  return std::equal(word.begin(), word.end(), wanted.begin(), wanted.end(), [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

BufferWords buffer_words(std::string_view line) {
  BufferWords words;
  Noise noise(line);
  for (std::size_t at = 0; at < line.size();) {
    if (!is_word_part(line[at])) {
      at = noise.behind(at);
      continue;
    }
    const std::size_t begin = at;
    while (at < line.size() && is_word_part(line[at])) ++at;
    const bool goes_on = at < line.size() && (line[at] == '[' || line[at] == '(' || line[at] == '=');
    const std::string_view word = line.substr(begin, at - begin);
    const bool opens = is_word(word, "open"), closes = is_word(word, "close");
    if (goes_on || (!opens && !closes)) continue;
    words.opens = words.opens || opens;
    words.closes = closes;  // the last word decides
  }
  return words;
}

bool is_error(const std::string& reason) { return reason.starts_with("error #"); }

}  // namespace

void Console::answer(const std::string& text) { std::printf("%s\n", text.c_str()); }

void Console::refuse(const std::string& reason) {
  const std::string text = is_error(reason) ? reason : "error #21: ILLEGAL PARAMETER: " + reason;
  const int line = error_place_.line > 0 ? error_place_.line : line_;
  std::printf("%s:%d:%d: %s\n", kName, line, std::max(error_place_.column, 1), text.c_str());
}

std::optional<std::string> Console::typed_line(int line) const {
  const auto found = typed_.find(line);
  return found == typed_.end() ? std::nullopt : std::optional<std::string>(found->second);
}

/// first_line: of the text.
void Console::execute(runtime::Machine& machine, const std::string& text, int first_line) {
  error_place_ = {};
  error_place_.before = first_line - 1;
  executing_ = true;
  machine.command(text, kName);
  executing_ = false;
  error_place_ = {};
}

/// wait 500 and wait idle are the console's own: simulated milliseconds, or until nothing moves. True: the line was one for the console.
bool Console::wait(const std::string& line) {
  static const std::regex kWait(R"(\s*wait\s+(idle|[0-9]+\.?[0-9]*|\.[0-9]+)(\s*ms)?\s*;?\s*)", std::regex::icase);
  static const std::regex kOwnWord(R"(\s*(wait|quit|exit|bye|help)\b(?!\s*[=(]).*)", std::regex::icase);
  std::smatch match;
  if (line.size() > kLongestOwnLine) return false;
  waits_ = std::regex_match(line, match, kWait);
  if (waits_) {
    wait_idle_ = std::isalpha(static_cast<unsigned char>(match[1].str()[0])) != 0;
    wait_ms_ = wait_idle_ ? 0 : std::strtod(match[1].str().c_str(), nullptr);
    return true;
  }
  if (!std::regex_match(line, match, kOwnWord)) return false;
  const bool is_wait = std::tolower(static_cast<unsigned char>(match[1].str()[0])) == 'w';
  refuse(is_wait ? "error #21: ILLEGAL PARAMETER: wait takes simulated milliseconds, or idle: wait 500, wait idle"
                 : "error #20: ILLEGAL CMD: " + match[1].str() + " is no command; Ctrl-D or the end of the input ends the console");
  return true;
}

/// A wait is acknowledged when it is over.
bool Console::wait_before_acknowledging(runtime::Machine& machine) {
  waits_ = false;
  if (advance(machine)) return true;
  refuse(outcome_.end == runtime::RunEnd::kInterrupted ? "error #39: NOT READY TO RUN: interrupted"
                                                       : "error #39: NOT READY TO RUN: the limit of the run is reached; the console ends here");
  return false;
}

/// A line of the open buffer; where the buffer grows too long, all of it is dropped up to its close.
void Console::keep_line(const std::string& line) {
  if (buffer_dropped_) return;
  buffer_dropped_ = buffer_.size() + line.size() >= kLongestBuffer;
  if (buffer_dropped_) {
    error_place_ = {};
    buffer_.clear();
    typed_.erase(typed_.lower_bound(buffer_line_), typed_.end());
    refuse(fmt::format("error #21: ILLEGAL PARAMETER: the buffer is longer than {} MiB and is dropped", kLongestBuffer >> 20));
    return;
  }
  typed_[line_] = line;
  buffer_ += line + "\n";
}

void Console::take_line(runtime::Machine& machine, const std::string& line) {
  ++line_;
  waits_ = false;
  wait_ms_ = options_.console_step_ms;
  wait_idle_ = false;
  const bool in_buffer = buffer_line_ > 0;
  const BufferWords words = buffer_words(line);
  if (line.size() > kLongestLine) {
    error_place_ = {};
    refuse("error #21: ILLEGAL PARAMETER: the line is too long");
  } else if (in_buffer || (words.opens && !words.closes)) {
    if (!in_buffer) buffer_line_ = line_;
    keep_line(line);
    if (!words.closes) return;
    if (!buffer_dropped_) execute(machine, buffer_, buffer_line_);
    buffer_.clear();
    buffer_dropped_ = false;
    buffer_line_ = 0;
  } else if (!wait(line)) {
    execute(machine, line, line_);
  }
}

/// Lets simulated time pass after a line. False when the run is over.
bool Console::advance(runtime::Machine& machine) {
  limits_.until_ms = machine.time_ms() + wait_ms_;
  if (options_.realtime) limits_.until_ms = std::max(machine.time_ms(), wall_ms() - wall_start_ms_);
  if (wait_idle_) limits_.until_ms.reset();
  limits_.more_follows = true;
  outcome_ = machine.run(limits_);
  return outcome_.end == runtime::RunEnd::kUntil || outcome_.end == runtime::RunEnd::kIdle;
}

runtime::RunOutcome Console::run(runtime::Machine& machine, const runtime::RunLimits& limits) {
  limits_ = limits;
  wall_start_ms_ = wall_ms() - machine.time_ms();
  std::printf("pmac-run 0.1.0 STDIN Open for ASCII Input\n");
  std::fflush(stdout);
  LineReader reader;
  std::string line;
  for (bool going = true; going;) {
    const LineReader::Got got = reader.next(line, options_.realtime ? kPaceMs : -1);
    if (got == LineReader::Got::kEnd) break;
    if (limits_.interrupted && limits_.interrupted()) {
      outcome_.end = runtime::RunEnd::kInterrupted;
      break;
    }
    if (options_.realtime) going = advance(machine);
    if (got == LineReader::Got::kNothing) continue;
    take_line(machine, line);
    const bool advances = !options_.realtime || wait_idle_;
    const bool waited = waits_ && advances;
    if (waited) going = wait_before_acknowledging(machine) && going;
    std::printf("%c\n", kAck);
    if (std::fflush(stdout) != 0) break;  // nobody listens any more
    if (going && advances && !waited) going = advance(machine);
  }
  if (buffer_line_ > 0 && !buffer_dropped_) execute(machine, buffer_, buffer_line_);  // says that it is not closed
  std::fflush(stdout);
  return outcome_;
}

}  // namespace pmac::tool
