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

TEST_CASE("npz: the same bytes, whether the number of rows is known beforehand or not, and rows come as rows or as columns", "[gather]") {
  const std::size_t count = GENERATE(0, 1, 100, 32768, 65536, 100001);
  std::vector<double> rows;
  std::vector<std::vector<double>> columns(3);
  for (std::size_t k = 0; k < count; ++k) {
    const auto value = static_cast<double>(k);
    const double row[] = {value, value * value, value / 3};
    rows.insert(rows.end(), row, row + 3);
    for (std::size_t c = 0; c < 3; ++c) columns[c].push_back(row[c]);
  }
  const ScratchFolder folder;
  const std::vector<std::string> names{"k", "square", "third"};
  const auto written_as = [&](std::uint64_t known_rows, bool by_columns) {
    const auto writer = make_table_writer(TableFormat::kNpz, folder.file("a.npz"), names, known_rows);
    if (!by_columns) writer->append(rows);
    for (std::size_t first = 0; by_columns && first < count; first += 5000) {
      std::vector<std::span<const double>> piece;
      for (const auto& column : columns) piece.push_back(std::span(column).subspan(first, std::min<std::size_t>(5000, count - first)));
      writer->append_columns(piece);
    }
    writer->finish();
    return contents_of(folder.file("a.npz"));
  };
  const std::string bytes = written_as(0, false);
  CHECK(read_npz(bytes)["third.npy"] == columns[2]);
  CHECK((written_as(0, true) == bytes));
  if (count > 0) CHECK((written_as(count, true) == bytes));
  CHECK((written_as(count + 1, false) == bytes));
  CHECK((written_as(10 * count + 12345, true) == bytes));  // ended early
}

TEST_CASE("csv: columns are written as the rows they make", "[gather]") {
  const ScratchFolder folder;
  const auto writer = make_table_writer(TableFormat::kCsv, folder.file("a.csv"), {"a", "b"});
  const std::vector<double> a{1, 2}, b{3, 4.5};
  const std::vector<std::span<const double>> columns{a, b};
  writer->append_columns(columns);
  writer->finish();
  CHECK(contents_of(folder.file("a.csv")) == "a,b\n1,3\n2,4.5\n");
}

TEST_CASE("checksum of archives: long runs of bytes as bit by bit, and joined from two parts", "[gather]") {
  std::mt19937 random(5);
  std::vector<std::uint8_t> bytes(1000);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  const auto bit_by_bit = [](std::span<const std::uint8_t> of) {  // the definition: PKWARE APPNOTE 4.4.7
    std::uint32_t crc = 0xffffffffu;
    for (const std::uint8_t byte : of) {
      crc ^= byte;
      for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) ? 0xedb88320u : 0u);
    }
    return ~crc;
  };
  for (const std::size_t size : {0, 1, 63, 64, 65, 127, 128, 200, 640, 1000}) {
    const std::span<const std::uint8_t> part(bytes.data(), size), rest(bytes.data() + size, bytes.size() - size);
    CHECK(zip_crc32(part) == bit_by_bit(part));
    CHECK(zip_crc32(rest, zip_crc32(part)) == bit_by_bit(bytes));
    CHECK(joined_crc32(zip_crc32(part), zip_crc32(rest), rest.size()) == bit_by_bit(bytes));
  }
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
