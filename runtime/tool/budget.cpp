#include "runtime/tool/budget.h"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <unistd.h>

namespace pmac::tool {
namespace {

constexpr std::uint64_t kMiB = 1u << 20;
constexpr std::uint64_t kSmallOutput = kMiB;  // fills no disk
constexpr const char* kStandardOutput = "/proc/self/fd/1";
constexpr unsigned kCallsPerLook = 16;   // at memory and disks: reading them costs microseconds

/// The folder that an output file fills, or nothing for a device or pipe.
std::optional<std::string> folder_of(const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (file.empty() || (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored))) return std::nullopt;
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? "." : folder.string();
}

}  // namespace

std::uint64_t memory_in_use() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t total = 0, resident = 0;
  if (!(file >> total >> resident)) return 0;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

Budget::Budget(const RunOptions& options) : options_(options) {
  const auto watch = [this](const std::string& file, const std::string& name) {
    if (auto folder = folder_of(file)) disks_.push_back({std::move(*folder), name});
  };
  for (const std::string& file : {options.record, options.gather, options.drive_record}) watch(file, file);
  if (options.trace != "-") watch(options.trace, options.trace);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(kStandardOutput, ignored)) disks_.push_back({kStandardOutput, "standard output"});
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
  if (calls_++ % kCallsPerLook != 0) return {};
  if (memory_in_use() > options_.max_memory_mib * kMiB) return fmt::format("the limit of {} MiB of memory is reached (--max-memory)", options_.max_memory_mib);
  return written > kSmallOutput ? find_full_disk() : std::string();
}

std::string Budget::find_full_disk() const {
  for (const Disk& disk : disks_) {
    std::error_code unknown;
    const std::filesystem::space_info space = std::filesystem::space(disk.folder, unknown);
    if (!unknown && space.available < options_.min_free_mib * kMiB) return fmt::format("less than {} MiB are free on the disk of {} (--min-free)", options_.min_free_mib, disk.output);
  }
  return {};
}

}  // namespace pmac::tool
