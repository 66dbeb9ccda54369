// A file under another name until it is whole. Where the tool is ended by Ctrl-C, SIGTERM or a terminal that goes away, it is removed.
#pragma once

#include <fstream>
#include <string>
#include <string_view>

namespace pmac::pmacc {

class TemporaryFile {
 public:
  /// Beside the target. One at a time.
  explicit TemporaryFile(const std::string& target);
  /// Without commit() nothing stays behind.
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::string_view bytes);
  /// Gives the file its name, and the permissions of a file that it replaces. Empty, or why that is not possible.
  std::string commit();

 private:
  std::string target_, name_;
  std::ofstream stream_;
};

}  // namespace pmac::pmacc
