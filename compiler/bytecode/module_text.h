// Texts for parts of a module, used by the disassembly, by verify()'s messages and by faults.
#pragma once

#include <string>

#include "compiler/bytecode/bytecode.h"

namespace pmac::bytecode {

/// Shortest decimal text that reads back as the same double.
std::string number_text(double value);

/// "P", "Q", ... "D"; "element".
std::string variable_class_name(VariableClass variable_class);

/// Number of variables of a class, at most; 0 for elements.
int variable_class_count(VariableClass variable_class);

/// Register of a frame as a reader thinks of it: L3 a local, t0 a temporary, R1 an outgoing argument.
std::string register_name(const Program& program, unsigned reg);

/// "Motor[3].JogSpeed", with register indices by their names.
std::string element_text(const Program& program, const ElementRef& ref);

/// "prog 5", "subprog 100000 (Timer)", "forward 1".
std::string program_title(const Program& program);

/// One instruction of a program: name and operands, "add           t0, L3, t1".
std::string instruction_text(const Module& module, const Program& program, const Instruction& instruction);

/// Text in double quotes with control characters escaped.
std::string quoted(const std::string& text);

}  // namespace pmac::bytecode
