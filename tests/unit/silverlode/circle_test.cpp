// The tables of circles: rows and errors worked out by hand and by an independent program from the formulas of the application note.
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

#include "runtime/drives/silverlode/units.h"
#include "tests/unit/silverlode/circles.h"

using namespace pmac::drives::silverlode;
using pmac::test::circle;
using pmac::test::sheet_of;
using pmac::test::table_of;

namespace {

/// ticks, then pos, acc, vel of X and of Y.
std::vector<std::int64_t> row(const Entry& entry) {
  std::vector<std::int64_t> numbers{entry.ticks};
  for (const AxisMove& move : entry.axis) numbers.insert(numbers.end(), {move.pos, move.acc, move.vel});
  return numbers;
}

using Row = std::vector<std::int64_t>;
constexpr std::int64_t kFar = kFarPosition;

double sagitta(const CircleSetup& setup) {
  return setup.radius * (1 - std::cos(std::abs(setup.distance_angle_deg) / static_cast<double>(setup.segments) / 360 * std::acos(-1.0)));
}

void check_errors(const CircleSetup& setup, bool literal, double min, double max, double closing, std::int64_t ticks) {
  CAPTURE(setup.segments, setup.limits[0].max_accel_rpm_s, literal);
  const CircleFigures figures = figures_of(setup, table_of(setup, literal));
  CHECK(figures.radial_min_counts == Approx(min).margin(std::abs(min) > 100 ? 0.6 : 0.0006));
  CHECK(figures.radial_max_counts == Approx(max).margin(std::abs(max) > 100 ? 0.6 : 0.0016));
  CHECK(figures.closing_counts == Approx(closing).margin(0.0006));
  if (ticks > 0) CHECK(figures.ticks == ticks);
}

}  // namespace

TEST_CASE("closed builder: rows of 72 segments", "[silverlode]") {
  const Table table = table_of(circle(72), false);
  REQUIRE(table.entries.size() == 73);
  CHECK(row(table.entries[0]) == Row{2928, -kFar, 8361, 351144, kFar, 191489, 8042520});
  CHECK(row(table.entries[1]) == Row{2909, -kFar, 174904, 1050760, kFar, 15303, 7981312});
  CHECK(row(table.entries[2]) == Row{2909, -kFar, 172905, 1742378, kFar, 30488, 7859361});
  CHECK(row(table.entries[71]) == Row{2890, kFar, 174904, 351144, kFar, 15303, 8042520});
  CHECK(row(table.entries[72]) == Row{43, kFar, 8361, 0, kFar, 191489, 0});
}

TEST_CASE("closed builder: first rows of 36 segments", "[silverlode]") {
  const Table table = table_of(circle(36), false);
  CHECK(row(table.entries[0]) == Row{5835, -kFar, 16690, 700952, kFar, 190760, 8011916});
  CHECK(row(table.entries[1]) == Row{5818, -kFar, 172576, 2081557, kFar, 30430, 7768478});
}

TEST_CASE("literal builder: first row of 36 segments, with the note's rounding of the slice", "[silverlode]") {
  CHECK(row(table_of(circle(36), true).entries[0]) == Row{5817, -kFar, 16909, 701072, kFar, 193273, 8013293});
  CHECK(sheet_of(circle(36), true).rounded_slice_s / kTick_s == Approx(5817));
  CHECK(sheet_of(circle(72), true).rounded_slice_s / kTick_s == Approx(2908));
  CHECK(sheet_of(circle(360), true).rounded_slice_s / kTick_s == Approx(581));
  CHECK(sheet_of(circle(36), false).rounded_slice_s / kTick_s == Approx(5818));
  CHECK(sheet_of(circle(72), false).rounded_slice_s / kTick_s == Approx(2909));
  CHECK(sheet_of(circle(360), false).rounded_slice_s / kTick_s == Approx(582));
}

TEST_CASE("literal builder: without the terminating entry the servo would be at full speed at the end", "[silverlode]") {
  const Table table = table_of(circle(72), true);
  CHECK(table.entries[71].axis[0].vel == 351264);
  CHECK(table.entries[71].axis[1].vel == 8045285);
  CHECK(table.entries[72].axis[0].vel == 0);
  CHECK(table.entries[72].axis[1].vel == 0);
}

TEST_CASE("radial and closing error of full circles", "[silverlode]") {
  check_errors(circle(36), true, -15.860, 0, 0.170, 209437);
  check_errors(circle(36), false, -15.221, 0, 0, 209491);
  check_errors(circle(72), true, -5.039, 0, 0.000, 209387);
  check_errors(circle(72), false, -3.807, 0, 0, 209491);
  check_errors(circle(360), true, -7.496, 0, 0.170, 209023);
  check_errors(circle(360), false, -0.152, 0, 0, 209563);
}

