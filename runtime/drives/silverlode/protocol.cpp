#include "runtime/drives/silverlode/protocol.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pmac::drives::silverlode {
namespace {

constexpr std::int64_t kLeastParameter = -2'147'483'648, kMostParameter = 4'294'967'295;

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t blank = std::min(text.find(' ', at), text.size());
    if (blank > at) words.push_back(text.substr(at, blank - at));
    at = blank + 1;
  }
  return words;
}

/// The whole word as a number in a range; nullopt otherwise.
std::optional<std::int64_t> number_of(std::string_view word, int base, std::int64_t least, std::int64_t most) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value, base);
  if (error != std::errc() || end != word.data() + word.size() || value < least || value > most) return std::nullopt;
  return value;
}

std::string shown(std::string_view bytes) {
  std::string text;
  for (const char c : bytes.substr(0, 40)) text += c >= 32 && c < 127 ? std::string(1, c) : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  return bytes.size() > 40 ? text + "..." : text;
}

std::string wrong(std::string_view what, std::string_view word) { return fmt::format("'{}' is no {}", shown(word), what); }

std::optional<std::string> problem_of_bytes(std::string_view bytes) {
  if (bytes.empty()) return "the frame is empty";
  if (bytes.size() >= kMostFrameBytes) return fmt::format("the frame is longer than {} bytes", kMostFrameBytes);
  for (const char c : bytes)
    if (c < 32 || c > 126) return fmt::format("byte {:02X}h has no place in a frame", static_cast<unsigned char>(c));
  return std::nullopt;
}

constexpr const char* kNames[] = {
#define COMMAND(id, number, parameters, documented, meaning) #id,
#include "runtime/drives/silverlode/command.def"
#undef COMMAND
};

}  // namespace

CommandSet::CommandSet() {
  rows_ = {
#define COMMAND(id, number, parameters, documented, meaning) {CommandName::k##id, kNames[static_cast<std::size_t>(CommandName::k##id)], number, parameters, documented != 0, meaning},
#include "runtime/drives/silverlode/command.def"
#undef COMMAND
  };
}

const CommandRow* CommandSet::find(int number) const {
  const auto at = std::find_if(rows_.begin(), rows_.end(), [number](const CommandRow& row) { return row.number == number; });
  return at == rows_.end() ? nullptr : &*at;
}

const CommandRow* CommandSet::find(std::string_view text) const {
  const auto at = std::find_if(rows_.begin(), rows_.end(), [text](const CommandRow& row) { return row.text == text; });
  return at == rows_.end() ? nullptr : &*at;
}

std::optional<std::string> CommandSet::set_number(std::string_view text, int number) {
  const CommandRow* row = find(text);
  if (row == nullptr) return fmt::format("there is no command {}", text);
  if (row->documented) return fmt::format("the number of {} is documented, {}; only those that are not can be set", text, row->number);
  if (number < 0 || number > kMostCommandNumber) return fmt::format("the number of {} must be 0 to {}", text, kMostCommandNumber);
  if (const CommandRow* other = find(number); other != nullptr && other != row) return fmt::format("{} is the number of {} already", number, other->text);
  rows_[static_cast<std::size_t>(row->name)].number = number;
  return std::nullopt;
}

std::string_view text_of(NakCode code) {
  switch (code) {
    case NakCode::kBadCommand: return "bad command";
    case NakCode::kBusy: return "busy";
    case NakCode::kBadFormat: return "bad format";
    case NakCode::kBufferFull: return "buffer full";
    case NakCode::kBadAddress: return "bad address";
    case NakCode::kBadResponse: return "bad response request";
    case NakCode::kLockOut: return "lock-out code";
    case NakCode::kChecksum: return "checksum";
  }
  return "unknown code";
}

std::string encode(const CommandFrame& frame) {
  std::string text = fmt::format("@{} {}", frame.address, frame.command);
  for (const std::int64_t parameter : frame.parameters) text += fmt::format(" {}", parameter);
  return text + "\r";
}

std::string encode(const ReplyFrame& frame) {
  if (const Ack* ack = std::get_if<Ack>(&frame)) return fmt::format("* {:02X}\r", ack->address);
  if (const Nak* nak = std::get_if<Nak>(&frame)) return fmt::format("! {:02X} {:04X} {:04X}\r", nak->address, nak->command, nak->code);
  const Data& data = std::get<Data>(frame);
  return fmt::format("# {:02X} {:04X} {:04X}\r", data.address, data.command, fmt::join(data.words, " "));
}

