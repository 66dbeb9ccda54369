// Streams of fast move blocks through one card, and what a stream does about damage.
#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>
#include <random>
#include <string>

#include "runtime/acr1000/block_stream.h"
#include "runtime/acr1000/card_system.h"

using namespace pmac::acr1000;

namespace {

using Bytes = std::vector<std::uint8_t>;

/// A stream that is made as it is read, `piece` bytes at a time.
ByteSource source_of(Bytes bytes, std::size_t piece = 7) {
  return [bytes = std::move(bytes), at = std::size_t{0}, piece](std::span<std::uint8_t> into) mutable {
    const std::size_t count = std::min({into.size(), bytes.size() - at, piece});
    std::memcpy(into.data(), bytes.data() + at, count);
    at += count;
    return count;
  };
}

Bytes joined(std::initializer_list<const char*> hex) {
  Bytes bytes;
  for (const char* text : hex) {
    const Bytes part = bytes_from_hex(text).value();
    bytes.insert(bytes.end(), part.begin(), part.end());
  }
  return bytes;
}

struct Stream {
  std::vector<CardMoveRecord> moves;
  std::vector<CardNotice> notices;
  std::string answers;
  CardSystem system{{{}, [this](const CardMoveRecord& m) { moves.push_back(m); }, [this](const CardNotice& n) { notices.push_back(n); }, {}}};
  Card& card = system.add({});
  explicit Stream(Bytes bytes, std::size_t piece = 7) {
    card.driver = std::make_unique<BlockStreamDriver>(card, source_of(std::move(bytes), piece), StreamActions{[this](const std::string& text) { answers += text; }, {}}, Place{});
  }
};

constexpr const char* kLine = "04 80 10 27 A0 86 01 00 A8 61 00 00";     // VEL 10000, P28 100000, target 25000
constexpr const char* kBack = "04 80 10 27 A0 86 01 00 00 00 00 00";     // and back to 0
constexpr const char* kLetMeKnow = "0C";

std::size_t resident_kb() {
  std::ifstream statm("/proc/self/statm");
  std::size_t total = 0, resident = 0;
  statm >> total >> resident;
  return resident * 4;
}

}  // namespace

TEST_CASE("stream: blocks move the card one after the other, and ctrl-L tells the count", "[acr1000]") {
  for (const std::size_t piece : {1u, 5u, 4096u}) {
    Stream stream(joined({kLine, kLetMeKnow, kBack, kLetMeKnow}), piece);
    stream.system.run({});
    REQUIRE(stream.moves.size() == 2);
    CHECK(stream.moves[0].to_pulses == 25000);
    CHECK(stream.moves[1].end_s == Approx(20));
    CHECK(stream.answers == "00000001\r00000002\r");
    CHECK(stream.card.rates.vel == 10000);
    CHECK(stream.card.parameter(28) == 100000);
  }
}

TEST_CASE("stream: the arc blocks of the contour set P28 and P29 and end there", "[acr1000]") {
  Stream stream(joined({"04 C0 10 27 14 B8 00 00 14 B8 00 00 20 4E 00 00 E0 B1 FF FF 00 00 00 00 5E 85 00 00"}));
  stream.system.run({});
  REQUIRE(stream.moves.size() == 1);
  CHECK(stream.moves[0].to_pulses == 34142);
  CHECK(stream.moves[0].end_s == Approx(4.7124));
  CHECK(stream.card.parameter(29) == 34142);
  CHECK(stream.notices.empty());
}

TEST_CASE("stream: an incremental arc's end point counts from its start", "[acr1000]") {
  Stream stream(joined({kLine, "04 E0 10 27 14 B8 00 00 14 B8 00 00 20 4E 00 00 E0 B1 FF FF 00 00 00 00 5E 85 00 00"}));
  stream.system.run({});
  REQUIRE(stream.moves.size() == 2);
  CHECK(stream.moves[1].to_pulses == 25000 + 34142);
}

TEST_CASE("stream: text blocks among binary ones", "[acr1000]") {
  Stream stream(joined({kLine, "04 0D 26 48 31 38 36 41 30 0D 30 0D", kLine}));
  stream.system.run({});
  REQUIRE(stream.moves.size() == 3);
  CHECK(stream.moves[1].to_pulses == 0);
}

