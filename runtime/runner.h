// A thread with its place in the machine: the motion program of a coordinate system, a PLC, a kinematic routine, or the command line.
#pragma once

#include "runtime/interpreter/interpreter.h"

namespace pmac::runtime {

enum class RunnerKind { kMotionProgram, kPlc, kKinematics, kOnline };

struct Runner {
  Runner(RunnerKind k, int n, double* p, double* q) : kind(k), number(n), thread(p, q) { thread.context = this; }
  RunnerKind kind;
  int number;       // coordinate system or PLC; 0 for the command line
  Thread thread;
  bool aborted = false;   // a kinematic routine asked for an abort, or wrote ErrorStatus
  double error_status = 0;  // that it wrote
  bool for_query = false;   // a kinematic routine answers a query: Ldata.Status is 0
  static Runner& of(Thread& thread) { return *static_cast<Runner*>(thread.context); }
};

}  // namespace pmac::runtime
