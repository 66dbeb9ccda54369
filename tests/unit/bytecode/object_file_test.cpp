#include "compiler/bytecode/object_file.h"

#include <catch2/catch.hpp>
#include <random>

#include "compiler/bytecode/chunk.h"
#include "compiler/bytecode/opcode.h"
#include "tests/reference/random_module.h"

using namespace pmac::bytecode;
using pmac::reference::random_module;

namespace {

std::string refusal(std::span<const std::uint8_t> bytes) {
  const auto loaded = load(bytes);
  const auto* error = std::get_if<ObjectFileError>(&loaded);
  return error == nullptr ? std::string() : error->message;
}

/// Refused, or the very module: what a damaged file may be.
bool refused_or_equal(std::span<const std::uint8_t> bytes, const Module& module) {
  const auto loaded = load(bytes);
  const auto* result = std::get_if<Module>(&loaded);
  return result == nullptr || *result == module;
}

/// The file with the chunk at `offset` replaced by `payload`, checksum correct.
std::vector<std::uint8_t> header_and(std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> bytes;
  append_header(bytes);
  append_chunk(bytes, payload);
  return bytes;
}

Module long_module() {
  Module module;
  module.files = {"long.pmc"};
  Program program;
  program.frame_size = 1;
  for (std::int32_t i = 0; i < 200000; ++i) {
    program.code.push_back(Instruction::with_imm(Opcode::kLoadInt, 0, i));
    program.lines.push_back({static_cast<std::uint32_t>(i), {0, i + 1, 1}});
    program.labels.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i)});
    module.constants.push_back(i / 3.0);
  }
  program.code.push_back(Instruction::with_imm(Opcode::kReturn, 0, 0));
  module.programs = {program};
  for (int i = 0; i < 40; ++i) module.strings.push_back(std::string(100000, static_cast<char>('a' + i % 26)));
  return module;
}

}  // namespace

TEST_CASE("object file: CRC-32 has its check value", "[object_file]") {
  const std::string_view text = "123456789";
  CHECK(crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}) == 0xcbf43926u);
}

TEST_CASE("object file: a loaded module equals the saved one", "[object_file]") {
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    INFO("seed " << seed);
    const Module module = random_module(seed);
    const std::vector<std::uint8_t> bytes = save(module);
    const auto loaded = load(bytes);
    REQUIRE(std::holds_alternative<Module>(loaded));
    CHECK(std::get<Module>(loaded) == module);
    CHECK(save(std::get<Module>(loaded)) == bytes);
  }
}

TEST_CASE("object file: an empty module and a long one come back", "[object_file]") {
  for (const Module& module : {Module{}, long_module()}) {
    const auto loaded = load(save(module));
    REQUIRE(std::holds_alternative<Module>(loaded));
    CHECK(std::get<Module>(loaded) == module);
  }
}

TEST_CASE("object file: the bytes need no alignment", "[object_file]") {
  const Module module = random_module(3);
  std::vector<std::uint8_t> bytes = save(module);
  bytes.insert(bytes.begin(), 0);
  const auto loaded = load(std::span(bytes).subspan(1));
  REQUIRE(std::holds_alternative<Module>(loaded));
  CHECK(std::get<Module>(loaded) == module);
}

TEST_CASE("object file: every truncation is refused", "[object_file]") {
  const std::vector<std::uint8_t> bytes = save(random_module(1));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    // A copy of its own, so that a sanitizer sees a read past the end.
    const std::vector<std::uint8_t> part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    INFO("size " << size);
    CHECK(refusal(part) != "");
  }
}

TEST_CASE("object file: trailing bytes are refused", "[object_file]") {
  std::vector<std::uint8_t> bytes = save(random_module(1));
  bytes.push_back(0);
  CHECK(refusal(bytes) == "object file has extra bytes after its end");
}

