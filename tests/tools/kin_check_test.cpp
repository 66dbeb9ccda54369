// pmac-run --kin-check and --kinematics: what they find, what they refuse, exit codes.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/tools/run_shell.h"

using nlohmann::json;
using pmac::test::program;
using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// An arm on one motor: X is the sine of the angle, with an error in the forward routine.
std::string crank(const std::string& forward) {
  return "&1\n#1->I\nopen forward (1)\n" + forward + "\nKinAxisUsed = $40;\nclose\nopen inverse (1)\nif (abs(KinPosAxisX) > 100) Coord[1].ErrorStatus = 255;\nKinPosMotor1 = "
         "asind(KinPosAxisX / 100);\nclose\n";
}

json checked(const ToolResult& ran) {
  const json report = json::parse(ran.out, nullptr, false);
  INFO(ran.out << ran.err);
  REQUIRE(report.is_object());
  return report["kin_check"][0];
}

}  // namespace

TEST_CASE("kin-check: routines that fit pass, what is out of reach is named with its box, and the edge is singular", "[tools]") {
  const Workspace w;
  w.write("crank.pmc", crank("KinPosAxisX = 100 * sind(KinPosMotor1);"));
  const ToolResult ran = w.run("pmac-run", "crank.pmc --kin-check --kin-range X=-150:150 --kin-samples 3000 --json");
  CHECK(ran.code == 0);
  const json r = checked(ran);
  CHECK(r["status"] == "ok");
  CHECK(r["samples"] == 3000);
  CHECK(r["solved"].get<int>() == Approx(2000).margin(100));  // 200 of 300 mm are in reach
  REQUIRE(r["out_of_reach"].size() == 1);
  CHECK(contains(r["out_of_reach"][0]["reason"], "ErrorStatus to 255"));
  CHECK(r["out_of_reach"][0]["count"].get<int>() == 3000 - r["solved"].get<int>());
  CHECK(r["error"]["worst"].get<double>() < 1e-9);
  CHECK(std::abs(r["out_of_reach"][0]["first"]["X"].get<double>()) > 100);
}

TEST_CASE("kin-check: a forward routine that does not fit is exit 3 with the pose", "[tools]") {
  const Workspace w;
  w.write("crank.pmc", crank("KinPosAxisX = 100.001 * sind(KinPosMotor1);"));
  const ToolResult ran = w.run("pmac-run", "crank.pmc --kin-check --kin-range X=-90:90 --json");
  CHECK(ran.code == 3);
  const json r = checked(ran);
  CHECK(r["status"] == "fault");
  CHECK(r["error"]["worst"].get<double>() == Approx(90 * 1e-5).epsilon(1e-2));  // a hundred-thousandth of the largest X
  CHECK(std::abs(r["error"]["pose"]["X"].get<double>()) > 89);
  CHECK(w.run("pmac-run", "crank.pmc --kin-check --kin-range X=-90:90 --kin-tolerance 0.01 -q").code == 0);
  const ToolResult text = w.run("pmac-run", "crank.pmc --kin-check --kin-range X=-90:90");
  CHECK(contains(text.out, "off by at most 0.0009 in X at X"));
  CHECK(contains(text.out, "FAULT"));
}

TEST_CASE("kin-check: the same seed gives the same bytes, another seed others", "[tools]") {
  const Workspace w;
  const std::string check = program("kinematics/two_link.pmc") + " --kin-check --kin-samples 500 --json";
  const std::string first = w.run("pmac-run", check).out;
  CHECK(first == w.run("pmac-run", check).out);
  CHECK(first != w.run("pmac-run", check + " --kin-seed 2").out);
}

TEST_CASE("kin-check: singular poses are found by a search from the worst sample", "[tools]") {
  const Workspace w;
  const ToolResult ran = w.run("pmac-run", program("kinematics/two_link.pmc") + " --kin-check --kin-range X=600:760 --kin-range Y=-10:10 --kin-condition 50 --json");
  CHECK(ran.code == 0);
  const json r = checked(ran);
  CHECK(r["singular"]["count"].get<int>() > 0);
  CHECK(r["singular"]["worst"].get<double>() > 200);
  CHECK(std::hypot(r["singular"]["pose"]["X"].get<double>(), r["singular"]["pose"]["Y"].get<double>()) == Approx(700).margin(0.5));  // stretched
}

TEST_CASE("kin-check: every kinematic program passes over its motors' ranges", "[tools]") {
  const Workspace w;
  for (const char* name : {"corexy", "five_axis_head", "five_axis_head_table", "five_axis_table", "hexapod", "linear_delta", "rotary_delta", "scara_square", "six_axis",
                           "three_jack_mirror", "two_link"}) {
    const ToolResult ran = w.run("pmac-run", program(std::string("kinematics/") + name + ".pmc") + " --kin-check --kin-samples 300");
    INFO(ran.out << ran.err);
    CHECK(ran.code == 0);
  }
}

