// Compensated paths against closed forms (squares, circles, corners) and, for random shapes, against the distance to the programmed
// path computed point by point.
#include "runtime/motion/cutter_compensation.h"

#include <cmath>
#include <numbers>
#include <random>

#include <catch2/catch.hpp>

#include "runtime/motion/circle.h"
#include "tests/unit/motion/scenario.h"

using namespace pmac::motion;
using namespace pmac::motion::test;
using pmac::runtime::Fault;
using pmac::runtime::FaultKind;
using std::numbers::pi;

namespace {

/// A program under compensation, as the coordinate system would hand it over.
class Job {
 public:
  explicit Job(double x = 0, double y = 0, const CompensationConfig& config = {}) {
    position_ = at_xy(x, y);
    compensation.configure(config);
  }
  Job& side(int ccmode) { side_ = ccmode; return *this; }
  Job& radius(double r) { radius_ = r; return *this; }
  Job& normal(double i, double j, double k) { normal_ = {i, j, k}; return *this; }
  Job& tm() { by_time_ = true; return *this; }
  Job& to(double x, double y) { return add(CommandKind::kLinear, {{kX, x}, {kY, y}}, {}, false); }
  Job& xyz(double x, double y, double z) { return add(CommandKind::kLinear, {{kX, x}, {kY, y}, {kZ, z}}, {}, false); }
  Job& z(double z) { return add(CommandKind::kLinear, {{kZ, z}}, {}, false); }
  Job& cw(double x, double y, double i, double j) { return add(CommandKind::kCircle, {{kX, x}, {kY, y}}, {i, j, 0}, true); }
  Job& ccw(double x, double y, double i, double j) { return add(CommandKind::kCircle, {{kX, x}, {kY, y}}, {i, j, 0}, false); }
  Job& rest() {
    if (!fault) fault = compensation.flush(out);
    return *this;
  }

  CutterCompensation compensation;
  std::vector<MotionCommand> out;
  std::optional<Fault> fault;

 private:
  Job& add(CommandKind kind, std::initializer_list<std::pair<std::size_t, double>> words, std::array<double, 3> center, bool clockwise) {
    if (fault) return *this;
    MotionCommand command;
    command.id = id_ += 2;
    command.source.line = static_cast<int>(id_ / 2);
    command.kind = kind;
    command.target_uu = position_;
    for (const auto& [axis, value] : words) {
      command.axes |= 1u << axis;
      command.target_uu[axis] = value;
    }
    command.feed_axes = 7u << kX;
    command.feed_uu = by_time_ ? 0 : 10;
    command.normal = normal_;
    command.clockwise = clockwise;
    command.has_center = kind == CommandKind::kCircle;
    command.center_uu = center;
    command.compensation_side = side_;
    command.compensation_radius_uu = radius_;
    fault = compensation.add(command, position_, out);
    position_ = command.target_uu;
    return *this;
  }

