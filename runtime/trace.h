// The trace: a record of every executed source line with what it assigned, and on request of every instruction. Only a machine that was
// made with MachineOptions::trace has a Tracer; its modules are not fused, and the interpreter runs its watched loop.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "runtime/interpreter/interpreter.h"
#include "runtime/state.h"

namespace pmac::runtime {

/// A source line that a program has executed, or one instruction of it.
struct TraceRecord {
  enum class What {
    kLine,          // from its beginning on, with what it assigned until another line began
    kGoesOn,        // the rest of a line that called or waited; only where it assigned something
    kInstruction,   // before it executes
    kSynchronous,   // a synchronous assignment (==) is performed
  };
  What what = What::kLine;
  double time_ms = 0;             // of calculation, which runs ahead of motion
  std::string thread;             // &1, plc 3, command: who executes
  std::string program;            // prog 5, subprog 500 (Timer), inverse 1, load: the buffer of the line
  bytecode::SourceLine source;
  std::uint32_t pc = 0;           // of an instruction
  std::string text;               // of an instruction: name and operands; else what was assigned: "P1 = 4, Depth = 2.5"
};

class Tracer : public InstructionWatcher {
 public:
  explicit Tracer(Machine::State& machine) : machine_(machine) {}

  /// False when MachineOptions::trace_limit records have been given.
  bool open() const { return given_ < machine_.options.trace_limit; }
  /// Declared names of variables, for what is assigned.
  void learn_names(const bytecode::Module& module);

  void before(const Thread& thread, std::uint32_t pc, std::span<const double> registers) override;
  void after_run(const Thread& thread, std::span<const double> registers) override;
  void performed(const SyncEntry& entry, const CoordSystem& coord);

 private:
  static constexpr int kNoRegister = -1;
  static constexpr std::size_t kMostValues = 16;   // of one record

  /// Where a thread stands, and the register that its last instruction writes where that is a variable.
  struct Stand {
    const bytecode::Program* program = nullptr;
    bytecode::SourceLine source;
    std::uint32_t pc = 0;
    int written_register = kNoRegister;
  };
  struct Named { std::string name; std::uint32_t size; };

  void note_line(const Thread& thread, Stand& stand, std::uint32_t pc);
  void note_instruction(const Thread& thread, std::uint32_t pc);
  void note_written(Stand& stand, std::span<const double> registers);
  void note_stored(const Thread& thread, const bytecode::Instruction& in, std::span<const double> registers);
  void add_value(const std::string& name, double value);
  void give(TraceRecord record);
  void give_line();
  TraceRecord record_of(const Thread& thread, TraceRecord::What what, bytecode::SourceLine source) const;
  std::string variable_name(bytecode::VariableClass variable_class, std::int64_t number) const;

  Machine::State& machine_;
  std::uint64_t given_ = 0;
  std::map<const Thread*, Stand> stands_;
  const Thread* line_thread_ = nullptr;   // of line_; nullptr: no line is open
  TraceRecord line_;
  std::vector<std::string> values_;       // of line_
  std::size_t more_values_ = 0;
  std::map<std::pair<bytecode::VariableClass, std::uint32_t>, Named> names_;   // by first number
};

}  // namespace pmac::runtime
