// The loops of a buffer: while, do, and goto back to a label of the same block.
#pragma once

#include <functional>
#include <vector>

#include "compiler/ir/ir.h"

namespace pmac::compiler::sema {

struct Loop {
  const ir::Expr* condition = nullptr;     // null: goto without a condition
  std::vector<const ir::Stmt*> body;
  source::Span span;                       // of the condition, or the goto
  std::vector<std::int64_t> labels;        // where a goto goes on with the loop
};

/// Every loop, outer ones first.
void for_each_loop(const ir::Body& body, const std::function<void(const Loop&)>& visit);

/// Some statement may leave the loop: break, return, stop, a jump out of it, a call of what may stop the program.
bool has_way_out(const Loop& loop);
/// Some statement moves, waits, or leads to statements that may.
bool may_take_time(const Loop& loop);

}  // namespace pmac::compiler::sema
