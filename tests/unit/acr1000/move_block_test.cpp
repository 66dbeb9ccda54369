// Fast move blocks, byte for byte. The bytes are those of the manual's field tables (chapter 8), worked by hand.
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "runtime/acr1000/move_block.h"

using namespace pmac::acr1000;

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const std::string& hex) { return bytes_from_hex(hex).value(); }

MoveBlock line(std::uint32_t velocity, std::uint32_t master, std::int32_t target) {
  MoveBlock block;
  block.velocity = velocity;
  block.master_distance = master;
  block.distance = target;
  return block;
}

MoveBlock arc(std::uint32_t velocity, std::uint32_t master, std::int32_t length, std::uint32_t radius, std::int32_t i, std::int32_t j, std::int32_t end) {
  MoveBlock block = line(velocity, master, length);
  block.is_circle = true;
  block.radius = radius;
  block.i = i;
  block.j = j;
  block.end_point = end;
  return block;
}

MoveBlock incremental(MoveBlock block) { block.incremental = true; return block; }
MoveBlock wide(MoveBlock block) { block.wide_velocity = true; return block; }

struct Worked { MoveBlock block; const char* bytes; };

std::vector<Worked> binary_blocks() {
  return {
      {line(10000, 100000, 25000), "04 80 10 27 A0 86 01 00 A8 61 00 00"},
      {line(10000, 100000, 100000), "04 80 10 27 A0 86 01 00 A0 86 01 00"},
      {incremental(line(1000, 500, -500)), "04 A0 E8 03 F4 01 00 00 0C FE FF FF"},
      {wide(line(250000, 100000, 25000)), "04 90 90 D0 03 A0 86 01 00 A8 61 00 00"},
      {arc(10000, 47124, 47124, 20000, -20000, 0, 34142), "04 C0 10 27 14 B8 00 00 14 B8 00 00 20 4E 00 00 E0 B1 FF FF 00 00 00 00 5E 85 00 00"},
      {arc(10000, 47124, 47124, 20000, 0, 20000, 34142), "04 C0 10 27 14 B8 00 00 14 B8 00 00 20 4E 00 00 00 00 00 00 20 4E 00 00 5E 85 00 00"},
      {arc(10000, 47124, 47124, 20000, -14142, 14142, 68284), "04 C0 10 27 14 B8 00 00 14 B8 00 00 20 4E 00 00 C2 C8 FF FF 3E 37 00 00 BC 0A 01 00"},
      {arc(10000, 47124, 47124, 20000, 14142, 14142, 20000), "04 C0 10 27 14 B8 00 00 14 B8 00 00 20 4E 00 00 3E 37 00 00 3E 37 00 00 20 4E 00 00"},
      {arc(10000, 125664, 62832, 10000, 0, -10000, 0), "04 C0 10 27 E0 EA 01 00 70 F5 00 00 10 27 00 00 00 00 00 00 F0 D8 FF FF 00 00 00 00"},
      {wide(arc(250000, 47124, 47124, 20000, -20000, 0, 34142)), "04 D0 90 D0 03 14 B8 00 00 14 B8 00 00 20 4E 00 00 E0 B1 FF FF 00 00 00 00 5E 85 00 00"},
      {arc(10000, 15708, -15708, 10000, 10000, 0, 0), "04 C0 10 27 5C 3D 00 00 A4 C2 FF FF 10 27 00 00 10 27 00 00 00 00 00 00 00 00 00 00"},
      {arc(10000, 15708, -15708, 10000, 0, -10000, 10000), "04 C0 10 27 5C 3D 00 00 A4 C2 FF FF 10 27 00 00 00 00 00 00 F0 D8 FF FF 10 27 00 00"},
  };
}

DecodedBlock decoded(const Bytes& bytes) {
  const auto result = decode_block(bytes);
  if (const auto* error = std::get_if<BlockError>(&result)) FAIL(error->detail);
  return std::get<DecodedBlock>(result);
}

BlockError refused(const Bytes& bytes) {
  const auto result = decode_block(bytes);
  REQUIRE(std::holds_alternative<BlockError>(result));
  return std::get<BlockError>(result);
}

}  // namespace

TEST_CASE("binary blocks: every worked block is written and read byte for byte", "[acr1000]") {
  for (const Worked& worked : binary_blocks()) {
    CAPTURE(worked.bytes);
    CHECK(hex_text(encode_block(worked.block)) == worked.bytes);
    const DecodedBlock read = decoded(bytes_of(worked.bytes));
    CHECK(read.block == worked.block);
    CHECK(read.length == bytes_of(worked.bytes).size());
  }
}

TEST_CASE("binary blocks: 12 and 28 bytes, 13 and 29 with the wide velocity", "[acr1000]") {
  for (const auto& [type, length] : std::vector<std::pair<int, std::size_t>>{{0x80, 12}, {0xa0, 12}, {0x90, 13}, {0xb0, 13}, {0xc0, 28}, {0xe0, 28}, {0xd0, 29}, {0xf0, 29}}) {
    CHECK(fast_block_length(Bytes{4, static_cast<std::uint8_t>(type)}) == length);
  }
  CHECK(fast_block_length(Bytes{4}) == 0);
}

