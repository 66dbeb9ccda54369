// An .npz file is a ZIP archive with one .npy file per array. The arrays are columns, the data arrive as rows. Rows are collected column
// by column in a block; full blocks go straight to their places in the archive where the number of rows is known beforehand. Else they
// wait in a scratch file, laid out
//
//     block 0: column 0, column 1, ...   block 1: column 0, ...
//
// and finish() copies column by column into the archive. A table that ends before the rows that were announced is moved together. Every
// entry is stored (not compressed) with 64-bit sizes, as numpy.savez itself writes it; how the rows came makes no difference to its bytes.
// Formats: PKWARE APPNOTE 6.3, numpy.lib.format 1.0.
#include "runtime/gather/npz_writer.h"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "runtime/gather/crc32.h"

namespace pmac::runtime {
namespace {

static_assert(std::endian::native == std::endian::little, "the arrays are written as they are in memory, as <f8");

constexpr std::size_t kBlockRows = 8192;   // of a few columns: they stay in the cache between checksum and write

/// Little-endian fields of a ZIP record.
class Record {
 public:
  std::vector<std::uint8_t> bytes;
  Record& u16(std::uint64_t value) { return put(value, 2); }
  Record& u32(std::uint64_t value) { return put(value, 4); }
  Record& u64(std::uint64_t value) { return put(value, 8); }
  Record& text(std::string_view value) {
    bytes.insert(bytes.end(), value.begin(), value.end());
    return *this;
  }

 private:
  Record& put(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
};

constexpr std::uint32_t kIn64Bits = 0xffffffffu;  // "see the ZIP64 field"
constexpr std::uint32_t kDate = 0x21;             // 1980-01-01: same rows, same bytes

struct Entry {
  std::string name;
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
  std::uint32_t crc = 0;
};

Record local_header(const Entry& entry) {
  Record record;
  record.u32(0x04034b50).u16(45).u16(0x800).u16(0).u16(0).u16(kDate).u32(entry.crc).u32(kIn64Bits).u32(kIn64Bits);
  record.u16(entry.name.size()).u16(20).text(entry.name);
  record.u16(1).u16(16).u64(entry.size).u64(entry.size);
  return record;
}

Record central_header(const Entry& entry) {
  Record record;
  record.u32(0x02014b50).u16(45).u16(45).u16(0x800).u16(0).u16(0).u16(kDate).u32(entry.crc).u32(kIn64Bits).u32(kIn64Bits);
  record.u16(entry.name.size()).u16(28).u16(0).u16(0).u16(0).u32(0).u32(kIn64Bits).text(entry.name);
  record.u16(1).u16(24).u64(entry.size).u64(entry.size).u64(entry.offset);
  return record;
}

/// The three records after the central directory, which begins at `start`.
Record end_records(std::uint64_t entries, std::uint64_t start, std::uint64_t size) {
  Record record;
  record.u32(0x06064b50).u64(44).u16(45).u16(45).u32(0).u32(0).u64(entries).u64(entries).u64(size).u64(start);
  record.u32(0x07064b50).u32(0).u64(start + size).u32(1);
  const std::uint64_t shown_entries = entries < 0xffff ? entries : 0xffff;
  record.u32(0x06054b50).u16(0).u16(0).u16(shown_entries).u16(shown_entries).u32(kIn64Bits).u32(kIn64Bits).u16(0);
  return record;
}

/// Header of a .npy file with `rows` doubles, a multiple of 64 bytes long.
Record npy_header(std::uint64_t rows) {
  std::string dictionary = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(rows) + ",), }";
  dictionary.resize((10 + dictionary.size() + 1 + 63) / 64 * 64 - 11, ' ');
  Record record;
  record.text("\x93NUMPY").u16(1).u16(dictionary.size() + 1).text(dictionary).text("\n");
  return record;
}

class NpzWriter : public TableWriter {
 public:
  NpzWriter(const std::string& path, std::vector<std::string> columns, std::uint64_t known_rows)
      : path_(path), file_(path), columns_(std::move(columns)), known_rows_(known_rows), block_(columns_.size() * kBlockRows), crc_(columns_.size()) {
    if (!file_.is_seekable()) throw OutputError("cannot write " + path + ": an .npz archive needs a file");
    for (std::size_t column = 0; has_places() && column < columns_.size(); ++column) places_.push_back(data_of(column, known_rows_));
  }
  ~NpzWriter() override {
    if (scratch_ != nullptr) std::fclose(scratch_);
  }
  NpzWriter(const NpzWriter&) = delete;
  NpzWriter& operator=(const NpzWriter&) = delete;

