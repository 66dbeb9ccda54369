// Fuzz target: a register script on a simulated MCX514. What is wrong with it is a problem with its line.
#include "runtime/drives/mcx514/chip.h"
#include "tests/fuzz/target.h"

using namespace pmac;
using namespace pmac::drives::mcx514;

namespace {

class Count : public PulseSink {
 public:
  std::uint64_t events = 0;
  void pulses(Time, const Event&, const AxisCounts&, const Interpolator&) override { ++events; }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Script script = read_script(fuzz::text_of(data, size));
  Chip chip;
  Count count;
  int polls = 0;
  chip.observe(&count);
  chip.set_interrupted([&] { return ++polls > 10'000 || count.events > 20'000; });
  chip.set_latest(time_from_seconds(10));
  if (run_items(script, chip)) chip.run_until_idle();
  for (const Problem& problem : script.problems) fuzz::check(problem.line > 0 && !problem.text.empty(), "a problem of the script has its line");
  for (const Problem& problem : chip.problems()) fuzz::check(problem.line > 0 && !problem.text.empty(), "a problem of a write has its line");
  return 0;
}