  AxisVector position_{};
  std::uint64_t id_ = 0;
  int side_ = 0;
  double radius_ = 2;
  bool by_time_ = false;
  std::array<double, 3> normal_{0, 0, -1};
};

/// The ends of what came out, one line a move: "line 8 2", "cw 0 12", rounded to 1e-9.
std::string ends(const Job& job) {
  std::string text;
  const auto number = [](double v) {
    const double r = std::round(v * 1e6) / 1e6;
    std::ostringstream s;
    s << (r == 0 ? 0 : r);
    return s.str();
  };
  for (const MotionCommand& c : job.out) {
    text += c.kind == CommandKind::kLinear ? "line " : c.clockwise ? "cw " : "ccw ";
    text += number(c.target_uu[kX]) + " " + number(c.target_uu[kY]) + (c.target_uu[kZ] != 0 ? " Z" + number(c.target_uu[kZ]) : "") + "\n";
  }
  return text;
}

/// Points along the moves first .. last of what came out, from where the one before ended.
std::vector<std::pair<double, double>> points_of(const std::vector<MotionCommand>& moves, std::size_t first, std::size_t last) {
  std::vector<std::pair<double, double>> points;
  for (std::size_t i = first; i <= last; ++i) {
    const AxisVector& start = moves[i - 1].target_uu;
    Curve curve = line(start, moves[i].target_uu);
    if (moves[i].kind == CommandKind::kCircle) curve = std::get<Arc>(make_arc(moves[i], start, moves[i].target_uu, {})).curve;
    for (int k = 0; k <= 50; ++k) {
      CurvePoint point;
      evaluate(curve, k / 50.0, point);
      points.emplace_back(point.position[kX], point.position[kY]);
    }
  }
  return points;
}

double distance_to_line(double x, double y, double x0, double y0, double x1, double y1) {
  const double dx = x1 - x0, dy = y1 - y0;
  const double t = std::clamp(((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(x - x0 - t * dx, y - y0 - t * dy);
}

FaultKind kind_of(const Job& job) {
  REQUIRE(job.fault);
  return job.fault->kind;
}

}  // namespace

TEST_CASE("compensation: round the outside of a square, lines at the radius and quarter circles about its corners", "[motion][cc]") {
  Job job(0, -5);
  job.side(1).to(0, 0).to(0, 10).to(10, 10).to(10, 0).to(0, 0).side(0).to(-5, 0);
  REQUIRE(!job.fault);
  CHECK(ends(job) ==
        "line -2 0\nline -2 10\ncw 0 12\nline 10 12\ncw 12 10\nline 12 0\ncw 10 -2\nline 0 -2\nline -5 0\n");
  for (const MotionCommand& c : job.out)
    if (c.added) CHECK(c.sweep_rad == Approx(pi / 2).margin(1e-12));
  CHECK(job.out[2].id == job.out[1].id + 1);
}

TEST_CASE("compensation: the other side of the same square is inside", "[motion][cc]") {
  Job job(5, 5);
  job.side(1).to(5, 0).to(10, 0).to(10, 10).to(0, 10).to(0, 0).to(5, 0).side(0).to(5, 5);
  CHECK(ends(job) == "line 5 2\nline 8 2\nline 8 8\nline 2 8\nline 2 2\nline 5 2\nline 5 5\n");
  Job right(5, 5);
  right.side(2).to(5, 0).to(0, 0).to(0, 10).to(10, 10).to(10, 0).to(5, 0).side(0).to(5, 5);
  CHECK(ends(right) == "line 5 2\nline 2 2\nline 2 8\nline 8 8\nline 8 2\nline 5 2\nline 5 5\n");
}

TEST_CASE("compensation: a full circle becomes a full circle of radius R - r inside and R + r outside", "[motion][cc]") {
  for (const bool inside : {true, false}) {
    Job job(inside ? 0 : 20, 0);
    job.side(inside ? 1 : 2).to(10, 0).ccw(10, 0, -10, 0).side(0).to(inside ? 0 : 20, 0);
    REQUIRE(!job.fault);
    REQUIRE(job.out.size() == 3);
    const double radius = inside ? 8 : 12;
    CHECK(job.out[0].target_uu[kX] == Approx(radius).margin(1e-12));
    CHECK(job.out[1].sweep_rad == Approx(2 * pi).margin(1e-12));
    CHECK(-job.out[1].center_uu[0] == Approx(radius).margin(1e-12));
    CHECK(!job.out[1].clockwise);
  }
}

TEST_CASE("compensation: a full circle between shallow corners stays a full circle", "[motion][cc]") {
  Job job(10.01, -5);  // meets the circle at a degree or so from its tangent
  job.side(2).to(10, 0).ccw(10, 0, -10, 0).to(9.99, 5).side(0).to(9.99, 10);
  REQUIRE(!job.fault);
  double sweep = 0;
  for (const MotionCommand& c : job.out)
    if (c.kind == CommandKind::kCircle && !c.added) sweep += c.sweep_rad;
  CHECK(sweep == Approx(2 * pi).margin(0.01));
}

TEST_CASE("compensation: a line tangent to an arc goes on at the radius", "[motion][cc]") {
  Job job(-5, 0);
  job.side(1).to(0, 0).to(20, 0).ccw(20, 20, 0, 10).to(0, 20).cw(0, 40, 0, 10).side(0).to(5, 40);
  REQUIRE(!job.fault);
  CHECK(ends(job) == "line 0 2\nline 20 2\nccw 20 18\nline 0 18\ncw 0 42\nline 5 40\n");
  CHECK(job.out[2].center_uu[1] == Approx(8.0).margin(1e-12));
  CHECK(job.out[4].center_uu[1] == Approx(12.0).margin(1e-12));
}

TEST_CASE("compensation: the arc of an acute corner turns by the change of direction", "[motion][cc]") {
  Job job(-20, 0);
  job.side(1).to(-10, 0).to(0, 0).to(-10, -10).side(0).to(-30, -30);  // turns right by 135 degrees
  REQUIRE(!job.fault);
  REQUIRE(job.out.size() == 5);
  CHECK(job.out[2].added);
  CHECK(job.out[2].clockwise);
  CHECK(job.out[2].sweep_rad == Approx(3 * pi / 4).margin(1e-12));
  CHECK(job.out[2].target_uu[kX] == Approx(2 / std::sqrt(2.0)).margin(1e-12));
  CHECK(job.out[2].target_uu[kY] == Approx(-2 / std::sqrt(2.0)).margin(1e-12));
}

TEST_CASE("compensation: turning back is an outside corner of half a circle", "[motion][cc]") {
  for (const double skew : {0.0, 0.05, -0.05}) {  // within a degree, either way
    Job job(-5, 0);
    job.side(1).to(0, 0).to(10, 0).to(0, skew).side(0).to(-5, skew);
    REQUIRE(!job.fault);
    CHECK(job.out[2].added);
    CHECK(job.out[2].clockwise);
    CHECK(job.out[2].sweep_rad == Approx(pi + std::atan(skew / 10)).margin(1e-9));
  }
}

TEST_CASE("compensation: a shallow outside corner is extended, by CCAddedArcBp also others", "[motion][cc]") {
  Job job(-5, 0);
  const double a = 0.01;  // rad, under the usual limit of 0.02
  job.side(1).to(0, 0).to(10, 0).to(10 + 10 * std::cos(a), -10 * std::sin(a)).side(0).to(40, -10 * std::sin(a));
  REQUIRE(!job.fault);
  CHECK(job.out[1].target_uu[kX] == Approx(10 + 2 * std::tan(a / 2)).margin(1e-12));
  CHECK(job.out[1].target_uu[kY] == Approx(2.0).margin(1e-12));
  Job miter(-5, 0, {-0.5, 20, 8, 0, 0});  // arcs only where the path turns by more than 120 degrees
  miter.side(1).to(0, 0).to(10, 0).to(10, -10).side(0).to(10, -20);
  CHECK(ends(miter) == "line 0 2\nline 12 2\nline 12 -10\nline 10 -20\n");
}

TEST_CASE("compensation: inside corners of lines and arcs are where their parallels cross", "[motion][cc]") {
  Job job(-20, 0);
  job.side(1).radius(1).to(-10, 0).to(0, 0).cw(20, 0, 10, 0).to(30, 0).side(0).to(40, 0);  // up and over a hump
  REQUIRE(!job.fault);
  // Parallels: y = 1 and a circle of radius 11 about (10, 0): x = 10 -+ sqrt(121 - 1).
  CHECK(job.out[1].target_uu[kX] == Approx(10 - std::sqrt(120.0)).margin(1e-12));
  CHECK(job.out[1].target_uu[kY] == Approx(1.0).margin(1e-12));
  CHECK(job.out[2].target_uu[kX] == Approx(10 + std::sqrt(120.0)).margin(1e-12));
  CHECK(job.out[2].sweep_rad == Approx(pi - 2 * std::asin(1.0 / 11)).margin(1e-12));
  // Two bowls of radius 10 about (10, 0) and (26, 0): their parallels of radius 9 cross at x = 18, y = sqrt(81 - 64).
  Job bowls(0, 5);
  bowls.side(1).radius(1).to(0, 0).ccw(18, 6, 10, 0).ccw(36, 0, 8, -6).side(0).to(36, 20);
  REQUIRE(!bowls.fault);
  CHECK(bowls.out[1].target_uu[kX] == Approx(18.0).margin(1e-12));
  CHECK(bowls.out[1].target_uu[kY] == Approx(std::sqrt(17.0)).margin(1e-12));
}

TEST_CASE("compensation: moves beside the plane are carried along, after the corner's arc", "[motion][cc]") {
  Job job(-5, 0);
  job.side(1).to(0, 0).z(-3).to(10, 0).z(4).to(10, -10).side(0).z(5).xyz(10, -20, 6);
  REQUIRE(!job.fault);
  CHECK(ends(job) == "line 0 2\nline 0 2 Z-3\nline 10 2 Z-3\ncw 12 0 Z-3\nline 12 0 Z4\nline 12 -10 Z4\nline 12 -10 Z5\nline 10 -20 Z6\n");
  Job many(-5, 0, {0, 3, 8, 0, 0});
  many.side(1).to(0, 0).to(10, 0).z(1).z(2).z(3);
  CHECK(!many.fault);
  many.z(4);
  CHECK(kind_of(many) == FaultKind::kCcBufferSize);
  CHECK(many.fault->source.line == 6);
}

TEST_CASE("compensation: planes ZX and YZ", "[motion][cc]") {
  Job zx(0, 0);  // normal j-1: seen from +Y, Z is the first axis and X the second
  zx.normal(0, -1, 0).side(1).xyz(0, 0, 5).xyz(0, 0, 15).xyz(10, 0, 15).side(0).xyz(20, 0, 15);
  REQUIRE(!zx.fault);
  CHECK(zx.out[1].target_uu[kX] == Approx(2.0).margin(1e-12));  // left of +Z is +X; the corner turns left
  CHECK(zx.out[1].target_uu[kZ] == Approx(13.0).margin(1e-12));
  Job yz(0, 0);  // normal i-1: Y, then Z
  yz.normal(-1, 0, 0).side(2).xyz(0, 5, 0).xyz(0, 15, 0).xyz(0, 15, -10).side(0).xyz(0, 15, -20);
  REQUIRE(!yz.fault);
  CHECK(yz.out[1].target_uu[kY] == Approx(13.0).margin(1e-12));
  CHECK(yz.out[1].target_uu[kZ] == Approx(-2.0).margin(1e-12));
}

TEST_CASE("compensation: lead-in and lead-out outside go round the corner", "[motion][cc]") {
  Job job(0, 10);
  job.side(1).to(0, 0).to(-10, 0).side(0).to(-10, 10);  // down, then turns right by 90 degrees
  CHECK(ends(job) == "line 2 0\ncw 0 -2\nline -10 -2\ncw -12 0\nline -10 10\n");
}

TEST_CASE("compensation: sides change where the paths cross, or along the next move", "[motion][cc]") {
  Job straight(-5, 0);
  straight.side(1).to(0, 0).to(10, 0).side(2).to(20, 0).to(30, 0).side(0).to(40, 0);
  CHECK(ends(straight) == "line 0 2\nline 10 2\nline 20 -2\nline 30 -2\nline 40 0\n");
  Job crossing(-5, 0);  // a right-angled corner to the left: y = 2 meets x = 12 beyond its end; to the right it does not
  crossing.side(1).to(0, 0).to(10, 0).side(2).to(10, 10).to(10, 20).side(0).to(10, 30);
  CHECK(ends(crossing) == "line 0 2\nline 8.8 2\nline 12 10\nline 12 20\nline 10 30\n");
  // An arc back under the line and up through it: y = 2 and the circle of radius 8 about C = (10 - 10 sin e, 10 cos e) cross.
  const double e = 0.3, cx = 10 - 10 * std::sin(e), cy = 10 * std::cos(e);
  Job meets(-5, 0);
  meets.side(1).to(0, 0).to(10, 0).side(2).cw(cx - 10, cy, cx - 10, cy).side(0).to(cx - 10, cy + 20);
  REQUIRE(!meets.fault);
  CHECK(meets.out[1].target_uu[kX] == Approx(cx - std::sqrt(64 - (cy - 2) * (cy - 2))).margin(1e-9));
  CHECK(meets.out[1].target_uu[kY] == Approx(2.0).margin(1e-12));
}

TEST_CASE("compensation: a new radius comes in along the next move, on an arc as a spiral", "[motion][cc]") {
  Job job(-5, 0);
  job.side(1).to(0, 0).to(10, 0).radius(3).to(20, 0).ccw(20, 20, 0, 10).radius(4).ccw(20, 0, 0, -10).side(0).to(30, 0);
  REQUIRE(!job.fault);
  CHECK(ends(job) == "line 0 2\nline 10 2\nline 20 3\nccw 20 17\nccw 20 4\nline 30 0\n");
  CHECK(job.out[4].center_uu[1] == Approx(-7.0).margin(1e-12));
}

TEST_CASE("compensation: what cannot be compensated is named with its line", "[motion][cc]") {
  CHECK(kind_of(Job(-1, 0).side(1).to(0, 0)) == FaultKind::kCcLeadIn);                            // shorter than the radius
  CHECK(kind_of(Job(0, 0).side(1).ccw(10, 10, 0, 10)) == FaultKind::kCcLeadIn);                   // no line
  CHECK(kind_of(Job(-5, 0).side(1).to(0, 0).side(0).to(5, 0)) == FaultKind::kCcNoMoves);
  CHECK(kind_of(Job(-5, 0).side(1).to(0, 0).to(5, 0).side(0).to(6, 0)) == FaultKind::kCcLeadOut);
  CHECK(kind_of(Job(-5, 0).side(1).to(0, 0).to(5, 0).side(0).ccw(15, 10, 0, 10)) == FaultKind::kCcLeadOut);
  CHECK(kind_of(Job(-5, 0).side(1).to(0, 0).tm().to(5, 0)) == FaultKind::kCcFeedRate);
  CHECK(kind_of(Job(-5, 0).side(1).to(0, 0).to(5, 0).normal(0, -1, 0).to(6, 0)) == FaultKind::kCcMoveType);
  const Job arc = Job(-5, 0).side(1).to(0, 0).to(10, 0).ccw(10, 3, 0, 1.5).to(0, 3);
  CHECK(kind_of(arc) == FaultKind::kCcNoSolution);
  CHECK(arc.fault->source.line == 3);
  CHECK(kind_of(Job(-5, 0).side(1).radius(6).to(5, 0).to(20, 0).ccw(0, 0, -10, 0).to(0, -30)) == FaultKind::kCcNoIntersection);
  // A slot of width 3 for a tool of radius 2: its end is passed backwards.
  const auto slot = [](const CompensationConfig& config) { return Job(-5, 0, config).side(1).to(0, 0).to(20, 0).to(20, 3).to(0, 3).side(0).to(-5, 3); };
  CHECK(kind_of(slot({0, 20, 0, 0, 0})) == FaultKind::kCcDirection);
  CHECK(slot({0, 20, 0, 0, 0}).fault->source.line == 3);
  CHECK(kind_of(slot({0, 20, 8, 0, 0})) == FaultKind::kCcDistance);
}

TEST_CASE("compensation: a notch that the tool does not enter is left out", "[motion][cc]") {
  // Floor with a small left turn and back: the tool of radius 2 passes a dent of width 1 by two inside corners that overlap.
  Job job(-5, 0);
  job.side(1).to(0, 0).to(10, 0).to(10.5, 0.5).to(10.5, 20).side(0).to(10.5, 30);
  REQUIRE(!job.fault);
  CHECK(ends(job) == "line 0 2\nline 8.5 2\nline 8.5 20\nline 10.5 30\n");
  Job strict(-5, 0, {0, 20, 0, 0, 0});
  strict.side(1).to(0, 0).to(10, 0).to(10.5, 0.5).to(10.5, 20);
  CHECK(kind_of(strict) == FaultKind::kCcDirection);
  CHECK(strict.fault->source.line == 3);
}

TEST_CASE("compensation: a stop ends the move at right angles and goes on from there", "[motion][cc]") {
  Job outside(-5, 0);
  outside.side(1).to(0, 0).to(10, 0).rest().to(10, -10).side(0).to(10, -20);
  CHECK(ends(outside) == "line 0 2\nline 10 2\ncw 12 0\nline 12 -10\nline 10 -20\n");
  Job inside(-5, 0);
  inside.side(1).to(0, 0).to(10, 0).rest().to(10, 10).rest().side(0).to(10, 20);
  CHECK(ends(inside) == "line 0 2\nline 10 2\nline 8 0\nline 8 10\nline 10 20\n");
}

TEST_CASE("compensation: nothing is touched while it is off", "[motion][cc]") {
  Job job(3, 4);
  job.to(5, 5).z(1).ccw(7, 7, 0, 2).tm().to(0, 0);
  REQUIRE(job.out.size() == 4);
  CHECK(!job.compensation.active());
  CHECK(job.out[0].axes == (1u << kX | 1u << kY));
}

TEST_CASE("compensation: every point is at least the radius from the path, on both sides of random shapes", "[motion][cc][property]") {
  const unsigned seed = 20240611;
  CAPTURE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int shape = 0; shape < 300; ++shape) {
    CAPTURE(shape);
    // A convex polygon: corners on a circle, at least 20 degrees apart; clockwise its left side is outside.
    std::vector<std::pair<double, double>> corner;
    for (double a = 0; a < 2 * pi - 0.35; a += 0.35 + uniform(random)) corner.emplace_back(20 * std::cos(a), -20 * std::sin(a));
    const bool outside = shape % 2 == 0;
    if (!outside) std::reverse(corner.begin(), corner.end());
    const double r = 0.2 + uniform(random);
    const auto [x0, y0] = corner[0];
    const double mx = (x0 + corner[1].first) / 2, my = (y0 + corner[1].second) / 2;  // start in the middle of a side
    const double far = outside ? 2 : 0;
    Job job(mx * far, my * far);
    job.radius(r).side(1).to(mx, my);
    std::vector<std::pair<double, double>> path{{mx, my}};
    for (std::size_t i = 1; i <= corner.size(); ++i) path.push_back(corner[i % corner.size()]);
    path.emplace_back(mx, my);
    for (std::size_t i = 1; i < path.size(); ++i) job.to(path[i].first, path[i].second);
    job.side(0).to(mx * far, my * far);
    REQUIRE(!job.fault);
    std::size_t arcs = 0;
    for (const MotionCommand& c : job.out) arcs += c.added;
    CHECK(arcs == (outside ? corner.size() : 0));
    for (const auto& [x, y] : points_of(job.out, 1, job.out.size() - 2)) {
      double nearest = 1e9;
      for (std::size_t i = 1; i < path.size(); ++i)
        nearest = std::min(nearest, distance_to_line(x, y, path[i - 1].first, path[i - 1].second, path[i].first, path[i].second));
      REQUIRE(nearest >= r - 1e-9);
      REQUIRE(nearest <= r + 1e-9);  // convex from both sides: the parallel path is at the radius everywhere
    }
  }
}

TEST_CASE("compensation: zigzag lines with corners both ways keep the radius on the outside and their lines exact", "[motion][cc][property]") {
  const unsigned seed = 7;
  CAPTURE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int shape = 0; shape < 300; ++shape) {
    CAPTURE(shape);
    std::vector<std::pair<double, double>> path{{0, 0}};
    double heading = 0;
    for (int i = 0; i < 12; ++i) {
      heading = std::clamp(heading + uniform(random), -1.2, 1.2);
      path.emplace_back(path.back().first + 5 * std::cos(heading), path.back().second + 5 * std::sin(heading));
    }
    const double r = 0.5;
    const int side = shape % 2 + 1;
    Job job(-5, 0);
    job.radius(r).side(side);
    for (const auto& [x, y] : path) job.to(x, y);
    job.side(0).to(path.back().first + 5 * std::cos(heading), path.back().second + 5 * std::sin(heading));
    REQUIRE(!job.fault);
    for (const auto& [x, y] : points_of(job.out, 1, job.out.size() - 2)) {
      double nearest = 1e9;
      for (std::size_t i = 1; i < path.size(); ++i)
        nearest = std::min(nearest, distance_to_line(x, y, path[i - 1].first, path[i - 1].second, path[i].first, path[i].second));
      REQUIRE(nearest >= r - 1e-9);
      REQUIRE(nearest <= r / std::cos(0.01) + 1e-9);
    }
  }
}
