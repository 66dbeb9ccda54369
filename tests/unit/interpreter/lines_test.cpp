// Lines of words: read, code letters, canned cycles, flags; by hand-assembled programs.
#include <catch2/catch.hpp>

#include "compiler/bytecode/letters.h"
#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;
using enum pmac::bytecode::Opcode;

namespace {

unsigned letter(const char* name) { return static_cast<unsigned>(letter_number(name)); }
double bit(const char* name) { return static_cast<double>(std::uint64_t{1} << (letter(name) - 1)); }

/// A program whose line has the words given (values in r4), then `behind`, and subprogram 1000 with `routine` at label 1000.
Bench line_bench(const std::vector<std::pair<const char*, int>>& words, std::vector<Instruction> behind, std::vector<Instruction> routine) {
  Bench bench;
  std::vector<Instruction> code{imm(kLineBegin)};
  unsigned number = 0;
  for (const auto& [name, value] : words) {
    code.push_back(imm(kLoadInt, 4, value));
    code.push_back(bc(kLineWord, 4, letter(name), number++));
  }
  code.insert(code.end(), behind.begin(), behind.end());
  code.push_back(imm(kReturn));
  bench.add(std::move(code));
  routine.insert(routine.begin(), imm(kReturn));  // the top, where missing labels lead to
  bench.add(std::move(routine), ProgramKind::kSubprog, 1000).labels = {{1000, 1}};
  bench.module.constants = {bit("X") + bit("Y"), bit("XX")};
  bench.host.elements[{ElementId::kCoordGprog, 0}] = 1000;
  return bench;
}

}  // namespace

TEST_CASE("read takes words of its list from behind the code and stops at the first other one", "[lines]") {
  Bench bench = line_bench({{"Y", 9}, {"G", 1}, {"X", 5}, {"Z", 3}, {"Y", 7}}, {imm(kLoadInt, 5, 1), bc(kCallCode, 5, letter("G"), 2)}, {imm(kRead, 0, 0), imm(kReturn)});
  bench.thread.d[25] = 42;
  bench.run();
  CHECK(bench.thread.d[0] == bit("X"));
  CHECK(bench.thread.d[24] == 5);
  CHECK(bench.thread.d[25] == 42);  // Y stands behind Z, which is not in the list
}

TEST_CASE("letters AA to ZZ are read into D27 to D52", "[lines]") {
  Bench bench = line_bench({{"XX", 8}}, {imm(kLoadInt, 5, 1), bc(kCallCode, 5, letter("G"), 0)}, {imm(kRead, 0, 1), imm(kReturn)});
  bench.run();
  CHECK(bench.thread.d[50] == 8);
  CHECK(bench.thread.d[0] == 562949953421312.0);  // $2000000000000, the mask that the manuals print for XX
}

TEST_CASE("a word that was read is jumped over, one that was not is executed", "[lines]") {
  Bench bench = line_bench({{"X", 5}, {"Z", 3}}, {imm(kLoadInt, 5, 1), bc(kCallCode, 5, letter("G"), 0), imm(kLoadInt, 0, 0), imm(kJumpIfTaken, 0, 10), imm(kLoadInt, 0, 77), imm(kLoadInt, 1, 1), imm(kJumpIfTaken, 1, 13), imm(kLoadInt, 1, 88)},
                           {imm(kRead, 0, 0), imm(kReturn)});
  bench.run();
  CHECK(bench.thread.local(0) == 0);
  CHECK(bench.thread.local(1) == 88);
}

TEST_CASE("a word that nobody reads and that is no move is named by a fault", "[lines]") {
  Bench bench = line_bench({{"P", 1000}}, {imm(kRequireTaken, 0)}, {imm(kReturn)});
  CHECK(bench.fault_of_run() == "test.pmc:4: the word P1000 of this line was read by no subprogram, and is no word of a move");
}

TEST_CASE("code letters: subprogram of the element, label number times 1000, locals zero, a missing label is the top", "[lines]") {
  const auto call = [](double number) {
    Bench bench = line_bench({}, {imm(kLoadConst, 5, 2), bc(kCallCode, 5, letter("G"), 0)}, {imm(kLoadInt, 0, 5), imm(kStoreP, 0, 1), imm(kStoreP, 1, 2), imm(kReturn)});
    bench.module.constants.push_back(number);
    bench.module.programs[0].code.insert(bench.module.programs[0].code.begin(), imm(kLoadInt, 13, 66));  // R1 of the caller
    bench.p[2] = -1;
    bench.run();
    return bench.p;
  };
  CHECK(call(1)[1] == 5);
  CHECK(call(0.9996)[1] == 5);   // rounds to label 1000
  CHECK(call(1)[2] == 0);        // L1 of the routine, not what the caller left in R1
  CHECK(call(2)[1] == 0);        // no label 2000: the top returns at once
}

