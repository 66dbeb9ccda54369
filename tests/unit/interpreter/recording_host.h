// A host that remembers what it was told, and short ways to build and run programs.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/module_text.h"
#include "compiler/bytecode/opcode.h"
#include "runtime/interpreter/interpreter.h"

namespace pmac::test {

using namespace pmac::bytecode;
using runtime::ElementAddress;
using runtime::Flow;
using runtime::ProgramHandle;
using runtime::RunResult;
using runtime::RunStop;
using runtime::Thread;

class RecordingHost : public runtime::Host {
 public:
  std::vector<std::string> log;
  std::map<int, double> m, i;
  std::map<std::pair<ElementId, std::uint32_t>, double> elements;
  std::map<std::uint32_t, ProgramHandle> subprograms;
  Flow answer = Flow::kContinue;    // of every motion, control, command, ... instruction
  bool fails = false;               // set a host fault on every read and write
  bool stops_thread = false;        // call Thread::stop() on every motion instruction

  double read_m(Thread& thread, int number) override { return check(thread), m[number]; }
  void write_m(Thread& thread, int number, double value) override { check(thread), m[number] = value; }
  double read_i(Thread& thread, int number) override { return check(thread), i[number]; }
  void write_i(Thread& thread, int number, double value) override { check(thread), i[number] = value; }
  double read_element(Thread& thread, const ElementAddress& at) override { return check(thread), elements[{at.id, at.index[0]}]; }
  Flow write_element(Thread& thread, const ElementAddress& at, double value) override {
    check(thread);
    elements[{at.id, at.index[0]}] = value;
    return answer;
  }
  double element_address(Thread&, const ElementAddress& at) override { return 1000.0 * static_cast<int>(at.id) + at.index[0]; }
  Flow motion(Thread& thread, const Instruction& in, std::span<const double> registers) override {
    log.push_back(std::string(opcode_info(in.op).text) + " " + number_text(in.a < registers.size() ? registers[in.a] : 0));  // a may mean nothing, as in block.end
    if (stops_thread) thread.stop();
    return answer;
  }
  Flow control(Thread&, ControlVerb verb, std::span<const double> arguments) override {
    log.emplace_back(control_verb_name(verb));
    for (const double argument : arguments) log.back() += " " + number_text(argument);
    return answer;
  }
  Flow queue_assignment(Thread&, const SyncTarget& target, const ElementAddress& at, double value) override {
    std::string name = variable_class_name(target.variable_class) + std::to_string(target.number);
    if (target.variable_class == VariableClass::kElement) {
      name = std::string(element_info(at.id).name) + std::to_string(at.index[0]);
    }
    log.push_back(name + " op" + std::to_string(static_cast<int>(target.op)) + " " + number_text(value));
    return answer;
  }
  ProgramHandle find_subprogram(std::uint32_t number) override {
    const auto found = subprograms.find(number);
    return found == subprograms.end() ? ProgramHandle{} : found->second;
  }
  Flow command(Thread&, std::string_view text) override { return log.push_back("cmd " + std::string(text)), answer; }
  Flow send(Thread&, int port, std::string_view text) override {
    return log.push_back("send" + std::to_string(port) + " " + std::string(text)), answer;
  }
  double random(double range) override { return range / 2; }
  void seed_random(double seed) override { log.push_back("seed " + number_text(seed)); }
  Flow online(Thread&, const Module&, const Instruction& in, std::span<const double>) override {
    return log.emplace_back(opcode_info(in.op).text), answer;
  }

 private:
  void check(Thread& thread) {
    if (fails) thread.set_host_fault({runtime::FaultKind::kRunTime, {}, "host says no"});
  }
};

inline Instruction bc(Opcode op, unsigned a, unsigned b, unsigned c = 0) { return Instruction::with_bc(op, a, b, c); }
inline Instruction imm(Opcode op, unsigned a = 0, std::int32_t value = 0) { return Instruction::with_imm(op, a, value); }

/// A module being built, variables, and a thread to run it with. Programs have 4 locals, 8 temporaries, 4 outgoing:
/// r0-r3 are L0-L3, r4-r11 temporaries, r12-r15 R0-R3. Instruction k of a program is on line k + 1 of "test.pmc".
class Bench {
 public:
  Module module;
  RecordingHost host;
  std::vector<double> p = std::vector<double>(kPCount);
  std::vector<double> q = std::vector<double>(kQCount);
  Thread thread{p.data(), q.data()};

  Bench() { module.files = {"test.pmc"}; }
  explicit Bench(std::vector<Instruction> code) : Bench() { add(std::move(code)); }

  Program& add(std::vector<Instruction> code, ProgramKind kind = ProgramKind::kProg, std::uint32_t number = 1) {
    Program program;
    program.kind = kind;
    program.number = number;
    program.local_count = 4;
    program.frame_size = 12;
    program.outgoing_count = 4;
    program.code = std::move(code);
    for (std::uint32_t pc = 0; pc < program.code.size(); ++pc) program.lines.push_back({pc, {0, static_cast<int>(pc) + 1, 1}});
    return module.programs.emplace_back(std::move(program));
  }
  /// Stands at the top of the first program; subprograms are found by number.
  void begin() {
    if (const std::string why = verify(module); !why.empty()) throw std::runtime_error(why);
    auto shared = std::make_shared<const Module>(module);
    for (const Program& program : shared->programs) {
      if (program.kind == ProgramKind::kSubprog) host.subprograms[program.number] = {shared, &program};
    }
    thread.begin({shared, &shared->programs[0]});
  }
  RunResult run(std::uint64_t budget = 1000000, std::int64_t jump_back_limit = 0) {
    if (!begun_) begin();
    begun_ = true;
    return thread.run(host, budget, jump_back_limit);
  }
  /// Runs to the end and answers L(i).
  double local_after_run(int local) { return run(), thread.local(local); }
  std::string fault_of_run() {
    const RunResult result = run();
    if (!result.fault) return "no fault";
    return bytecode::to_string(module, result.fault->source) + ": " + result.fault->detail;
  }

 private:
  bool begun_ = false;
};

}  // namespace pmac::test
