// Functions of vectors, matrices, bytes and texts, and the texts of send and cmd, by what programs say with them.
#include <catch2/catch.hpp>

#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;
using Lines = std::vector<std::string>;

namespace {

const char* const kArrays = "global A(9), B(9), C(9), D(9), N, Text(8)\n";

/// What the lines send from program 1; every send 1 is one line.
Lines said(const std::string& lines, const std::string& before = kArrays) {
  ProgramBench bench("a.pmc", "&1 #1->X\n" + before + "open prog 1\n" + lines + "\nclose\n");
  bench.run("&1 b1r");
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.faults.empty());
  Lines result;
  for (const std::string& answer : bench.answers) result.push_back(answer.substr(std::string("[send 1] ").size()));
  return result;
}

std::string fault_of(const std::string& lines) {
  ProgramBench bench("a.pmc", "&1 #1->X\n" + std::string(kArrays) + "open prog 1\n" + lines + "\nclose\n");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.size() == 1);
  return bench.faults[0].fault.detail;
}

}  // namespace

TEST_CASE("vectors: sums, products, copies with steps", "[functions]") {
  // 1 + 2 + ... + 9 = 45; every second of them from the last one back: 9 + 7 + 5 + 3 + 1 = 25
  CHECK(said("A(0)=1,2,3,4,5,6,7,8,9\nsend1 \"%g %g\", sum(&A(0), 9), sum(&A(8), 5, -2)") == Lines{"45 25"});
  CHECK(said("A(0)=1,2,3\nB(0)=4,5,6\nsend1 \"%g\", sumprod(&A(0), &B(0), 3)") == Lines{"32"});  // 4 + 10 + 18
  CHECK(said("A(0)=1,2,3,4\nvcopy(&B(3), &A(0), 4, -1, 1)\nsend1 \"%g %g %g %g\", B(0), B(1), B(2), B(3)") == Lines{"4 3 2 1"});
  CHECK(said("A(0)=1,2,3\nN = vscale(&A(0), &A(0), -2, 3)\nsend1 \"%g %g %g %g\", A(0), A(1), A(2), N") == Lines{"-2 -4 -6 3"});
  CHECK(said("A(0)=1,2,3\nB(0)=4,5,6\nC(0)=7,8,9\nvmadd(&D(0), &A(0), &B(0), &C(0), 3)\nsend1 \"%g %g %g\", D(0), D(1), D(2)") == Lines{"11 18 27"});
}

TEST_CASE("vectors live in every class of variables, also behind pointers", "[functions]") {
  CHECK(said("local T(3), i\nT(0)=1,2,3 i=1\nsend1 \"%g %g\", sum(&T(0), 3), sum(&T(i), 2)") == Lines{"6 5"});
  CHECK(said("Q5=1,2,3 D40=4,5 M100=6,7\nsend1 \"%g %g %g\", sum(&Q5, 3), sum(&D40, 2), sum(&M100, 2)") == Lines{"6 9 13"});
  CHECK(said("Motor[1].JogSpeed = 40\nsend1 \"%g\", sum(&Speed, 1)", "ptr Speed->Motor[1].JogSpeed\n") == Lines{"40"});
  CHECK(said("vcopy(&Q10, &P10, 2) send1 \"%g %g\", Q10, Q11", "P10=8,9\n") == Lines{"8 9"});
}

TEST_CASE("sine and cosine of one angle go to two variables", "[functions]") {
  CHECK(said("N = sincosd(60, &A(0))\nsend1 \"%.6f %.6f %.6f\", N, A(0), A(1)") == Lines{"0.866025 0.866025 0.500000"});
  CHECK(said("sincos(1, &A(0))\nsend1 \"%.12g\", A(0)*A(0) + A(1)*A(1)") == Lines{"1"});
}

