#include "runtime/tool/budget.h"

#include <fstream>

#include <fmt/format.h>
#include <unistd.h>

namespace pmac::tool {
namespace {

constexpr std::uint64_t kMiB = 1u << 20;
constexpr unsigned kCallsPerLook = 16;   // at memory: reading it costs microseconds

}  // namespace

std::uint64_t memory_in_use() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t total = 0, resident = 0;
  if (!(file >> total >> resident)) return 0;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

const std::string& Budget::reached() {
  if (reached_.empty()) reached_ = find();
  return reached_;
}

std::string Budget::find() {
  if (moves_ > options_.max_moves) return fmt::format("the limit of {} moves is reached (--max-moves)", options_.max_moves);
  std::uint64_t written = 0;
  for (const auto& bytes : outputs_) written += bytes();
  if (written > options_.max_output_mib * kMiB) return fmt::format("the limit of {} MiB of output is reached (--max-output)", options_.max_output_mib);
  if (calls_++ % kCallsPerLook == 0 && memory_in_use() > options_.max_memory_mib * kMiB) return fmt::format("the limit of {} MiB of memory is reached (--max-memory)", options_.max_memory_mib);
  return {};
}

}  // namespace pmac::tool
