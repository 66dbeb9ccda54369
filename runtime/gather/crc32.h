// The checksum of ZIP archives.
#pragma once

#include <cstdint>
#include <span>

namespace pmac::runtime {

/// CRC-32 (IEEE 802.3), continued from `crc` (0 to begin).
std::uint32_t zip_crc32(std::span<const std::uint8_t> bytes, std::uint32_t crc = 0);

}  // namespace pmac::runtime
