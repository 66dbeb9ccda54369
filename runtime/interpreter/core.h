// The machinery behind Thread::run(): one InterpreterCore lives for the length of one run() and works on verified code only.
// The dispatch loop (core.cpp) keeps the program counter and the register window in local variables; whatever needs more
// than a few machine instructions is a member here and reads the place from the thread.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "runtime/interpreter/interpreter.h"
#include "runtime/interpreter/memory_address.h"

namespace pmac::runtime {

inline constexpr std::size_t kMaxCallDepth = 255;  // Users Manual p662

class InterpreterCore {
 public:
  InterpreterCore(Thread& thread, Host& host, std::uint64_t instruction_budget, std::int64_t jump_back_limit)
      : thread_(thread), host_(host), budget_(clamp_budget(instruction_budget)),
        jump_back_limit_(jump_back_limit > 0 ? jump_back_limit : std::numeric_limits<std::int64_t>::max()) {}

  RunResult run();

 private:
  using Instruction = bytecode::Instruction;

  /// What the dispatch loop does after a member has worked.
  enum class Next { kContinue, kEnter, kLeave };

  // core.cpp. kWatched: the watcher hears of every instruction.
  template <bool kWatched>
  void dispatch();
  void watch(const Instruction& in, std::uint32_t pc);
  const bytecode::Program& program() const { return *thread_.program_.program; }
  double* registers() const { return thread_.stack_.data() + thread_.base_; }
  std::size_t register_count() const { return program().frame_size + program().outgoing_count; }
  Next after(Flow flow);
  void end(RunStop stop) { result_.stop = stop; }
  Next end_program();
  Next fault(std::string detail);
  Next raise(Fault fault);
  bool host_failed();

  // core_access.cpp: variables and elements by computed number. False, or kLeave: a fault has been raised.
  bool variable(bytecode::VariableClass variable_class, double number, int& index);
  bool load_indexed(const Instruction& in, double* r);
  bool store_indexed(const Instruction& in, double* r);
  bool resolve(const bytecode::ElementRef& ref, const double* r, ElementAddress& address);
  bool load_element(const Instruction& in, double* r);
  Next store_element(const Instruction& in, const double* r);
  Next sync_store(const Instruction& in, const double* r);
  double read_variable(bytecode::VariableClass variable_class, int index, const double* r);
  void write_variable(bytecode::VariableClass variable_class, int index, double value, double* r);

  // core_memory.cpp: addresses and what they point at
  bool load_address(const Instruction& in, double* r);
  void limit_address(const Instruction& in, double* r);
  bool load_byte_address(const Instruction& in, double* r);
  void load_text(const Instruction& in, double* r);
  bool add_format_value(double value);
  bool refuse_memory(const std::string& why);
  std::int64_t end_of(const MemoryAddress& address) const;
  std::optional<MemoryAddress> memory(double number, bool text_allowed);
  bool fits(const MemoryAddress& address, std::int64_t count, std::int64_t step);
  bool read_values(double address, std::int64_t count, std::int64_t step, std::vector<double>& values);
  bool write_values(double address, std::int64_t step, std::span<const double> values);
  char byte_at(const MemoryAddress& address, std::size_t at);
  std::size_t room(const MemoryAddress& address) const;
  bool read_bytes(double address, std::size_t count, std::string& bytes);
  bool read_text(double address, std::string& text);
  bool write_bytes(double address, std::string_view bytes);
  std::string text_of(const MemoryAddress& address) const;
  bool fill_format(const std::string& format, bool always, std::string& text);
  Next put_out(const Instruction& in);

  // core_vectors.cpp, core_transforms.cpp, core_texts.cpp: functions of addresses and transformations
  bool memory_function(const Instruction& in, double* r, std::int64_t& budget);
  bool count_argument(double value, std::int64_t& count);
  bool step_argument(double value, std::int64_t& step);
  bool read_matrix(double address, std::int64_t rows, std::int64_t columns, std::vector<double>& values);
  bool vector_function(bytecode::Function function, const double* x, double& result, std::int64_t& work);
  bool matrix_function(bytecode::Function function, const double* x, double& result, std::int64_t& work);
  bool transform_function(bytecode::Function function, const double* x, double& result);
  bool write_text(double address, const std::string& text, double& result);
  bool byte_count_argument(double value, std::size_t& count);
  bool writing_text_function(bytecode::Function function, const double* x, double& result);
  bool reading_text_function(bytecode::Function function, const double* x, double& result);
  bool print_function(const double* x, double& result);

  // core_calls.cpp: leave and enter frames; the thread holds the place afterwards.
  bool find_label(double number, std::uint32_t& pc);
  bool push_frame(std::size_t first_word);
  bool push_frame() { return push_frame(thread_.line_begin_); }
  void open_frame(const bytecode::Program& caller, const bytecode::Program& routine);
  Next gosub(std::uint32_t target);
  Next callsub(std::uint32_t target);
  Next call(double subprogram, std::int64_t label);
  Next call_constant(const Instruction& in);
  Next call_computed(double target);
  Next return_from_routine();

  // core_lines.cpp: lines of words, code letters, flags, canned cycles.
  void set_line_word(const Instruction& in, double value);
  bool is_taken(unsigned word) const;
  Next require_taken(unsigned word);
  void read_words(double letters);
  bool dispatches_feed();
  Next call_code(unsigned letter, double number, unsigned first_word);
  Next set_feed(double feed);
  bool flag_mask(double bit, std::uint64_t& mask);
  bool test_flag(const Instruction& in, double* r);
  Next change_flag(double bit, bool set);
  Next define_cycle(double target);
  Next call_cycle();
  bool in_cycle_block() const { return (thread_.cycle_.armed || thread_.cycle_.called) && thread_.code_depth_ == 0; }
  Next put_row(const Instruction& in, double* r);
  void stand_at_next_row();
  Next collect_cycle_word(const Instruction& in, double value);
  Next end_cycle_block();
  Next enter_cycle();
  Next leave_cycle();

  static std::int64_t clamp_budget(std::uint64_t budget) {
    const auto most = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    return static_cast<std::int64_t>(budget < most ? budget : most);
  }

  Thread& thread_;
  Host& host_;
  InstructionWatcher* const watcher_ = host_.watcher();
  std::int64_t budget_;
  std::int64_t jump_back_limit_;
  RunResult result_;
  std::string_view calling_;   // the memory function at work, for messages
};

}  // namespace pmac::runtime
