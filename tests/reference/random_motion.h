// Random motion programs of every mode, and what is plainly true of them: where they end, where they dwell, how long their lines and
// arcs are. A program is a list of small integers, so that a failing one can be made smaller number by number.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace pmac::reference {

/// One statement or a few; kind chooses what, x y z and p are numbers for it.
struct MotionItem { int kind = 0, x = 0, y = 0, z = 0, p = 0; };

inline constexpr int kMotionItemKinds = 15;

struct MotionSetUp {
  int segment_ms = 0;     // 0: unsegmented
  bool lookahead = false;
  int window = 200;
  int ta_ms = 50, ts_ms = 0, td_ms = 50;
  bool rates = false;     // ta and ts as rates
  bool no_blend = false;
  int feed = 100;         // mm/s
  int accel = 10;         // 0.1 mu/ms^2
  int max_speed = 300;    // mu/ms
};

struct MotionSpec {
  MotionSetUp set_up;
  std::vector<MotionItem> items;
};

struct RandomMotion {
  std::string text;                              // program 1 of coordinate system 1, axes X Y Z at 1000 motor units
  std::array<double, 3> end_uu{};
  std::vector<std::array<double, 3>> dwells_uu;  // where each dwell stands
  std::vector<double> pvt_ms;                    // of each pvt block
  double line_length_uu = 0;                     // of linear and circle moves
  bool only_lines_and_arcs = true;
  bool steps_in_speed = false;                   // programmed with ta0 ts0 and no limit to help
};

RandomMotion random_motion(const MotionSpec& spec);

}  // namespace pmac::reference
