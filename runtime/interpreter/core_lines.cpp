// Lines of letter-number words: what a subprogram can read from the line that called it, code letters, canned cycles.
//
//     G83 X1 Y2 Z-3 R1 F200       the line's words, numbered from 0
//      |  `--- words from 1 on can be read in the subprogram that G83 calls; a word that has been read is "taken"
//      `--- subprogram Coord[].Gprog, label 83000
//
// read stops at the first word whose letter is not in its list (Software Reference Manual, read). After the return the words that
// nobody has taken execute in order: the compiler has put jump.taken in front of each.
#include <algorithm>
#include <cmath>
#include <utility>

#include "compiler/bytecode/element.h"
#include "compiler/bytecode/letters.h"
#include "compiler/bytecode/module_text.h"
#include "compiler/bytecode/opcode.h"
#include "runtime/interpreter/core.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

constexpr double kTwoTo32 = 4294967296.0;
constexpr int kFlagCount = 32;

ElementId subprogram_element(unsigned letter) {
  switch ("ABCDEFGHIJKLMNOPQRSTUVWXYZ"[(letter - 1) % 26]) {
    case 'D': return ElementId::kCoordDprog;
    case 'F': return ElementId::kCoordFprog;
    case 'H': return ElementId::kCoordHprog;
    case 'M': return ElementId::kCoordMprog;
    case 'S': return ElementId::kCoordSprog;
    case 'T': return ElementId::kCoordTprog;
    default: return ElementId::kCoordGprog;
  }
}

/// "G1", "X(nan)" as a person would write the word.
std::string word_text(unsigned letter, double value) {
  const std::string number = bytecode::number_text(value);
  return bytecode::letter_name(static_cast<int>(letter)) + (std::isfinite(value) ? number : "(" + number + ")");
}

std::string element_name(ElementId element, int coord) {
  std::string name(bytecode::element_info(element).name);
  return name.replace(name.find("[]"), 2, "[" + std::to_string(coord) + "]");
}

unsigned letter_of_block_word(unsigned kind, unsigned index) {
  switch (static_cast<bytecode::WordKind>(kind)) {
    case bytecode::WordKind::kRadius: return static_cast<unsigned>(bytecode::letter_number("R"));
    case bytecode::WordKind::kCenter: {
      static constexpr const char* kNames[] = {"I", "J", "K", "II", "JJ", "KK"};
      return static_cast<unsigned>(bytecode::letter_number(kNames[index % 6]));
    }
    default: return static_cast<unsigned>(bytecode::letter_number(bytecode::axis_name(static_cast<int>(index))));
  }
}

std::uint64_t letter_bit(unsigned letter) { return letter == 0 ? 0 : std::uint64_t{1} << (letter - 1); }

bool is_target(unsigned kind) {
  const auto word = static_cast<bytecode::WordKind>(kind);
  return word != bytecode::WordKind::kVelocity && word != bytecode::WordKind::kTriggerDistance;
}

}  // namespace

// --- words --------------------------------------------------------------------------------------------------------------

void InterpreterCore::set_line_word(const Instruction& in, double value) {
  const std::size_t at = thread_.line_begin_ + in.c();
  if (at >= thread_.line_.size()) thread_.line_.resize(at + 1);
  thread_.line_[at] = {value, static_cast<std::uint8_t>(in.b()), false};
}

bool InterpreterCore::is_taken(unsigned word) const {
  const std::size_t at = thread_.line_begin_ + word;
  return at < thread_.line_.size() && thread_.line_[at].taken;
}

InterpreterCore::Next InterpreterCore::require_taken(unsigned word) {
  const std::size_t at = thread_.line_begin_ + word;
  const bool may_be_read_later = thread_.cycle_.armed && thread_.code_depth_ == 0;
  if (at >= thread_.line_.size() || thread_.line_[at].taken || may_be_read_later) return Next::kContinue;
  const Thread::LineWord& left = thread_.line_[at];
  return fault("the word " + word_text(left.letter, left.value) + " of this line was read by no subprogram, and is no word of a move");
}

