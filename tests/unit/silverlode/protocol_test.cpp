// Frames of the 8-bit ASCII protocol.
#include <catch2/catch.hpp>

#include <random>

#include "runtime/drives/silverlode/protocol.h"

using namespace pmac::drives::silverlode;

namespace {

std::string why_not_command(std::string_view bytes) {
  const auto frame = decode_command(bytes);
  return frame.index() == 0 ? std::string() : std::get<std::string>(frame);
}

}  // namespace

TEST_CASE("frames: the command reference's examples", "[silverlode]") {
  const auto clear = decode_command("@16 163");
  REQUIRE(clear.index() == 0);
  CHECK(std::get<0>(clear).address == 16);
  CHECK(std::get<0>(clear).command == 163);
  const auto move = decode_command("@15 135 100 2000 2000 0 0");
  REQUIRE(move.index() == 0);
  CHECK(std::get<0>(move).parameters == std::vector<std::int64_t>{100, 2000, 2000, 0, 0});
  CHECK(encode(std::get<0>(move)) == "@15 135 100 2000 2000 0 0\r");
}

TEST_CASE("frames: replies are hexadecimal", "[silverlode]") {
  const auto ack = decode_reply("* 10");
  REQUIRE(ack.index() == 0);
  CHECK(std::get<Ack>(std::get<0>(ack)).address == 16);
  const auto nak = decode_reply("! 10 FD 6");
  REQUIRE(nak.index() == 0);
  CHECK(std::get<Nak>(std::get<0>(nak)).command == 253);
  CHECK(std::get<Nak>(std::get<0>(nak)).code == static_cast<int>(NakCode::kBufferFull));
  const auto data = decode_reply("# 10 000C FFFF D8F0");
  REQUIRE(data.index() == 0);
  CHECK(std::get<Data>(std::get<0>(data)).words == std::vector<std::uint16_t>{0xFFFF, 0xD8F0});
  CHECK(encode(ReplyFrame(Ack{16})) == "* 10\r");
}

TEST_CASE("frames: what is no command says why", "[silverlode]") {
  CHECK(why_not_command("") == "the frame is empty");
  CHECK(why_not_command("16 3") == "a command begins with @");
  CHECK(why_not_command("@") == "the address is missing after @");
  CHECK(why_not_command("@16") == "the command number is missing");
  CHECK(why_not_command("@0 3") == "'0' is no address, 1 to 255");
  CHECK(why_not_command("@256 3") == "'256' is no address, 1 to 255");
  CHECK(why_not_command("@16 300") == "'300' is no command number, 0 to 255");
  CHECK(why_not_command("@16 3 x") == "'x' is no parameter of 32 bits");
  CHECK(why_not_command("@16 3 4294967296") == "'4294967296' is no parameter of 32 bits");
  CHECK(why_not_command("@16 3\t0").find("byte 09h") != std::string::npos);
  CHECK(why_not_command("@16 3 1 2 3 4 5 6 7 8 9") == "more than 8 parameters");
  CHECK(why_not_command("@16 3 " + std::string(200, '1')).find("longer than") != std::string::npos);
}

TEST_CASE("frames: what was encoded is decoded as it was", "[silverlode]") {
  std::mt19937 random(3);
  const auto between = [&random](std::int64_t low, std::int64_t high) { return std::uniform_int_distribution<std::int64_t>(low, high)(random); };
  for (int k = 0; k < 500; ++k) {
    CommandFrame frame{static_cast<int>(between(1, 255)), static_cast<int>(between(0, 255)), {}};
    for (std::int64_t n = between(0, 8); n > 0; --n) frame.parameters.push_back(between(INT32_MIN, UINT32_MAX));
    std::string bytes = encode(frame);
    REQUIRE(bytes.back() == '\r');
    bytes.pop_back();
    const auto decoded = decode_command(bytes);
    REQUIRE(decoded.index() == 0);
    CHECK(std::get<0>(decoded).address == frame.address);
    CHECK(std::get<0>(decoded).command == frame.command);
    CHECK(std::get<0>(decoded).parameters == frame.parameters);
    const Data data{frame.address, frame.command, {static_cast<std::uint16_t>(between(0, 65535)), 7}};
    std::string reply = encode(ReplyFrame(data));
    reply.pop_back();
    const auto back = decode_reply(reply);
    REQUIRE(back.index() == 0);
    CHECK(std::get<Data>(std::get<0>(back)).words == data.words);
  }
}

TEST_CASE("frames: random and damaged bytes are refused or decoded, never more", "[silverlode]") {
  std::mt19937 random(5);
  const std::string alphabet = "@*#! 0123456789-ABCDEFabcdefxX\r\t";
  CommandSet commands;
  for (int k = 0; k < 20'000; ++k) {
    std::string bytes = k % 2 == 0 ? "@16 253 2928 -1073741824 8361 351144" : "! 10 00FD 0006";
    for (int n = 0; n < 1 + k % 4; ++n) {
      const std::size_t at = random() % (bytes.size() + 1);
      if (random() % 3 == 0) bytes.erase(std::min(at, bytes.size() - 1), 1);
      else bytes.insert(at, 1, random() % 8 == 0 ? static_cast<char>(random() % 256) : alphabet[random() % alphabet.size()]);
      if (bytes.empty()) bytes = "@";
    }
    const auto command = decode_command(bytes);
    if (command.index() == 0) CHECK(decode_command(encode(std::get<0>(command)).substr(0, encode(std::get<0>(command)).size() - 1)).index() == 0);
    else CHECK_FALSE(std::get<std::string>(command).empty());
    const auto reply = decode_reply(bytes);
    if (reply.index() == 0) CHECK_FALSE(describe(std::get<0>(reply), commands).empty());
  }
}

TEST_CASE("frame cutter: frames end with CR; too long ones come out as nothing", "[silverlode]") {
  FrameCutter cutter;
  CHECK(cutter.take("@16 3").empty());
  auto frames = cutter.take(" 0\r@16 4\r@17");
  REQUIRE(frames.size() == 2);
  CHECK(frames[0] == "@16 3 0");
  CHECK(frames[1] == "@16 4");
  CHECK(cutter.pending() == 3);
  frames = cutter.take(std::string(1'000'000, '1') + "\r@16 4\r");
  REQUIRE(frames.size() == 2);
  CHECK_FALSE(frames[0]);
  CHECK(frames[1] == "@16 4");
}

TEST_CASE("command numbers: only those that are not documented can be set", "[silverlode]") {
  CommandSet commands;
  CHECK(commands.number(CommandName::kSTP) == 3);
  CHECK_FALSE(commands.row(CommandName::kIMW).documented);
  CHECK_FALSE(commands.set_number("IMW", 240));
  CHECK(commands.number(CommandName::kIMW) == 240);
  CHECK(commands.set_number("STP", 9)->find("documented") != std::string::npos);
  CHECK(commands.set_number("IMQ", 240)->find("IMW") != std::string::npos);
  CHECK(commands.set_number("NOP", 1)->find("no command") != std::string::npos);
  CHECK(commands.set_number("WRI", 300)->find("0 to 255") != std::string::npos);
}
