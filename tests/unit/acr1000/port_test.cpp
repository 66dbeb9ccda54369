// The port of a card: bytes to lines, blocks and ctrl-L. The blocks are those of the ACR1000 manual's formats, chapter 8.
#include "runtime/acr1000/port.h"

#include <catch2/catch.hpp>
#include <random>

using namespace pmac::acr1000;

namespace {

using Kind = PortEvent::Kind;

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

const std::vector<std::uint8_t> kLineBlock = *bytes_from_hex("04 80 10 27 A0 86 01 00 A8 61 00 00");
const std::vector<std::uint8_t> kArcBlock = *bytes_from_hex("04 C0 10 27 14 B8 00 00 14 B8 00 00 20 4E 00 00 E0 B1 FF FF 00 00 00 00 5E 85 00 00");

}  // namespace

TEST_CASE("port: lines end with CR, LF or both, and ctrl-L is a question of its own in the middle of a line", "[acr1000]") {
  Port port;
  const auto events = port.receive(bytes_of("MOV\x0c 5\r\n\rLIST\n"));
  REQUIRE(events.size() == 3);
  CHECK(events[0].kind == Kind::kCounter);
  CHECK(events[1].text == "MOV 5");
  CHECK(events[2].text == "LIST");
}

TEST_CASE("port: a block is taken in pieces of any size, and the next line follows at once", "[acr1000]") {
  for (const auto& block : {kLineBlock, kArcBlock}) {
    Port port;
    std::vector<PortEvent> events;
    for (const std::uint8_t byte : block)
      for (PortEvent& event : port.receive({&byte, 1})) events.push_back(std::move(event));
    for (PortEvent& event : port.receive(bytes_of("RUN\r"))) events.push_back(std::move(event));
    REQUIRE(events.size() == 2);
    CHECK(events[0].kind == Kind::kBlock);
    CHECK(events[0].block.velocity == 10000u);
    CHECK(events[1].text == "RUN");
  }
}

TEST_CASE("port: a block cut short at any byte is reported, and the next command works", "[acr1000]") {
  for (const auto& block : {kLineBlock, kArcBlock})
    for (std::size_t length = 1; length < block.size(); ++length) {
      Port port;
      CHECK(port.receive(std::span(block).first(length)).empty());
      CHECK(port.in_block());
      const auto reported = port.pause();
      INFO(length);
      REQUIRE(reported.size() == 1);
      CHECK(reported[0].kind == Kind::kError);
      CHECK(reported[0].text.find("ACR-E12") != std::string::npos);
      const auto next = port.receive(bytes_of("P30=5\r"));
      REQUIRE(next.size() == 1);
      CHECK(next[0].text == "P30=5");
    }
}

TEST_CASE("port: a line longer than the card takes is reported once and left out", "[acr1000]") {
  Port port;
  const auto events = port.receive(bytes_of(std::string(1 << 20, 'X') + "\rRUN\r"));
  REQUIRE(events.size() == 2);
  CHECK(events[0].kind == Kind::kError);
  CHECK(events[1].text == "RUN");
}

TEST_CASE("port: random bytes never harm it, and a line behind a pause works", "[acr1000][robustness]") {
  constexpr unsigned kSeed = 20250303;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  Port port;
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::uint8_t> bytes(random() % 300);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() % 4 == 0 ? "\x04\x80\x0c\r"[random() % 4] : random());
    port.receive(bytes);
    port.pause();
    const auto events = port.receive(bytes_of("RUN\r"));
    REQUIRE(events.size() == 1);
    REQUIRE(events[0].text == "RUN");
  }
}
