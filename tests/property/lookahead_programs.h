// Programs for tests of the lookahead: shapes as program lines, and machines to run them on.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace pmac::test {

/// Axis definitions, limits by motor, segments.
struct LookaheadMachine {
  std::vector<std::string> definitions{"1000X", "1000Y"};
  struct Limits { double speed_mu_ms, inv_amax_ms2_mu; };
  std::vector<Limits> limits{{500, 1}, {500, 1}};
  double segment_ms = 5;
  int window = 200;
  std::string more;

  std::string text() const {
    std::string out = "&1\n";
    for (std::size_t m = 0; m < definitions.size(); ++m) out += fmt::format("#{}->{}\n", m + 1, definitions[m]);
    for (std::size_t m = 0; m < definitions.size(); ++m) {
      const Limits& l = limits[std::min(m, limits.size() - 1)];
      out += fmt::format("Motor[{0}].MaxSpeed={1}\nMotor[{0}].InvAmax={2}\nMotor[{0}].InvDmax={2}\n", m + 1, l.speed_mu_ms, l.inv_amax_ms2_mu);
    }
    return out + fmt::format("Coord[1].SegMoveTime={}\n&1 define lookahead 40000\nCoord[1].LHDistance={}\n{}\n", segment_ms, window, more);
  }
};

inline std::string program_on(const LookaheadMachine& machine, const std::string& lines) {
  return machine.text() + "open prog 1\nnormal K-1 abs\n" + lines + "close\n";
}

inline std::string speed_words(double feed, double ta_ms = 0, double ts_ms = 0) { return fmt::format("F{} ta{} ts{}\n", feed, ta_ms, ts_ms); }

inline std::string oval(double length = 60, double radius = 10) {
  return fmt::format("linear X{0}\ncircle2 X{0} Y{2} R{1}\nlinear X-{0} Y{2}\ncircle2 X-{0} Y0 R{1}\nlinear X0 Y0\n", length, radius, 2 * radius);
}

/// The contour of the vendor's examples, as increments, times k.
inline std::string contour(double k = 1) {
  struct Row { const char* mode; double x, y, i, j; };
  constexpr Row kRows[] = {{"linear", 0, 9, 0, 0}, {"circle1", 1, 1, 1, 0}, {"linear", 1, 0, 0, 0}, {"circle1", 1, -1, 0, -1},
                           {"linear", 0, -6, 0, 0}, {"circle2", 3, -3, 3, 0}, {"linear", 6, 0, 0, 0}, {"circle1", 1, -1, 0, -1},
                           {"linear", 0, -1, 0, 0}, {"circle1", -1, -1, -1, 0}, {"linear", -9, 0, 0, 0}, {"circle1", -3, 3, 0, 3}};
  std::string out = "inc\n";
  for (const Row& r : kRows) {
    out += fmt::format("{} X{} Y{}", r.mode, r.x * k, r.y * k);
    out += r.mode[0] == 'c' ? fmt::format(" I{} J{}\n", r.i * k, r.j * k) : "\n";
  }
  return out;
}

/// A tangent path in increments: lines, and arcs to either side.
class TangentLines {
 public:
  explicit TangentLines(double heading_rad = 0) : heading_(heading_rad) {}
  TangentLines& line(double length) {
    text_ += fmt::format("linear X{:.12f} Y{:.12f}\n", length * std::cos(heading_), length * std::sin(heading_));
    return *this;
  }
  /// turn_rad > 0: to the left.
  TangentLines& arc(double radius, double turn_rad) {
    const double side = turn_rad > 0 ? 1 : -1, after = heading_ + turn_rad;
    const double i = -side * radius * std::sin(heading_), j = side * radius * std::cos(heading_);
    text_ += fmt::format("circle{} X{:.12f} Y{:.12f} I{:.12f} J{:.12f}\n", side > 0 ? 2 : 1, i + side * radius * std::sin(after),
                         j - side * radius * std::cos(after), i, j);
    heading_ = after;
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_ = "inc\n";
  double heading_;
};

/// Legs of 10 mm with right angles between them, rounded with 0.5 mm.
inline std::string zigzag(int legs) {
  TangentLines path;
  for (int leg = 0; leg < legs; ++leg) {
    path.line(leg == 0 || leg == legs - 1 ? 9.5 : 9);
    if (leg + 1 < legs) path.arc(0.5, (leg % 2 == 0 ? 1 : -1) * std::numbers::pi / 2);
  }
  return path.text();
}

inline std::string corners() {
  return "inc\nlinear X20\nlinear Y20\nlinear X-20 Y5\nlinear X10 Y10\nlinear X-15 Y-2\nlinear X3 Y3\nlinear X0.5\nlinear Y0.5\nlinear X20 Y20\n";
}

inline std::string reversals() { return "linear X20\nlinear X0\nlinear X10 Y5\nlinear X0 Y0\nlinear X5\ndelay 20\nlinear X0\n"; }

/// Short blocks that turn a little each time.
inline std::string short_blocks(double length, double turn_rad, int count) {
  std::string out = "inc\n";
  for (int i = 0; i < count; ++i) out += fmt::format("linear X{:.12f} Y{:.12f}\n", length * std::cos(turn_rad * i), length * std::sin(turn_rad * i));
  return out;
}

}  // namespace pmac::test
