// A table as a NumPy .npz archive; see table_writer.h.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "runtime/gather/table_writer.h"

namespace pmac::runtime {

/// Memory stays bounded: rows beyond a block per column wait in an unnamed temporary file until finish().
std::unique_ptr<TableWriter> make_npz_writer(const std::string& path, std::vector<std::string> columns);

}  // namespace pmac::runtime
