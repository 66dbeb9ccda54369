// Lines of words. All words are evaluated and put into the line first, so that the subprograms that the line calls can read them;
// then the line executes in order, each word only if nobody has read it:
//
//     G01 X10 Y(P1) F200 M03 P5     G01
//                                   F200          F, S and T before the move that they stand with
//                                   P5 faults unless it was read
//                                   X10 Y(P1)     one move; Y(P1) is evaluated again: G01 may have changed P1
//                                   M03           a code letter ends the move
//
// That F acts on the move in front of it is what part programs rely on (RS-274: feed rate, spindle speed and tool come before motion).
#include <algorithm>

#include "compiler/bytecode/letters.h"
#include "compiler/bytecode/opcode.h"
#include "compiler/codegen/program_writer.h"

namespace pmac::compiler::codegen {
namespace {

using bytecode::Opcode;
using bytecode::WordKind;

enum class Role { kCode, kParameter, kBlock, kOther };

struct BlockWord { WordKind kind; int index; };

/// I J K II JJ KK, or -1.
int vector_index(int letter) {
  constexpr std::string_view kNames[] = {"I", "J", "K", "II", "JJ", "KK"};
  const auto* found = std::find(std::begin(kNames), std::end(kNames), bytecode::letter_name(letter));
  return found == std::end(kNames) ? -1 : static_cast<int>(found - std::begin(kNames));
}

BlockWord block_word(int letter) {
  const std::string name = bytecode::letter_name(letter);
  if (name == "R") return {WordKind::kRadius, 0};
  if (const int vector = vector_index(letter); vector >= 0) return {WordKind::kCenter, vector};
  return {WordKind::kTarget, bytecode::axis_index_from_name(name)};
}

Role role_of(int letter) {
  const std::string name = bytecode::letter_name(letter);
  if (name == "F" || name == "S" || name == "T") return Role::kParameter;
  if (bytecode::is_code_letter(letter)) return Role::kCode;
  return block_word(letter).index >= 0 ? Role::kBlock : Role::kOther;
}

}  // namespace

void ProgramWriter::write(const ir::CodeLine& node, const source::Span& span) {
  emit_imm(Opcode::kLineBegin, 0, 0);
  put_line_words(node, 0, node.words.size(), false);
  if (node.call) statement(*node.call);
  const auto* cycle = node.call ? std::get_if<ir::Cycle>(&node.call->node) : nullptr;
  const bool words_are_kept = cycle && cycle->verb == ir::CycleVerb::kDefine;
  place_source(span);
  for (std::size_t begin = words_are_kept ? node.words.size() : 0; begin < node.words.size();) {
    std::size_t end = begin;
    const bool begins_with_code = role_of(node.words[begin].letter) == Role::kCode;
    if (begins_with_code) ++end;
    while (end < node.words.size() && role_of(node.words[end].letter) != Role::kCode) ++end;
    const bool stale = begin > 0 || node.call;
    if (stale) put_line_words(node, begin, end, true);
    if (begins_with_code) write_code(node, begin++);
    write_line_part(node, begin, end);
    begin = end;
  }
  emit_imm(Opcode::kLineEnd, 0, 0);
}

/// Words begin .. end into the line; only_computed: those that may have another value now.
void ProgramWriter::put_line_words(const ir::CodeLine& line, std::size_t begin, std::size_t end, bool only_computed) {
  for (std::size_t i = begin; i < end; ++i) {
    if (only_computed && ir::constant_value(*line.words[i].value)) continue;
    const Register before = next_;
    Target taken;
    if (only_computed) jump_to(Opcode::kJumpIfTaken, static_cast<Register>(i), taken);
    emit_abc(Opcode::kLineWord, value(*line.words[i].value), static_cast<Register>(line.words[i].letter), static_cast<Register>(i));
    place(taken);
    next_ = before;
  }
}

void ProgramWriter::write_code(const ir::CodeLine& line, std::size_t word) {
  const Register before = next_;
  Target taken;
  const bool may_be_taken = word > 0 || line.call;
  if (may_be_taken) jump_to(Opcode::kJumpIfTaken, static_cast<Register>(word), taken);
  emit_abc(Opcode::kCallCode, value(*line.words[word].value), static_cast<Register>(line.words[word].letter), static_cast<Register>(word + 1));
  place(taken);
  next_ = before;
}

/// The words between two code letters: parameters, then the move.
void ProgramWriter::write_line_part(const ir::CodeLine& line, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i)
    if (role_of(line.words[i].letter) == Role::kParameter) write_code(line, i);
  for (std::size_t i = begin; i < end; ++i)
    if (role_of(line.words[i].letter) == Role::kOther) emit_imm(Opcode::kRequireTaken, static_cast<Register>(i), 0);
  std::vector<int> letters;
  for (std::size_t i = begin; i < end; ++i) {
    if (role_of(line.words[i].letter) != Role::kBlock) continue;
    if (std::find(letters.begin(), letters.end(), line.words[i].letter) != letters.end()) {
      emit_imm(Opcode::kBlockEnd, 0, 0);
      letters.clear();
    }
    letters.push_back(line.words[i].letter);
    write_block_word(line, i);
  }
  if (!letters.empty()) emit_imm(Opcode::kBlockEnd, 0, 0);
}

void ProgramWriter::write_block_word(const ir::CodeLine& line, std::size_t number) {
  const ir::LineWord& word = line.words[number];
  const BlockWord place_in_block = block_word(word.letter);
  const auto put = [&](const ir::Expr& expr, WordKind kind) {
    const Register before = next_;
    emit_abc(Opcode::kAxisWord, value(expr), static_cast<Register>(place_in_block.index), static_cast<Register>(kind));
    next_ = before;
  };
  Target taken;
  jump_to(Opcode::kJumpIfTaken, static_cast<Register>(number), taken);
  put(*word.value, place_in_block.kind);
  if (word.velocity) put(*word.velocity, WordKind::kVelocity);
  if (word.trigger) put(*word.trigger, WordKind::kTriggerDistance);
  place(taken);
}

// --- read, flags, cycles -------------------------------------------------------------------------------------------------------

void ProgramWriter::write(const ir::ReadWords& node, const source::Span&) { emit_imm(Opcode::kRead, 0, tables_.constant(static_cast<double>(node.letters))); }

void ProgramWriter::write(const ir::LineCondition& node, const source::Span&) {
  const Register set = take();
  emit_abc(Opcode::kFlagTest, set, value(*node.flag));
  Target end;
  jump_to(node.skip ? Opcode::kJumpIfTrue : Opcode::kJumpIfFalse, set, end);
  body(node.rest);
  place(end);
}

void ProgramWriter::write(const ir::SetFlag& node, const source::Span&) { emit_imm(node.set ? Opcode::kFlagSet : Opcode::kFlagClear, value(*node.flag), 0); }

void ProgramWriter::write(const ir::Cycle& node, const source::Span&) {
  switch (node.verb) {
    case ir::CycleVerb::kDefine: emit_imm(Opcode::kCycleDefine, value(*node.number), 0); return;
    case ir::CycleVerb::kUndefine: emit_imm(Opcode::kCycleUndefine, 0, 0); return;
    case ir::CycleVerb::kCall: emit_imm(Opcode::kCycleCall, 0, 0); return;
  }
}

void ProgramWriter::write(const ir::StepBlock& node, const source::Span&) { emit_imm(node.begin ? Opcode::kStepBegin : Opcode::kStepEnd, 0, 0); }

}  // namespace pmac::compiler::codegen
