// A table as a NumPy .npz archive; see table_writer.h.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "runtime/gather/table_writer.h"

namespace pmac::runtime {

/// Memory stays bounded: rows beyond a block per column go to the file where known_rows says how many there will be, and wait in an unnamed
/// temporary file until finish() where it is 0. Fewer may come than were announced.
std::unique_ptr<TableWriter> make_npz_writer(const std::string& path, std::vector<std::string> columns, std::uint64_t known_rows);

}  // namespace pmac::runtime