TEST_CASE("object file: every flipped bit is noticed", "[object_file]") {
  const Module module = random_module(5);
  std::vector<std::uint8_t> bytes = save(module);
  for (std::size_t bit = 0; bit < bytes.size() * 8; bit += 1) {
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    if (refusal(bytes).empty()) FAIL("bit " << bit << " flipped and the file loads");
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
  }
  SUCCEED();
}

TEST_CASE("object file: random damage is refused", "[object_file]") {
  std::mt19937 random(99);
  for (int round = 0; round < 5000; ++round) {
    const Module module = random_module(static_cast<std::uint32_t>(random() % 20));
    std::vector<std::uint8_t> bytes = save(module);
    for (unsigned i = 1 + random() % 8; i > 0; --i) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (!refused_or_equal(bytes, module)) FAIL("round " << round);
  }
  SUCCEED();
}

TEST_CASE("object file: contents behind a correct checksum are still verified", "[object_file]") {
  std::mt19937 random(4);
  const std::vector<std::uint8_t> bytes = save(random_module(2));
  for (int round = 0; round < 5000; ++round) {
    std::vector<std::uint8_t> file;
    append_header(file);
    ChunkReader reader(bytes);
    REQUIRE(reader.read_header().empty());
    while (!reader.at_end()) {
      const auto payload = reader.next();
      std::vector<std::uint8_t> damaged(payload->begin(), payload->end());
      if (random() % 4 == 0) damaged[random() % damaged.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
      append_chunk(file, damaged);
    }
    const auto loaded = load(file);  // no crash; whatever loads is safe
    if (const auto* module = std::get_if<Module>(&loaded)) CHECK(verify(*module).empty());
  }
}

TEST_CASE("object file: other formats and versions are refused by name", "[object_file]") {
  std::vector<std::uint8_t> bytes = save(random_module(1));
  CHECK(looks_like_object_file(bytes));
  const std::string_view text = "open prog 1\nX10\nclose\n";
  const std::span<const std::uint8_t> source(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  CHECK_FALSE(looks_like_object_file(source));
  CHECK_FALSE(looks_like_object_file({}));
  CHECK(looks_like_object_file(std::span(bytes).first(5)));
  CHECK(refusal(source) == "not an object file");
  bytes[8] = 9;
  CHECK(refusal(bytes) == "object file of format version 9; this tool reads version 2, compile the program again");
  bytes[8] = 2;
  bytes[12] ^= 1;
  CHECK(refusal(bytes).find("another release") != std::string::npos);
}

TEST_CASE("object file: a size larger than the file is refused before memory is asked for", "[object_file]") {
  std::vector<std::uint8_t> bytes;
  append_header(bytes);
  for (int i = 0; i < 8; ++i) bytes.push_back(0xff);
  CHECK(refusal(bytes).find("truncated") != std::string::npos);
}

TEST_CASE("object file: missing, repeated and swapped chunks are refused or harmless", "[object_file]") {
  const Module module = random_module(8);
  const std::vector<std::uint8_t> bytes = save(module);
  ChunkReader reader(bytes);
  REQUIRE(reader.read_header().empty());
  std::vector<std::vector<std::uint8_t>> chunks;
  while (!reader.at_end()) {
    const auto payload = reader.next();
    chunks.emplace_back(payload->begin(), payload->end());
  }
  for (std::size_t missing = 0; missing < chunks.size(); ++missing) {
    std::vector<std::uint8_t> file;
    append_header(file);
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      if (i != missing) append_chunk(file, chunks[i]);
    }
    CHECK(refusal(file) != "");
  }
}

TEST_CASE("object file: an empty or unknown chunk is refused", "[object_file]") {
  CHECK(refusal(header_and({})) != "");
  const std::vector<std::uint8_t> zeros(64, 0);
  CHECK(refusal(header_and(zeros)) != "");
}

TEST_CASE("object file: modules that are not safe are refused", "[object_file]") {
  Module module = random_module(1);
  module.programs[0].code[0] = Instruction::with_imm(Opcode::kLoadP, 0, -5);
  CHECK(refusal(save(module)).find("not safe to run") != std::string::npos);
}
