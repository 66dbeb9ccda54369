#include "compiler/tool/temporary_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>

namespace pmac::pmacc {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

/// Name of the file for the handler; what it reads must be no string.
std::array<char, 4096> g_name{};
std::atomic<bool> g_exists{false};

void remove_and_end(int signal) {
  if (g_exists.exchange(false)) ::unlink(g_name.data());
  std::signal(signal, SIG_DFL);
  ::raise(signal);
}

void watch(const std::string& name) {
  if (name.size() >= g_name.size()) return;
  std::copy(name.begin(), name.end(), g_name.begin());
  g_name[name.size()] = '\0';
  g_exists = true;
  for (const int signal : kSignals)
    if (std::signal(signal, remove_and_end) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

TemporaryFile::TemporaryFile(const std::string& target) : target_(target), name_(fmt::format("{}.{}.tmp", target, ::getpid())) {
  watch(name_);
  errno = 0;
  stream_.open(name_, std::ios::binary);
}

TemporaryFile::~TemporaryFile() {
  if (!g_exists) return;
  std::error_code ignored;
  std::filesystem::remove(name_, ignored);
  g_exists = false;  // only now: a signal in between must still find it
}

void TemporaryFile::write(std::string_view bytes) {
  if (stream_) stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

std::string TemporaryFile::commit() {
  if (stream_) stream_.close();
  if (!stream_) return errno != 0 ? std::strerror(errno) : "it could not be written";
  std::error_code error;
  if (std::filesystem::exists(target_, error)) std::filesystem::permissions(name_, std::filesystem::status(target_).permissions(), error);
  if (!error) std::filesystem::rename(name_, target_, error);
  if (error) return error.message();
  g_exists = false;
  return {};
}

}  // namespace pmac::pmacc
