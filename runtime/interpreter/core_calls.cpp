// Calls. A gosub runs on the registers of its caller; callsub and call open a frame that begins at the caller's outgoing
// arguments, so that R(i) of the caller is L(i) of the routine and results are found there after the return.
//
//     stack:  | L0 L1 .. temporaries | R0 R1 ...            |        caller
//                                    | L0 L1 .. temporaries | R0 ...  routine
#include <algorithm>
#include <cmath>

#include "runtime/interpreter/core.h"

namespace pmac::runtime {
namespace {

constexpr double kTwoTo32 = 4294967296.0;

/// Integer of a label or subprogram number held in a double, or -1 if there is no such number.
std::int64_t whole_number(double number) {
  return number > -1.0 && number < kTwoTo32 ? static_cast<std::int64_t>(number) : -1;
}

}  // namespace

bool InterpreterCore::find_label(double number, std::uint32_t& pc) {
  const std::int64_t label = whole_number(number);
  const bytecode::LabelEntry* entry = label < 0 ? nullptr : bytecode::find_label(program(), label);
  if (entry == nullptr) {
    fault(label < 0 ? "the computed label number is not in the range 0 to 4294967295"
                    : "the program has no label N" + std::to_string(label));
    return false;
  }
  pc = entry->pc;
  return true;
}

/// The words of the running line from first_word (an index of the thread's lines) on can be read by what is called.
bool InterpreterCore::push_frame(std::size_t first_word) {
  if (thread_.frames_.size() >= kMaxCallDepth) {
    fault("calls are nested deeper than " + std::to_string(kMaxCallDepth));
    return false;
  }
  const std::size_t end_word = thread_.line_.size();
  thread_.frames_.push_back({thread_.program_, thread_.pc_ + 1, thread_.base_, thread_.line_begin_, std::min(first_word, end_word), end_word, 0});
  thread_.line_begin_ = end_word;
  return true;
}

InterpreterCore::Next InterpreterCore::gosub(std::uint32_t target) {
  if (!push_frame()) return Next::kLeave;
  thread_.pc_ = target;
  return Next::kEnter;
}

InterpreterCore::Next InterpreterCore::callsub(std::uint32_t target) {
  if (!push_frame()) return Next::kLeave;
  open_frame(program(), program());
  thread_.pc_ = target;
  return Next::kEnter;
}

void InterpreterCore::open_frame(const bytecode::Program& caller, const bytecode::Program& routine) {
  thread_.base_ += caller.frame_size;
  const std::size_t needed = thread_.base_ + routine.frame_size + routine.outgoing_count;
  if (thread_.stack_.size() < needed) thread_.stack_.resize(std::max(needed, 2 * thread_.stack_.size()));
  double* r = registers();
  if (caller.outgoing_count < routine.local_count) std::fill(r + caller.outgoing_count, r + routine.local_count, 0.0);
}

InterpreterCore::Next InterpreterCore::call(double subprogram, std::int64_t label) {
  const std::int64_t wanted = whole_number(subprogram);
  if (wanted < 0) return fault("the number of the called subprogram is not in the range 0 to 4294967295");
  const auto number = static_cast<std::uint32_t>(wanted);
  ProgramHandle routine = host_.find_subprogram(number);
  if (!routine) return fault("subprogram " + std::to_string(number) + " does not exist");
  if (!push_frame()) return Next::kLeave;
  open_frame(program(), *routine.program);
  thread_.program_ = std::move(routine);
  const auto* entry = label < 0 ? nullptr : bytecode::find_label(program(), label);
  thread_.pc_ = entry == nullptr ? 0 : entry->pc;  // a missing label is the top (Users Manual p703)
  return Next::kEnter;
}

InterpreterCore::Next InterpreterCore::call_constant(const Instruction& in) {
  const bytecode::CallTarget& target = thread_.program_.module->call_targets[static_cast<std::size_t>(in.imm)];
  return call(target.subprogram, target.label);
}

InterpreterCore::Next InterpreterCore::call_computed(double target) {
  const double subprogram = std::trunc(target);
  const double label = std::rint(std::abs(target - subprogram) * 1e6);
  return call(subprogram, label > 0 ? static_cast<std::int64_t>(label) : -1);
}

InterpreterCore::Next InterpreterCore::return_from_routine() {
  if (thread_.frames_.empty()) {
    thread_.came_to_end_ = true;
    return end_program();
  }
  Thread::SavedFrame& frame = thread_.frames_.back();
  thread_.program_ = std::move(frame.program);
  thread_.pc_ = frame.return_pc;
  thread_.base_ = frame.base;
  thread_.line_.resize(frame.end_word);
  thread_.line_begin_ = frame.line_begin;
  if (frame.letter != 0) --thread_.code_depth_;
  thread_.frames_.pop_back();
  return Next::kEnter;
}

}  // namespace pmac::runtime
