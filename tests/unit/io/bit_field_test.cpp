#include "runtime/io/bit_field.h"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

using namespace pmac::runtime;
using pmac::bytecode::PointerDefinition;

namespace {

PointerDefinition field(int start_bit, int width, bool is_signed = false) {
  PointerDefinition definition;
  definition.start_bit = static_cast<std::uint8_t>(start_bit);
  definition.width = static_cast<std::uint8_t>(width);
  definition.is_signed = is_signed;
  return definition;
}

}  // namespace

TEST_CASE("bit fields: read as shifted and masked, unsigned and two's complement", "[io]") {
  CHECK(read_bits(0x00001000, field(12, 1)) == 1);
  CHECK(read_bits(0x00001000, field(11, 1)) == 0);
  CHECK(read_bits(0x0000ab00, field(8, 8)) == 0xab);
  CHECK(read_bits(0x0000ab00, field(8, 8, true)) == 0xab - 256);
  CHECK(read_bits(0xffffffff, field(0, 32)) == 4294967295.0);
  CHECK(read_bits(0xffffffff, field(0, 32, true)) == -1);
  CHECK(read_bits(0x80000000, field(31, 1, true)) == -1);
}

TEST_CASE("bit fields: writing truncates toward zero, masks, and keeps the other bits", "[io]") {
  CHECK(write_bits(0xffff00ff, field(8, 8), 0x1ab) == 0xffffabff);
  CHECK(write_bits(0, field(4, 4), 3.99) == 0x30);
  CHECK(write_bits(0, field(4, 4), -1) == 0xf0);
  CHECK(write_bits(0, field(4, 4), -0.99) == 0);
  CHECK(write_bits(0xffffffff, field(0, 32), 5) == 5);
  CHECK(write_bits(7, field(0, 2), std::numeric_limits<double>::quiet_NaN()) == 4);
}

TEST_CASE("bit fields: what is written is read, for every place", "[io]") {
  std::mt19937 random(5);
  for (int start_bit = 0; start_bit < 32; ++start_bit) {
    for (int width = 1; start_bit + width <= 32; ++width) {
      const auto word = static_cast<std::uint32_t>(random());
      const double low = -std::ldexp(1.0, width - 1);
      const double value = static_cast<double>(random() % (std::uint64_t{1} << width));
      const std::uint32_t written = write_bits(word, field(start_bit, width), value);
      CHECK(read_bits(written, field(start_bit, width)) == value);
      CHECK(read_bits(write_bits(word, field(start_bit, width, true), value + low), field(start_bit, width, true)) == value + low);
      CHECK(write_bits(written, field(start_bit, width), read_bits(word, field(start_bit, width))) == word);
    }
  }
}

TEST_CASE("bit fields of elements keep the bits above 31", "[io]") {
  const double mask = 2251799813685248.0;  // 2^51
  CHECK(write_bit_field(mask + 0xff, field(0, 4), 0) == mask + 0xf0);
  CHECK(read_bit_field(mask + 0xff, field(4, 4)) == 15);
  CHECK(write_bit_field(-1, field(0, 8), 0) == -256);
}