TEST_CASE("code letters without a subprogram are faults that name the element", "[lines]") {
  Bench none = line_bench({}, {imm(kLoadInt, 5, 500), bc(kCallCode, 5, letter("S"), 0)}, {imm(kReturn)});
  CHECK(none.fault_of_run() == "test.pmc:3: S500 calls no subprogram: Coord[0].Sprog is 0");
  Bench missing = line_bench({}, {imm(kLoadInt, 5, 3), bc(kCallCode, 5, letter("M"), 0)}, {imm(kReturn)});
  missing.host.elements[{ElementId::kCoordMprog, 0}] = 1001;
  CHECK(missing.fault_of_run() == "test.pmc:3: M3 calls subprogram 1001 (Coord[0].Mprog), which does not exist; load a library that opens it");
  Bench negative = line_bench({}, {imm(kLoadInt, 5, -3), bc(kCallCode, 5, letter("G"), 0)}, {imm(kReturn)});
  CHECK(negative.fault_of_run() == "test.pmc:3: the number of G-3 is not in the range 0 to 4294967.295");
}

TEST_CASE("F is the feed rate, or calls Fprog, in which F is the feed rate", "[lines]") {
  Bench feed = line_bench({}, {imm(kLoadInt, 5, 120), bc(kCallCode, 5, letter("F"), 0)}, {imm(kReturn)});
  feed.run();
  CHECK(feed.host.log == std::vector<std::string>{"set.motion 120"});
  Bench called = line_bench({}, {imm(kLoadInt, 5, 1), bc(kSetMotion, 5, static_cast<unsigned>(MotionParameter::kFeed))}, {imm(kLoadInt, 0, 77), bc(kSetMotion, 0, static_cast<unsigned>(MotionParameter::kFeed)), imm(kReturn)});
  called.host.elements[{ElementId::kCoordFprog, 0}] = 1000;
  called.run();
  CHECK(called.host.log == std::vector<std::string>{"set.motion 77"});
}

TEST_CASE("flags are bits of Cflags; others than 0 to 31 are faults", "[lines]") {
  Bench bench({imm(kLoadInt, 4, 31), imm(kFlagSet, 4), imm(kLoadInt, 5, 2), imm(kFlagSet, 5), bc(kFlagTest, 0, 5), imm(kFlagClear, 5), bc(kFlagTest, 1, 5), imm(kReturn)});
  bench.run();
  CHECK(bench.host.elements[{ElementId::kCoordCflags, 0}] == 2147483648.0);
  CHECK(bench.thread.local(0) == 1);
  CHECK(bench.thread.local(1) == 0);
  Bench outside({imm(kLoadInt, 4, 32), imm(kFlagSet, 4), imm(kReturn)});
  CHECK(outside.fault_of_run() == "test.pmc:2: flag 32 does not exist; the flags of a coordinate system are 0 to 31");
}

TEST_CASE("a canned cycle reads the words of each move block; what it leaves moves", "[lines]") {
  const unsigned x = 6, z = 8;
  Bench bench;
  bench.add({imm(kLoadInt, 4, 1000), imm(kCycleDefine, 4), imm(kLoadInt, 5, 5), bc(kAxisWord, 5, x, 0), imm(kLoadInt, 6, 9), bc(kAxisWord, 6, z, 0), imm(kBlockEnd),
             imm(kCycleUndefine), bc(kAxisWord, 5, x, 0), imm(kBlockEnd), imm(kReturn)});
  bench.add({imm(kRead, 0, 0), imm(kLoadD, 0, 24), bc(kAxisWord, 0, 7, 0), imm(kBlockEnd), imm(kReturn)}, ProgramKind::kSubprog, 1000);
  bench.module.constants = {bit("X")};
  bench.run();
  // inside the cycle: word Y = D24 = 5 and its block; then the Z that was left; then the plain block after cundef
  CHECK(bench.host.log == std::vector<std::string>{"word 5", "block.end 5", "word 9", "block.end 0", "word 5", "block.end 0"});
}

TEST_CASE("scan.loop ends the scan of a PLC program at the test of its loop, and does nothing elsewhere", "[lines]") {
  const std::vector<Instruction> code = {imm(kLoadP, 4, 1), imm(kJumpIfFalse, 4, 6), imm(kLoadInt, 5, 7), imm(kStoreP, 5, 2), imm(kScanLoop, 0, 0), imm(kLoadInt, 0, 3), imm(kReturn)};
  Bench plc(code);
  plc.thread.ends_scans = true;
  plc.p[1] = 1;
  CHECK(plc.run(1000, 1).stop == RunStop::kJumpBack);
  plc.p[1] = 0;
  CHECK(plc.run(1000, 1).stop == RunStop::kEnded);
  CHECK(plc.thread.local(0) == 0);  // the test came first in the second scan
  Bench motion(code);
  motion.p[1] = 1;
  CHECK(motion.local_after_run(0) == 3);
}

TEST_CASE("lines do not grow: a new line begins where the one before did, and a line has at most 256 words", "[lines]") {
  Bench bench({imm(kLineBegin), imm(kLoadInt, 4, 1), bc(kLineWord, 4, 24, 255), imm(kLoop, 0, 0)});
  CHECK(verify(bench.module).empty());
  bench.run(10000);
  Bench wide({bc(kLineWord, 4, 24, 256), imm(kReturn)});
  CHECK(verify(wide.module).find("too many words in a line") != std::string::npos);
  Bench unknown({bc(kLineWord, 4, 53, 0), imm(kReturn)});
  CHECK(verify(unknown.module).find("no such letter") != std::string::npos);
  Bench no_code({bc(kCallCode, 4, 24, 0), imm(kReturn)});
  CHECK(verify(no_code.module).find("not a code letter") != std::string::npos);
}
