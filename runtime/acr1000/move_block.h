// The fast move block of a DNC host: a whole move in a few bytes behind ctrl-D, for lines and arcs, as text or binary. It acts like
// VEL, P28, P29 and MOV or CIRCLE, one after the other. Encoding and decoding are exact to the byte. Source: ACR1000 manual, chapter 8.
//
//   text     04  velocity CR  master distance CR  target CR            decimal or &H hexadecimal; an empty velocity keeps VEL
//   binary   04  type  velocity (2 or 3 bytes)  P28 (4)  move distance (4)  [ radius (4)  I (4)  J (4)  end point (4) ]
//                                                                      least significant byte first; [ ] for arcs
//   type     1 r v 24-bit 0000:  bit 7 binary, 6 arc, 5 incremental, 4 velocity of 24 bits, 3-0 reserved
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "runtime/acr1000/axis_law.h"

namespace pmac::acr1000 {

inline constexpr std::uint8_t kControlD = 0x04;

struct MoveBlock {
  bool is_circle = false;
  bool incremental = false;              // target, or end point of an arc, counts from where the axis is
  bool wide_velocity = false;            // the velocity has 24 bits; executive version 4.x
  std::optional<std::uint32_t> velocity; // absent: VEL stays. Binary blocks write 0 for it [assumed]
  std::uint32_t master_distance = 0;     // P28
  std::int32_t distance = 0;             // line: target or increment; arc: arc length, positive clockwise
  std::uint32_t radius = 0;              // arcs only, and so on
  std::int32_t i = 0, j = 0;
  std::int32_t end_point = 0;            // P29
  bool operator==(const MoveBlock&) const = default;
};

/// The CIRCLE that an arc block stands for. A length of 0 is clockwise [assumed].
CircleArguments circle_of(const MoveBlock& block);

/// What is wrong with the bytes of a block, and where. offset counts from the ctrl-D; bytes_missing of a block that is cut short
/// (0: the block is malformed; of a text block the least that is missing).
struct [[nodiscard]] BlockError {
  std::size_t offset = 0;
  std::size_t bytes_missing = 0;
  std::string detail;
};
/// "the block ends after 5 of 12 bytes, at byte 5; 7 bytes are missing".
std::string text_of(const BlockError& error);

/// Bytes of the block at the front of so_far (which begins with ctrl-D), known from its second byte for binary blocks and from its
/// third CR for text; 0: not known yet.
std::size_t fast_block_length(std::span<const std::uint8_t> so_far);

/// A text block longer than this is malformed; keeps a port from collecting for ever.
inline constexpr std::size_t kMaxTextBlock = 256;

/// A block with its length, or what is wrong with it. bytes begin with the ctrl-D; what follows the block is left alone.
struct DecodedBlock { MoveBlock block; std::size_t length = 0; };
std::variant<DecodedBlock, BlockError> decode_block(std::span<const std::uint8_t> bytes);

enum class NumberForm { kDecimal, kHex };
/// Binary form. Fields of arcs are written for arcs only.
std::vector<std::uint8_t> encode_block(const MoveBlock& block);
/// Text form; absolute lines only, which is all that it can say.
std::vector<std::uint8_t> encode_text_block(const MoveBlock& block, NumberForm form);

/// "04 80 10 27 ...": bytes as a listing shows them, and back. nullopt: no pairs of hexadecimal digits.
std::string hex_text(std::span<const std::uint8_t> bytes);
std::optional<std::vector<std::uint8_t>> bytes_from_hex(std::string_view text);

}  // namespace pmac::acr1000