TEST_CASE("binary blocks: one that is cut short at any byte is reported with its end and what is missing", "[acr1000]") {
  for (const Worked& worked : binary_blocks()) {
    const Bytes whole = bytes_of(worked.bytes);
    for (std::size_t size = 2; size < whole.size(); ++size) {
      const BlockError error = refused(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
      CHECK(error.offset == size);
      CHECK(error.bytes_missing == whole.size() - size);
    }
    CHECK(refused(Bytes{4}).offset == 1);
  }
}

TEST_CASE("binary blocks: reserved bits of the type are refused", "[acr1000]") {
  Bytes bytes = bytes_of("04 80 10 27 A0 86 01 00 A8 61 00 00");
  for (const int bit : {1, 2, 4, 8}) {
    bytes[1] = static_cast<std::uint8_t>(0x80 | bit);
    const BlockError error = refused(bytes);
    CHECK(error.offset == 1);
    CHECK(error.bytes_missing == 0);
  }
}

TEST_CASE("binary blocks: what follows a block is left alone", "[acr1000]") {
  Bytes bytes = bytes_of("04 A0 E8 03 F4 01 00 00 0C FE FF FF");
  bytes.insert(bytes.end(), {'M', 'O', 'V', '\r'});
  CHECK(decoded(bytes).length == 12);
}

TEST_CASE("binary blocks: velocity 0 keeps VEL, and the sign of the length is the direction", "[acr1000]") {
  CHECK_FALSE(decoded(bytes_of("04 80 00 00 A0 86 01 00 A8 61 00 00")).block.velocity.has_value());
  CHECK(circle_of(arc(1, 1, -15708, 10000, 10000, 0, 0)) == CircleArguments{-1, 10000, 10000, 0, 15708});
  CHECK(circle_of(arc(1, 1, 0, 10000, 10000, 0, 0)).rot == 1);
  CHECK(circle_of(arc(1, 1, INT32_MIN, 10000, 10000, 0, 0)).distance == 2147483648);
}

TEST_CASE("text blocks: decimal, hexadecimal and without a velocity", "[acr1000]") {
  const MoveBlock block = line(10000, 100000, 25000);
  const Bytes decimal = bytes_of("04 31 30 30 30 30 0D 31 30 30 30 30 30 0D 32 35 30 30 30 0D");
  const Bytes hex = bytes_of("04 26 48 32 37 31 30 0D 26 48 31 38 36 41 30 0D 26 48 36 31 41 38 0D");
  CHECK(encode_text_block(block, NumberForm::kDecimal) == decimal);
  CHECK(encode_text_block(block, NumberForm::kHex) == hex);
  for (const Bytes& bytes : {decimal, hex}) {
    CHECK(decoded(bytes).block == block);
    CHECK(decoded(bytes).length == bytes.size());
    CHECK(fast_block_length(bytes) == bytes.size());
  }
  const MoveBlock kept = decoded(bytes_of("04 0D 31 30 30 30 30 30 0D 32 35 30 30 30 0D")).block;
  CHECK_FALSE(kept.velocity.has_value());
  CHECK(kept.distance == 25000);
}

TEST_CASE("text blocks: blanks, signs and line feeds", "[acr1000]") {
  const auto text = [](const std::string& s) { return Bytes(s.begin(), s.end()); };
  CHECK(decoded(text("\x04 10 000\r 100000 \r -25 000\r")).block == line(10000, 100000, -25000));
  CHECK(decoded(text("\x04""10000\r\n100000\r\n25000\r\nMOV")).block == line(10000, 100000, 25000));
  CHECK(decoded(text("\x04""10000\n100000\n25000\n")).block == line(10000, 100000, 25000));
  CHECK(decoded(text("\x04\r1\r&HFFFFFFFF\r")).block.distance == -1);
}

TEST_CASE("text blocks: wrong numbers are refused with their offset", "[acr1000]") {
  const auto text = [](const std::string& s) { return Bytes(s.begin(), s.end()); };
  CHECK(refused(text("\x04""10x\r1\r1\r")).offset == 1);
  CHECK(refused(text("\x04""10\r\r1\r")).offset == 4);
  CHECK(refused(text("\x04""10\r5\rA\r")).offset == 6);
  CHECK(refused(text("\x04""10\r5\r2147483648\r")).offset == 6);
  CHECK(refused(text("\x04""10\r-5\r1\r")).offset == 4);
  CHECK(refused(text("\x04""99999999\r5\r1\r")).offset == 1);
  CHECK(refused(text("\x04""10\r5")).bytes_missing == 2);
  CHECK(refused(text("\x04" + std::string(1000, '1'))).offset == kMaxTextBlock);
  CHECK(fast_block_length(text("\x04" + std::string(1000, '1'))) == kMaxTextBlock);
}

TEST_CASE("blocks: whatever follows ctrl-D is a block or refused", "[acr1000]") {
  std::uint32_t seed = 1;
  for (int k = 0; k < 200000; ++k) {
    Bytes bytes{4};
    seed = seed * 1664525u + 1013904223u;
    const std::size_t size = (seed >> 8) % 40;
    for (std::size_t n = 0; n < size; ++n) {
      seed = seed * 1664525u + 1013904223u;
      bytes.push_back(static_cast<std::uint8_t>(seed >> 24));
    }
    const auto result = decode_block(bytes);
    if (const auto* block = std::get_if<DecodedBlock>(&result)) {
      CHECK(block->length <= bytes.size());
      if ((bytes[1] & 0x80) != 0) CHECK(encode_block(block->block) == Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(block->length)));
    }
  }
}