TEST_CASE("matrices: determinant, inverse, product, transposed, by hand", "[functions]") {
  // det [4 7; 2 6] = 24 - 14 = 10; inverse = [6 -7; -2 4] / 10
  CHECK(said("A(0)=4,7,2,6\nN = minv(&B(0), &A(0), 2)\nsend1 \"%g %g %g %g %g %g\", mdet(&A(0), 2), N, B(0), B(1), B(2), B(3)") ==
        Lines{"10 10 0.6 -0.7 -0.2 0.4"});
  // [1 2 3; 4 5 6] [1 0; 0 1; 1 1] = [4 5; 10 11], and with 10 added
  CHECK(said("A(0)=1,2,3,4,5,6\nB(0)=1,0,0,1,1,1\nmmul(&C(0), &A(0), &B(0), 2, 3, 2)\nsend1 \"%g %g %g %g\", C(0), C(1), C(2), C(3)") == Lines{"4 5 10 11"});
  CHECK(said("A(0)=1,2,3,4,5,6\nB(0)=1,0,0,1,1,1\nC(0)=10,10,10,10\nmmadd(&D(0), &A(0), &B(0), &C(0), 2, 3, 2)\nsend1 \"%g %g %g %g\", D(0), D(1), D(2), D(3)") ==
        Lines{"14 15 20 21"});
  CHECK(said("A(0)=1,2,3,4,5,6\nmtrans(&A(0), &A(0), 2, 3)\nsend1 \"%g %g %g %g %g %g\", A(0), A(1), A(2), A(3), A(4), A(5)") == Lines{"1 4 2 5 3 6"});
  // rows 1 and 2, columns 0 and 2 of [1 2 3; 4 5 6; 7 8 10]: 4 * 10 - 6 * 7 = -2
  CHECK(said("A(0)=1,2,3,4,5,6,7,8,10\nsend1 \"%g %.6g\", mminor(&A(0), 3, 0, 1), mdet(&A(0), 3)") == Lines{"-2 -3"});
}

TEST_CASE("matrices: linear equations, and what has no solution", "[functions]") {
  // 2x + y = 5, x - y = 1: x = 2, y = 1
  CHECK(said("A(0)=2,1,1,-1\nB(0)=5,1\nN = msolve(&C(0), &A(0), &B(0), 2)\nsend1 \"%.9g %.9g %g\", C(0), C(1), N") == Lines{"2 1 -3"});
  CHECK(said("A(0)=1,2,2,4\nN = minv(&B(0), &A(0), 2)\nsend1 \"%g %d\", N, isnan(B(0)) + isnan(B(3))") == Lines{"0 2"});
}

TEST_CASE("an array that a function would leave is a fault and stays as it is", "[functions]") {
  CHECK(fault_of("N = sum(&A(5), 5)") == "sum: P8201 is outside; the array ends with P8200");
  CHECK(fault_of("local T(4), i\ni = 2 N = sum(&T(i), 3)") == "sum: L4 is outside; the array ends with L3");
  CHECK(fault_of("mmul(&P65535, &A(0), &B(0), 2, 2, 2)") == "mmul: P65538 is outside; the array ends with P65535");
  CHECK(fault_of("N = mdet(&A(0), 1000)") == "mdet: a matrix of 1000 x 1000 elements is larger than any array");
  CHECK(fault_of("N = sum(&A(0), 0/0)").find("is no number of elements") != std::string::npos);
  CHECK(fault_of("strcpy(&Text(7), \"123456789\")") == "strcpy: 10 bytes do not fit behind P8236, where there are 8");
  CHECK(fault_of("memcpy(&Sys.Cdata[1048575], &A(0), 2)") == "memcpy: 2 bytes do not fit behind Sys.Cdata[1048575], where there are 1");
}

TEST_CASE("texts: copy, append, compare, search, as their namesakes in C", "[functions]") {
  CHECK(said("N = strcpy(&Text(0), \"Hello\") strcat(&Text(0), \", World\")\nsend1 \"%s %d %d\", &Text(0), N, strlen(&Text(0))") == Lines{"Hello, World 5 12"});
  CHECK(said("strcpy(&Text(0), \"abc\") strncat(&Text(0), \"defg\", 2) strtoupper(&Text(0))\nsend1 \"%s\", &Text(0)") == Lines{"ABCDE"});
  CHECK(said("strcpy(&Text(0), \"abcdef\") strncpy(&Text(0), \"xy\", 4)\nsend1 \"%s %d\", &Text(0), Sys.Cdata[0]") == Lines{"xy 0"});
  CHECK(said("send1 \"%d %d %d %d\", strcmp(\"a\", \"b\"), strcmp(\"b\", \"a\"), strcmp(\"a\", \"a\"), strncmp(\"abX\", \"abY\", 2)") == Lines{"-1 1 0 0"});
  CHECK(said("send1 \"%d %d %d\", strchr(\"x,y,z\", 44), strrchr(\"x,y,z\", 44), strchr(\"x\", 44)") == Lines{"1 3 -1"});
  CHECK(said("send1 \"%d %d %d %d\", strspn(\"12ab\", \"0123456789\"), strcspn(\"ab;c\", \",;\"), strpbrk(\"ab;c\", \",;\"), strstr(\"hello\", \"lo\")") == Lines{"2 2 2 3"});
  CHECK(said("send1 \"%g %g %g\", strtod(\" -1.5e3mm\"), strtod(\"mm\"), strtod(\"+7\")") == Lines{"-1500 0 7"});
}

