// programs/kinematics: the routines of every program give the numbers of the stock robot of the same geometry, and every program runs.
#include <filesystem>

#include "kinematics/robot.h"
#include "tests/unit/kinematics/poses.h"
#include "tests/unit/programs/bench.h"

using namespace pmac;
using kinematics::axis::bit;
using test::ProgramBench;

namespace {

struct Row { const char* program; const char* robot; };

const Row kRows[] = {
    {"corexy", "corexy"},
    {"five_axis_head", "five_axis_head"},
    {"five_axis_head_table", "five_axis_head_table"},
    {"five_axis_table", "five_axis_table"},
    {"hexapod", "hexapod"},
    {"linear_delta", "linear_delta"},
    {"rotary_delta", "rotary_delta"},
    {"scara_square", "scara"},
    {"six_axis", "six_axis"},
    {"three_jack_mirror", "three_jack_mirror"},
    {"two_link", "two_link"},
};

std::string file_of(const Row& row) { return "kinematics/" + std::string(row.program) + ".pmc"; }

using Motors = std::array<double, bytecode::kMaxMotors>;

double difference(const Motors& a, const Motors& b) {
  double worst = 0;
  for (std::size_t m = 0; m < a.size(); ++m) worst = std::max(worst, std::abs(a[m] - b[m]));
  return worst;
}

}  // namespace

TEST_CASE("kinematic programs: there is one for every stock robot", "[programs]") {
  for (const auto& kind : kinematics::robot_kinds()) {
    INFO(kind.name);
    CHECK(std::any_of(std::begin(kRows), std::end(kRows), [&](const Row& row) { return row.robot == kind.name; }));
  }
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(PMAC_SOURCE_DIR) + "/programs/kinematics")) files += entry.path().extension() == ".pmc";
  CHECK(files == std::size(kRows));
}

TEST_CASE("kinematic programs: routines and stock robots give the same numbers to 1e-9", "[programs]") {
  for (const Row& row : kRows) {
    INFO(row.program);
    ProgramBench script(file_of(row)), stock(file_of(row));
    stock.machine->set_robot(1, kinematics::test::standard_robot(row.robot), {1.0});
    kinematics::test::Random random(161803398);
    double worst_mu = 0, worst_uu = 0;
    for (int i = 0; i < 500; ++i) {
      const auto pose = kinematics::test::random_pose(row.robot, random);
      Motors by_script{}, by_stock{};
      REQUIRE_FALSE(script.machine->motors_from_axes(1, pose, by_script));
      REQUIRE_FALSE(stock.machine->motors_from_axes(1, pose, by_stock));
      worst_mu = std::max(worst_mu, difference(by_script, by_stock));
      motion::AxisVector from_script{}, from_stock{};
      REQUIRE(script.machine->axes_from_motors(1, by_script, from_script));
      REQUIRE(stock.machine->axes_from_motors(1, by_script, from_stock));
      worst_uu = std::max(worst_uu, kinematics::test::difference(from_script, from_stock, ~0u));
      CHECK(script.machine->axes_of(1) == stock.machine->axes_of(1));
    }
    CHECK(worst_mu < 1e-9);
    CHECK(worst_uu < 1e-9);
  }
}

TEST_CASE("kinematic programs: each compiles without a warning and runs to its end, with its routines as with the stock robot", "[programs]") {
  for (const Row& row : kRows) {
    INFO(row.program);
    std::vector<Motors> ends;
    for (const bool stock : {false, true}) {
      ProgramBench bench(file_of(row));
      CHECK(bench.diagnostics.empty());
      if (stock) bench.machine->set_robot(1, kinematics::test::standard_robot(row.robot), {1.0});
      CHECK(bench.run("&1 b1r").end == runtime::RunEnd::kIdle);
      CHECK(bench.refusals.empty());
      CHECK(bench.faults.empty());
      CHECK(bench.moves.size() > 4);
      ends.push_back(bench.motor_mu.back());
    }
    CHECK(difference(ends[0], ends[1]) < 1e-8);
  }
}

