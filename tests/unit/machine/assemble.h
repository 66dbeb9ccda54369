// Modules put together by hand, so that the machine is tested without a compiler.
#pragma once

#include <string>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "compiler/bytecode/opcode.h"

namespace pmac::test {

using bytecode::Instruction;
using bytecode::Opcode;

/// A program under construction; registers are handed out behind the locals.
class ProgramBuilder {
 public:
  ProgramBuilder(bytecode::Module& module, bytecode::ProgramKind kind, std::uint32_t number, std::uint32_t locals = 0)
      : module_(module) {
    program_.kind = kind;
    program_.number = number;
    program_.local_count = locals;
    program_.frame_size = locals + 8;
  }

  unsigned temporary(unsigned i = 0) const { return program_.local_count + i; }
  std::int32_t here() const { return static_cast<std::int32_t>(program_.code.size()); }
  void line(int number) { program_.lines.push_back({static_cast<std::uint32_t>(here()), {0, number, 1}}); }
  void op(Instruction instruction) { program_.code.push_back(instruction); }

  void load(unsigned reg, double value) {
    module_.constants.push_back(value);
    op(Instruction::with_imm(Opcode::kLoadConst, reg, static_cast<std::int32_t>(module_.constants.size() - 1)));
  }
  void mode(bytecode::MoveMode mode) { op(Instruction::with_imm(Opcode::kSetMode, static_cast<unsigned>(mode), 0)); }
  void set(bytecode::MotionParameter parameter, double value) {
    load(temporary(), value);
    op(Instruction::with_bc(Opcode::kSetMotion, temporary(), static_cast<unsigned>(parameter)));
  }
  void word(bytecode::WordKind kind, int index, double value) {
    load(temporary(), value);
    op(Instruction::with_bc(Opcode::kAxisWord, temporary(), static_cast<unsigned>(index), static_cast<unsigned>(kind)));
  }
  void move(const std::string& axis, double value) {
    word(bytecode::WordKind::kTarget, bytecode::axis_index_from_name(axis), value);
    end_block();
  }
  void end_block() { op(Instruction::with_imm(Opcode::kBlockEnd, 0, 0)); }
  void dwell(double ms) {
    load(temporary(), ms);
    op(Instruction::with_imm(Opcode::kDwell, temporary(), 0));
  }
  void control(bytecode::ControlVerb verb, const std::vector<double>& arguments) {
    for (unsigned i = 0; i < arguments.size(); ++i) load(temporary(i), arguments[i]);
    op(Instruction::with_bc(Opcode::kControl, static_cast<unsigned>(verb), temporary(), static_cast<unsigned>(arguments.size())));
  }
  void element(bytecode::ElementId id, unsigned index, double value) {
    bytecode::ElementRef ref;
    ref.id = id;
    ref.index[0].value = index;
    module_.element_refs.push_back(ref);
    load(temporary(), value);
    op(Instruction::with_imm(Opcode::kStoreElement, temporary(), static_cast<std::int32_t>(module_.element_refs.size() - 1)));
  }
  void address_coord(int number) {
    load(temporary(), number);
    op(Instruction::with_imm(Opcode::kAddressCoord, temporary(), 0));
  }
  void define_axis(int motor, const std::string& axis, double scale) {
    bytecode::AxisDefinition d;
    d.motor = motor;
    d.terms = {{static_cast<std::uint8_t>(bytecode::axis_index_from_name(axis)), scale}};
    module_.axis_definitions.push_back(d);
    op(Instruction::with_imm(Opcode::kDefineAxis, 0, static_cast<std::int32_t>(module_.axis_definitions.size() - 1)));
  }
  void install(std::uint32_t program) { op(Instruction::with_imm(Opcode::kInstallProgram, 0, static_cast<std::int32_t>(program))); }
  /// Ends the program and adds it to the module; its index there.
  std::uint32_t finish() {
    op(Instruction::with_imm(Opcode::kReturn, 0, 0));
    module_.programs.push_back(program_);
    return static_cast<std::uint32_t>(module_.programs.size() - 1);
  }

 private:
  bytecode::Module& module_;
  bytecode::Program program_;
};

}  // namespace pmac::test