TEST_CASE("bytes: variables are eight of them, and the user buffer is the memory of M variables", "[functions]") {
  CHECK(said("P1=1.5 P2=-2 memcpy(&P11, &P1, 16)\nsend1 \"%g %g\", P11, P12", "") == Lines{"1.5 -2"});
  CHECK(said("A(0)=1,2 N = memset(&A(0), 0, 16)\nsend1 \"%g %g %g\", A(0), A(1), N") == Lines{"0 0 16"});
  CHECK(said("Sys.Ddata[2] = 2.5 memcpy(&P1, &Sys.Cdata[16], 8)\nsend1 \"%g %g\", P1, M5", "M5->d.user:16\n") == Lines{"2.5 2.5"});
  CHECK(said("Sys.Idata[0] = -1\nsend1 \"%u %g %d\", Sys.Udata[0], Sys.Idata[0], Sys.Cdata[3]", "") == Lines{"4294967295 -1 -1"});
}

TEST_CASE("formats print as printf does", "[functions]") {
  CHECK(said("send1 \"%5.2f|%-6d|%06d|%+d|%x|%X|%o|%c|%e|%%\", 3.14159, 42, -42, 7, 255, 255, 8, 65, 12345.678", "") ==
        Lines{"\x20" "3.14|42    |-00042|+7|ff|FF|10|A|1.234568e+04|%"});
  CHECK(said("send1 \"%8s|%-8s|%.2s\", \"abc\", \"abc\", \"abc\"", "") == Lines{"     abc|abc     |ab"});
  CHECK(said("send1 \"%d %d %.1f\", -3.9, 1e15, 0/0", "") == Lines{"-3 1000000000000000 nan"});
  CHECK(said("N = sprintf(&Text(0), \"X%d=%g\", 3, 2.5)\nsend1 \"%s %d\", &Text(0), N") == Lines{"X3=2.5 6"});
}

TEST_CASE("a text without values stands as it is", "[functions]") {
  ProgramBench bench("a.pmc", "open plc 1\nsend1 \"100% done\"\ndisable plc 1\nclose\n");
  pmac::runtime::RunLimits limits;
  limits.until_ms = 5;
  bench.run("enable plc 1", limits);
  CHECK(bench.answers == Lines{"[send 1] 100% done"});
}

TEST_CASE("transformations: product, inverse and determinant, by hand", "[functions]") {
  // T1: a quarter turn, X' = -Y, Y' = X, and 10 added to X. T2: twice as long in X. T2 after T1: X' = 2 (10 - Y), Y' = X.
  const std::string set = "tinit(1) tinit(2)\nTdata[1].Diag[6]=0 Tdata[1].Diag[7]=0 Tdata[1].XYZ[0]=-1 Tdata[1].XYZ[2]=1 Tdata[1].Bias[6]=10 Tdata[2].Diag[6]=2\n";
  CHECK(said(set + "N = tprop(3, 2, 1)\nsend1 \"%g %g %g %g %g\", N, Tdata[3].XYZ[0], Tdata[3].XYZ[2], Tdata[3].Bias[6], Tdata[3].Bias[7]") == Lines{"2 -2 1 20 0"});
  // inverse of T1: X = Y', Y = 10 - X'
  CHECK(said(set + "N = tinv(4, 1)\nsend1 \"%g %g %g %g %g\", N, Tdata[4].XYZ[0], Tdata[4].XYZ[2], Tdata[4].Bias[6], Tdata[4].Bias[7]") == Lines{"1 1 -1 0 10"});
  CHECK(said("tinit(1) Tdata[1].Diag[6]=0 N = tinv(1, 1)\nsend1 \"%g %g %g\", N, tdet(1), Tdata[1].Diag[7]") == Lines{"0 0 1"});
  CHECK(said("send1 \"%g %g\", tinit(255), tdet(255)") == Lines{"1 1"});
  CHECK(fault_of("N = tinit(256)") == "tinit: there is no Tdata[256]; the numbers are 0 to 255");
}