TEST_CASE("kinematic programs: out of reach is the routine's ErrorStatus", "[programs]") {
  const Row rows[] = {{"scara_square", "X900 Y0"}, {"linear_delta", "X900 Y0"}, {"rotary_delta", "Z-900"}, {"six_axis", "X3000"}, {"three_jack_mirror", "A95"}};
  for (const Row& row : rows) {
    INFO(row.program);
    std::string text = test::read_program(file_of(row));
    text = text.substr(0, text.find("open prog 1")) + "open prog 1\nabs;\nrapid " + row.robot + ";\nclose\n";
    ProgramBench bench(row.program, text);
    bench.run("&1 b1r");
    REQUIRE(bench.faults.size() == 1);
    CHECK(bench.faults[0].fault.detail.find("ErrorStatus to 255") != std::string::npos);
    bench.machine->command("Coord[1].ErrorStatus");
    REQUIRE_FALSE(bench.answers.empty());
    CHECK(bench.answers.back().find("=255") != std::string::npos);
  }
}

TEST_CASE("six-axis program: the flange turns by 300 degrees without a jump, by script and by the stock robot", "[programs]") {
  std::string text = test::read_program("kinematics/six_axis.pmc");
  text = text.substr(0, text.find("open prog 1")) + "open prog 1\nabs;\nlinear F300 ta100 ts50;\nC150;\nC300 X800;\ndwell 0;\nclose\n";
  for (const bool stock : {false, true}) {
    ProgramBench bench("six_axis.pmc", text);
    if (stock) bench.machine->set_robot(1, kinematics::test::standard_robot("six_axis"), {1.0});
    bench.run("&1 b1r");
    REQUIRE(bench.faults.empty());
    double worst_step = 0;
    for (std::size_t k = 1; k < bench.motor_mu.size(); ++k) worst_step = std::max(worst_step, difference(bench.motor_mu[k - 1], bench.motor_mu[k]));
    CHECK(worst_step < 0.05);                                             // 30 degrees/s are 0.013 a servo cycle
    CHECK(std::abs(bench.motor(6).final_mu) == Approx(300).margin(1e-6));  // the flange looks down: joint 6 turns as C does
  }
}

TEST_CASE("five-axis programs: while rotary axes alone move the tip stands still at servo rate", "[programs]") {
  struct Tip { const char* program; std::size_t first_move, last_move; };
  for (const Tip& tip : {Tip{"five_axis_head", 0, 1}, Tip{"five_axis_table", 1, 1}, Tip{"five_axis_head_table", 1, 1}}) {
    INFO(tip.program);
    ProgramBench bench(std::string("kinematics/") + tip.program + ".pmc", [&] {
      std::string text = test::read_program(std::string("kinematics/") + tip.program + ".pmc");
      return text.insert(text.find("open prog 1"), "Coord[1].NoBlend = 1\n");
    }());
    bench.run("&1 b1r");
    REQUIRE(bench.moves.size() > tip.last_move);
    const double from_ms = bench.moves[tip.first_move].start_ms, to_ms = bench.moves[tip.last_move].end_ms;
    double worst = 0;
    std::optional<motion::AxisVector> first;
    for (std::size_t k = 0; k < bench.time_ms.size(); ++k) {
      if (bench.time_ms[k] < from_ms || bench.time_ms[k] > to_ms) continue;
      motion::AxisVector axes{};
      REQUIRE(bench.machine->axes_from_motors(1, bench.motor_mu[k], axes));
      if (!first) first = axes;
      for (std::size_t a = 6; a <= 8; ++a) worst = std::max(worst, std::abs(axes[a] - (*first)[a]));
    }
    REQUIRE(first);
    CHECK(worst < 1e-4);
  }
}
