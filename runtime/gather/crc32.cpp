// Eight bytes a step with eight tables ("slicing by 8").
#include "runtime/gather/crc32.h"

#include <array>

namespace pmac::runtime {
namespace {

using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1u) ? 0xedb88320u : 0u);
    tables[0][i] = value;
  }
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t i = 0; i < 256; ++i) tables[k][i] = (tables[k - 1][i] >> 8) ^ tables[0][tables[k - 1][i] & 0xffu];
  }
  return tables;
}

constexpr Tables kTables = make_tables();

}  // namespace

std::uint32_t zip_crc32(std::span<const std::uint8_t> bytes, std::uint32_t crc) {
  crc = ~crc;
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    const std::uint8_t* b = bytes.data() + i;
    crc = kTables[7][(crc ^ b[0]) & 0xffu] ^ kTables[6][((crc >> 8) ^ b[1]) & 0xffu] ^
          kTables[5][((crc >> 16) ^ b[2]) & 0xffu] ^ kTables[4][((crc >> 24) ^ b[3]) & 0xffu] ^ kTables[3][b[4]] ^
          kTables[2][b[5]] ^ kTables[1][b[6]] ^ kTables[0][b[7]];
  }
  for (; i < bytes.size(); ++i) crc = (crc >> 8) ^ kTables[0][(crc ^ bytes[i]) & 0xffu];
  return ~crc;
}

}  // namespace pmac::runtime
