#include "runtime/acr1000/card_memory.h"

#include <fmt/format.h>

namespace pmac::acr1000 {
namespace {

bool is_of_counter(std::uint16_t address) { return address >= kCounterAddress && address < kCounterAddress + 4; }

/// Position of the byte in the counter: 24 for the first address, 0 for the last.
int counter_shift(std::uint16_t address) { return 8 * (3 - (address - kCounterAddress)); }

}  // namespace

std::uint8_t CardMemory::peek(std::uint16_t address) const {
  if (is_of_counter(address)) return static_cast<std::uint8_t>(move_counter_ >> counter_shift(address));
  const auto at = bytes_.find(address);
  return at == bytes_.end() ? std::uint8_t{0} : at->second;
}

void CardMemory::poke(std::uint16_t address, std::uint8_t byte) {
  if (!is_of_counter(address)) {
    bytes_[address] = byte;
    return;
  }
  const int shift = counter_shift(address);
  move_counter_ = (move_counter_ & ~(0xffu << shift)) | std::uint32_t{byte} << shift;
}

std::string CardMemory::counter_answer() const { return fmt::format("{:08X}\r", move_counter_); }

}  // namespace pmac::acr1000