TEST_CASE("radial and closing error of full circles with ramps of 100 ms", "[silverlode]") {
  check_errors(circle(36, 150), true, -15.853, 0, 0.170, 0);
  check_errors(circle(36, 150), false, -15.224, 0, 0.005, 210279);
  check_errors(circle(72, 150), true, -5.278, 0.013, 0.170, 0);
  check_errors(circle(72, 150), false, -3.813, 0, 0.010, 210283);
  check_errors(circle(360, 150), true, -175.5, 220.7, 0.000, 0);
  check_errors(circle(360, 150), false, -0.156, 0.001, 0.005, 210447);
}

TEST_CASE("closed builder: slices grow where a change of speed does not fit into two of them", "[silverlode]") {
  check_errors(circle(360, 30), false, -0.176, 0.008, 0.026, 214199);
  CircleSetup fast = circle(72, 150);
  fast.velocity = 4000;
  check_errors(fast, false, -3.824, 0, 0.017, 56027);
  CircleSetup fine = circle(360, 150);
  fine.velocity = 2000;
  check_errors(fine, false, -0.158, 0, 0.008, 106633);
}

TEST_CASE("open arcs show the drift that full circles hide", "[silverlode]") {
  const auto arc = [](std::int64_t segments, double angle_deg, double accel) {
    CircleSetup setup = circle(segments, accel);
    setup.start_angle_deg = 30;
    setup.distance_angle_deg = angle_deg;
    return setup;
  };
  CHECK(figures_of(arc(90, 90, 3000), table_of(arc(90, 90, 3000), true)).closing_counts == Approx(5.13).margin(0.005));
  CHECK(figures_of(arc(90, 90, 3000), table_of(arc(90, 90, 3000), false)).closing_counts < 0.0001);
  CHECK(figures_of(arc(90, 90, 150), table_of(arc(90, 90, 150), true)).closing_counts == Approx(221.7).margin(0.05));
  CHECK(figures_of(arc(90, 90, 150), table_of(arc(90, 90, 150), false)).closing_counts < 0.01);
  CHECK(figures_of(arc(54, 270, 3000), table_of(arc(54, 270, 3000), true)).closing_counts == Approx(0.94).margin(0.005));
  CHECK(figures_of(arc(54, 270, 3000), table_of(arc(54, 270, 3000), false)).closing_counts < 0.0001);
  CHECK(figures_of(arc(27, -135, 3000), table_of(arc(27, -135, 3000), true)).closing_counts == Approx(1.09).margin(0.005));
  CHECK(figures_of(arc(27, -135, 3000), table_of(arc(27, -135, 3000), false)).closing_counts < 0.0001);
}

TEST_CASE("final position of the integer model, 2^-26 counts", "[silverlode]") {
  for (const auto& [segments, x] : {std::pair{36, -1148}, std::pair{72, -732}, std::pair{360, -778}}) {
    std::int64_t start = 0, last_x = 0, last_y = 0;
    execute(table_of(circle(segments), false), [&](std::int64_t tick, std::span<const Profile> servos) {
      if (tick == 0) start = servos[0].position;
      last_x = servos[0].position - start;
      last_y = servos[1].position;
    });
    CHECK(last_x == x);
    CHECK(last_y == 0);
  }
}

