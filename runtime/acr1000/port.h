// The port of a card: bytes from the host become command lines, fast move blocks and questions for the move counter. Control characters
// act when they come and are no part of a line. What a host can send is bounded, so the memory is too. Source: ACR1000 manual, chapter 8.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/acr1000/move_block.h"

namespace pmac::acr1000 {

struct PortEvent {
  enum class Kind : std::uint8_t { kLine, kBlock, kCounter, kError };
  Kind kind = Kind::kLine;
  std::string text;     // the line without its CR; of kError what is wrong
  MoveBlock block;
};

class Port {
 public:
  static constexpr std::size_t kLongestLine = 4096;

  /// Bytes from the host, in pieces of any size.
  std::vector<PortEvent> receive(std::span<const std::uint8_t> bytes);
  /// The host has stopped in the middle of something: a line ends here, a block that is not complete is given up and reported. What
  /// comes next begins anew.
  std::vector<PortEvent> pause();
  /// A block has begun and is not complete.
  bool in_block() const { return in_block_; }

 private:
  void take(std::uint8_t byte, std::vector<PortEvent>& events);
  void take_block_byte(std::uint8_t byte, std::vector<PortEvent>& events);
  void end_line(std::vector<PortEvent>& events);
  void end_block(std::vector<PortEvent>& events);

  bool in_block_ = false, too_long_ = false;
  std::string line_;
  std::vector<std::uint8_t> block_;
};

}  // namespace pmac::acr1000
