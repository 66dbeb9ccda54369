// Fuzz target: what is typed at the console of a controller with two motors and a program, standard input and all.
#include <sys/mman.h>
#include <unistd.h>

#include "compiler/compiler.h"
#include "runtime/tool/console.h"
#include "tests/fuzz/small_machine.h"
#include "tests/fuzz/target.h"

using namespace pmac;

namespace {

constexpr const char* kSetUp =
    "&1 #1->1000X #2->1000Y\nCoord[1].SegMoveTime=5\n"
    "open prog 1\nlinear abs ta10 ts0 F1000\nX1 Y1\ndwell 5\nX0 Y0\nclose\n"
    "open plc 1\nP1++\nclose\n";

/// The bytes become standard input.
void type(std::string_view bytes) {
  const int file = memfd_create("typed", 0);
  fuzz::check(file >= 0 && write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()), "a file in memory");
  lseek(file, 0, SEEK_SET);
  dup2(file, STDIN_FILENO);
  close(file);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  return std::freopen("/dev/null", "w", stdout) == nullptr;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tool::RunOptions options;
  options.console = true;
  compiler::Session session;
  tool::Console console(options);
  fuzz::SmallMachine small({.time_ms = 1000}, tool::online_compiler(session, &console.error_place()));
  auto module = session.compile({{"set_up.pmc", kSetUp}});
  fuzz::check(module.has_value(), "the set-up compiles");
  small.machine().load(std::move(*module));
  type(fuzz::text_of(data, size));
  console.run(small.machine(), small.limits());
  return 0;
}
