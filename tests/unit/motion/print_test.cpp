#include "runtime/motion/print.h"

#include <catch2/catch.hpp>

#include "tests/unit/motion/scenario.h"

using namespace pmac::motion;
using namespace pmac::motion::test;

TEST_CASE("print: one line a record, with the source line", "[motion][print]") {
  Program p;
  p.feed(50).ta(100).ts(0).xy(20, 0).arc_ij(true, 21, 1, 1, 0).delay(20);
  CHECK(to_text(p.commands[0]) == "1 line 1 linear X20 Y0 F=50 ta=100 td=100 ts=0 tsd=0");
  CHECK(to_text(p.commands[1]) == "2 line 2 circle cw I1 J0 K0 X21 Y1 F=50 ta=100 td=100 ts=0 tsd=0");
  CHECK(to_text(p.commands[2]) == "3 line 3 delay - tm=20 ta=100 td=100 ts=0 tsd=0");
  MotionCommand modes = p.commands[0];
  modes.feed_axes2 = 1u << 0 | 1u << 8;
  modes.transform = 3;
  modes.compensation_side = 2;
  modes.compensation_radius_uu = 1.5;
  modes.no_blend = true;
  CHECK(to_text(modes) == "1 line 1 linear X20 Y0 F=50 ta=100 td=100 ts=0 tsd=0 frax2=AZ tsel=3 ccmode=2 ccr=1.5 stop");
  const Run r = run(config_xy(1000), Program().feed(50).ta(100).ts(0).xy(20, 0));
  REQUIRE(r.pieces.size() == 3);
  CHECK(to_text(r.pieces[0]) == "1 line 1 line 0 100 X2.5 | X0.05 from-rest");
  CHECK(to_text(r.pieces[1]) == "1 line 1 line 100 300 X17.5 | X0.05");
  CHECK(to_text(r.timed[1]) == "1 line 1 100 300 300 1 1 17500 0");
}
