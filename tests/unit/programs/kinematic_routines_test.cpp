// What the runtime makes of kinematic routines: rapid moves, pvt with and without segmentation, velocities, errors, loops, queries.
#include <numbers>

#include "kinematics/kinematics.h"
#include "tests/unit/programs/bench.h"

using namespace pmac;
using test::ProgramBench;

namespace {

constexpr double kRadian = std::numbers::pi / 180;

/// Set-up and routines of a kinematic program with another motion program 1 and further set-up.
std::string with_program(const std::string& name, const std::string& lines, const std::string& set_up = {}) {
  const std::string text = test::read_program("kinematics/" + name + ".pmc");
  return text.substr(0, text.find("open prog 1")) + set_up + "\nopen prog 1\nabs;\n" + lines + "\nclose\n";
}

/// One motor that is an axis, with routines of one's own.
std::string one_axis(const std::string& forward, const std::string& inverse, const std::string& lines) {
  return "&1\n#1->I\nMotor[1].MaxSpeed=1\nopen forward (1)\n" + forward + "\nclose\nopen inverse (1)\n" + inverse + "\nclose\nopen prog 1\nabs;\nF100 ta10 ts0\n" + lines +
         "\nclose\n";
}

const char* kForward = "KinPosAxisX = KinPosMotor1; KinAxisUsed = $40;";

std::string fault_of(const std::string& text) {
  ProgramBench bench("routine.pmc", text);
  const auto outcome = bench.run("&1 b1r");
  CHECK(outcome.end == runtime::RunEnd::kIdle);
  REQUIRE(bench.faults.size() == 1);
  return bench.faults[0].fault.detail;
}

std::string answer_to(ProgramBench& bench, const std::string& command) {
  bench.answers.clear();
  bench.machine->command(command);
  REQUIRE_FALSE(bench.answers.empty());
  return bench.answers.back();
}

struct Joint { double position, velocity; };

/// Joints of the 400/300 mm arm and their velocities, from the pose and its velocity (the Jacobian's inverse, by hand).
std::array<Joint, 2> joints_of(double x, double y, double vx, double vy) {
  const auto j = kinematics::scara_inverse({}, {x, y, 250, 0}, kinematics::ScaraArm::kElbowPositive);
  REQUIRE(j);
  const double a = j->shoulder_deg * kRadian, b = (j->shoulder_deg + j->elbow_deg) * kRadian, det = std::sin(j->elbow_deg * kRadian);
  const double u = (vx * std::cos(b) + vy * std::sin(b)) / (400 * det), v = -(vx * std::cos(a) + vy * std::sin(a)) / (300 * det);
  return {Joint{j->shoulder_deg, u / kRadian}, Joint{j->elbow_deg, (v - u) / kRadian}};
}

double hermite(const Joint& from, const Joint& to, double time, double u) {
  const double u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * from.position + (u3 - 2 * u2 + u) * time * from.velocity + (3 * u2 - 2 * u3) * to.position + (u3 - u2) * time * to.velocity;
}

}  // namespace

TEST_CASE("kinematics: a rapid move calls the inverse once, and every motor goes by its own profile", "[programs]") {
  ProgramBench bench("rapid.pmc", with_program("scara_square", "rapid X500 Y0 Z240 C0;\ndwell 0;"));
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  const double want[] = {-36.86989764584401, 90, -53.13010235415599, -10};  // worked by hand from the law of cosines
  for (int m = 1; m <= 4; ++m) CHECK(bench.motor(m).final_mu == Approx(want[m - 1]).margin(1e-9));
  // Motor 2 is the slowest: 90 degrees at 0.2 a ms and one ramp of 150 ms.
  const auto rapid = std::find_if(bench.moves.begin(), bench.moves.end(), [](const auto& m) { return m.mode == "rapid"; });
  REQUIRE(rapid != bench.moves.end());
  CHECK(rapid->end_ms - rapid->start_ms == Approx(450 + 150).margin(1));
}

