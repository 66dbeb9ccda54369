#include "tests/reference/random_machine.h"

#include <cstdio>
#include <random>

namespace pmac::reference {
namespace {

class Writer {
 public:
  explicit Writer(std::uint32_t seed) : random_(seed) {}

  RandomMachine write() {
    put_machine();
    put_subprograms();
    add("open prog 1");
    add("local a, b, list(3);");
    add("normal K-1 abs linear");
    add(ramps_ + " F" + number(20, 200));
    put_block(2, 4 + below(10), false);
    add("return");
    put_routine(100);
    put_routine(200);
    add("close");
    put_plcs();
    return std::move(result_);
  }

 private:
  int below(int limit) { return static_cast<int>(random_() % static_cast<unsigned>(limit)); }
  bool one_in(int n) { return below(n) == 0; }
  void add(const std::string& line) { result_.text += line + "\n"; }

  /// A number with up to three decimals.
  std::string number(int low, int high) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.*f", below(4), low + (high - low) * (below(10000) / 1e4));
    return buffer;
  }

  // --- the machine ---------------------------------------------------------------------------------------------------------------

  void put_machine() {
    add("global Speed = 5, Row(6);\nptr Lamp->u.user:100;\nptr Word->i.user:200;");
    lookahead_ = one_in(2);
    const int segment_ms = lookahead_ ? 1 + below(6) : below(3) * 2;
    result_.limits_must_hold = lookahead_;
    if (one_in(4)) put_kinematics();
    else add(one_in(3) ? "&1 #1->1000X #2->1000Y+200X #3->500Z+3" : "&1 #1->1000X #2->1000Y #3->1000Z");
    add("&2 #4->100X");
    for (int motor = 1; motor <= 4; ++motor) {
      const std::string prefix = "Motor[" + std::to_string(motor) + "].";
      add(prefix + "MaxSpeed = " + number(50, 600) + "; " + prefix + "InvAmax = " + number(1, 3) + "; " + prefix + "InvDmax = " + number(1, 3));
      add(prefix + "JogSpeed = " + number(5, 60) + "; " + prefix + "JogTa = -2; " + prefix + "JogTs = -5;");
    }
    add("Coord[1].SegMoveTime = " + std::to_string(segment_ms) + "; Coord[1].AltFeedRate = 0;");
    if (lookahead_) add("&1 define lookahead 4000\nCoord[1].LHDistance = " + std::to_string(20 + below(200)));
    if (one_in(5)) add("Coord[1].NoBlend = 1;");
    segmented_ = segment_ms > 0;
    ramps_ = lookahead_ && one_in(2) ? "ta1 ts0" : "ta" + number(5, 60) + " ts" + number(0, 20);
  }

  void put_kinematics() {
    add("&1 #1->I #2->I #3->I\nopen forward(1)\nKinPosAxisX = KinPosMotor1 / 1000; KinPosAxisY = (KinPosMotor2 - KinPosMotor1) / 1000;\n"
        "KinPosAxisZ = KinPosMotor3 / 500;\nKinAxisUsed = $1C0;\nclose");
    add("open inverse(1)\nKinPosMotor1 = KinPosAxisX * 1000; KinPosMotor2 = (KinPosAxisX + KinPosAxisY) * 1000;\nKinPosMotor3 = KinPosAxisZ * 500;\nclose");
  }

  // --- expressions ---------------------------------------------------------------------------------------------------------------

  std::string variable() {
    switch (below(in_program_ ? 8 : 6)) {
      case 0: return "P" + std::to_string(100 + below(6));
      case 1: return "Q" + std::to_string(10 + below(4));
      case 2: return "P(100 + (" + term() + " & 3))";
      case 3: return "Row(" + std::to_string(below(6)) + ")";
      case 4: return "Speed";
      case 5: return "M" + std::to_string(50 + below(4));
      case 6: return "a";
      default: return "list(" + std::to_string(below(3)) + ")";
    }
  }

  std::string term() {
    switch (below(4)) {
      case 0: return number(0, 10);
      case 1: return "P" + std::to_string(100 + below(6));
      case 2: return "$" + std::to_string(below(100));
      default: return "Q" + std::to_string(10 + below(4));
    }
  }