void InterpreterCore::read_words(double letters) {
  const auto mask = static_cast<std::uint64_t>(letters);
  std::uint64_t found = 0;
  if (!thread_.frames_.empty()) {
    const Thread::SavedFrame& frame = thread_.frames_.back();
    for (std::size_t i = frame.first_word; i < frame.end_word; ++i) {
      Thread::LineWord& word = thread_.line_[i];
      if (word.taken) continue;
      const std::uint64_t bit = letter_bit(word.letter);
      if ((mask & bit) == 0 || (found & bit) != 0) break;
      word.taken = true;
      thread_.d[word.letter] = word.value;
      found |= bit;
    }
  }
  thread_.d[0] = static_cast<double>(found);
}

// --- plain move lines -----------------------------------------------------------------------------------------------------

/// The words of a row, one after the other as the words of a move line; then the register says which row comes next.
InterpreterCore::Next InterpreterCore::put_row(const Instruction& in, double* r) {
  const bytecode::MoveRun& run = thread_.program_.module->move_runs[static_cast<std::size_t>(in.imm)];
  const double number = r[in.a];
  if (!(number >= 0 && number < static_cast<double>(run.row_count()))) return fault("this row of moves does not exist");
  const auto row = static_cast<std::size_t>(number);
  const std::size_t first = run.first_word[row], count = run.first_word[row + 1] - first;
  const bool for_cycle = thread_.cycle_.armed && thread_.code_depth_ == 0;
  for (std::size_t i = first; for_cycle && i < first + count; ++i) {
    const std::uint8_t word = run.words[i];
    const auto as_word = Instruction::with_bc(bytecode::Opcode::kAxisWord, 0, static_cast<unsigned>(bytecode::move_word_index(word)), static_cast<unsigned>(bytecode::move_word_kind(word)));
    if (collect_cycle_word(as_word, run.values[i]) == Next::kLeave) return Next::kLeave;
  }
  if (!for_cycle)
    if (after(host_.move_words(thread_, {run.words.data() + first, count}, {run.values.data() + first, count})) == Next::kLeave) return Next::kLeave;
  r[in.a] = row + 1 == run.row_count() ? 0.0 : number + 1;
  return Next::kContinue;
}

/// A program that waits behind a row stands at the next row, as it stands at the next line elsewhere.
void InterpreterCore::stand_at_next_row() {
  const std::vector<Instruction>& code = program().code;
  const std::uint32_t pc = thread_.pc_;
  const bool behind_row = pc >= 2 && pc < code.size() && code[pc - 1].op == bytecode::Opcode::kBlockEnd && code[pc - 2].op == bytecode::Opcode::kRowWords;
  const bool at_loop = behind_row && (code[pc].op == bytecode::Opcode::kRowLoop || code[pc].op == bytecode::Opcode::kLoopIfTrue) && code[pc].imm + 2 == static_cast<std::int64_t>(pc);
  if (!at_loop) return;
  thread_.pc_ = registers()[code[pc].a] != 0 ? pc - 2 : pc + 1;
}

// --- code letters ---------------------------------------------------------------------------------------------------------

/// F calls a subprogram where Coord[].Fprog names one; inside of that F is the feed rate.
bool InterpreterCore::dispatches_feed() {
  const ElementAddress at{ElementId::kCoordFprog, {static_cast<std::uint32_t>(thread_.executing_coord())}};
  if (!(host_.read_element(thread_, at) > 0)) return false;
  for (const Thread::SavedFrame& frame : thread_.frames_)
    if (bytecode::letter_name(frame.letter) == "F") return false;
  return true;
}

InterpreterCore::Next InterpreterCore::set_feed(double feed) {
  const auto in = Instruction::with_bc(bytecode::Opcode::kSetMotion, 0, static_cast<unsigned>(bytecode::MotionParameter::kFeed));
  const Next next = after(host_.motion(thread_, in, {&feed, 1}));
  if (next == Next::kContinue) ++thread_.pc_;
  return next;
}

