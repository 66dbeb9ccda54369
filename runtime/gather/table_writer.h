// Writes a table of doubles, columns by name, rows as they come, in one of three forms chosen by the ending of the file name:
//
//     .csv  a line of names, then rows; numbers in the shortest form that reads back as the same double
//     .npz  one NumPy array per column under its name (an uncompressed ZIP archive of .npy files)
//     .txt  as the controller's gather tool uploads: no header, values separated by one blank
//
// The name appears when the table is complete: finish(), at any time; a writer that is dropped before leaves nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/gather/output_file.h"

namespace pmac::runtime {

enum class TableFormat { kCsv, kNpz, kText };

/// Format by the ending of a file name, in either case; nullopt for others.
std::optional<TableFormat> table_format_of(std::string_view path);

class TableWriter {
 public:
  virtual ~TableWriter() = default;
  /// rows: row-major, a multiple of the number of columns. Throws OutputError.
  virtual void append(std::span<const double> rows) = 0;
  /// The same for rows that lie column by column: as many columns as the table has, all of one size.
  virtual void append_columns(std::span<const std::span<const double>> columns);
  /// Completes the file with the rows appended so far. Throws OutputError; then nothing keeps the name. Call at most once.
  virtual void finish() = 0;
  /// Bytes that the rows so far have taken on the disk.
  virtual std::uint64_t size() const = 0;
};

/// Throws OutputError when the file cannot be created, std::invalid_argument without columns. known_rows: most rows that will come, where
/// that is known; an archive is written faster then. 0: not known.
std::unique_ptr<TableWriter> make_table_writer(TableFormat format, const std::string& path, std::vector<std::string> columns,
                                               std::uint64_t known_rows = 0);

/// Rows, row-major, of columns of one size.
void interleave(std::span<const std::span<const double>> columns, std::vector<double>& rows);

}  // namespace pmac::runtime