  std::string expression(int depth) {
    static constexpr const char* kOperators[] = {" + ", " - ", " * ", " / ", " % ", " & ", " | ", " ^ ", "<<", ">>"};
    static constexpr const char* kFunctions[] = {"sin", "cosd", "atan", "abs", "int", "sqrt", "exp", "ln", "rnd", "isnan"};
    switch (depth <= 0 ? below(2) : below(6)) {
      case 0: return term();
      case 1: return one_in(3) ? "Speed" : variable();
      case 2: return std::string(kFunctions[below(10)]) + "(" + expression(depth - 1) + ")";
      case 3: return "(" + expression(depth - 1) + ")";
      case 4: return "-" + term();
      default: return expression(depth - 1) + kOperators[below(10)] + term();
    }
  }

  std::string condition() {
    static constexpr const char* kComparators[] = {" == ", " != ", " < ", " > ", " <= ", " >= ", " !> ", " ~ "};
    const std::string first = expression(1) + kComparators[below(8)] + term();
    if (one_in(3)) return "(" + first + ") " + (one_in(2) ? "&&" : "||") + " !(" + term() + ")";
    return first;
  }

  // --- statements ----------------------------------------------------------------------------------------------------------------

  void put_assignment(bool may_be_synchronous) {
    static constexpr const char* kOperators[] = {" = ", " = ", " += ", " -= ", " *= ", " |= ", " &= ", " <<= "};
    if (one_in(6)) return add(variable() + (one_in(2) ? "++" : "--"));
    if (may_be_synchronous && one_in(4)) return add((one_in(2) ? "Lamp == " : "P105 == ") + expression(1));
    add(variable() + kOperators[below(8)] + expression(2) + (one_in(2) ? ";" : ""));
  }

  /// A finite place within 9 user units, a number or computed.
  std::string place() {
    if (one_in(4)) return "(int(" + expression(1) + ") % 9 * 0 + " + number(-8, 8) + ")";
    return number(-9, 9);
  }

  std::string axes() {
    std::string text;
    for (const char axis : {'X', 'Y', 'Z'})
      if (text.empty() || one_in(2)) text += std::string(text.empty() ? "" : " ") + axis + place();
    return text;
  }

  void put_move() {
    switch (below(12)) {
      case 0: case 1: case 2: return add("linear " + axes());
      case 3: return add("inc linear X" + number(-1, 1) + " Y" + number(-1, 1) + "\nabs");
      case 4: return put_arc();
      case 5: return put_rapid();
      case 6: return add("dwell " + number(1, 20));
      case 7: return add("delay(" + number(1, 20) + ")");
      case 8: return add("F" + number(10, 200) + " " + axes());
      case 9: return put_pvt();
      case 10: return put_spline();
      default: return add("linear tm" + number(20, 200) + " " + axes() + "\nF" + number(20, 200));
    }
  }

  void put_arc() {
    add("inc " + std::string(one_in(2) ? "circle1" : "circle2") + " X" + number(1, 3) + " Y" + number(-3, 3) + " R" + number(5, 9) + "\nabs linear");
  }

  /// Rapid moves keep limits of their own.
  void put_rapid() {
    add("rapid " + axes() + "\nlinear");
    result_.limits_must_hold = false;
  }

  void put_pvt() {
    add("inc pvt" + number(40, 120) + " X" + number(0, 1) + ":" + number(0, 5) + "\nX" + number(0, 1) + ":0\nabs linear");
    result_.limits_must_hold = false;
  }

  void put_spline() {
    add("inc spline" + number(30, 90) + " " + "X" + number(-1, 1) + " Y" + number(-1, 1) + "\nX" + number(-1, 1) + "\nY0.5\nabs linear");
    result_.limits_must_hold = false;
  }

  void put_loop(int depth, bool is_while) {
    const std::string counter = "P" + std::to_string(900 + loops_++);
    const std::string go_on = "(" + counter + " < " + std::to_string(2 + below(3)) + (one_in(2) ? " && " + condition() : "") + ")";
    add(counter + " = 0;");
    add(is_while ? "while " + go_on + " {" : "do {");
    add(counter + "++;");
    put_block(depth - 1, 1 + below(3), true);
    add(is_while ? "}" : "} while " + go_on);
  }

