#include "runtime/gather/table_writer.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <map>
#include <random>

#include "runtime/gather/crc32.h"
#include "tests/unit/gather/scratch_folder.h"

using namespace pmac::test;
using namespace pmac::runtime;

namespace {

std::string written(TableFormat format, const std::vector<std::string>& columns, const std::vector<double>& rows) {
  const ScratchFolder folder;
  const auto writer = make_table_writer(format, folder.file("table"), columns);
  writer->append(rows);
  writer->finish();
  return contents_of(folder.file("table"));
}

std::uint64_t little_endian(const std::string& bytes, std::size_t offset, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = (value << 8) | static_cast<std::uint8_t>(bytes.at(offset + i));
  return value;
}

/// Reads an archive by its central directory, as numpy does: name -> values. Checks sizes and checksums.
std::map<std::string, std::vector<double>> read_npz(const std::string& bytes) {
  std::map<std::string, std::vector<double>> arrays;
  const std::size_t locator = bytes.size() - 22 - 20;
  REQUIRE(little_endian(bytes, bytes.size() - 22, 4) == 0x06054b50);
  REQUIRE(little_endian(bytes, locator, 4) == 0x07064b50);
  const std::size_t end = little_endian(bytes, locator + 8, 8);
  REQUIRE(little_endian(bytes, end, 4) == 0x06064b50);
  const std::uint64_t entries = little_endian(bytes, end + 32, 8);
  std::size_t at = little_endian(bytes, end + 48, 8);
  for (std::uint64_t i = 0; i < entries; ++i) {
    REQUIRE(little_endian(bytes, at, 4) == 0x02014b50);
    const std::uint64_t crc = little_endian(bytes, at + 16, 4);
    const std::size_t name_size = little_endian(bytes, at + 28, 2);
    const std::string name = bytes.substr(at + 46, name_size);
    const std::size_t size = little_endian(bytes, at + 46 + name_size + 4, 8);
    const std::size_t local = little_endian(bytes, at + 46 + name_size + 20, 8);
    REQUIRE(little_endian(bytes, local, 4) == 0x04034b50);
    CHECK(little_endian(bytes, local + 14, 4) == crc);
    const std::string array = bytes.substr(local + 30 + name_size + 20, size);
    CHECK(zip_crc32({reinterpret_cast<const std::uint8_t*>(array.data()), array.size()}) == crc);
    const std::size_t header = 10 + little_endian(array, 8, 2);
    CHECK(array.substr(0, 6) == "\x93NUMPY");
    CHECK(header % 64 == 0);
    CHECK(array[header - 1] == '\n');
    std::vector<double> values((array.size() - header) / 8);
    if (!values.empty()) std::memcpy(values.data(), array.data() + header, values.size() * 8);
    CHECK(array.find("'shape': (" + std::to_string(values.size()) + ",)") != std::string::npos);
    arrays[name] = std::move(values);
    at += 46 + name_size + 28;
  }
  return arrays;
}

}  // namespace

TEST_CASE("checksum of archives: the check value of CRC-32", "[gather]") {
  const std::string text = "123456789";
  CHECK(zip_crc32({reinterpret_cast<const std::uint8_t*>(text.data()), 9}) == 0xcbf43926u);
}

TEST_CASE("tables: the format is chosen by the ending", "[gather]") {
  CHECK(table_format_of("a/b.csv") == TableFormat::kCsv);
  CHECK(table_format_of("b.NPZ") == TableFormat::kNpz);
  CHECK(table_format_of("b.txt") == TableFormat::kText);
  CHECK_FALSE(table_format_of("b.dat").has_value());
  CHECK_FALSE(table_format_of("").has_value());
}

TEST_CASE("csv: names, then rows in the shortest form that reads back", "[gather]") {
  CHECK(written(TableFormat::kCsv, {"time_s", "Motor[1].DesPos"}, {0, 1000, 0.00044274211, -0.1, 1e300, 0.30000000000000004}) ==
        "time_s,Motor[1].DesPos\n0,1000\n0.00044274211,-0.1\n1e+300,0.30000000000000004\n");
}

TEST_CASE("csv: names with commas or quotes are quoted, odd numbers are named", "[gather]") {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  CHECK(written(TableFormat::kCsv, {"a,b", "say \"x\""}, {kInf, std::numeric_limits<double>::quiet_NaN()}) ==
        "\"a,b\",\"say \"\"x\"\"\"\ninf,nan\n");
}

TEST_CASE("text: as the controller's upload, no names and one blank between values", "[gather]") {
  CHECK(written(TableFormat::kText, {"t", "x"}, {0, 1, 2, 3.5}) == "0 1\n2 3.5\n");
}

TEST_CASE("tables: without rows there are only names", "[gather]") {
  CHECK(written(TableFormat::kCsv, {"t", "x"}, {}) == "t,x\n");
  CHECK(written(TableFormat::kText, {"t"}, {}).empty());
  CHECK(read_npz(written(TableFormat::kNpz, {"t"}, {})) == std::map<std::string, std::vector<double>>{{"t.npy", {}}});
  CHECK_THROWS_AS(make_table_writer(TableFormat::kCsv, "x", {}), std::invalid_argument);
}

TEST_CASE("npz: one array per column", "[gather]") {
  const auto arrays = read_npz(written(TableFormat::kNpz, {"time_s", "X"}, {0, 10, 1, 11, 2, 12.5}));
  CHECK(arrays == std::map<std::string, std::vector<double>>{{"time_s.npy", {0, 1, 2}}, {"X.npy", {10, 11, 12.5}}});
}

TEST_CASE("npz: more rows than a block, appended in uneven pieces", "[gather]") {
  const ScratchFolder folder;
  const auto writer = make_table_writer(TableFormat::kNpz, folder.file("a.npz"), {"k", "square", "third"});
  std::mt19937 random(3);
  std::vector<double> rows;
  const std::size_t count = 100000;  // three blocks and a rest
  for (std::size_t k = 0; k < count; ++k) {
    const auto value = static_cast<double>(k);
    rows.insert(rows.end(), {value, value * value, value / 3});
    if (random() % 1000 != 0 && k + 1 < count) continue;
    writer->append(rows);
    rows.clear();
  }
  writer->finish();
  auto arrays = read_npz(contents_of(folder.file("a.npz")));
  REQUIRE(arrays["third.npy"].size() == count);
  bool is_right = true;
  for (std::size_t k = 0; k < count; ++k) {
    const auto value = static_cast<double>(k);
    is_right = is_right && arrays["k.npy"][k] == value && arrays["square.npy"][k] == value * value && arrays["third.npy"][k] == value / 3;
  }
  CHECK(is_right);
  CHECK(folder.file_count() == 1);
}

TEST_CASE("npz: cannot go into a pipe or device", "[gather]") {
  CHECK_THROWS_WITH(make_table_writer(TableFormat::kNpz, "/dev/null", {"t"}), Catch::Contains("needs a file"));
}

TEST_CASE("tables: a writer that is dropped leaves nothing", "[gather]") {
  const ScratchFolder folder;
  for (const TableFormat format : {TableFormat::kCsv, TableFormat::kNpz, TableFormat::kText}) {
    const std::vector<double> row = {1.0};
    make_table_writer(format, folder.file("a"), {"t"})->append(row);
  }
  CHECK(folder.file_count() == 0);
}
