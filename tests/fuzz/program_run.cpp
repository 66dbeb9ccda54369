// Fuzz target: program text compiled, loaded and run: its load script, then every motion program and PLC program of it.
#include <cmath>

#include "compiler/compiler.h"
#include "runtime/tool/load.h"
#include "runtime/servo/servo.h"
#include "tests/fuzz/small_machine.h"
#include "tests/fuzz/target.h"

using namespace pmac;

namespace {

/// "&1 b7r" for every motion program, each in a coordinate system of its own; "enable plc 3" for every PLC program.
std::vector<std::string> starts(const bytecode::Module& module) {
  std::vector<std::string> commands;
  int coord = 1;
  for (const bytecode::Program& program : module.programs) {
    const std::string number = std::to_string(program.number);
    if (program.kind == bytecode::ProgramKind::kProg && coord <= 4) commands.push_back("&" + std::to_string(coord++) + " b" + number + "r");
    if (program.kind == bytecode::ProgramKind::kPlc) commands.push_back("enable plc " + number);
  }
  if (commands.size() > 8) commands.resize(8);
  return commands;
}

/// Samples follow each other, and no motor is nowhere.
class Follows : public runtime::SampleSink {
 public:
  void take(const runtime::SampleBlock& block) override {
    fuzz::check(block.first_tick == next_, "blocks of samples follow each other");
    next_ = block.first_tick + block.count;
    for (const double position_mu : block.position_mu) fuzz::check(std::isfinite(position_mu), "every motor is somewhere");
  }

 private:
  std::int64_t next_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  compiler::Session session;
  auto module = session.compile({{"fuzz.pmc", std::string(fuzz::text_of(data, size))}});
  if (!module) return 0;
  const std::vector<std::string> commands = starts(*module);
  fuzz::SmallMachine small({}, tool::online_compiler(session));
  Follows follows;
  small.machine().add_sink(&follows);
  small.machine().load(std::move(*module));
  for (const std::string& command : commands) small.machine().command(command);
  small.run();
  return 0;
}