  void append(std::span<const double> rows) override;
  void append_columns(std::span<const std::span<const double>> columns) override;
  void finish() override;
  std::uint64_t size() const override { return file_.size() + rows() * columns_.size() * sizeof(double); }

 private:
  double* column_of_block(std::size_t column) { return block_.data() + column * kBlockRows; }
  std::span<const std::uint8_t> bytes_of_block(std::size_t column) {
    return {reinterpret_cast<const std::uint8_t*>(column_of_block(column)), block_rows_ * sizeof(double)};
  }
  std::uint64_t rows() const { return spilled_rows_ + block_rows_; }
  Entry entry_of(std::size_t column, std::uint64_t rows) const;
  std::uint64_t data_of(std::size_t column, std::uint64_t rows) const;
  bool has_places() const { return known_rows_ > 0; }
  void spill();
  void spill_to_places();
  void spill_to_scratch();
  void move_together();
  void write_headers();
  void write_column(const Entry& entry, std::size_t column);
  std::span<const std::uint8_t> spilled(std::uint64_t block, std::size_t column);

  std::string path_;
  OutputFile file_;
  std::vector<std::string> columns_;
  std::uint64_t known_rows_;        // 0: not known beforehand
  std::vector<std::uint64_t> places_;  // of the columns' data, where known_rows_ says them
  std::vector<double> block_;       // [column][row]
  std::vector<std::uint32_t> crc_;  // of the spilled data of each column
  std::size_t block_rows_ = 0;
  std::uint64_t spilled_rows_ = 0;
  std::FILE* scratch_ = nullptr;
  std::vector<std::uint8_t> read_back_;
};

void NpzWriter::append(std::span<const double> rows) {
  const std::size_t width = columns_.size();
  for (std::size_t first = 0; first + width <= rows.size(); first += width) {
    if (block_rows_ == kBlockRows) spill();
    for (std::size_t column = 0; column < width; ++column) column_of_block(column)[block_rows_] = rows[first + column];
    ++block_rows_;
  }
}

void NpzWriter::append_columns(std::span<const std::span<const double>> columns) {
  for (std::size_t done = 0; done < columns[0].size();) {
    if (block_rows_ == kBlockRows) spill();
    const std::size_t count = std::min(columns[0].size() - done, kBlockRows - block_rows_);
    for (std::size_t column = 0; column < columns_.size(); ++column)
      std::copy_n(columns[column].begin() + static_cast<std::ptrdiff_t>(done), count, column_of_block(column) + block_rows_);
    block_rows_ += count;
    done += count;
  }
}

/// The block is full, or the table complete.
void NpzWriter::spill() {
  for (std::size_t column = 0; column < columns_.size(); ++column) crc_[column] = zip_crc32(bytes_of_block(column), crc_[column]);
  if (has_places()) spill_to_places();
  else spill_to_scratch();
  spilled_rows_ += block_rows_;
  block_rows_ = 0;
}

void NpzWriter::spill_to_places() {
  if (rows() > known_rows_) throw std::logic_error("more rows than were announced for " + path_);
  for (std::size_t column = 0; column < columns_.size(); ++column)
    file_.patch(places_[column] + spilled_rows_ * sizeof(double), bytes_of_block(column));
}

void NpzWriter::spill_to_scratch() {
  if (scratch_ == nullptr) scratch_ = std::tmpfile();
  const bool written = scratch_ != nullptr && std::fwrite(block_.data(), sizeof(double), block_.size(), scratch_) == block_.size();
  if (!written) throw OutputError("cannot write the temporary data of " + path_ + ": " + std::strerror(errno));
}

/// Where the entry of a column lies, and how large it is, where all columns have so many rows.
Entry NpzWriter::entry_of(std::size_t column, std::uint64_t rows) const {
  const Record header = npy_header(rows);
  Entry entry{columns_[column] + ".npy", 0, header.bytes.size() + rows * sizeof(double), 0};
  for (std::size_t before = 0; before < column; ++before) entry.offset += local_header({columns_[before] + ".npy", 0, 0, 0}).bytes.size() + entry.size;
  entry.crc = joined_crc32(zip_crc32(header.bytes), crc_[column], rows * sizeof(double));
  return entry;
}

std::uint64_t NpzWriter::data_of(std::size_t column, std::uint64_t rows) const {
  const Entry entry = entry_of(column, rows);
  return entry.offset + local_header(entry).bytes.size() + npy_header(rows).bytes.size();
}

/// The table has ended early: its columns have been written further on than they belong.
void NpzWriter::move_together() {
  for (std::size_t column = 0; column < columns_.size(); ++column)
    file_.move_down(data_of(column, known_rows_), data_of(column, rows()), rows() * sizeof(double));
}

void NpzWriter::write_headers() {
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    const Entry entry = entry_of(column, rows());
    Record header = local_header(entry);
    const Record npy = npy_header(rows());
    header.bytes.insert(header.bytes.end(), npy.bytes.begin(), npy.bytes.end());
    file_.patch(entry.offset, header.bytes);
  }
  const Entry last = entry_of(columns_.size() - 1, rows());
  file_.end_at(last.offset + local_header(last).bytes.size() + last.size);
}

std::span<const std::uint8_t> NpzWriter::spilled(std::uint64_t block, std::size_t column) {
  read_back_.resize(kBlockRows * sizeof(double));
  const std::uint64_t offset = (block * columns_.size() + column) * read_back_.size();
  std::size_t done = 0;
  while (done < read_back_.size()) {
    const ::ssize_t count = ::pread(::fileno(scratch_), read_back_.data() + done, read_back_.size() - done,
                                    static_cast<::off_t>(offset + done));
    if (count <= 0) throw OutputError("cannot read the temporary data of " + path_);
    done += static_cast<std::size_t>(count);
  }
  return read_back_;
}

/// From the scratch file and the block.
void NpzWriter::write_column(const Entry& entry, std::size_t column) {
  file_.write(local_header(entry).bytes);
  file_.write(npy_header(rows()).bytes);
  for (std::uint64_t block = 0; block < spilled_rows_ / kBlockRows; ++block) file_.write(spilled(block, column));
  file_.write(bytes_of_block(column));
}

void NpzWriter::finish() {
  if (has_places()) {
    spill();
    if (rows() < known_rows_) move_together();
    write_headers();
  } else {
    if (scratch_ != nullptr && std::fflush(scratch_) != 0) {
      throw OutputError("cannot write the temporary data of " + path_ + ": " + std::strerror(errno));
    }
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      crc_[column] = zip_crc32(bytes_of_block(column), crc_[column]);
      write_column(entry_of(column, rows()), column);
    }
  }
  const std::uint64_t start = file_.size();
  for (std::size_t column = 0; column < columns_.size(); ++column) file_.write(central_header(entry_of(column, rows())).bytes);
  file_.write(end_records(columns_.size(), start, file_.size() - start).bytes);
  file_.commit();
}

}  // namespace

std::unique_ptr<TableWriter> make_npz_writer(const std::string& path, std::vector<std::string> columns, std::uint64_t known_rows) {
  return std::make_unique<NpzWriter>(path, std::move(columns), known_rows);
}

}  // namespace pmac::runtime
