#include "runtime/gather/table_writer.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include "runtime/gather/npz_writer.h"

namespace pmac::runtime {
namespace {

constexpr std::size_t kNumberChars = 32;  // the shortest form of a double has at most 24

std::string csv_field(const std::string& name) {
  if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char ch : name) quoted += ch == '"' ? std::string("\"\"") : std::string(1, ch);
  return quoted + '"';
}

std::string csv_header(const std::vector<std::string>& columns) {
  std::string header;
  for (const std::string& name : columns) header += (header.empty() ? "" : ",") + csv_field(name);
  return header + "\n";
}

/// Rows as lines of text.
class TextTableWriter : public TableWriter {
 public:
  TextTableWriter(const std::string& path, std::size_t column_count, char separator, std::string_view header)
      : file_(path), column_count_(column_count), separator_(separator) {
    file_.write(header);
  }

  void append(std::span<const double> rows) override {
    for (std::size_t first = 0; first + column_count_ <= rows.size(); first += column_count_) {
      append_row(rows.subspan(first, column_count_));
    }
  }
  void finish() override { file_.commit(); }
  std::uint64_t size() const override { return file_.size(); }

 private:
  void append_row(std::span<const double> row) {
    char* const begin = file_.reserve(kNumberChars * column_count_);
    char* at = begin;
    for (const double value : row) {
      at = std::to_chars(at, at + kNumberChars, value).ptr;
      *at++ = separator_;
    }
    at[-1] = '\n';
    file_.advance(static_cast<std::size_t>(at - begin));
  }

  OutputFile file_;
  std::size_t column_count_;
  char separator_;
};

}  // namespace

void interleave(std::span<const std::span<const double>> columns, std::vector<double>& rows) {
  const std::size_t width = columns.size(), count = columns.empty() ? 0 : columns[0].size();
  rows.resize(width * count);
  for (std::size_t column = 0; column < width; ++column) {
    const double* from = columns[column].data();
    double* to = rows.data() + column;
    for (std::size_t row = 0; row < count; ++row) to[row * width] = from[row];
  }
}

void TableWriter::append_columns(std::span<const std::span<const double>> columns) {
  std::vector<double> rows;
  interleave(columns, rows);
  append(rows);
}

std::optional<TableFormat> table_format_of(std::string_view path) {
  std::string ending(path.size() < 4 ? path : path.substr(path.size() - 4));
  for (char& ch : ending) ch = static_cast<char>(std::tolower(static_cast<unsigned char>(ch)));
  if (ending == ".csv") return TableFormat::kCsv;
  if (ending == ".npz") return TableFormat::kNpz;
  if (ending == ".txt") return TableFormat::kText;
  return std::nullopt;
}

std::unique_ptr<TableWriter> make_table_writer(TableFormat format, const std::string& path, std::vector<std::string> columns,
                                               std::uint64_t known_rows) {
  if (columns.empty()) throw std::invalid_argument("a table needs columns");
  if (format == TableFormat::kNpz) return make_npz_writer(path, std::move(columns), known_rows);
  const bool is_csv = format == TableFormat::kCsv;
  return std::make_unique<TextTableWriter>(path, columns.size(), is_csv ? ',' : ' ',
                                           is_csv ? csv_header(columns) : std::string());
}

}  // namespace pmac::runtime
