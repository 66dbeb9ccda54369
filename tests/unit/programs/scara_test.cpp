// The SCARA program: its routines against the closed form, a straight Cartesian line, and a target out of reach.
#include <random>

#include "kinematics/kinematics.h"
#include "tests/unit/programs/bench.h"

using namespace pmac;
using test::ProgramBench;

namespace {

motion::AxisVector pose(double x, double y, double z, double c) {
  motion::AxisVector axes{};
  axes[6] = x;
  axes[7] = y;
  axes[8] = z;
  axes[2] = c;
  return axes;
}

/// The program's set-up and routines with another motion program 10.
std::string with_program(const std::string& lines) {
  const std::string text = test::read_program("10_scara.pmc");
  return text.substr(0, text.find("open prog 10")) + "open prog 10\n" + lines + "\nclose\n";
}

}  // namespace

TEST_CASE("SCARA routines: the worked poses", "[programs]") {
  ProgramBench bench("10_scara.pmc");
  struct Row { motion::AxisVector axes; double m[4]; };
  const Row rows[] = {  // by hand, law of cosines with 400 and 300 mm
      {pose(500, 0, 250, 0), {-36.86989764584401, 90, -53.13010235415599, 0}},
      {pose(400, 300, 250, 90), {0, 90, 0, 0}},
      {pose(300, 400, 200, 45), {16.26020470831197, 90, -61.26020470831197, -50}},
      {pose(0, 600, 250, 0), {63.61567025059204, 62.72038726402191, -126.33605751461394, 0}},
  };
  for (const Row& row : rows) {
    std::array<double, bytecode::kMaxMotors> motors{};
    REQUIRE_FALSE(bench.machine->motors_from_axes(1, row.axes, motors));
    for (int m = 0; m < 4; ++m) CHECK(motors[static_cast<std::size_t>(m + 1)] == Approx(row.m[m]).margin(1e-9));
  }
}

TEST_CASE("SCARA routines: forward of inverse is the pose, 10000 random poses", "[programs]") {
  ProgramBench bench("10_scara.pmc");
  std::mt19937_64 random(271828);
  std::uniform_real_distribution<double> radius(104.7, 699.3), angle(-3.14159, 3.14159), z(0, 500), c(-180, 180);
  for (int i = 0; i < 10000; ++i) {
    const double r = radius(random), a = angle(random);
    const auto want = pose(r * std::cos(a), r * std::sin(a), z(random), c(random));
    std::array<double, bytecode::kMaxMotors> motors{};
    REQUIRE_FALSE(bench.machine->motors_from_axes(1, want, motors));
    motion::AxisVector back{};
    REQUIRE(bench.machine->axes_from_motors(1, motors, back));
    for (int axis : {2, 6, 7, 8})
      REQUIRE(std::abs(back[static_cast<std::size_t>(axis)] - want[static_cast<std::size_t>(axis)]) < 1e-9);
  }
}

TEST_CASE("SCARA program: the first Cartesian line is straight to 1e-3 mm at servo rate", "[programs]") {
  ProgramBench bench("10_scara.pmc");
  bench.run("&1 b10r");
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.faults.empty());
  const auto line = std::find_if(bench.moves.begin(), bench.moves.end(), [](const auto& m) { return m.mode == "linear"; });
  REQUIRE(line != bench.moves.end());
  double worst = 0;
  int samples = 0;
  for (std::size_t k = 0; k < bench.time_ms.size(); ++k) {
    if (bench.time_ms[k] < line->start_ms || bench.time_ms[k] > line->end_ms - 75) continue;  // before the blend into the next
    const auto p = kinematics::scara_forward({}, {bench.motor_mu[k][1], bench.motor_mu[k][2], bench.motor_mu[k][3], bench.motor_mu[k][4]});
    worst = std::max(worst, std::abs((p.x_mm - 500) * 300 + p.y_mm * 100) / std::hypot(300, 100));  // line (500,0)-(400,300)
    ++samples;
  }
  CHECK(samples > 6000);  // 316 mm at 100 mm/s
  CHECK(worst < 1e-3);
  CHECK(bench.motor(4).final_mu == Approx(0.0).margin(1e-9));
}

TEST_CASE("SCARA program: a target out of reach stops the program at its line, motors at rest", "[programs]") {
  ProgramBench bench("scara.pmc", with_program("abs; rapid X500 Y0 Z250 C0;\ndwell 0;\nF100; ta100; ts50;\nlinear X600 Y0;\nX750 Y0;\nX500 Y0;"));
  const auto outcome = bench.run("&1 b10r");
  CHECK(outcome.end == runtime::RunEnd::kIdle);
  REQUIRE(bench.faults.size() == 1);
  const std::string text = with_program("");
  const auto first = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("open prog 10")), '\n') + 2;
  CHECK(bench.faults[0].fault.source.line == first + 4);
  CHECK(bench.faults[0].fault.detail.find("inverse") != std::string::npos);
  const std::size_t n = bench.motor_mu.size();
  for (int m = 1; m <= 4; ++m) CHECK(bench.motor_mu[n - 1][static_cast<std::size_t>(m)] == bench.motor_mu[n - 5][static_cast<std::size_t>(m)]);
}
