// Inside the execution of control verbs: online.cpp takes those of coordinate systems and PLC programs, motor_verbs.cpp those of motors.
#pragma once

#include <span>
#include <string>

#include "compiler/bytecode/control.h"
#include "compiler/bytecode/missing.h"
#include "runtime/state.h"

namespace pmac::runtime {

/// One verb with its arguments, and what is asked of whom.
struct Call {
  Machine::State& s;
  Runner& runner;
  bytecode::ControlVerb verb;
  std::span<const double> arguments;
  std::string& refusal;

  double argument(std::size_t i) const { return i < arguments.size() ? arguments[i] : bytecode::missing_argument(); }
};

/// Number of the coordinate system or motor a verb acts on; -1 (with a refusal) where there is none.
int number_or(const Call& call, int addressed, int limit, const char* what);
Flow not_simulated(const Call& call);
/// Aborts; a program that does it to itself ends here.
Flow abort_coord(const Call& call, CoordSystem& coord, int number);
/// Jogs, home searches, kill, open loop.
Flow motor_verb(const Call& call);

}  // namespace pmac::runtime