TEST_CASE("kinematics: pvt without segmentation takes the motors' velocities from the routine (KinVelEna)", "[programs]") {
  ProgramBench bench("pvt.pmc", with_program("two_link", "rapid X500 Y0;\ndwell 10;\npvt 200;\nX480 Y60:200;\nX440 Y120:150;\nX400 Y150:0;\ndwell 0;"));
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  // A word velocity that is missing is 0: X has none, Y the one given, in mm/s.
  const std::array<Joint, 2> knots[] = {joints_of(500, 0, 0, 0), joints_of(480, 60, 0, 0.2), joints_of(440, 120, 0, 0.15), joints_of(400, 150, 0, 0)};
  double worst = 0;
  int samples = 0;
  std::size_t piece = 0;
  for (const auto& move : bench.moves) {
    if (move.mode != "pvt") continue;
    REQUIRE(piece < 3);
    for (std::size_t k = 0; k < bench.time_ms.size(); ++k) {
      const double u = (bench.time_ms[k] - move.start_ms) / 200;
      if (u < 0 || u > 1) continue;
      ++samples;
      for (std::size_t m = 0; m < 2; ++m)
        worst = std::max(worst, std::abs(bench.motor_mu[k][m + 1] - hermite(knots[piece][m], knots[piece + 1][m], 200, u)));
    }
    ++piece;
  }
  CHECK(piece == 3);
  CHECK(samples > 1300);
  CHECK(worst < 1e-8);
}

TEST_CASE("kinematics: segmented pvt follows the axes' cubics", "[programs]") {
  ProgramBench bench("pvt.pmc", with_program("two_link", "rapid X500 Y0;\ndwell 10;\npvt 400;\nX480 Y60:200;\nX440 Y120:0;\ndwell 0;", "Coord[1].SegMoveTime = 2"));
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  const Joint x[] = {{500, 0}, {480, 0}, {440, 0}}, y[] = {{0, 0}, {60, 0.2}, {120, 0}};
  double worst = 0;
  std::size_t piece = 0;
  for (const auto& move : bench.moves) {
    if (move.mode != "pvt") continue;
    for (std::size_t k = 0; k < bench.time_ms.size(); ++k) {
      const double u = (bench.time_ms[k] - move.start_ms) / 400;
      if (u < 0 || u > 1) continue;
      const auto pose = kinematics::scara_forward({}, {bench.motor_mu[k][1], bench.motor_mu[k][2], 0, 0});
      worst = std::max({worst, std::abs(pose.x_mm - hermite(x[piece], x[piece + 1], 400, u)), std::abs(pose.y_mm - hermite(y[piece], y[piece + 1], 400, u))});
    }
    ++piece;
  }
  CHECK(piece == 2);
  CHECK(worst < 1e-4);
}

TEST_CASE("kinematics: a spline without segmentation passes the weighted points with the motors' velocities", "[programs]") {
  ProgramBench bench("spline.pmc", with_program("two_link", "rapid X500 Y0;\ndwell 10;\nspline 200;\nX480 Y60;\nX440 Y120;\nX400 Y150;\ndwell 0;"));
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  const auto end = joints_of(400, 150, 0, 0);
  CHECK(bench.motor(1).final_mu == Approx(end[0].position).margin(1e-9));
  CHECK(bench.motor(2).final_mu == Approx(end[1].position).margin(1e-9));
  // At 400 ms: (1, 4, 1)/6 of the start, the first and the second point, and half their difference over 200 ms.
  const auto knot = joints_of((500 + 4 * 480 + 440) / 6.0, (0 + 4 * 60 + 120) / 6.0, (440 - 500) / 400.0, 120 / 400.0);
  double start_ms = -1;
  for (const auto& move : bench.moves)
    if (start_ms < 0 && move.mode == "spline") start_ms = move.start_ms;
  const double period_ms = bench.time_ms[1] - bench.time_ms[0];
  const auto k = static_cast<std::size_t>((start_ms + 400) / period_ms);
  const double before_ms = start_ms + 400 - bench.time_ms[k];  // within a servo cycle
  for (std::size_t m = 0; m < 2; ++m) {
    CHECK(bench.motor_mu[k][m + 1] + before_ms * knot[m].velocity == Approx(knot[m].position).margin(1e-5));
    CHECK((bench.motor_mu[k + 1][m + 1] - bench.motor_mu[k][m + 1]) / period_ms == Approx(knot[m].velocity).margin(1e-4));
  }
}

TEST_CASE("kinematics: a routine without velocities refuses pvt without segmentation", "[programs]") {
  const std::string detail = fault_of(with_program("corexy", "pvt 100;\nX10:5 Y0;\nX20:0 Y0;", "Coord[1].SegMoveTime = 0"));
  CHECK(detail.find("KinVelMotor1 is not set") != std::string::npos);
  CHECK(detail.find("SegMoveTime") != std::string::npos);
}

TEST_CASE("kinematics: velocity queries ask the forward routine for KinVelAxis", "[programs]") {
  ProgramBench bench("velocity.pmc", one_axis("KinPosAxisX = 2 * KinPosMotor1; if (KinVelEna) KinVelAxisX = 77; KinAxisUsed = $40;", "KinPosMotor1 = KinPosAxisX / 2;", "linear X1;"));
  CHECK(answer_to(bench, "Coord[1].FeedTime=1 &1v").find("77") != std::string::npos);
  ProgramBench without("velocity.pmc", one_axis(kForward, "KinPosMotor1 = KinPosAxisX;", "linear X1;"));
  CHECK(answer_to(without, "&1v") == "X0");
}

