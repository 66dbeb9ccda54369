// The move counter as PEEK, POKE and ctrl-L see it. ACR1000 manual, chapter 8, "Move Counter".
#include <catch2/catch.hpp>

#include "runtime/acr1000/card_memory.h"

using namespace pmac::acr1000;

TEST_CASE("move counter: preset to 300 with POKE 401D=0,0,1,2C, most significant byte first", "[acr1000]") {
  CardMemory memory;
  const std::uint8_t preset[] = {0x00, 0x00, 0x01, 0x2c};
  for (std::uint16_t k = 0; k < 4; ++k) memory.poke(static_cast<std::uint16_t>(0x401d + k), preset[k]);
  CHECK(memory.move_counter() == 300);
  CHECK(memory.counter_answer() == "0000012C\r");
  memory.count_move();
  CHECK(memory.peek(0x401f) == 0x01);
  CHECK(memory.peek(0x4020) == 0x2d);
}

TEST_CASE("move counter: wraps after 2^32 - 1", "[acr1000]") {
  CardMemory memory;
  for (std::uint16_t k = 0; k < 4; ++k) memory.poke(static_cast<std::uint16_t>(0x401d + k), 0xff);
  memory.count_move();
  CHECK(memory.move_counter() == 0);
}

TEST_CASE("card memory: bytes keep their values and are 0 at power-on", "[acr1000]") {
  CardMemory memory;
  CHECK(memory.peek(0xffff) == 0);
  memory.poke(0xffff, 0x5a);
  memory.poke(0x401c, 0x11);
  memory.poke(0x4021, 0x22);
  CHECK(memory.peek(0xffff) == 0x5a);
  CHECK(memory.move_counter() == 0);
}
