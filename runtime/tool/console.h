// pmac-run --console: on-line commands from standard input, answered as the controller's command interpreter answers them over a pipe:
// answer lines, then ACK and an end of line for every command line. Simulated time goes on between the lines. See docs/pmac-run.md.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "runtime/machine.h"
#include "runtime/tool/load.h"
#include "runtime/tool/options.h"

namespace pmac::tool {

/// What the machine answers and refuses while a line of the console executes, and what lines it has taken.
class Console {
 public:
  explicit Console(const RunOptions& options) : options_(options) {}

  /// True while a line executes: answers and refusals belong to it.
  bool executing() const { return executing_; }
  void answer(const std::string& text);
  void refuse(const std::string& reason);
  /// Where the compiler found the first error of a text.
  ErrorPlace& error_place() { return error_place_; }
  /// A line that was typed into a buffer, for list.
  std::optional<std::string> typed_line(int line) const;

  /// Reads lines until the end of input, Ctrl-D or a limit. Answers the outcome of the last piece of simulated time.
  runtime::RunOutcome run(runtime::Machine& machine, const runtime::RunLimits& limits);

  static constexpr const char* kName = "stdin";  // of the console in messages

 private:
  void keep_line(const std::string& line);
  void take_line(runtime::Machine& machine, const std::string& line);
  void execute(runtime::Machine& machine, const std::string& text, int first_line);
  bool wait(const std::string& line);
  bool wait_before_acknowledging(runtime::Machine& machine);
  bool advance(runtime::Machine& machine);

  const RunOptions& options_;
  runtime::RunLimits limits_;
  runtime::RunOutcome outcome_;
  bool executing_ = false;
  int line_ = 0;                       // number of the last line
  ErrorPlace error_place_;
  std::string buffer_;                 // lines since open, while a buffer is open
  int buffer_line_ = 0;                // of its open
  bool buffer_dropped_ = false;        // it was too long
  std::map<int, std::string> typed_;   // lines of buffers
  double wait_ms_ = 0;                 // what the last line lets pass
  bool wait_idle_ = false;
  bool waits_ = false;                 // the last line was a wait
  double wall_start_ms_ = 0;
};

}  // namespace pmac::tool
