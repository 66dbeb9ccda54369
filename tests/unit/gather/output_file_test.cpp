#include "runtime/gather/output_file.h"

#include <catch2/catch.hpp>

#include "tests/unit/gather/scratch_folder.h"

using namespace pmac::test;
using pmac::runtime::OutputError;
using pmac::runtime::OutputFile;

TEST_CASE("output file: has its name only when it is complete", "[gather]") {
  const ScratchFolder folder;
  {
    OutputFile file(folder.file("a.txt"));
    file.write("hello");
    CHECK_FALSE(std::filesystem::exists(folder.file("a.txt")));
    file.commit();
  }
  CHECK(contents_of(folder.file("a.txt")) == "hello");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("output file: dropped before the end, the old file stays and nothing else", "[gather]") {
  const ScratchFolder folder;
  std::ofstream(folder.file("a.txt")) << "old";
  {
    OutputFile file(folder.file("a.txt"));
    file.write(std::string(3000000, 'x'));
  }
  CHECK(contents_of(folder.file("a.txt")) == "old");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("output file: replaces the target of a link, not the link", "[gather]") {
  const ScratchFolder folder;
  std::ofstream(folder.file("real.txt")) << "old";
  std::filesystem::create_symlink("real.txt", folder.file("link.txt"));
  OutputFile file(folder.file("link.txt"));
  file.write("new");
  file.commit();
  CHECK(std::filesystem::is_symlink(folder.file("link.txt")));
  CHECK(contents_of(folder.file("real.txt")) == "new");
}

TEST_CASE("output file: errors name the file", "[gather]") {
  const ScratchFolder folder;
  CHECK_THROWS_WITH(OutputFile(folder.file("none/a.txt")), Catch::Contains("none/a.txt: No such file"));
  std::filesystem::create_directories(folder.file("dir"));
  CHECK_THROWS_WITH(OutputFile(folder.file("dir")), Catch::Contains("Is a directory"));
  CHECK(folder.file_count() == 1);
}

TEST_CASE("output file: a full device is an error", "[gather]") {
  if (!std::filesystem::exists("/dev/full")) return;
  OutputFile file("/dev/full");
  file.write("hello");
  CHECK_THROWS_AS(file.commit(), OutputError);
}

TEST_CASE("output file: devices are written directly", "[gather]") {
  OutputFile file("/dev/null");
  CHECK_FALSE(file.is_seekable());
  file.write("hello");
  file.commit();
  CHECK(std::filesystem::is_character_file("/dev/null"));
}

TEST_CASE("output file: earlier bytes can be patched, large writes pass the buffer", "[gather]") {
  const ScratchFolder folder;
  const std::string large(5000000, 'y');
  OutputFile file(folder.file("a.bin"));
  file.write("0123456789");
  file.write(large);
  file.write("end");
  const std::uint8_t patch[] = {'A', 'B'};
  file.patch(4, patch);
  CHECK(file.size() == 5000013);
  file.commit();
  CHECK(contents_of(folder.file("a.bin")) == "0123AB6789" + large + "end");
}
