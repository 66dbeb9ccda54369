// Fuzz target: every four bytes are the seed of a valid project (tests/reference/random_machine.h) and of a program whose meaning is known
// (random_program.h). They compile; what is made is verified, the same after formatting, the same after saving and loading, and what was
// loaded runs as what was saved; lookahead keeps the limits.
#include <cmath>
#include <cstring>

#include "compiler/bytecode/object_file.h"
#include "compiler/compiler.h"
#include "compiler/style/style.h"
#include "runtime/servo/limit_check.h"
#include "runtime/tool/load.h"
#include "tests/fuzz/small_machine.h"
#include "tests/fuzz/target.h"
#include "tests/reference/random_machine.h"
#include "tests/reference/random_program.h"

using namespace pmac;

namespace {

/// check() that shows the project.
void expect(bool holds, const char* promise, const std::string& text) {
  if (!holds) std::fputs(text.c_str(), stderr);
  fuzz::check(holds, promise);
}

/// Disassembly without the places behind it, which formatting moves.
std::string code_of(const bytecode::Module& module) {
  const std::string text = bytecode::disassemble(module);
  std::string code;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = std::string_view(text).substr(at, end - at);
    const std::string_view kept = line.substr(0, line.find(" ; "));
    code.append(kept.substr(0, kept.find_last_not_of(' ') + 1)).append("\n");
    at = end + 1;
  }
  return code;
}

bytecode::Module compiled(const std::string& text, const char* promise) {
  compiler::Session session;
  auto module = session.compile({{"structured.pmc", text}});
  if (!module)
    for (const source::Diagnostic& diagnostic : session.diagnostics().all()) std::fprintf(stderr, "%s\n", diagnostic.message.c_str());
  expect(module.has_value(), promise, text);
  expect(bytecode::verify(*module).empty(), "what the compiler makes is verified", text);
  return std::move(*module);
}

bytecode::Module reloaded(const bytecode::Module& module, const std::string& text) {
  const auto bytes = bytecode::save(module);
  auto loaded = bytecode::load(bytes);
  expect(std::holds_alternative<bytecode::Module>(loaded), "what is saved can be loaded", text);
  expect(bytecode::save(std::get<bytecode::Module>(loaded)) == bytes, "what is loaded is saved as the same bytes", text);
  return std::move(std::get<bytecode::Module>(loaded));
}

/// Everything that a run's samples hold, as one number; and that all of it is finite.
class Digest : public runtime::SampleSink {
 public:
  std::uint64_t value = 1469598103934665603u;
  bool finite = true;
  void take(const runtime::SampleBlock& block) override {
    add(static_cast<double>(block.first_tick));
    for (const double position_mu : block.position_mu) add(position_mu);
  }

 private:
  void add(double number) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    value = (value ^ bits) * 1099511628211u;
    finite = finite && std::isfinite(number);
  }
};

std::uint64_t run(bytecode::Module module, const reference::RandomMachine& project) {
  compiler::Session session;
  session.adopt(module);
  fuzz::SmallMachine small({.time_ms = 20'000, .instructions = 300'000, .moves = 600, .polls = 200'000}, tool::online_compiler(session));
  Digest digest;
  runtime::LimitCheck limits([&small](int motor, double time_ms) { return small.machine().activity(motor, time_ms); });
  small.machine().add_sink(&digest);
  small.machine().add_sink(&limits);
  small.machine().load(std::move(module));
  small.machine().command("&1 b1r");
  small.run();
  expect(digest.finite, "every motor is somewhere", project.text);
  if (project.limits_must_hold && !small.machine().any_fault())
    for (const runtime::LimitCheck::Row& row : limits.rows()) expect(row.motor > 3 || row.keeps_limits(), "lookahead keeps the limits", project.text);
  return digest.value;
}

void try_project(std::uint32_t seed) {
  const reference::RandomMachine project = reference::random_machine(seed);
  bytecode::Module module = compiled(project.text, "the project compiles");
  const style::Formatted formatted = style::format(project.text, "structured.pmc", {}, {});
  expect(formatted.problems.empty(), "the project can be formatted", project.text);
  expect(code_of(compiled(formatted.text, "the formatted project compiles")) == code_of(module), "formatting changes no code", project.text);
  bytecode::Module again = reloaded(module, project.text);
  const std::uint64_t first = run(std::move(module), project);
  expect(run(std::move(again), project) == first, "what is loaded runs as what was saved", project.text);
}

void try_program(std::uint32_t seed) {
  const std::string text = to_script(reference::random_program(seed));
  const bytecode::Module module = compiled(text, "the program compiles");
  const style::Formatted formatted = style::format(text, "structured.pmc", {}, {});
  expect(formatted.problems.empty(), "the program can be formatted", text);
  expect(code_of(compiled(formatted.text, "the formatted program compiles")) == code_of(module), "formatting changes no code", text);
  reloaded(module, text);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (std::size_t at = 0; at + 4 <= size && at < 16; at += 4) {
    std::uint32_t seed = 0;
    std::memcpy(&seed, data + at, 4);
    try_project(seed);
    try_program(seed);
  }
  return 0;
}