  void put_switch(int depth) {
    add("switch (" + expression(1) + " & 3) {");
    for (int label = 0; label < 3; ++label) {
      add("case " + std::to_string(label) + ":");
      put_block(depth - 1, 1, false);
      if (!one_in(3)) add("break");
    }
    add("default:");
    put_block(depth - 1, 1, false);
    add("}");
  }

  void put_if(int depth, bool in_loop) {
    add("if (" + condition() + ") {");
    put_block(depth - 1, 1 + below(2), in_loop);
    if (one_in(2)) {
      add("} else {");
      put_block(depth - 1, 1, in_loop);
    }
    add("}");
  }

  void put_call() {
    switch (below(4)) {
      case 0: return add("gosub 100");
      case 1: return add("gosub(100 + 100);");
      case 2: return add("call Leg(" + number(-5, 5) + ", " + expression(1) + ", &b);");
      default: return add("call 500");
    }
  }

  /// A jump over a few statements.
  void put_goto(int depth) {
    const std::string label = std::to_string(3000 + labels_++);
    add("if (" + condition() + ") goto " + label);
    put_block(depth - 1, 2, false);
    add("N" + label + ":");
  }

  void put_statement(int depth, bool in_loop) {
    const int kind = depth <= 0 ? below(8) : below(14);
    if (kind <= 3) return put_move();
    if (kind <= 6) return put_assignment(true);
    if (kind == 7 && in_loop) return add("if (" + condition() + ") " + (one_in(2) ? "break" : "continue"));
    if (kind == 7) return add(one_in(2) ? "send 1, \"at %d\\n\", P100 & $ff" : "cmd \"P110 = 7\"");
    if (kind == 8) return put_loop(depth, true);
    if (kind == 9) return put_loop(depth, false);
    if (kind == 10) return put_switch(depth);
    if (kind == 11) return put_if(depth, in_loop);
    if (kind == 12 && may_call_) return put_call();
    if (kind == 13 && may_call_ && depth == 2) return put_goto(depth);
    put_assignment(false);
  }

  void put_block(int depth, int count, bool in_loop) {
    for (int i = 0; i < count; ++i) put_statement(depth, in_loop);
  }

  // --- routines ------------------------------------------------------------------------------------------------------------------

  void put_routine(int label) {
    may_call_ = false;
    add("N" + std::to_string(label) + ":");
    put_block(1, 1 + below(3), false);
    add("return");
    may_call_ = true;
  }

  void put_subprograms() {
    in_program_ = false;
    may_call_ = false;
    add("open subprog Leg(x, y, &z)\nlocal t;\nt = x + 1; z = t * 2;");
    add("linear abs X(x) Y" + number(-5, 5));
    put_block(1, 1 + below(3), false);
    add("return\nclose\nopen subprog 500");
    put_block(1, 1 + below(3), false);
    add("close");
    in_program_ = true;
    may_call_ = true;
  }

  void put_plcs() {
    in_program_ = false;
    add("open plc 1\nlocal n;\nn++; P120++;\nif (P120 == 5) jog 4 = " + number(-50, 50) + "\nif (P120 == 40) jog/ 4");
    for (int i = 0; i < 1 + below(3); ++i) put_assignment(false);
    add("close\nopen plc 2");
    if (one_in(2)) add("if (" + condition() + ") { P121++ } else { Row(1) = " + expression(2) + " }");
    add("Word = P121 & $7f\nswitch (P121 % 3) { case 0: Q12 = 1 break default: Q12 = 2 }");
    add("close\nenable plc 1, 2");
  }

  std::mt19937 random_;
  RandomMachine result_;
  bool lookahead_ = false, segmented_ = false, in_program_ = true, may_call_ = true;
  std::string ramps_;
  int loops_ = 0, labels_ = 0;
};

}  // namespace

RandomMachine random_machine(std::uint32_t seed) { return Writer(seed).write(); }

}  // namespace pmac::reference
