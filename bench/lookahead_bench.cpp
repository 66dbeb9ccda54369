// What the lookahead costs, per segment of 5 ms: a closed contour of lines and arcs as the segmenter makes it, laps long, in two and three
// axes; once within the limits (F50), once held back by them nearly everywhere (F200). The goal is 150 ns.
#include <cmath>
#include <numbers>

#include <benchmark/benchmark.h>

#include "runtime/motion/lookahead.h"

namespace {

using namespace pmac::motion;

constexpr double kSegment_ms = 5, kScale_mu_mm = 1000, kSide_mm = 40, kRadius_mm = 5, kWindow_ms = 200 * kSegment_ms, kServo_ms = 0.44274211;
constexpr int kLaps = 20;

struct Point { double x, y, vx, vy; };   // mm, and along the path

/// Place on a square with rounded corners, `way` mm from its start.
Point on_contour(double way) {
  const double arc = kRadius_mm * std::numbers::pi / 2, quarter = kSide_mm + arc;
  const int corner = static_cast<int>(way / quarter) % 4;
  const double along = std::fmod(way, quarter), heading = corner * std::numbers::pi / 2;
  const double turn = along < kSide_mm ? 0 : (along - kSide_mm) / kRadius_mm;
  const double forward = std::min(along, kSide_mm) + kRadius_mm * std::sin(turn), left = kRadius_mm * (1 - std::cos(turn));
  double x = 0, y = 0;
  for (int i = 0; i < corner; ++i) {
    x += (kSide_mm + kRadius_mm) * std::cos(i * std::numbers::pi / 2) - kRadius_mm * std::sin(i * std::numbers::pi / 2);
    y += (kSide_mm + kRadius_mm) * std::sin(i * std::numbers::pi / 2) + kRadius_mm * std::cos(i * std::numbers::pi / 2);
  }
  return {x + forward * std::cos(heading) - left * std::sin(heading), y + forward * std::sin(heading) + left * std::cos(heading),
          std::cos(heading + turn), std::sin(heading + turn)};
}

/// The third axis, where there is one, goes up and down in step with the first.
std::vector<Segment> contour(double feed_mm_s, std::size_t axes) {
  const double step_mm = feed_mm_s * kSegment_ms / 1000, lap_mm = 4 * kSide_mm + 2 * std::numbers::pi * kRadius_mm;
  const double speed = feed_mm_s * kScale_mu_mm / 1000;
  std::vector<Segment> segments(static_cast<std::size_t>(kLaps * lap_mm / step_mm));
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Point from = on_contour(static_cast<double>(i) * step_mm), to = on_contour(static_cast<double>(i + 1) * step_mm);
    const MotorCubic x = hermite_cubic(from.x * kScale_mu_mm, from.vx * speed, to.x * kScale_mu_mm, to.vx * speed, kSegment_ms);
    const MotorCubic y = hermite_cubic(from.y * kScale_mu_mm, from.vy * speed, to.y * kScale_mu_mm, to.vy * speed, kSegment_ms);
    Segment& segment = segments[i];
    segment.start_ms = static_cast<double>(i) * kSegment_ms;
    segment.duration_ms = kSegment_ms;
    segment.motor = {x, y};
    if (axes > 2) segment.motor.push_back({x.c0 / 2, x.c1 / 2, x.c2 / 2, x.c3 / 2});
  }
  return segments;
}

void plan_contour(benchmark::State& state) {
  const auto axes = static_cast<std::size_t>(state.range(0));
  const std::vector<Segment> segments = contour(static_cast<double>(state.range(1)), axes);
  std::vector<MotorLimits> limits(axes);
  for (MotorLimits& limit : limits) limit.max_speed_mu_ms = 500, limit.inv_amax_ms2_mu = 1;
  std::vector<TimedSegment> out;
  for (auto _ : state) {
    Lookahead lookahead(limits, kWindow_ms, kServo_ms);
    for (const Segment& segment : segments) {
      lookahead.add(segment, out);
      out.clear();
    }
    lookahead.finish(out);
    out.clear();
  }
  state.counters["per_segment"] = benchmark::Counter(static_cast<double>(segments.size()),
                                                     benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(plan_contour)->ArgNames({"axes", "feed_mm_s"})->ArgsProduct({{2, 3}, {50, 200}})->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
