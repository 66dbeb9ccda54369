// Retracing: the stored path is run through backwards and forwards again. The clock of the coordinate system stands at the place that the
// program has come to, and the path position lies behind it by back_ms_; so all that happens once on the way (moves, synchronous
// assignments) has happened, and does not happen again.
//
//   path position   ____                 ____/        the clock
//                  /    \_            __/
//                 /        \__________/              < quick stop, back ... > forward
//
// Rates are shaped as a quick stop is (quick_stop.cpp): the lookahead's limits hold backwards as well. Without lookahead (LHDistance 1)
// they change by FeedHoldSlew. Source: User's Manual p692-694; the stored path begins where motion last came to rest for a dwell, a rapid
// move or the like, or as many segments back as the buffer holds beyond LHDistance [assumed].
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/state.h"

namespace pmac::runtime {

using bytecode::ElementId;

/// Programmed time of the segments that are stored behind the place of motion.
double CoordSystem::stored_ms() const {
  const auto cs = static_cast<unsigned>(number_);
  const double segments = lookahead_buffer - machine_.elements.get(ElementId::kCoordLHDistance, cs);
  const bool on = machine_.elements.get(ElementId::kCoordLHDistance, cs) > 0;
  return on ? std::max(0.0, segments) * machine_.elements.get(ElementId::kCoordSegMoveTime, cs) : 0;
}

/// What is stored, and the way that motion needs to come to rest behind it.
double CoordSystem::history_wanted_ms() const {
  constexpr double kStops = 4;  // stopping times of the slowest motor: on a curve less than its whole limit is left for stopping
  if (stored_ms() == 0) return 0;
  const ElementStore& e = machine_.elements;
  const double slew_ms = e.get(ElementId::kCoordFeedHoldSlew, static_cast<unsigned>(number_));
  double reserve_ms = slew_ms > 0 ? machine_.period_ms() * machine_.period_ms() / slew_ms : 0;
  for (int motor : motors_) {
    const auto n = static_cast<unsigned>(motor);
    reserve_ms = std::max(reserve_ms, kStops * e.get(ElementId::kMotorMaxSpeed, n) * e.get(ElementId::kMotorInvAmax, n));
  }
  return stored_ms() + reserve_ms;
}

double CoordSystem::path_position(double time_ms) const {
  const double clock_ms = time_base_.path_at(time_ms);
  return retracing() ? clock_ms + std::min(0.0, back_ms_ + back_rate_ * (time_ms - back_from_ms_)) : clock_ms;
}

void CoordSystem::forget_retrace() {
  back_ms_ = back_rate_ = back_from_ms_ = 0;
  shaped_by_slew_ = false;
}

std::string CoordSystem::retrace(double time_ms) {
  if (!program_running() || !on_path_)
    return fmt::format("error #39: NOT READY TO RUN: coordinate system {} is on no path that could be retraced", number_);
  if (stored_ms() == 0)
    return fmt::format("error #39: NOT READY TO RUN: no path is stored to retrace; it takes Coord[{}].SegMoveTime above 0, LHDistance above 0 "
                       "and define lookahead with more segments than LHDistance", number_);
  double slope_per_ms = 0;
  if (!lookahead_)
    if (std::string refusal = slope_of(ElementId::kCoordFeedHoldSlew, slope_per_ms); !refusal.empty()) return refusal;
  if (shaping_ == Shaping::kBack) return {};
  shaped_by_slew_ = !lookahead_;
  retrace_to_ms_ = pipeline_.history_start_ms(time_base_.path_at(time_ms), stored_ms());
  quick_stopped_ = false;
  begin_shaping(Shaping::kBack);
  return {};
}

std::string CoordSystem::forward_on_path(double time_ms) {
  if (!retracing()) return resume(time_ms);
  shaped_by_slew_ = !lookahead_;
  quick_stopped_ = false;
  if (shaping_ != Shaping::kFaster) begin_shaping(Shaping::kFaster);
  return {};
}

}  // namespace pmac::runtime
