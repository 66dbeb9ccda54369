// Runs a fuzz target without libFuzzer: every file of the folders named, then seeded random changes of them.
//
//     replay_compiler FOLDER...|FILE... [--rounds N] [--seconds N] [--seed N] [--max-len BYTES] [--last-input FILE]
//
// Every input is written to a file (--last-input) before it runs, so that it is at hand after a crash.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include "tests/fuzz/target.h"

/// Of targets that need something done before; as libFuzzer has it.
extern "C" __attribute__((weak)) int LLVMFuzzerInitialize(int* argc, char*** argv);

namespace {

namespace fs = std::filesystem;

struct Settings {
  std::vector<fs::path> places;
  unsigned long rounds = 0, seed = 1, max_len = 4096;
  double seconds = 0;   // 0: as many rounds as asked for
  fs::path last_input = "last_input";
};

Settings read_arguments(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] { return i + 1 < argc ? std::string(argv[++i]) : std::string("0"); };
    if (word == "--rounds") settings.rounds = std::stoul(value());
    else if (word == "--seconds") settings.seconds = std::stod(value());
    else if (word == "--seed") settings.seed = std::stoul(value());
    else if (word == "--max-len") settings.max_len = std::stoul(value());
    else if (word == "--last-input") settings.last_input = value();
    else settings.places.emplace_back(word);
  }
  return settings;
}

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The files named and those in the folders named, in order of their names.
std::vector<fs::path> files_of(const std::vector<fs::path>& places) {
  std::vector<fs::path> files;
  for (const fs::path& place : places) {
    if (!fs::is_directory(place)) files.push_back(place);
    else for (const auto& entry : fs::recursive_directory_iterator(place)) if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

void run(const std::string& bytes) { LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()); }

/// A few bytes flipped, inserted, removed, or copied from another example.
std::string changed(std::string bytes, const std::vector<std::string>& examples, std::mt19937& random) {
  const std::string& other = examples[random() % examples.size()];
  for (auto n = 1 + random() % 8; n > 0; --n) {
    const std::size_t at = random() % (bytes.size() + 1);
    const std::string& from = random() % 2 ? other : bytes;
    switch (random() % 5) {
      case 0: bytes.insert(at, 1, static_cast<char>(random() % 256)); break;
      case 1: if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1u << random() % 8)); break;
      case 2: if (at < bytes.size()) bytes.erase(at, 1 + random() % 16); break;
      case 3: if (at < bytes.size()) bytes.replace(at, 1 + random() % 24, std::string(from, random() % (from.size() + 1), random() % 24)); break;
      default: bytes.insert(at, std::string(from, random() % (from.size() + 1), random() % 48)); break;
    }
  }
  return bytes;
}

class Clock {
 public:
  explicit Clock(double seconds) : seconds_(seconds) {}
  bool over() const { return seconds_ > 0 && std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() > seconds_; }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double seconds_;
};

}  // namespace

int main(int argc, char** argv) {
  const Settings settings = read_arguments(argc, argv);
  if (LLVMFuzzerInitialize != nullptr) LLVMFuzzerInitialize(&argc, &argv);
  std::vector<std::string> examples;
  for (const fs::path& file : files_of(settings.places)) {
    examples.push_back(read_file(file));
    fs::create_directories(settings.last_input.has_parent_path() ? settings.last_input.parent_path() : fs::path("."));
    std::ofstream(settings.last_input, std::ios::binary) << examples.back();
    run(examples.back());
  }
  if (examples.empty()) return std::fprintf(stderr, "no corpus is named\n"), 2;
  std::mt19937 random(static_cast<std::mt19937::result_type>(settings.seed));
  const Clock clock(settings.seconds);
  unsigned long rounds = 0;
  for (; settings.seconds > 0 ? !clock.over() : rounds < settings.rounds; ++rounds) {
    std::string bytes = changed(examples[random() % examples.size()], examples, random);
    bytes.resize(std::min<std::size_t>(bytes.size(), settings.max_len));
    std::ofstream(settings.last_input, std::ios::binary) << bytes;
    run(bytes);
  }
  std::error_code ignored;
  fs::remove(settings.last_input, ignored);
  std::fprintf(stderr, "%zu inputs of the corpus and %lu changed ones, seed %lu: nothing found\n", examples.size(), rounds, settings.seed);
  return 0;
}
