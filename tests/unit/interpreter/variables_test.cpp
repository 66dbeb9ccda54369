#include <catch2/catch.hpp>
#include <limits>

#include "compiler/bytecode/element.h"
#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;
using enum pmac::bytecode::Opcode;

TEST_CASE("loads: constants, integers and moves", "[interpreter]") {
  Bench bench({imm(kNop), imm(kLoadConst, 0, 0), imm(kLoadInt, 1, -7), bc(kMove, 2, 0), imm(kReturn)});
  bench.module.constants = {2.5};
  CHECK(bench.run().stop == RunStop::kEnded);
  CHECK(bench.thread.local(0) == 2.5);
  CHECK(bench.thread.local(1) == -7);
  CHECK(bench.thread.local(2) == 2.5);
}

TEST_CASE("variables: P, Q, M, I, C and D are stored and loaded", "[interpreter]") {
  Bench bench({imm(kLoadInt, 4, 11),
               imm(kStoreP, 4, 65535), imm(kStoreQ, 4, 8191), imm(kStoreM, 4, 16383), imm(kStoreI, 4, 123),
               imm(kStoreC, 4, 63), imm(kStoreD, 4, 127),
               imm(kLoadP, 0, 65535), imm(kLoadQ, 5, 8191), bc(kAdd, 0, 0, 5), imm(kLoadM, 5, 16383), bc(kAdd, 0, 0, 5),
               imm(kLoadI, 5, 123), bc(kAdd, 0, 0, 5), imm(kLoadC, 5, 63), bc(kAdd, 0, 0, 5), imm(kLoadD, 5, 127),
               bc(kAdd, 0, 0, 5), imm(kReturn)});
  CHECK(bench.local_after_run(0) == 66);
  CHECK(bench.p[65535] == 11);
  CHECK(bench.q[8191] == 11);
  CHECK(bench.host.m[16383] == 11);
  CHECK(bench.host.i[123] == 11);
  CHECK(bench.thread.c[63] == 11);
  CHECK(bench.thread.d[127] == 11);
}

TEST_CASE("computed numbers: every class, truncated toward zero", "[interpreter]") {
  for (unsigned variable_class = 0; variable_class < 8; ++variable_class) {
    Bench bench({imm(kLoadConst, 4, 0), imm(kLoadInt, 5, 42), bc(kStoreIndexed, 5, 4, variable_class),
                 bc(kLoadIndexed, 6, 4, variable_class), imm(kStoreP, 6, 100), imm(kReturn)});
    bench.module.constants = {2.9999};  // P(2.9999) is P2
    CHECK(bench.run().stop == RunStop::kEnded);
    CHECK(bench.p[100] == 42);
    switch (static_cast<VariableClass>(variable_class)) {
      case VariableClass::kP: CHECK(bench.p[2] == 42); break;
      case VariableClass::kQ: CHECK(bench.q[2] == 42); break;
      case VariableClass::kM: CHECK(bench.host.m[2] == 42); break;
      case VariableClass::kI: CHECK(bench.host.i[2] == 42); break;
      case VariableClass::kL: CHECK(bench.thread.local(2) == 42); break;
      case VariableClass::kR: CHECK(bench.thread.outgoing(2) == 42); break;
      case VariableClass::kC: CHECK(bench.thread.c[2] == 42); break;
      case VariableClass::kD: CHECK(bench.thread.d[2] == 42); break;
      case VariableClass::kElement: break;
    }
  }
}

TEST_CASE("computed numbers: -0.9 is number 0", "[interpreter]") {
  Bench bench({imm(kLoadConst, 4, 0), imm(kLoadInt, 5, 42), bc(kStoreIndexed, 5, 4, 0), imm(kReturn)});
  bench.module.constants = {-0.9};
  CHECK(bench.run().stop == RunStop::kEnded);
  CHECK(bench.p[0] == 42);
}

TEST_CASE("computed numbers: out of range is a fault that names the variable and the line", "[interpreter]") {
  const auto fault = [](double number, VariableClass variable_class, Opcode op) {
    Bench bench({imm(kLoadConst, 4, 0), bc(op, 5, 4, static_cast<unsigned>(variable_class)), imm(kReturn)});
    bench.module.constants = {number};
    return bench.fault_of_run();
  };
  CHECK(fault(65536, VariableClass::kP, kLoadIndexed) ==
        "test.pmc:2: variable P(65536) does not exist; the range is P0 to P65535");
  CHECK(fault(-1, VariableClass::kQ, kStoreIndexed) == "test.pmc:2: variable Q(-1) does not exist; the range is Q0 to Q8191");
  CHECK(fault(4, VariableClass::kL, kLoadIndexed) == "test.pmc:2: variable L(4) does not exist; the range is L0 to L3");
  CHECK(fault(4, VariableClass::kR, kStoreIndexed) == "test.pmc:2: variable R(4) does not exist; the range is R0 to R3");
  for (const double number : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e300, 1e300}) {
    CHECK(fault(number, VariableClass::kM, kStoreIndexed).find("does not exist") != std::string::npos);
  }
}

TEST_CASE("elements: constant and register indices reach the host", "[interpreter]") {
  Bench bench({imm(kLoadInt, 0, 3), imm(kLoadInt, 4, 20), imm(kStoreElement, 4, 0), imm(kLoadElement, 1, 1),
               imm(kLoadElement, 2, 2), imm(kReturn)});
  bench.module.element_refs = {{ElementId::kMotorJogSpeed, {{true, 0}}},
                               {ElementId::kMotorJogSpeed, {{false, 3}}},
                               {ElementId::kMotorJogSpeed, {{false, 7}}, true}};
  CHECK(bench.local_after_run(1) == 20);
  CHECK(bench.host.elements[{ElementId::kMotorJogSpeed, 3}] == 20);
  CHECK(bench.thread.local(2) == 1000.0 * static_cast<int>(ElementId::kMotorJogSpeed) + 7);
}

TEST_CASE("elements: a register index out of range is a fault that names the element", "[interpreter]") {
  Bench bench({imm(kLoadInt, 0, 33), imm(kLoadElement, 1, 0), imm(kReturn)});
  bench.module.element_refs = {{ElementId::kMotorJogSpeed, {{true, 0}}}};
  CHECK(bench.fault_of_run() == "test.pmc:2: index 33 of Motor[].JogSpeed is out of range; it is 0 to 32");
}

TEST_CASE("host faults: reads and writes of M, I and elements stop the program", "[interpreter]") {
  for (const Opcode op : {kLoadM, kStoreM, kLoadI, kStoreI, kLoadElement, kStoreElement}) {
    Bench bench({imm(kNop), imm(op, 0, 0), imm(kReturn)});
    bench.module.element_refs = {{ElementId::kSysServoPeriod}};
    bench.host.fails = true;
    CHECK(bench.fault_of_run() == "test.pmc:2: host says no");
    CHECK_FALSE(bench.thread.active());
  }
}