TEST_CASE("ACR-E12: a block that is cut short at any byte is reported with its place, and what came before is done", "[acr1000]") {
  const Bytes line = joined({kLine});
  for (std::size_t size = 1; size < line.size(); ++size) {
    Bytes bytes = line;
    bytes.insert(bytes.end(), line.begin(), line.begin() + static_cast<std::ptrdiff_t>(size));
    Stream stream(bytes);
    stream.system.run({});
    CHECK(stream.moves.size() == 1);
    REQUIRE(stream.notices.size() == 1);
    CHECK(stream.notices[0].id == "ACR-E12");
    CHECK(stream.notices[0].text.find("at byte " + std::to_string(12 + size)) != std::string::npos);
  }
}

TEST_CASE("ACR-E12: behind a malformed block the next one works", "[acr1000]") {
  Stream stream(joined({"04 83 10 27 A0 86 01 00 A8 61 00 00", kLine, "41 42 0D", kBack}));
  stream.system.run({});
  CHECK(stream.moves.size() == 2);
  REQUIRE(stream.notices.size() == 3);
  CHECK(stream.notices[0].id == "ACR-E12");
  CHECK(stream.notices[0].text.find("reserved bits") != std::string::npos);
  CHECK(stream.notices[1].id == "ACR-E12");    // "AB" is no block
  CHECK(stream.notices[2].id == "ACR-W07");    // the way back, joined without a stop ramp
}

TEST_CASE("ACR-E12: a velocity of 24 bits needs executive version 4.x", "[acr1000]") {
  const Bytes bytes = joined({"04 90 90 D0 03 A0 86 01 00 A8 61 00 00"});
  Stream old(bytes);
  old.system.run({});
  REQUIRE(old.notices.size() == 1);
  CHECK(old.notices[0].id == "ACR-E12");

  CardSystem system({});
  CardConfig config;
  config.wide_velocity = true;
  Card& card = system.add(config);
  card.driver = std::make_unique<BlockStreamDriver>(card, source_of(bytes), StreamActions{}, Place{});
  CHECK(system.run({}).time_s == Approx(0.4));
}

TEST_CASE("stream: a million blocks in bounded memory, all counted", "[acr1000]") {
  constexpr std::uint32_t kBlocks = 1'000'000;
  std::uint32_t made = 0;
  const ByteSource endless = [&made](std::span<std::uint8_t> into) {
    std::size_t size = 0;
    for (; made < kBlocks && size + 12 <= into.size(); size += 12) {
      MoveBlock block;
      block.incremental = true;
      block.velocity = 50000;
      block.master_distance = 50;
      block.distance = ++made % 2 == 1 ? 50 : 30;
      const Bytes bytes = encode_block(block);
      std::copy(bytes.begin(), bytes.end(), into.begin() + static_cast<std::ptrdiff_t>(size));
    }
    return size;
  };
  std::size_t moves = 0;
  CardSystem system({{}, [&moves](const CardMoveRecord&) { ++moves; }, {}, {}});
  Card& card = system.add({});
  card.driver = std::make_unique<BlockStreamDriver>(card, endless, StreamActions{}, Place{});
  const std::size_t before_kb = resident_kb();
  const SystemOutcome outcome = system.run({});
  CHECK(moves == kBlocks);
  CHECK(card.memory().move_counter() == kBlocks);
  CHECK(card.commanded_pulses() == 40'000'000);
  CHECK(outcome.time_s == Approx(1000));
#ifndef __SANITIZE_ADDRESS__   // which keeps what is given back for a while
  CHECK(resident_kb() < before_kb + 4096);
#endif
}

TEST_CASE("stream: random bytes never crash a card", "[acr1000]") {
  std::mt19937 random(7);
  for (int run = 0; run < 200; ++run) {
    Bytes bytes(2000);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() % 5 == 0 ? 4 : random());
    Stream stream(bytes, 1 + random() % 100);
    SystemLimits limits;
    limits.max_s = 10;
    stream.system.run(limits);
    CHECK(stream.notices.size() <= 2001);
  }
}
