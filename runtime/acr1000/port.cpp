#include "runtime/acr1000/port.h"

#include <fmt/format.h>

namespace pmac::acr1000 {
namespace {

constexpr std::uint8_t kControlL = 0x0c, kReturn = 0x0d, kLineFeed = 0x0a, kTab = 0x09, kBlank = 0x20, kDelete = 0x7f;

bool is_control(std::uint8_t byte) { return (byte < kBlank && byte != kTab) || byte == kDelete; }

PortEvent error(std::string text) {
  PortEvent event;
  event.kind = PortEvent::Kind::kError;
  event.text = std::move(text);
  return event;
}

std::string what_is_wrong(const BlockError& wrong) {
  const std::string missing = wrong.bytes_missing > 0 ? fmt::format("; {} more bytes are missing", wrong.bytes_missing) : "";
  return fmt::format("ACR-E12: fast move block, byte {}: {}{}", wrong.offset, wrong.detail, missing);
}

}  // namespace

std::vector<PortEvent> Port::receive(std::span<const std::uint8_t> bytes) {
  std::vector<PortEvent> events;
  for (const std::uint8_t byte : bytes) {
    if (in_block_) take_block_byte(byte, events);
    else take(byte, events);
  }
  return events;
}

void Port::take(std::uint8_t byte, std::vector<PortEvent>& events) {
  if (byte == kReturn || byte == kLineFeed) return end_line(events);
  if (byte == kControlL) {
    events.emplace_back().kind = PortEvent::Kind::kCounter;
  } else if (byte == kControlD) {
    in_block_ = true;
    block_.assign(1, byte);
  } else if (is_control(byte)) {
    events.push_back(error(fmt::format("warning: the control character {:02X} means nothing to the card", byte)));
  } else if (line_.size() < kLongestLine) {
    line_ += static_cast<char>(byte);
  } else {
    too_long_ = true;
  }
}

/// CR LF ends one line; empty lines are nothing.
void Port::end_line(std::vector<PortEvent>& events) {
  if (too_long_) events.push_back(error(fmt::format("ACR-E02: the line is longer than {} characters", kLongestLine)));
  else if (!line_.empty()) events.emplace_back().text = line_;
  line_.clear();
  too_long_ = false;
}

void Port::take_block_byte(std::uint8_t byte, std::vector<PortEvent>& events) {
  block_.push_back(byte);
  const std::size_t length = fast_block_length(block_);
  const bool complete = length != 0 && block_.size() >= length;
  if (complete || block_.size() >= kMaxTextBlock) end_block(events);
}

void Port::end_block(std::vector<PortEvent>& events) {
  const auto decoded = decode_block(block_);
  if (const auto* wrong = std::get_if<BlockError>(&decoded)) {
    events.push_back(error(what_is_wrong(*wrong)));
  } else {
    PortEvent& event = events.emplace_back();
    event.kind = PortEvent::Kind::kBlock;
    event.block = std::get<DecodedBlock>(decoded).block;
  }
  in_block_ = false;
  block_.clear();
}

std::vector<PortEvent> Port::pause() {
  std::vector<PortEvent> events;
  if (in_block_) end_block(events);
  end_line(events);
  return events;
}

}  // namespace pmac::acr1000
