#include "compiler/bytecode/element.h"
#include "runtime/io/io_space.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "runtime/io/pointer_table.h"

using namespace pmac::runtime;
using pmac::bytecode::kMCount;
using pmac::bytecode::PointerDefinition;
using pmac::bytecode::PointerKind;

namespace {

PointerDefinition at(PointerKind kind, std::uint32_t address, int start_bit = 0, int width = 32) {
  PointerDefinition definition;
  definition.kind = kind;
  definition.address = address;
  definition.start_bit = static_cast<std::uint8_t>(start_bit);
  definition.width = static_cast<std::uint8_t>(width);
  return definition;
}

}  // namespace

TEST_CASE("I/O: the points of the example card", "[io]") {
  IoSpace io;
  const PointerDefinition point28 = at(PointerKind::kIo, 0xa0000c, 12, 1);  // $A0000C.12: register 3, 8*3 + 12-8
  const PointerDefinition point24 = at(PointerKind::kIo, 0xa0000c, 8, 1);
  CHECK(io.read(point28) == 0);
  CHECK(io.write(point28, 1));
  CHECK_FALSE(io.write(point28, 1));
  CHECK(io.write(point24, 1));
  CHECK(io.word(0xa0000c) == 0x1100);
  CHECK(io.write(point28, 0));
  CHECK(io.word(0xa0000c) == 0x0100);
  CHECK(io.word(0xa00000) == 0);
}

TEST_CASE("I/O: a stimulus sets whole words", "[io]") {
  IoSpace io;
  CHECK(io.set_word(0xa00000, 0x200));
  CHECK_FALSE(io.set_word(0xa00000, 0x200));
  CHECK(io.read(at(PointerKind::kIo, 0xa00000, 9, 1)) == 1);
}

TEST_CASE("user memory: integers, floats and doubles at byte offsets", "[io]") {
  IoSpace io;
  CHECK(io.read(at(PointerKind::kUserDouble, 512)) == 0);
  CHECK(io.write(at(PointerKind::kUserDouble, 0), 0.1));
  CHECK(io.read(at(PointerKind::kUserDouble, 0)) == 0.1);
  CHECK(io.write(at(PointerKind::kUserFloat, 8), 0.1));
  CHECK(io.read(at(PointerKind::kUserFloat, 8)) == static_cast<double>(0.1f));
  CHECK(io.write(at(PointerKind::kUserInteger, 12, 4, 8), 300));  // masked to 8 bits
  CHECK(io.read(at(PointerKind::kUserInteger, 12, 4, 8)) == 44);
  CHECK(io.read(at(PointerKind::kUserInteger, 12)) == 44 * 16);
}

TEST_CASE("user memory: floats beyond their range are infinite", "[io]") {
  IoSpace io;
  const PointerDefinition cell = at(PointerKind::kUserFloat, 0);
  io.write(cell, 1e300);
  CHECK(io.read(cell) == std::numeric_limits<double>::infinity());
  io.write(cell, -1e300);
  CHECK(io.read(cell) == -std::numeric_limits<double>::infinity());
  io.write(cell, std::numeric_limits<double>::quiet_NaN());
  CHECK(std::isnan(io.read(cell)));
}

TEST_CASE("user memory: the last bytes can be used, outside nothing happens", "[io]") {
  IoSpace io;
  const std::uint32_t last = UserMemory::kSize - 8;
  CHECK(io.write(at(PointerKind::kUserDouble, last), 3));
  CHECK(io.read(at(PointerKind::kUserDouble, last)) == 3);
  for (const std::uint32_t outside : {last + 1, 0xffffffffu, 0xfffffff8u}) {
    CHECK_FALSE(io.write(at(PointerKind::kUserDouble, outside), 3));
    CHECK(io.read(at(PointerKind::kUserDouble, outside)) == 0);
    CHECK(refusal_of(at(PointerKind::kUserDouble, outside)).find("outside user memory") != std::string::npos);
  }
  CHECK(refusal_of(at(PointerKind::kUserDouble, last)).empty());
  CHECK(refusal_of(at(PointerKind::kIo, 0xffffffff)).empty());
  CHECK(refusal_of(at(PointerKind::kIo, 0, 30, 4)) != "");
}

TEST_CASE("pointers: every M variable is its own until it is defined", "[io]") {
  PointerTable table;
  CHECK(table.at(kMCount - 1).definition.kind == PointerKind::kSelf);
  table.at(7).value = 5;
  PointerDefinition definition = at(PointerKind::kElement, 0);
  definition.name = "Speed";
  table.define(7, definition, {pmac::bytecode::ElementId::kMotorJogSpeed, {3, 0, 0}});
  CHECK(table.at(7).definition.kind == PointerKind::kElement);
  CHECK(table.at(7).definition.first_m == 7);
  CHECK(table.at(7).definition.name == "Speed");
  CHECK(table.at(7).element.index[0] == 3);
  table.define(7, PointerDefinition{});
  CHECK(table.at(7).definition.kind == PointerKind::kSelf);
  CHECK(table.at(7).value == 0);
  CHECK(table.at(8).value == 0);
}
