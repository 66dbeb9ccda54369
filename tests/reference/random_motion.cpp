#include "tests/reference/random_motion.h"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace pmac::reference {
namespace {

using std::numbers::pi;

std::string text_of(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

std::string xyz(const std::array<double, 3>& at) { return " X" + text_of(at[0]) + " Y" + text_of(at[1]) + " Z" + text_of(at[2]) + "\n"; }

/// Writes the program and walks along with it. at: program position, mm.
class Writer {
 public:
  explicit Writer(const MotionSpec& spec) : spec_(spec) {}

  RandomMotion write() {
    put_set_up();
    for (const MotionItem& item : spec_.items) put(item);
    result_.text += "close\n";
    result_.end_uu = at_;
    return std::move(result_);
  }

 private:
  using Point = std::array<double, 3>;
  static Point point(const MotionItem& item) { return {item.x * 0.1, item.y * 0.1, item.z * 0.02}; }

  void add(const std::string& line) { result_.text += line + "\n"; }

  void put_set_up() {
    const MotionSetUp& s = spec_.set_up;
    add("&1\n#1->1000X\n#2->1000Y\n#3->1000Z");
    for (const char* motor : {"1", "2", "3"}) {
      const std::string prefix = std::string("Motor[") + motor + "].";
      add(prefix + "MaxSpeed = " + std::to_string(s.max_speed));
      add(prefix + "InvAmax = " + text_of(10.0 / s.accel));
      add(prefix + "InvDmax = " + text_of(10.0 / s.accel));
      add(prefix + "JogTa = -2\n" + prefix + "JogTs = -5");
    }
    add("Coord[1].SegMoveTime = " + std::to_string(s.segment_ms));
    if (s.lookahead) add("&1 define lookahead 20000\nCoord[1].LHDistance = " + std::to_string(s.window));
    if (s.no_blend) add("Coord[1].NoBlend = 1");
    add("Coord[1].AltFeedRate = 0");
    add("open prog 1\nnormal K-1; abs; frax(X,Y,Z);\nF" + std::to_string(s.feed));
    put_ramps(s.ta_ms, s.ts_ms, s.td_ms);
  }

  /// As rates: what brings the feed rate about in the same time.
  void put_ramps(int ta_ms, int ts_ms, int td_ms) {
    const double speed = spec_.set_up.feed / 1000.0;
    const bool rates = spec_.set_up.rates && ta_ms > 0;
    const double ts_time = std::min(ts_ms, ta_ms), ta = rates ? -ta_ms / speed : ta_ms, ts = rates ? -ts_time * ta_ms / speed : ts_ms;
    add("ta(" + text_of(ta) + "); ts(" + text_of(ts) + ");");
    if (!rates) add("td(" + std::to_string(td_ms) + ");");
    if (ta_ms == 0 && ts_ms == 0) result_.steps_in_speed = true;
    if (!rates && td_ms == 0 && ts_ms == 0) result_.steps_in_speed = true;
  }

  void put(const MotionItem& item) {
    switch (item.kind) {
      case 0: case 1: case 2: case 3: return put_line(point(item));
      case 4: return put_increment(item);
      case 5: return put_arc(item);
      case 6: return put_circle(item);
      case 7: return put_rapid(point(item));
      case 8: return put_dwell(item.p);
      case 9: return add("delay " + std::to_string(1 + item.p % 80));
      case 10: return add("F" + std::to_string(5 + item.p % 300));
      case 11: return put_ramps(5 + item.p % 90, item.x & 1 ? item.p % 40 : 0, 5 + item.p / 2 % 60);
      case 12: return put_pvt(item);
      case 13: return put_spline(item);
      default: return put_timed(item);
    }
  }

  void go(const Point& to) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += (to[i] - at_[i]) * (to[i] - at_[i]);
    result_.line_length_uu += std::sqrt(sum);
    at_ = to;
  }

  void put_line(const Point& to) {
    add("linear" + xyz(to));
    go(to);
  }
  void put_increment(const MotionItem& item) {
    const Point to{at_[0] + item.x * 0.01, at_[1] + item.y * 0.01, at_[2]};
    add("inc\nlinear X" + text_of(item.x * 0.01) + " Y" + text_of(item.y * 0.01) + "\nabs");
    go(to);
  }
  /// By its radius, no more than half a circle; unsegmented it is a line.
  void put_arc(const MotionItem& item) {
    const Point to{item.x * 0.1, item.y * 0.1, at_[2]};
    const double chord = std::hypot(to[0] - at_[0], to[1] - at_[1]);
    if (chord == 0) return put_line(to);
    const double radius = chord / 2 * (1.05 + (item.p % 50) * 0.1);
    add(std::string(item.z > 0 ? "circle1" : "circle2") + " X" + text_of(to[0]) + " Y" + text_of(to[1]) + " R" + text_of(radius));
    if (spec_.set_up.segment_ms > 0) result_.line_length_uu += 2 * radius * std::asin(chord / 2 / radius) - chord;
    go(to);
  }
  /// A full turn of a helix.
  void put_circle(const MotionItem& item) {
    const double i = 1 + std::abs(item.x) * 0.03, j = item.y * 0.02, rise = item.z * 0.01;
    const Point to{at_[0], at_[1], at_[2] + rise};
    add(std::string(item.p & 1 ? "circle1" : "circle2") + xyz(to).substr(0, xyz(to).size() - 1) + " I" + text_of(i) + " J" + text_of(j));
    if (spec_.set_up.segment_ms > 0) result_.line_length_uu += std::hypot(2 * pi * std::hypot(i, j), rise) - std::abs(rise);
    go(to);
  }
  void put_rapid(const Point& to) {
    add("rapid" + xyz(to));
    at_ = to;
    result_.only_lines_and_arcs = false;
  }
  void put_dwell(int p) {
    add("dwell " + std::to_string(5 + p % 30));
    result_.dwells_uu.push_back(at_);
  }
  /// Three points, the last one at rest.
  void put_pvt(const MotionItem& item) {
    const Point to = point(item), from = at_;
    const double time_ms = 40 + item.p % 100;
    add("pvt" + text_of(time_ms));
    for (int k = 1; k <= 3; ++k) {
      std::string line;
      for (std::size_t i = 0; i < 3; ++i) {
        const double along = (to[i] - from[i]) / 3;
        line += std::string(" ") + "XYZ"[i] + text_of(from[i] + along * k) + ":" + text_of(k == 3 ? 0 : along / time_ms * 1000);
      }
      add(line);
      result_.pvt_ms.push_back(time_ms);
    }
    at_ = to;
    result_.only_lines_and_arcs = false;
  }
  void put_spline(const MotionItem& item) {
    const Point to = point(item);
    const Point middle{(at_[0] + to[0]) / 2 + item.p * 0.01, (at_[1] + to[1]) / 2, at_[2]};
    add("spline" + text_of(20 + item.p % 80));
    add(xyz(middle) + xyz(to));
    at_ = to;
    result_.only_lines_and_arcs = false;
  }
  void put_timed(const MotionItem& item) {
    add("tm" + std::to_string(10 + item.p % 300));
    put_line(point(item));
    add("F" + std::to_string(spec_.set_up.feed));
  }

  const MotionSpec& spec_;
  RandomMotion result_;
  Point at_{};
};

}  // namespace

RandomMotion random_motion(const MotionSpec& spec) { return Writer(spec).write(); }

}  // namespace pmac::reference
