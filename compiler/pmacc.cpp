// pmacc: the compiler as a tool. Exit codes: 0 ok, 1 errors in the user's program, 2 usage or unreadable file, 70 internal error.
#include <csignal>
#include <exception>
#include <iostream>
#include <string_view>

#include "compiler/tool/commands.h"
#include "compiler/tool/fmt.h"
#include "compiler/tool/options.h"

int main(int argc, char** argv) {
  using namespace pmac;
  std::signal(SIGPIPE, SIG_IGN);  // a reader that has gone and a limit of the size of files are errors of writing,
  std::signal(SIGXFSZ, SIG_IGN);  // with a message and nothing left behind
  try {
    if (argc > 1 && std::string_view(argv[1]) == "fmt") return pmacc::run_fmt(argc - 1, argv + 1);
    std::optional<int> exit_code;
    const pmacc::Arguments arguments = pmacc::parse_command_line(argc, argv, exit_code);
    return exit_code ? *exit_code : pmacc::run(arguments);
  } catch (const pmacc::UsageError& error) {
    std::cerr << "pmacc: " << error.what() << "\n";
    return pmacc::kUsage;
  } catch (const std::exception& error) {
    std::cerr << "pmacc: internal error: " << error.what() << "\n";
    return pmacc::kInternal;
  }
}
