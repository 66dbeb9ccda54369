#include "runtime/gather/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace pmac::runtime {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBufferBytes = 1u << 20;

/// The file that a name stands for: the target where the name is a link.
std::string target_of(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_symlink(path, ignored)) return path;
  const fs::path target = fs::weakly_canonical(path, ignored);
  return target.empty() ? path : target.string();
}

bool is_device_or_pipe(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_regular_file(path, ignored) && !fs::is_directory(path, ignored);
}

}  // namespace

void flush_standard_output() {
  const bool lost = std::ferror(stdout) != 0;
  errno = 0;
  if (lost) {  // what was the matter is asked by one more character
    std::clearerr(stdout);
    std::fputc('\n', stdout);
  }
  const bool fails = std::fflush(stdout) != 0;
  if (lost || fails) throw OutputError("cannot write standard output" + (fails && errno != 0 ? ": " + std::string(std::strerror(errno)) : std::string()));
}

OutputFile::OutputFile(const std::string& path) : path_(path), buffer_(kBufferBytes) {
  if (is_device_or_pipe(path)) {
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    path_ = target_of(path);
    temporary_ = path_ + ".partial-" + std::to_string(::getpid());
    descriptor_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  }
  std::error_code ignored;
  if (descriptor_ >= 0 && fs::is_directory(path_, ignored)) {
    ::close(descriptor_);
    ::unlink(temporary_.c_str());
    descriptor_ = -1;
    errno = EISDIR;
  }
  if (descriptor_ < 0) fail("write");
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::fail(const char* action) const {
  throw OutputError("cannot " + std::string(action) + " " + path_ + ": " + std::strerror(errno));
}

void OutputFile::write_out(const std::uint8_t* bytes, std::size_t size) {
  while (size > 0) {
    const ::ssize_t written = ::write(descriptor_, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write");
    bytes += written;
    size -= static_cast<std::size_t>(written);
    flushed_ += static_cast<std::uint64_t>(written);
  }
}

void OutputFile::flush() {
  const std::size_t size = used_;
  used_ = 0;
  write_out(buffer_.data(), size);
}

char* OutputFile::reserve(std::size_t size) {
  if (buffer_.size() - used_ < size) flush();
  if (buffer_.size() < size) buffer_.resize(size);
  return reinterpret_cast<char*>(buffer_.data() + used_);
}

void OutputFile::write(std::span<const std::uint8_t> bytes) {
  if (bytes.size() >= buffer_.size()) {
    flush();
    return write_out(bytes.data(), bytes.size());
  }
  if (bytes.empty()) return;
  std::memcpy(reserve(bytes.size()), bytes.data(), bytes.size());
  advance(bytes.size());
}

void OutputFile::write(std::string_view text) {
  write(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

void OutputFile::patch(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  flush();
  while (!bytes.empty()) {
    const ::ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<::off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

void OutputFile::move_down(std::uint64_t from, std::uint64_t to, std::uint64_t size) {
  flush();
  while (size > 0 && from != to) {
    const ::ssize_t count = ::pread(descriptor_, buffer_.data(), std::min<std::uint64_t>(size, buffer_.size()), static_cast<::off_t>(from));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail("read");
    patch(to, {buffer_.data(), static_cast<std::size_t>(count)});
    from += static_cast<std::uint64_t>(count);
    to += static_cast<std::uint64_t>(count);
    size -= static_cast<std::uint64_t>(count);
  }
}

void OutputFile::end_at(std::uint64_t offset) {
  flush();
  if (::ftruncate(descriptor_, static_cast<::off_t>(offset)) != 0 || ::lseek(descriptor_, static_cast<::off_t>(offset), SEEK_SET) < 0) fail("write");
  flushed_ = offset;
}

void OutputFile::commit() {
  flush();
  const int descriptor = descriptor_;
  if (temporary_.empty()) {
    descriptor_ = -1;
    ::close(descriptor);
    return;
  }
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("replace");
  descriptor_ = -1;
  if (::close(descriptor) != 0 && errno != EINTR) {
    ::unlink(path_.c_str());
    fail("write");
  }
}

}  // namespace pmac::runtime
