#include "runtime/acr1000/print.h"

#include <fmt/format.h>

namespace pmac::acr1000 {
namespace {

std::string motion_words(const MoveRequest& request) {
  switch (request.kind) {
    case MoveKind::kMoveTo: return fmt::format("mov to {}", request.distance);
    case MoveKind::kMoveBy: return fmt::format("mov by {}", request.distance);
    case MoveKind::kCircle: break;
  }
  const CircleArguments& c = request.circle;
  return fmt::format("circle {} R{} I{} J{} length {} P29={}{}", c.rot > 0 ? "cw" : "ccw", c.radius, c.i, c.j, c.distance, request.end_point,
                     request.end_point_is_relative ? " from the start" : "");
}

const char* phase_name(std::size_t phase, const SpeedPhase& p) {
  if (phase == 2) return "stop";
  return phase == 1 ? "even" : p.accel_pulses_s2 < 0 ? "slower" : "faster";
}

}  // namespace

std::string command_header() { return "# card line start_s motion P28 VEL ACC DEC STP [coordinated move]"; }
std::string path_header() { return "# card line phase start_s duration_s master_pulses master_pulses_s end_pulses"; }

std::string command_text(const std::string& card, const PlannedMove& move, std::uint64_t coordinated) {
  const RateSettings& r = move.request.rates;
  const std::string together = coordinated > 0 ? fmt::format(" move {}", coordinated) : "";
  return fmt::format("{} {} {} {} P28={} VEL={} ACC={} DEC={} STP={}{}", card, text_of(move.request.place), move.start_s, motion_words(move.request),
                     move.request.master_length, r.vel, r.acc, r.dec, r.stp, together);
}

std::string path_text(const std::string& card, const PlannedMove& move) {
  std::string text;
  double start_s = 0, master = 0;
  for (std::size_t k = 0; k < move.profile.phase.size(); ++k) {
    const SpeedPhase& phase = move.profile.phase[k];
    if (phase.duration_s <= 0) continue;
    master += phase.length_pulses();
    const double end_speed = phase.start_speed_pulses_s + phase.accel_pulses_s2 * phase.duration_s;
    text += fmt::format("{} {} {} {} {} {} {} {}\n", card, text_of(move.request.place), phase_name(k, phase), move.start_s + start_s, phase.duration_s, master, end_speed,
                        path_at(move, move.start_s + start_s + phase.duration_s).position_pulses);
    start_s += phase.duration_s;
  }
  if (text.empty()) text = fmt::format("{} {} nothing {} 0 0 0 {}\n", card, text_of(move.request.place), move.start_s, move.law.end_pulses);
  text.pop_back();
  return text;
}

}  // namespace pmac::acr1000
