// The script and the error messages go through unnamed temporary files, so that only one pipe has to be read and nothing can
// block. No shell takes part, so that no name needs quoting.
#include "runtime/gather/gnuplot.h"

#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "runtime/gather/output_file.h"

namespace pmac::runtime {
namespace {

constexpr int kNotFound = 127;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using TemporaryFile = std::unique_ptr<std::FILE, CloseFile>;

[[noreturn]] void fail_to_start() { throw OutputError(std::string("cannot run gnuplot: ") + std::strerror(errno)); }

TemporaryFile temporary_file_with(const std::string& text) {
  TemporaryFile file(std::tmpfile());
  if (!file || std::fwrite(text.data(), 1, text.size(), file.get()) != text.size()) fail_to_start();
  if (std::fflush(file.get()) != 0 || std::fseek(file.get(), 0, SEEK_SET) != 0) fail_to_start();
  return file;
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 65536> part;
  for (;;) {
    const ::ssize_t count = ::read(descriptor, part.data(), part.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(count));
  }
}

/// Becomes gnuplot with these descriptors as its standard streams.
[[noreturn]] void become_gnuplot(int input, int output, int errors) {
  ::dup2(input, 0);
  ::dup2(output, 1);
  ::dup2(errors, 2);
  ::execlp("gnuplot", "gnuplot", "-", static_cast<char*>(nullptr));
  ::_exit(kNotFound);
}

int exit_code_of(::pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string contents_of(std::FILE* file) {
  ::lseek(::fileno(file), 0, SEEK_SET);
  return read_all(::fileno(file));
}

}  // namespace

std::string run_gnuplot(const std::string& script) {
  const TemporaryFile input = temporary_file_with(script);
  const TemporaryFile errors = temporary_file_with("");
  std::array<int, 2> pipe_ends{};
  if (::pipe(pipe_ends.data()) != 0) fail_to_start();
  const ::pid_t child = ::fork();
  if (child < 0) fail_to_start();
  if (child == 0) become_gnuplot(::fileno(input.get()), pipe_ends[1], ::fileno(errors.get()));
  ::close(pipe_ends[1]);
  std::string picture = read_all(pipe_ends[0]);
  ::close(pipe_ends[0]);
  const int exit_code = exit_code_of(child);
  if (exit_code == kNotFound) {
    throw OutputError("gnuplot is needed to draw pictures and was not found; install the package gnuplot-nox");
  }
  if (exit_code != 0 || picture.empty()) throw OutputError("gnuplot failed: " + contents_of(errors.get()));
  return picture;
}

}  // namespace pmac::runtime