/// Calls the subprogram of a code letter, with all locals 0. first_word: number of the line's word behind the code.
InterpreterCore::Next InterpreterCore::call_code(unsigned letter, double number, unsigned first_word) {
  const ElementId element = subprogram_element(letter);
  if (element == ElementId::kCoordFprog && !dispatches_feed()) return host_failed() ? Next::kLeave : set_feed(number);
  const int coord = thread_.executing_coord();
  const double subprogram = host_.read_element(thread_, {element, {static_cast<std::uint32_t>(coord)}});
  if (host_failed()) return Next::kLeave;
  const std::string code = word_text(letter, number), name = element_name(element, coord);
  if (!(subprogram >= 1 && subprogram < kTwoTo32)) return fault(code + " calls no subprogram: " + name + " is " + bytecode::number_text(subprogram));
  const double label = std::round(number * 1000);
  if (!(label >= 0 && label < kTwoTo32)) return fault("the number of " + code + " is not in the range 0 to 4294967.295");
  ProgramHandle routine = host_.find_subprogram(static_cast<std::uint32_t>(subprogram));
  if (!routine) return fault(code + " calls subprogram " + bytecode::number_text(std::trunc(subprogram)) + " (" + name + "), which does not exist; load a library that opens it");
  if (!push_frame(thread_.line_begin_ + first_word)) return Next::kLeave;
  thread_.frames_.back().letter = static_cast<std::uint8_t>(letter);
  ++thread_.code_depth_;
  open_frame(program(), *routine.program);
  thread_.program_ = std::move(routine);
  std::fill_n(registers(), program().local_count, 0.0);
  const auto* entry = bytecode::find_label(program(), static_cast<std::int64_t>(label));
  thread_.pc_ = entry == nullptr ? 0 : entry->pc;  // a missing label is the top (Users Manual p703)
  return Next::kEnter;
}

// --- flags of cset, cclr, cexec, cskip ---------------------------------------------------------------------------------------

bool InterpreterCore::flag_mask(double bit, std::uint64_t& mask) {
  if (bit > -1.0 && bit < kFlagCount) return mask = std::uint64_t{1} << static_cast<int>(bit), true;
  fault("flag " + bytecode::number_text(bit) + " does not exist; the flags of a coordinate system are 0 to " + std::to_string(kFlagCount - 1));
  return false;
}

bool InterpreterCore::test_flag(const Instruction& in, double* r) {
  std::uint64_t mask = 0;
  if (!flag_mask(r[in.b()], mask)) return false;
  const double flags = host_.read_element(thread_, {ElementId::kCoordCflags, {static_cast<std::uint32_t>(thread_.executing_coord())}});
  const bool is_set = flags >= 0 && flags < kTwoTo32 && (static_cast<std::uint64_t>(flags) & mask) != 0;
  r[in.a] = is_set ? 1.0 : 0.0;
  return !host_failed();
}

InterpreterCore::Next InterpreterCore::change_flag(double bit, bool set) {
  std::uint64_t mask = 0;
  if (!flag_mask(bit, mask)) return Next::kLeave;
  const ElementAddress at{ElementId::kCoordCflags, {static_cast<std::uint32_t>(thread_.executing_coord())}};
  const double flags = host_.read_element(thread_, at);
  if (host_failed()) return Next::kLeave;
  const std::uint64_t before = flags >= 0 && flags < kTwoTo32 ? static_cast<std::uint64_t>(flags) : 0;
  return after(host_.write_element(thread_, at, static_cast<double>(set ? before | mask : before & ~mask)));
}

// --- canned cycles: cdef, cundef, ccall ----------------------------------------------------------------------------------------
// cdef arms a call. Each move block of the program (not of the routines that code letters call, nor of the cycle itself) is then
// collected here instead of going to the coordinate system; at its end the armed call can read the words given with cdef (without
// the letters of the block), then the block's words, then the other words of the line. What it leaves of the block moves as usual.

InterpreterCore::Next InterpreterCore::define_cycle(double target) {
  Thread::Cycle& cycle = thread_.cycle_;
  if (!(target >= 0 && target < kTwoTo32)) return fault("the number of a canned cycle, " + bytecode::number_text(target) + ", is not in the range 0 to 4294967295");
  cycle.armed = true;
  cycle.target = target;
  cycle.words.assign(thread_.line_.begin() + static_cast<std::ptrdiff_t>(thread_.line_begin_), thread_.line_.end());
  return Next::kContinue;
}

