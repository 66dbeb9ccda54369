#include "compiler/bytecode/opcode.h"
#include "runtime/interpreter/core.h"

namespace pmac::runtime {

Thread::Thread(double* p_variables, double* q_variables) : p(p_variables), q(q_variables) {}

bool Thread::begin(ProgramHandle program, std::int64_t label) {
  top_ = program;
  const bytecode::Program& code = *program.program;
  stack_.assign(std::size_t{code.frame_size} + code.outgoing_count, 0.0);
  cycle_ = {};
  return stand_at_top(label);
}

void Thread::go_on_with(ProgramHandle program) {
  top_ = std::move(program);
  stack_.assign(std::size_t{top_.program->frame_size} + top_.program->outgoing_count, 0.0);
  stand_at_top(-1);
}

bool Thread::restart() { return top_ && stand_at_top(-1); }

bool Thread::stand_at_top(std::int64_t label) {
  program_ = top_;
  frames_.clear();
  forget_lines();
  base_ = 0;
  came_to_end_ = false;
  jump_backs_ = 0;
  host_fault_.reset();
  format_values_.clear();
  const bytecode::LabelEntry* entry = label < 0 ? nullptr : bytecode::find_label(*program_.program, label);
  pc_ = entry == nullptr ? 0 : entry->pc;
  return label < 0 || entry != nullptr;
}

void Thread::forget_lines() {
  line_.clear();
  line_begin_ = 0;
  code_depth_ = 0;
  cycle_.called = false;
  cycle_.block.clear();
}

RunResult Thread::run(Host& host, std::uint64_t instruction_budget, std::int64_t jump_back_limit) {
  return InterpreterCore(*this, host, instruction_budget, jump_back_limit).run();
}

/// The row of a move run that stands at pc_, or is being executed there; nullopt: no row.
std::optional<bytecode::SourceLine> Thread::row_source() const {
  const std::vector<bytecode::Instruction>& code = program_.program->code;
  const bool at_end = pc_ > 0 && code[pc_].op == bytecode::Opcode::kBlockEnd && code[pc_ - 1].op == bytecode::Opcode::kRowWords;
  if (!at_end && code[pc_].op != bytecode::Opcode::kRowWords) return std::nullopt;
  const bytecode::Instruction& in = code[at_end ? pc_ - 1 : pc_];
  const bytecode::MoveRun& run = program_.module->move_runs[static_cast<std::size_t>(in.imm)];
  const double next = stack_[base_ + in.a];  // behind row.words: the row after, or 0 behind the last
  const double row = !at_end ? next : next == 0 ? static_cast<double>(run.row_count()) - 1 : next - 1;
  return row >= 0 && row < static_cast<double>(run.row_count()) ? std::optional(run.source(static_cast<std::size_t>(row))) : std::nullopt;
}

std::optional<Thread::RowPlace> Thread::at_row() const {
  using bytecode::Opcode;
  if (!program_ || one_line_ || (cycle_.armed && code_depth_ == 0)) return std::nullopt;
  const std::vector<bytecode::Instruction>& code = program_.program->code;
  if (std::size_t{pc_} + 2 >= code.size() || code[pc_].op != Opcode::kRowWords) return std::nullopt;
  const bytecode::Instruction &in = code[pc_], &loop = code[pc_ + 2];
  const bool is_loop = code[pc_ + 1].op == Opcode::kBlockEnd && loop.op == Opcode::kRowLoop && loop.a == in.a && loop.imm == static_cast<std::int64_t>(pc_);
  const bytecode::MoveRun& run = program_.module->move_runs[static_cast<std::size_t>(in.imm)];
  const double row = stack_[base_ + in.a];
  if (!is_loop || !(row >= 0 && row < static_cast<double>(run.row_count()))) return std::nullopt;
  return RowPlace{&run, static_cast<std::size_t>(row)};
}

void Thread::stand_at_row(std::size_t row) { stack_[base_ + program_.program->code[pc_].a] = static_cast<double>(row); }

bytecode::SourceLine Thread::source() const {
  if (!program_) return {};
  if (const auto row = row_source()) return *row;
  return bytecode::source_of(*program_.program, pc_);
}

double& Thread::local(int i) { return stack_[base_ + static_cast<std::size_t>(i)]; }

double& Thread::outgoing(int i) {
  const ProgramHandle& running = program_ ? program_ : top_;
  return stack_[base_ + running.program->frame_size + static_cast<std::size_t>(i)];
}

Flow Host::move_words(Thread& thread, std::span<const std::uint8_t> words, std::span<const double> values) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto index = static_cast<unsigned>(bytecode::move_word_index(words[i])), kind = static_cast<unsigned>(bytecode::move_word_kind(words[i]));
    const Flow flow = motion(thread, bytecode::Instruction::with_bc(bytecode::Opcode::kAxisWord, 0, index, kind), values.subspan(i, 1));
    if (flow != Flow::kContinue) return flow;
  }
  return Flow::kContinue;
}

Flow Host::card(Thread& thread, bytecode::CardVerb, std::span<const double>) {
  thread.set_host_fault({FaultKind::kNotSimulated, {}, "this is an instruction for an ACR1000 card, and the program runs on no card"});
  return Flow::kFault;
}

double Host::relay(Thread& thread, double) {
  thread.set_host_fault({FaultKind::kNotSimulated, {}, "this asks for a relay of an ACR1000 card, and the program runs on no card"});
  return 0;
}

}  // namespace pmac::runtime
