// A file that either is complete under its name or does not exist: bytes go to a temporary name beside it, commit() renames.
// Devices and pipes (/dev/stdout) are written directly.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace pmac::runtime {

/// A file that cannot be written: disk full, no such folder, ... what() names the file and the reason.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What was printed has arrived. Throws OutputError where some of it has not, with the reason where the stream still knows it.
void flush_standard_output();

class OutputFile {
 public:
  /// Throws OutputError when the file cannot be created.
  explicit OutputFile(const std::string& path);
  /// Without commit() nothing stays behind.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::span<const std::uint8_t> bytes);
  void write(std::string_view text);
  /// Room for `size` bytes to be filled by the caller, who then says how many with advance().
  char* reserve(std::size_t size);
  void advance(std::size_t size) { used_ += size; }

  /// Bytes written so far.
  std::uint64_t size() const { return flushed_ + used_; }
  /// Writes bytes to a place, before or beyond the end. Not for devices and pipes.
  void patch(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  /// Bytes written earlier, also to another place of the file (to <= from). As above.
  void move_down(std::uint64_t from, std::uint64_t to, std::uint64_t size);
  /// The file ends here: what lies beyond is dropped, and write() goes on from here. As above.
  void end_at(std::uint64_t offset);
  bool is_seekable() const { return !temporary_.empty(); }

  /// Writes what is buffered and gives the file its name. Throws OutputError; then nothing keeps the name.
  void commit();

 private:
  void flush();
  void write_out(const std::uint8_t* bytes, std::size_t size);
  [[noreturn]] void fail(const char* action) const;

  std::string path_;
  std::string temporary_;   // empty: written directly
  int descriptor_ = -1;
  std::vector<std::uint8_t> buffer_;
  std::size_t used_ = 0;
  std::uint64_t flushed_ = 0;
};

}  // namespace pmac::runtime
