// CRC-32 of ZIP archives (polynomial 0x04C11DB7, reflected).
#pragma once

#include <cstdint>
#include <span>

namespace pmac::runtime {

/// Checksum of what `crc` is the checksum of, followed by bytes.
std::uint32_t zip_crc32(std::span<const std::uint8_t> bytes, std::uint32_t crc = 0);

/// Checksum of two runs of bytes in a row, from the checksums of both and the size of the second.
std::uint32_t joined_crc32(std::uint32_t first, std::uint32_t second, std::uint64_t second_size);

}  // namespace pmac::runtime