std::variant<CommandFrame, std::string> decode_command(std::string_view bytes) {
  if (auto why = problem_of_bytes(bytes)) return *why;
  if (bytes.front() != '@') return "a command begins with @";
  const auto words = words_of(bytes.substr(1));
  if (words.empty() || bytes.size() < 2 || bytes[1] == ' ') return "the address is missing after @";
  if (words.size() < 2) return "the command number is missing";
  if (words.size() > 2 + kMostParameters) return fmt::format("more than {} parameters", kMostParameters);
  const auto address = number_of(words[0], 10, 1, kMostAddress);
  if (!address) return wrong("address, 1 to 255", words[0]);
  const auto command = number_of(words[1], 10, 0, kMostCommandNumber);
  if (!command) return wrong("command number, 0 to 255", words[1]);
  CommandFrame frame{static_cast<int>(*address), static_cast<int>(*command), {}};
  for (std::size_t i = 2; i < words.size(); ++i) {
    const auto parameter = number_of(words[i], 10, kLeastParameter, kMostParameter);
    if (!parameter) return wrong("parameter of 32 bits", words[i]);
    frame.parameters.push_back(*parameter);
  }
  return frame;
}

std::variant<ReplyFrame, std::string> decode_reply(std::string_view bytes) {
  if (auto why = problem_of_bytes(bytes)) return *why;
  const char kind = bytes.front();
  if (kind != '*' && kind != '#' && kind != '!') return "a reply begins with *, # or !";
  const auto words = words_of(bytes.substr(1));
  const std::size_t least = kind == '*' ? 1 : kind == '!' ? 3 : 2, most = kind == '#' ? 2 + kMostParameters : least;
  if (words.size() < least || words.size() > most) return fmt::format("a reply {} has {} to {} numbers", kind, least, most);
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto number = number_of(words[i], 16, i == 0 ? 1 : 0, i == 0 ? kMostAddress : 0xFFFF);
    if (!number) return wrong(i == 0 ? "address, 1 to FF" : "word, 0 to FFFF", words[i]);
    numbers.push_back(*number);
  }
  const int address = static_cast<int>(numbers[0]);
  if (kind == '*') return Ack{address};
  if (kind == '!') return Nak{address, static_cast<int>(numbers[1]), static_cast<int>(numbers[2])};
  Data data{address, static_cast<int>(numbers[1]), {}};
  for (std::size_t i = 2; i < numbers.size(); ++i) data.words.push_back(static_cast<std::uint16_t>(numbers[i]));
  return data;
}

std::vector<std::optional<std::string>> FrameCutter::take(std::string_view bytes) {
  std::vector<std::optional<std::string>> frames;
  for (const char c : bytes) {
    if (c == '\r') {
      frames.push_back(too_long_ ? std::nullopt : std::optional(held_));
      held_.clear();
      too_long_ = false;
    } else if (held_.size() + 1 >= kMostFrameBytes) {
      too_long_ = true;
      held_.clear();
    } else if (!too_long_) {
      held_ += c;
    }
  }
  return frames;
}

bool has_its_parameters(const CommandFrame& frame, const CommandSet& commands) {
  const CommandRow* row = commands.find(frame.command);
  return row == nullptr || static_cast<int>(frame.parameters.size()) == row->parameters;
}

std::string describe(const CommandFrame& frame, const CommandSet& commands) {
  const CommandRow* row = commands.find(frame.command);
  std::string text = row == nullptr ? fmt::format("command {}", frame.command) : std::string(row->text);
  text += fmt::format(" to {}", frame.address);
  if (row != nullptr && row->name == CommandName::kIMW && frame.parameters.size() == 4)
    return text + fmt::format(": {} ticks, pos {}, acc {}, vel {}", frame.parameters[0], frame.parameters[1], frame.parameters[2], frame.parameters[3]);
  if (!frame.parameters.empty()) text += fmt::format(": {}", fmt::join(frame.parameters, " "));
  if (row == nullptr) return text + "  (no known command)";
  if (!has_its_parameters(frame, commands)) text += fmt::format("  (wants {} parameters)", row->parameters);
  return text;
}

std::string describe(const ReplyFrame& frame, const CommandSet& commands) {
  const auto name = [&commands](int number) {
    const CommandRow* row = commands.find(number);
    return row == nullptr ? fmt::format("command {}", number) : std::string(row->text);
  };
  if (const Ack* ack = std::get_if<Ack>(&frame)) return fmt::format("acknowledged by {}", ack->address);
  if (const Nak* nak = std::get_if<Nak>(&frame)) return fmt::format("{} refused by {}: {} ({})", name(nak->command), nak->address, text_of(static_cast<NakCode>(nak->code)), nak->code);
  const Data& data = std::get<Data>(frame);
  return fmt::format("{} answered by {}: {:04X}", name(data.command), data.address, fmt::join(data.words, " "));
}

}  // namespace pmac::drives::silverlode
