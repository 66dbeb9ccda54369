// What PEEK and POKE see of a card: 64 KiB of bytes, all 0 at power-on, with the move counter mapped in at 401D-4020, most significant
// byte first (so that PEEK 401F,2 reads its lower half). Everything but the counter is plain memory [assumed].
// Source: ACR1000 manual, chapter 8, "Move Counter"; the manual prints the last address as 402H.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>

namespace pmac::acr1000 {

inline constexpr std::uint16_t kCounterAddress = 0x401d;

class CardMemory {
 public:
  std::uint8_t peek(std::uint16_t address) const;
  void poke(std::uint16_t address, std::uint8_t byte);

  /// Counts a move that begins; wraps at 2^32 [assumed].
  void count_move() { ++move_counter_; }
  std::uint32_t move_counter() const { return move_counter_; }
  /// Answer to ctrl-L: eight hexadecimal digits and CR.
  std::string counter_answer() const;

 private:
  std::uint32_t move_counter_ = 0;
  std::unordered_map<std::uint16_t, std::uint8_t> bytes_;  // those that are not 0
};

}  // namespace pmac::acr1000