TEST_CASE("kinematics: what the inverse routine can do wrong is a fault that says so", "[programs]") {
  struct Row { const char* inverse; const char* says; };
  const Row rows[] = {
      {"P1 = 1;", "KinPosMotor1 is not set"},
      {"KinPosMotor1 = sqrt(-1);", "not a number"},
      {"KinPosMotor1 = 1 / 0;", "not a number"},
      {"KinPosMotor1 = KinPosAxisX; abort1;", "the routine aborted"},
      {"Coord[1].ErrorStatus = 255;", "set Coord[1].ErrorStatus to 255"},
      {"while (1) {}\nKinPosMotor1 = 0;", "looped more than Ldata.GoBack = 10 times"},
      {"N10: goto 10;", "looped more than Ldata.GoBack = 10 times"},
      {"while (1) { Ldata.GoBack = Ldata.GoBack + 1; }\nKinPosMotor1 = 0;", "does not come to an end"},
      {"gosub 10;\nreturn;\nN10: gosub 10;\nreturn;", ""},
  };
  for (const Row& row : rows) {
    INFO(row.inverse);
    const std::string detail = fault_of(one_axis(kForward, row.inverse, "linear X1;"));
    INFO(detail);
    CHECK(detail.find("the inverse kinematics has no solution for this move") != std::string::npos);
    CHECK(detail.find(row.says) != std::string::npos);
  }
}

TEST_CASE("kinematics: a bounded loop that raises Ldata.GoBack first runs to its end", "[programs]") {
  const std::string inverse = "local N; Ldata.GoBack = 60; N = 0; while (N < 50) { N++; } KinPosMotor1 = KinPosAxisX + N;";
  ProgramBench bench("loop.pmc", one_axis("KinPosAxisX = KinPosMotor1 - 50; KinAxisUsed = $40;", inverse, "linear X1;"));
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == Approx(51));
}

TEST_CASE("kinematics: ErrorStatus keeps the number of the routine, and is 255 otherwise", "[programs]") {
  struct Row { const char* inverse; const char* status; };
  for (const Row& row : {Row{"Coord[1].ErrorStatus = 200;", "=200"}, Row{"abort1;", "=255"}, Row{"KinPosMotor1 = sqrt(-1);", "=255"}}) {
    ProgramBench bench("status.pmc", one_axis(kForward, row.inverse, "linear X1;"));
    bench.run("&1 b1r");
    CHECK(bench.faults.size() == 1);
    CHECK(answer_to(bench, "Coord[1].ErrorStatus").find(row.status) != std::string::npos);
    CHECK(answer_to(bench, "Coord[1].ProgActive").find("=0") != std::string::npos);
  }
}

TEST_CASE("kinematics: Ldata.Status tells a program from a query, and a query answers nan", "[programs]") {
  const std::string forward = "KinPosAxisX = KinPosMotor1; KinAxisUsed = $40; if (Ldata.Status & $40) P1 = P1 + 1; else KinPosAxisX = sqrt(-1);";
  ProgramBench bench("query.pmc", one_axis(forward, "KinPosMotor1 = KinPosAxisX;", "linear X1;"));
  CHECK(answer_to(bench, "&1p") == "Xnan");
  CHECK(answer_to(bench, "P1") == "P1=0");
  bench.run("&1 b1r");
  CHECK(bench.faults.empty());
  CHECK(answer_to(bench, "P1") == "P1=1");
}

TEST_CASE("kinematics: a forward routine that fails refuses the start", "[programs]") {
  struct Row { const char* forward; const char* says; };
  const Row rows[] = {{"KinPosAxisX = KinPosMotor1;", "KinAxisUsed"}, {"KinPosAxisX = sqrt(-1); KinAxisUsed = $40;", "not a number"},
                      {"abort1;", "aborted"}, {"while (1) {}", "GoBack"}, {"Coord[1].ErrorStatus = 201;", "to 201"}};
  for (const Row& row : rows) {
    INFO(row.forward);
    ProgramBench bench("start.pmc", one_axis(row.forward, "KinPosMotor1 = KinPosAxisX;", "linear X1;"));
    bench.run("&1 b1r");
    REQUIRE(bench.refusals.size() == 1);
    CHECK(bench.refusals[0].find("error #39") != std::string::npos);
    CHECK(bench.refusals[0].find(row.says) != std::string::npos);
  }
}
