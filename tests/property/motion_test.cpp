// Random motion programs of every mode (tests/reference/random_motion.h). PMAC_RANDOM_PROGRAMS: how many of each property, 40 if not set;
// PMAC_RANDOM_SEED: where to begin. A program that fails is made smaller and printed with its text.
#include <cstdlib>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <rapidcheck.h>

#include "runtime/motion/pipeline.h"
#include "tests/property/motion_check.h"

using namespace pmac::test;
using pmac::reference::kMotionItemKinds;
using pmac::reference::MotionItem;
using pmac::reference::MotionSetUp;
using pmac::reference::MotionSpec;
using pmac::reference::random_motion;
using pmac::reference::RandomMotion;

namespace {

int from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

template <class Property>
void holds(const std::string& what, const Property& property) {
  rc::detail::TestParams parameters;
  parameters.seed = static_cast<std::uint64_t>(from_environment("PMAC_RANDOM_SEED", 1));
  parameters.maxSuccess = from_environment("PMAC_RANDOM_PROGRAMS", 40);
  parameters.maxSize = 100;
  rc::detail::TestMetadata metadata;
  metadata.id = metadata.description = what;
  const rc::detail::TestResult result = rc::detail::checkTestable(property, metadata, parameters);
  std::ostringstream message;
  rc::detail::printResultMessage(result, message);
  INFO(message.str());
  CHECK(result.template is<rc::detail::SuccessResult>());
}

rc::Gen<MotionItem> any_item() {
  return rc::gen::build<MotionItem>(rc::gen::set(&MotionItem::kind, rc::gen::noShrink(rc::gen::inRange(0, kMotionItemKinds))),
                                    rc::gen::set(&MotionItem::x, rc::gen::inRange(-200, 200)), rc::gen::set(&MotionItem::y, rc::gen::inRange(-200, 200)),
                                    rc::gen::set(&MotionItem::z, rc::gen::inRange(-200, 200)), rc::gen::set(&MotionItem::p, rc::gen::inRange(0, 300)));
}

rc::Gen<std::vector<MotionItem>> some_items() {
  return rc::gen::mapcat(rc::gen::inRange(1, 14), [](int count) { return rc::gen::resize(100, rc::gen::container<std::vector<MotionItem>>(static_cast<std::size_t>(count), any_item())); });
}

rc::Gen<int> one_of(std::initializer_list<int> values) { return rc::gen::elementOf(std::vector<int>(values)); }

/// lookahead: 0 never, 1 always, 2 sometimes.
rc::Gen<MotionSetUp> any_set_up(int lookahead) {
  return rc::gen::map(
      rc::gen::tuple(one_of({0, 1, 2, 5, 5, 10, 20}), one_of({0, 1, 5, 20, 50, 100}), one_of({0, 0, 5, 20, 50}), one_of({5, 20, 50, 100}),
                     rc::gen::arbitrary<bool>(), one_of({0, 0, 0, 1}), rc::gen::inRange(10, 250), rc::gen::inRange(3, 40), one_of({40, 100, 500}),
                     one_of({lookahead == 1, lookahead > 0})),
      [](const auto& t) {
        MotionSetUp s;
        int ahead = 0, single = 0;
        std::tie(s.segment_ms, s.ta_ms, s.ts_ms, s.td_ms, s.rates, single, s.feed, s.accel, s.max_speed, ahead) = t;
        s.lookahead = ahead != 0;
        s.no_blend = single != 0;
        if (s.lookahead && s.segment_ms == 0) s.segment_ms = 5;
        if (!s.lookahead && s.ta_ms + s.ts_ms < 5) s.ta_ms = 20;
        return s;
      });
}

MotionSpec any_motion(int lookahead) {
  MotionSpec spec;
  spec.set_up = *any_set_up(lookahead);
  spec.items = *some_items();
  return spec;
}

/// The program as it was run, for the message, and a fault is none of the properties.
MotionRun run_of(const RandomMotion& motion, const std::string& set_up = "", const std::string& commands = "&1 b1r") {
  MotionRun run = run_motion(motion.text, set_up, commands);
  if (!run.fault.empty()) RC_FAIL(run.fault + "\n" + motion.text);
  return run;
}

void expect(const std::string& wrong, const RandomMotion& motion) {
  if (!wrong.empty()) RC_FAIL(wrong + "\n" + motion.text);
}

/// Moves that the planner blends or stops between by itself: no rapid moves, dwells, pvt and splines, before which a program waits for rest.
MotionSpec any_blended_motion() {
  MotionSpec spec = any_motion(0);
  std::erase_if(spec.items, [](const MotionItem& item) { return item.kind == 7 || item.kind == 8 || item.kind == 12 || item.kind == 13; });
  return spec;
}

pmac::motion::PipelineConfig whole_path_config(const MotionSetUp& s, double period_ms) {
  const double inv_accel = std::stod(fmt::format("{:.9g}", 10.0 / s.accel));   // as the program's text says it
  pmac::motion::PipelineConfig config;
  config.segment_time_ms = s.segment_ms;
  config.servo_period_ms = period_ms;
  config.map.matrix_mu_uu.assign(3 * pmac::bytecode::kAxisCount, 0);
  config.map.offset_mu.assign(3, 0);
  for (std::size_t m = 0; m < 3; ++m) {
    config.map.motors.push_back(static_cast<int>(m) + 1);
    config.map.matrix_mu_uu[m * pmac::bytecode::kAxisCount + static_cast<std::size_t>(pmac::bytecode::axis_index_from_name("X")) + m] = 1000;
    config.limits.push_back({static_cast<double>(s.max_speed), inv_accel, inv_accel, 50});
  }
  return config;
}

/// All commands of the program at once, from rest at start_ms on; positions at the ticks from there to the end.
std::vector<std::array<double, 3>> whole_path(const std::vector<pmac::motion::MotionCommand>& commands, const pmac::motion::PipelineConfig& config, double start_ms) {
  pmac::motion::Pipeline pipeline;
  pipeline.reset(config, {}, start_ms);
  for (const auto& command : commands)
    if (auto fault = pipeline.add(command)) RC_FAIL(fault->detail);
  if (auto fault = pipeline.end_sequence()) RC_FAIL(fault->detail);
  std::vector<std::array<double, 3>> rows;
  for (double tick = std::ceil(start_ms / config.servo_period_ms); tick * config.servo_period_ms <= pipeline.end_ms(); ++tick) {
    std::array<double, 3> row{};
    pipeline.sample(tick * config.servo_period_ms, row, {});
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

TEST_CASE("random motion: without lookahead a program run as it goes moves as its whole path does", "[property][motion]") {
  holds("streaming without lookahead", [] {
    const MotionSpec spec = any_blended_motion();
    const RandomMotion motion = random_motion(spec);
    std::vector<pmac::motion::MotionCommand> commands;
    const MotionRun run = run_motion(motion.text, "", "&1 b1r", [&](int, const pmac::motion::MotionCommand& command) { commands.push_back(command); });
    if (!run.fault.empty()) RC_FAIL(run.fault + "\n" + motion.text);
    if (commands.empty()) return;
    const double start_ms = run.moves.front().start_ms;
    const auto rows = whole_path(commands, whole_path_config(spec.set_up, run.period_ms), start_ms);
    const auto first = static_cast<std::size_t>(std::ceil(start_ms / run.period_ms));
    if (run.position_mu.size() < first + rows.size()) RC_FAIL("it ends earlier than its whole path\n" + motion.text);
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (std::size_t m = 0; m < 3; ++m)   // a tick's time rounds differently
        if (!(std::abs(run.position_mu[first + k][m] - rows[k][m]) <= 1e-6)) RC_FAIL("tick " + std::to_string(first + k) + ": " + std::to_string(run.position_mu[first + k][m]) + ", whole path " + std::to_string(rows[k][m]) + "\n" + motion.text);
  });
}

TEST_CASE("random motion: ends, dwells, lengths and times are those of the program", "[property][motion]") {
  holds("ends, dwells, lengths, times", [] {
    const MotionSpec spec = any_motion(2);
    const RandomMotion motion = random_motion(spec);
    const MotionRun run = run_of(motion);
    expect(wrong_end(motion, run), motion);
    expect(wrong_dwell(motion, run), motion);
    expect(wrong_lengths(motion, run), motion);
    expect(wrong_times(run), motion);
    if (!spec.set_up.lookahead) expect(wrong_pvt_times(motion, run), motion);
  });
}

TEST_CASE("random motion: position and speed are continuous", "[property][motion]") {
  holds("continuous", [] {
    const RandomMotion motion = random_motion(any_motion(0));
    if (motion.steps_in_speed) return;
    expect(step_in_motion(run_of(motion), run_of(motion, "Sys.ServoPeriod = 0.05")), motion);
  });
}

TEST_CASE("random motion: lookahead keeps the limits at servo rate", "[property][motion]") {
  holds("limits", [] {
    const MotionSpec spec = any_motion(1);
    MotionSpec on_the_path = spec;
    std::erase_if(on_the_path.items, [](const MotionItem& item) { return item.kind == 7 || item.kind == 13; });  // rapid has limits of its own, spline none
    const RandomMotion motion = random_motion(on_the_path);
    expect(broken_limit(spec.set_up, run_of(motion)), motion);
  });
}

TEST_CASE("random motion: the same bytes twice", "[property][motion]") {
  holds("the same twice", [] {
    const RandomMotion motion = random_motion(any_motion(2));
    expect(difference(run_of(motion), run_of(motion)), motion);
  });
}

TEST_CASE("random motion: a window that covers the path gives what a larger one gives", "[property][motion]") {
  holds("streaming", [] {
    MotionSpec spec = any_motion(1);
    std::erase_if(spec.items, [](const MotionItem& item) { return item.kind == 13; });
    spec.set_up.window = 20000;
    const MotionRun whole = run_of(random_motion(spec));
    // Twice the time to stop from MaxSpeed: half of it is what a stop takes on average.
    spec.set_up.window = static_cast<int>(2.0 * spec.set_up.max_speed * 10 / spec.set_up.accel / spec.set_up.segment_ms) + 20;
    const RandomMotion motion = random_motion(spec);
    const MotionRun run = run_of(motion);
    const double off = run.position_mu.size() > whole.position_mu.size() ? double(run.position_mu.size() - whole.position_mu.size()) : double(whole.position_mu.size() - run.position_mu.size());
    if (off > 1) RC_FAIL("window of " + std::to_string(spec.set_up.window) + " segments: " + std::to_string(run.position_mu.size()) + " samples, whole path " + std::to_string(whole.position_mu.size()) + "\n" + motion.text);
  });
}

TEST_CASE("random motion: overrides and holds leave ends and limits of the path alone", "[property][motion]") {
  holds("time base", [] {
    const RandomMotion motion = random_motion(any_motion(2));
    const int first = *rc::gen::inRange(1, 100), second = *rc::gen::inRange(1, 150);
    ProgramBench bench("random.pmc", motion.text + "Coord[1].TimeBaseSlew = 0.001\n");
    bench.machine->at(300, "&1%" + std::to_string(second));
    bench.machine->at(900, "&1%0");
    bench.machine->at(1900, "&1%100");
    bench.run("&1 %" + std::to_string(first) + " b1r");
    if (!bench.refusals.empty()) RC_FAIL(bench.refusals[0]);
    if (!bench.faults.empty()) RC_FAIL(bench.faults[0].fault.detail + "\n" + motion.text);
    MotionRun run;
    run.period_ms = bench.machine->servo_period_ms();
    for (const auto& row : bench.motor_mu) run.position_mu.push_back({row[1], row[2], row[3]});
    expect(wrong_end(motion, run), motion);
  });
}