InterpreterCore::Next InterpreterCore::call_cycle() {
  if (!thread_.cycle_.armed) return fault("ccall without a number calls what cdef has set, and nothing is set");
  return call_computed(thread_.cycle_.target);
}

InterpreterCore::Next InterpreterCore::collect_cycle_word(const Instruction& in, double value) {
  auto& block = thread_.cycle_.block;
  if (block.size() >= bytecode::kMaxLineWords) return fault("a move block has more than " + std::to_string(bytecode::kMaxLineWords) + " words");
  block.push_back({in.b(), in.c(), value});
  return Next::kContinue;
}

InterpreterCore::Next InterpreterCore::end_cycle_block() {
  if (thread_.cycle_.called) return leave_cycle();
  if (!thread_.cycle_.block.empty()) return enter_cycle();
  ++thread_.pc_;
  return Next::kEnter;
}

InterpreterCore::Next InterpreterCore::enter_cycle() {
  Thread::Cycle& cycle = thread_.cycle_;
  const std::size_t line_end = thread_.line_.size();
  cycle.first_word = line_end;
  std::uint64_t in_block = 0;
  for (const auto& word : cycle.block) in_block |= letter_bit(letter_of_block_word(word.kind, word.index));
  for (const Thread::LineWord& word : cycle.words)
    if ((in_block & letter_bit(word.letter)) == 0) thread_.line_.push_back({word.value, word.letter, false});
  cycle.first_block = thread_.line_.size();
  for (const auto& word : cycle.block)
    if (is_target(word.kind)) thread_.line_.push_back({word.value, static_cast<std::uint8_t>(letter_of_block_word(word.kind, word.index)), false});
  for (std::size_t i = thread_.line_begin_; i < line_end; ++i) {
    const Thread::LineWord word = thread_.line_[i];
    const bool is_for_cycle = !word.taken && word.letter != 0 && !bytecode::is_code_letter(word.letter) && (in_block & letter_bit(word.letter)) == 0;
    if (is_for_cycle) thread_.line_.push_back(word);
  }
  cycle.called = true;
  const std::uint32_t block_end = thread_.pc_;
  const double target = cycle.target;
  const Next next = call_computed(target);
  if (next == Next::kLeave) return next;
  Thread::SavedFrame& frame = thread_.frames_.back();
  frame.return_pc = block_end;  // to leave_cycle()
  frame.first_word = cycle.first_word;
  frame.letter = Thread::kCycle;
  ++thread_.code_depth_;
  return next;
}

/// The words of the block that the cycle has not read make a move.
InterpreterCore::Next InterpreterCore::leave_cycle() {
  Thread::Cycle& cycle = thread_.cycle_;
  cycle.called = false;
  const std::vector<Thread::Cycle::BlockWord> block = std::exchange(cycle.block, {});
  std::size_t next_word = cycle.first_block;
  bool is_taken = false, any = false;
  for (const auto& word : block) {
    if (is_target(word.kind)) is_taken = thread_.line_[next_word++].taken;
    if (is_taken) continue;
    any = true;
    const auto in = Instruction::with_bc(bytecode::Opcode::kAxisWord, 0, word.index, word.kind);
    const Next next = after(host_.motion(thread_, in, {&word.value, 1}));
    if (next == Next::kLeave) return next;
  }
  for (; next_word < thread_.line_.size(); ++next_word) {
    const Thread::LineWord left = thread_.line_[next_word];
    if (!left.taken) return fault("the word " + word_text(left.letter, left.value) + " of this line was not read by the canned cycle, and is no word of a move");
  }
  thread_.line_.resize(cycle.first_word);
  const auto end = Instruction::with_imm(bytecode::Opcode::kBlockEnd, 0, 0);
  const Next next = any ? after(host_.motion(thread_, end, {registers(), register_count()})) : Next::kContinue;
  if (next == Next::kContinue) ++thread_.pc_;
  return next;
}

}  // namespace pmac::runtime
