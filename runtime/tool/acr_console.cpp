#include "runtime/tool/acr_console.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "runtime/acr1000/image.h"
#include "runtime/tool/options.h"

namespace pmac::tool {
namespace {

using acr1000::PortEvent;

constexpr const char* kPortName = "port";
constexpr int kPauseMs = 300;          // wall-clock time after which a host has stopped in the middle of a block

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string capitals_without_blanks(const std::string& text) {
  std::string result;
  for (const char c : text)
    if (!is_blank(c)) result += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

bool word_is(const std::string& text, std::string_view word) { return capitals_without_blanks(text) == word; }

/// The line's number and what follows it; nullopt: it has none. The compiler has seen the line, so the number is in range.
struct NumberedLine { std::int64_t number = 0; bool is_empty = false; };
std::optional<NumberedLine> numbered(const std::string& text) {
  NumberedLine line;
  bool any = false;
  std::size_t at = 0;
  for (; at < text.size(); ++at) {
    if (is_blank(text[at])) continue;
    if (std::isdigit(static_cast<unsigned char>(text[at])) == 0) break;
    line.number = std::min<std::int64_t>(10 * line.number + (text[at] - '0'), 1'000'000);
    any = true;
  }
  line.is_empty = at == text.size();
  return any ? std::optional(line) : std::nullopt;
}

}  // namespace

CardConsole::CardConsole(CardConsoleOptions options, std::function<void(std::string_view)> send) : options_(std::move(options)), send_(std::move(send)) {
  acr1000::SystemObservers observers;
  observers.notice = [this](const acr1000::CardNotice& notice) {
    if (notice.is_error) ++errors_;
    send_(fmt::format("?{}: {} ({})\r\n", notice.id, notice.text, acr1000::text_of(notice.place)));
  };
  system_ = std::make_unique<acr1000::CardSystem>(std::move(observers));
  compiler::Session session = new_session();
  const auto module = session.compile({{"power-up", "AXIS X\n"}});
  tell(session);
  acr1000::CardConfig config;
  if (module) {
    const acr1000::SystemImage image = acr1000::read_image(std::make_shared<const bytecode::Module>(*module));
    if (!image.cards.empty()) config = image.cards.front().config;
  }
  card_ = &system_->add(config);
  auto processor = std::make_unique<acr1000::CardProcessor>(*card_, send_, static_cast<acr1000::ProgramMemory*>(this));
  processor_ = processor.get();
  card_->driver = std::move(processor);
}

CardConsole::~CardConsole() = default;

compiler::Session CardConsole::new_session() const {
  compiler::Options options;
  options.dialect = compiler::Dialect::kAcr1000;
  options.card_settings = options_.settings;
  return compiler::Session(options);
}

void CardConsole::answer_error(std::string_view id, std::string_view text) {
  ++errors_;
  send_(fmt::format("?{}: {}\r\n", id, text));
}

/// What the compiler says about a line or the program.
void CardConsole::tell(compiler::Session& session) {
  for (const source::Diagnostic& message : session.diagnostics().take()) {
    if (message.severity == source::Severity::kError) answer_error(message.code, message.message);
    else send_(fmt::format("?{}: warning: {}\r\n", message.code, message.message));
  }
}

// --- the stored program ----------------------------------------------------------------------------------------------------------

CardConsole::Program CardConsole::program() {
  if (!changed_) return compiled_;
  changed_ = false;
  compiled_ = {};
  if (lines_.empty()) return compiled_;
  compiler::Session session = new_session();
  auto module = session.compile({{"program", listing()}});
  tell(session);
  if (!module) return compiled_;
  const auto shared = std::make_shared<const bytecode::Module>(std::move(*module));
  for (const bytecode::Program& one : shared->programs)
    if (one.kind == bytecode::ProgramKind::kProg) compiled_ = {shared, &one};
  return compiled_;
}

std::string CardConsole::listing() {
  std::string text;
  for (const auto& [number, line] : lines_) text += line + "\r\n";
  return text;
}

void CardConsole::erase() {
  lines_.clear();
  changed_ = true;
}

std::string CardConsole::renumber() {
  if (lines_.empty()) return {};
  compiler::Session session = new_session();
  const std::vector<std::string> renumbered = session.renumbered({"program", listing()});
  tell(session);
  if (renumbered.empty()) return {};
  lines_.clear();
  for (const std::string& line : renumbered) lines_[numbered(line)->number] = line;
  changed_ = true;
  return {};
}

/// The line has been found good.
void CardConsole::store(const std::string& text) {
  const NumberedLine line = *numbered(text);
  changed_ = true;
  if (line.is_empty) lines_.erase(line.number);
  else lines_[line.number] = text;
}

// --- what comes in ------------------------------------------------------------------------------------------------------------------

bool CardConsole::perform(const std::vector<PortEvent>& events) {
  for (const PortEvent& event : events)
    if (!perform(event)) return false;
  return true;
}

bool CardConsole::perform(const PortEvent& event) {
  switch (event.kind) {
    case PortEvent::Kind::kCounter: send_(card_->memory().counter_answer()); return true;
    case PortEvent::Kind::kError:
      ++errors_;
      send_(fmt::format("?{}\r\n", event.text));
      return true;
    case PortEvent::Kind::kBlock: return block(event.block);
    case PortEvent::Kind::kLine: break;
  }
  return line(event.text);
}

/// Lets simulated time go on. False: the time limit is reached.
bool CardConsole::pass(double time_s) {
  acr1000::SystemLimits limits;
  limits.has_until = true;
  limits.until_s = std::min(system_->time_s() + time_s, options_.max_time_s);
  limits.max_s = options_.max_time_s;
  system_->run(limits);
  if (system_->time_s() < options_.max_time_s) return true;
  answer_error("ACR-W08", fmt::format("the time limit of {} s is reached", options_.max_time_s));
  return false;
}

/// Until the line before is done and no motion waits for its beginning: the card takes one command after the other.
bool CardConsole::settle() {
  while (processor_->executes_line() || (card_->waits() && !processor_->program_runs()))
    if (!pass(options_.step_s)) return false;
  return true;
}

bool CardConsole::block(const acr1000::MoveBlock& block) {
  if (!settle()) return false;
  if (card_->waits()) return answer_error("ACR-E09", "a block cannot be taken while a motion of the program waits; HALT ends the program"), true;
  if (const auto refusal = card_->request(block, {})) return answer_error(acr1000::row_of(refusal->id).id, refusal->detail), true;
  system_->wake(0);
  return pass(options_.step_s);
}

/// HEX 04 80 ...: a block that a terminal can type.
bool CardConsole::hex_line(const std::string& text) {
  const auto bytes = acr1000::bytes_from_hex(std::string_view(text).substr(3));
  if (!bytes || bytes->empty() || bytes->front() != acr1000::kControlD) return answer_error("ACR-E12", "HEX takes the bytes of a block that begins with 04: HEX 04 80 10 27"), true;
  acr1000::Port port;
  std::vector<PortEvent> events = port.receive(*bytes);
  for (PortEvent& event : port.pause()) events.push_back(std::move(event));
  return perform(events);
}

/// WAIT 500 and WAIT IDLE are the console's own: simulated milliseconds, or until nothing moves. False: the line is for the card.
bool CardConsole::wait_line(const std::string& text, bool& going) {
  const std::string line = capitals_without_blanks(text);
  if (!line.starts_with("WAIT")) return false;
  char* end = nullptr;
  const double time_ms = std::strtod(line.c_str() + 4, &end);
  const bool is_time = line.size() > 4 && *end == '\0' && std::isfinite(time_ms) && time_ms >= 0;
  if (is_time) {
    going = pass(time_ms / 1000);
  } else if (line == "WAITIDLE") {
    while (going && (processor_->executes_line() || processor_->program_runs() || card_->busy())) going = pass(options_.step_s);
  } else {
    answer_error("ACR-E02", "WAIT takes simulated milliseconds, or IDLE: WAIT 500, WAIT IDLE");
  }
  return true;
}

bool CardConsole::line(const std::string& text) {
  bool going = true;
  const std::string word = capitals_without_blanks(text);
  if (word.empty()) return true;
  if (word.starts_with("HEX")) return hex_line(text);
  if (wait_line(text, going)) return going;
  if (word == "HALT" || word == "HAL") return system_->halt(0), pass(options_.step_s);
  return command(text);
}

bool CardConsole::command(const std::string& text) {
  compiler::Session session = new_session();
  auto module = session.compile_online(text, kPortName);
  tell(session);
  if (!module || module->load_order.empty()) return true;
  if (numbered(text)) return store(text), true;
  const auto shared = std::make_shared<const bytecode::Module>(std::move(*module));
  const Program commands{shared, &shared->programs[shared->load_order.front()]};
  if (word_is(text, "RUN") || word_is(text, "NEW")) system_->halt(0);  // both end a program that runs
  if (processor_->program_runs()) {
    if (const auto refused = processor_->execute_now(commands)) answer_error(refused->id, refused->detail);
  } else {
    if (!settle()) return false;
    processor_->start(commands);
  }
  system_->wake(0);
  return pass(options_.step_s);
}

// --- standard input and output --------------------------------------------------------------------------------------------------------

int run_card_console(const CardConsoleOptions& options) {
  CardConsole console(options, [](std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
  });
  std::uint8_t bytes[65536];
  bool going = true;   // false: the time limit is reached
  while (going && std::ferror(stdout) == 0) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    const int ready = ::poll(&input, 1, console.in_block() ? kPauseMs : -1);
    if (ready < 0) break;  // a signal
    if (ready == 0) {
      going = console.pause();
      continue;
    }
    const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (count <= 0) {
      console.pause();
      break;
    }
    going = console.receive({bytes, static_cast<std::size_t>(count)});
  }
  if (std::ferror(stdout) != 0) {
    std::fprintf(stderr, "pmac-run: standard output cannot be written\n");
    return kExitUsage;
  }
  return going ? kExitOk : kExitLimit;
}

}  // namespace pmac::tool