TEST_CASE("kin-check: what it cannot check is a usage error that says what is missing", "[tools]") {
  const Workspace w;
  w.write("crank.pmc", crank("KinPosAxisX = 100 * sind(KinPosMotor1);"));
  w.write("linear.pmc", "&1\n#1->X\n");
  struct Row { const char* arguments; const char* says; };
  const Row rows[] = {
      {"linear.pmc --kin-check", "no motor of any coordinate system is defined ->I"},
      {"crank.pmc --kin-check", "Motor[1].MinPos and MaxPos"},
      {"crank.pmc --kin-check --kin-range Y=1:2", "axis Y is no axis of coordinate system 1"},
      {"crank.pmc --kin-check --kin-range X=2:1", "LOW must be below HIGH"},
      {"crank.pmc --kin-check --kin-range X=1", "AXIS=LOW:HIGH"},
      {"crank.pmc --kin-check --kin-range X=a:2", "'a' is not a number"},
      {"crank.pmc --kin-check --kin-range ?\?=1:2", "there is no such axis"},
      {"crank.pmc --kin-check --kin-samples 0", "--kin-samples"},
  };
  for (const Row& row : rows) {
    const ToolResult ran = w.run("pmac-run", row.arguments);
    INFO(row.arguments << "\n" << ran.err);
    CHECK(ran.code == 2);
    CHECK(contains(ran.err, row.says));
  }
}

TEST_CASE("stock kinematics: a program without routines runs with a robot", "[tools]") {
  const Workspace w;
  w.write("arm.pmc", "&1\n#1->I\n#2->I\nMotor[1].MaxSpeed=1 Motor[2].MaxSpeed=1\nopen prog 1\nabs; rapid X0 Y5; dwell 0;\nclose\n");
  w.write("arm.json", "{\"upper_arm_mm\": 3, \"forearm_mm\": 4, \"motor_mu\": [1000, 100]}");
  const ToolResult none = w.run("pmac-run", "arm.pmc -e '&1 b1r'");
  CHECK(none.code == 3);
  CHECK(contains(none.err, "no inverse kinematic routine"));
  const ToolResult inline_settings = w.run("pmac-run", "arm.pmc -e '&1 b1r' --json=summary --kinematics 1=two_link:upper_arm_mm=3,forearm_mm=4,elbow=-1,motor_mu=1000");
  CHECK(inline_settings.code == 0);
  CHECK(json::parse(inline_settings.out)["motors"]["2"]["final"].get<double>() == Approx(-90000).margin(1e-6));  // 3-4-5: the elbow is a right angle
  const ToolResult file = w.run("pmac-run", "arm.pmc -e '&1 b1r' --json=summary --kinematics '&1=two_link:arm.json'");
  CHECK(file.code == 0);
  CHECK(json::parse(file.out)["motors"]["2"]["final"].get<double>() == Approx(9000).margin(1e-6));
}

TEST_CASE("stock kinematics: wrong choices are usage errors, too few motors a refusal", "[tools]") {
  const Workspace w;
  w.write("arm.pmc", "&1\n#1->I\nopen prog 1\nlinear abs F1 X1\nclose\n");
  w.write("bad.json", "{\"upper_arm_mm\": \"long\"}");
  w.write("none.json", "[1]");
  struct Row { const char* choice; const char* says; };
  const Row rows[] = {
      {"scara", "N=ROBOT"},          {"1=skara", "there is no robot 'skara'; there are scara"}, {"999=scara", "coordinate systems are 0 to"}, {"x=scara", "not a number"},
      {"1=scara:elbow=2", "1 or -1"}, {"1=scara:elbow", "NAME=VALUE"},                          {"1=scara:arm=1", "no setting 'arm'"},        {"1=scara:motor_mu=0", "must not be 0"},
      {"1=scara:bad.json", "neither a number"}, {"1=scara:none.json", "not a JSON object"},    {"1=scara:gone.json", "cannot read"},         {"1=scara:motor_mu=1/2", "needs 1 or 4"},
  };
  for (const Row& row : rows) {
    const ToolResult ran = w.run("pmac-run", std::string("arm.pmc --kinematics '") + row.choice + "'");
    INFO(row.choice << "\n" << ran.err);
    CHECK(ran.code == 2);
    CHECK(contains(ran.err, row.says));
  }
  const ToolResult ran = w.run("pmac-run", "arm.pmc -e '&1 b1r' --kinematics 1=two_link");
  CHECK(ran.code == 3);
  CHECK(contains(ran.err, "the robot has 2 joints, and coordinate system 1 has 1 motors defined ->I"));
  const ToolResult list = w.run("pmac-run", "--kinematics list");
  CHECK(list.code == 0);
  CHECK(contains(list.out, "hexapod: Stewart platform"));
  CHECK(contains(list.out, "base_deg=-10/10/110/130/230/250"));
}
