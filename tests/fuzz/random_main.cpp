// Runs a fuzz target without libFuzzer: seeded random changes of example inputs. With files as arguments: those, once each.
//
//     FUZZ_ROUNDS=100000 silverlode_frames_fuzz        FUZZ_SEED=7 ...        silverlode_frames_fuzz crash.bin
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

const std::vector<std::string>& examples() {
  static const std::vector<std::string> texts = {
      "@16 251 1\r@16 253 2928 -1073741824 8361 351144\r@16 253 43 1073741824 8361 0\r@16 11 11 1\r@16 252\r",
      "@16 134 1000 2000 2000000 0 0\r@16 3 0\r@16 4\r@16 0\r@16 12 11\r",
      "* 10\r# 10 000C 0000 0001\r! 10 00FD 0006\r",
      "@255 255 2147483647 -2147483648 4294967295 0 1 2 3 4\r@1 0\r",
  };
  return texts;
}

void run(const std::string& bytes) { LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()); }

std::string changed(std::string bytes, std::mt19937& random) {
  const std::string alphabet = "@*#! 0123456789-ABCDEF\r";
  for (auto n = random() % 12; n > 0; --n) {
    const std::size_t at = random() % (bytes.size() + 1);
    switch (random() % 4) {
      case 0: bytes.insert(at, 1, static_cast<char>(random() % 256)); break;
      case 1: bytes.insert(at, 1, alphabet[random() % alphabet.size()]); break;
      case 2: if (at < bytes.size()) bytes.erase(at, 1 + random() % 8); break;
      default: bytes.insert(at, bytes.substr(random() % (bytes.size() + 1), random() % 24)); break;
    }
  }
  return bytes;
}

unsigned long number_from(const char* variable, unsigned long otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoul(text, nullptr, 10);
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    run({std::istreambuf_iterator<char>(file), {}});
  }
  if (argc > 1) return 0;
  const unsigned long rounds = number_from("FUZZ_ROUNDS", 20'000), seed = number_from("FUZZ_SEED", 1);
  std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
  for (unsigned long k = 0; k < rounds; ++k) run(changed(examples()[random() % examples().size()], random));
  std::printf("%lu inputs, seed %lu\n", rounds, seed);
  return 0;
}