TEST_CASE("closed builder: limits, whole ramps and the chord polygon hold for random circles", "[silverlode]") {
  std::mt19937 random(20240);
  const auto between = [&random](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  for (int k = 0; k < 60; ++k) {
    CircleSetup setup = circle(static_cast<std::int64_t>(between(3, 361)), std::exp(between(std::log(32.0), std::log(3000.0))));
    setup.distance_angle_deg = between(20, 720) * (k % 2 == 0 ? 1 : -1);
    setup.start_angle_deg = between(-360, 360);
    setup.velocity = between(200, 3000);
    CAPTURE(k, setup.segments, setup.limits[0].max_accel_rpm_s, setup.distance_angle_deg, setup.start_angle_deg, setup.velocity);
    const Sheet sheet = sheet_of(setup, false);
    const Table table = table_of(setup, false);
    const CircleFigures figures = figures_of(setup, table);
    const double turns = std::max(1.0, std::abs(setup.distance_angle_deg) / 360);
    CHECK(figures.closing_counts < 0.2 * turns);
    CHECK(figures.radial_min_counts > -sagitta(setup) - 0.15 * turns);
    CHECK(figures.radial_max_counts < 0.2 * turns);
    const double most_sau = sau_from_counts_s2(counts_s_from_rpm(setup.limits[0].max_accel_rpm_s)) + 1;
    for (std::size_t i = 0; i < table.entries.size(); ++i) {
      CHECK(sheet.motor_time[i + 1] * kTick_s >= sheet.time_acc_max[i + 1] - 1e-9);  // the ramp ends within its entry
      for (const AxisMove& move : table.entries[i].axis) CHECK(move.acc <= most_sau);
    }
    for (const AxisMove& move : table.entries.back().axis) CHECK(move.vel == 0);
  }
}

TEST_CASE("a tangential knife turns evenly, a quarter turn ahead of the radius, and counts for the limits", "[silverlode]") {
  CircleSetup setup = circle(72);
  setup.knife_counts_deg = 100.0 / 9;     // 4000 counts a turn
  setup.limits.push_back({4000, 3000});
  const Sheet sheet = sheet_of(setup, false);
  CHECK(sheet.axis[2].position[0] == Approx(1000));
  CHECK(sheet.axis[2].position[72] == Approx(5000));
  CHECK(sheet.axis[2].delta[5] == Approx(4000.0 / 72));
  setup.limits[2].max_speed_rpm = 1;      // 66.67 counts/s: a turn takes a minute
  CHECK(static_cast<double>(table_of(setup, false).ticks()) * kTick_s == Approx(60).margin(0.1));
  setup.distance_angle_deg = -360;
  CHECK(sheet_of(setup, false).axis[2].position[0] == Approx(-1000));
}

TEST_CASE("the slowest axis and the least slice stretch the time of a segment", "[silverlode]") {
  CircleSetup setup = circle(4);
  setup.velocity = 1e9;
  setup.limits = {{60, 30000}, {600, 30000}};   // X: 4000 counts/s over 4000 counts a segment
  for (std::size_t i = 1; i <= 4; ++i) CHECK(sheet_of(setup, false).time_vel_max[i] == Approx(1.0).margin(0.001));
  setup.min_slice_s = 2.5;
  for (const bool literal : {false, true}) CHECK(sheet_of(setup, literal).time_vel_max[2] == Approx(2.5).margin(0.001));
}

TEST_CASE("units: 1000 counts/s, 200000 counts/s^2, 4000 rpm", "[silverlode]") {
  CHECK(svu_from_counts_s(1000) == Approx(8'053'063.68).epsilon(1e-12));
  CHECK(sau_from_counts_s2(200'000) == Approx(193'273.5).epsilon(1e-6));
  CHECK(svu_from_counts_s(counts_s_from_rpm(4000)) == Approx(2'147'483'648.0).epsilon(1e-12));
}

TEST_CASE("a circle that leaves the ranges of the servos is refused with what and where", "[silverlode]") {
  CircleSetup setup = circle(72, 1e7);
  setup.velocity = 1e6;
  setup.limits[0].max_speed_rpm = setup.limits[1].max_speed_rpm = 9000;
  auto made = table_from(sheet_of(setup, true));
  REQUIRE(made.index() == 1);
  CHECK(std::get<std::string>(made).find("velocity of Y in SVU") != std::string::npos);
  CircleSetup slow = circle(3);
  slow.velocity = 1e-5;
  made = table_from(sheet_of(slow, true));
  REQUIRE(made.index() == 1);
  CHECK(std::get<std::string>(made).find("time in ticks") != std::string::npos);
}

TEST_CASE("a set-up that is none is refused", "[silverlode]") {
  const auto problem = [](auto change) {
    CircleSetup setup = circle(72);
    change(setup);
    return problem_of(setup).value_or("");
  };
  CHECK(problem([](CircleSetup&) {}).empty());
  CHECK(problem([](CircleSetup& s) { s.segments = 0; }).find("segments") != std::string::npos);
  CHECK(problem([](CircleSetup& s) { s.radius = -1; }).find("radius") != std::string::npos);
  CHECK(problem([](CircleSetup& s) { s.velocity = 0; }).find("velocity") != std::string::npos);
  CHECK(problem([](CircleSetup& s) { s.distance_angle_deg = 0; }).find("distance angle") != std::string::npos);
  CHECK(problem([](CircleSetup& s) { s.segments = 1; }).find("every segment ends where it starts") != std::string::npos);
  CHECK(problem([](CircleSetup& s) { s.scale_x = 0; }).find("scale") != std::string::npos);
  CHECK(problem([](CircleSetup& s) { s.limits[1].max_accel_rpm_s = 0; }).find("acceleration of Y") != std::string::npos);
  CHECK(problem([](CircleSetup& s) { s.scale_x = 1e6; }).find("range of the servos") != std::string::npos);
  CHECK(problem([](CircleSetup& s) { s.offset_x = std::nan(""); }).find("finite") != std::string::npos);
}
