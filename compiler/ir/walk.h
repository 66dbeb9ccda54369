// Visits every statement and every expression of a program, in the order of the text.
#pragma once

#include <functional>

#include "compiler/ir/ir.h"

namespace pmac::compiler::ir {

/// How a statement uses an expression. kReference: its address is taken, or a call gives a value back in it.
enum class Use : std::uint8_t { kRead, kWrite, kUpdate, kReference };

struct Visitor {
  std::function<void(const Stmt&)> statement;           // before what is inside of it; may be empty
  std::function<void(const Expr&, Use)> expression;     // before its operands; may be empty
};

void walk(const Stmt& statement, const Visitor& visitor);
void walk(const Body& body, const Visitor& visitor);
void walk(const Expr& expr, Use use, const Visitor& visitor);

}  // namespace pmac::compiler::ir
