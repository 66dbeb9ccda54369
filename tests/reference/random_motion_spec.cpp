#include "tests/reference/random_motion_spec.h"

#include <array>
#include <random>

namespace pmac::reference {
namespace {

class Chooser {
 public:
  explicit Chooser(std::uint32_t seed) : random_(seed) {}

  /// low <= result < high
  int between(int low, int high) { return low + static_cast<int>(random_() % static_cast<unsigned>(high - low)); }
  bool once_in(int times) { return between(0, times) == 0; }
  template <std::size_t n>
  int one_of(const std::array<int, n>& values) { return values[static_cast<std::size_t>(between(0, static_cast<int>(n)))]; }

 private:
  std::mt19937 random_;   // and no std::distribution: their numbers differ from library to library
};

MotionSetUp random_set_up(Chooser& choose) {
  MotionSetUp s;
  s.segment_ms = choose.one_of(std::array{0, 1, 2, 5, 10, 20});
  s.lookahead = s.segment_ms > 0 && choose.once_in(2);
  s.ta_ms = choose.one_of(std::array{5, 20, 50, 100});
  s.ts_ms = choose.one_of(std::array{0, 0, 5, 20, 50});
  s.td_ms = choose.one_of(std::array{5, 20, 50, 100});
  s.rates = choose.once_in(2);
  s.no_blend = choose.once_in(4);
  s.feed = choose.between(10, 250);
  s.accel = choose.between(3, 40);
  s.max_speed = choose.one_of(std::array{40, 100, 500});
  return s;
}

MotionItem random_item(Chooser& choose) {
  MotionItem item;
  item.kind = choose.between(0, kMotionItemKinds);
  item.x = choose.between(-200, 200);
  item.y = choose.between(-200, 200);
  item.z = choose.between(-200, 200);
  item.p = choose.between(0, 300);
  return item;
}

}  // namespace

MotionSpec random_motion_spec(std::uint32_t seed) {
  Chooser choose(seed);
  MotionSpec spec;
  spec.set_up = random_set_up(choose);
  const int count = choose.between(1, 16);
  for (int i = 0; i < count; ++i) spec.items.push_back(random_item(choose));
  return spec;
}

}  // namespace pmac::reference
