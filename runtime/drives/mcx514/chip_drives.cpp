// Drive commands: what they need to be set, and the drives that come of them.
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "runtime/drives/mcx514/arc.h"
#include "runtime/drives/mcx514/chip_state.h"
#include "runtime/drives/mcx514/line.h"

namespace pmac::drives::mcx514 {
namespace {

std::string named(const Command& command) { return fmt::format("{:02X}h ({})", command.code, command.meaning); }

int count_of(std::uint32_t mask) {
  int count = 0;
  for (; mask != 0; mask &= mask - 1) ++count;
  return count;
}

int lowest_of(std::uint32_t mask) {
  int axis = 0;
  while (axis < kAxes && !has_axis(mask, static_cast<std::size_t>(axis))) ++axis;
  return axis;
}

bool is_arc(std::uint8_t code) { return code == code::kCHKCW || code == code::kCHKCCW; }
bool is_helix(std::uint8_t code) { return code >= code::kHLCW && code <= code::kHLPCCW; }
bool is_pattern(std::uint8_t code) { return code >= code::kBHK2 && code <= code::kBHK4; }
bool is_clockwise(std::uint8_t code) { return code == code::kCHKCW || code == code::kHLCW || code == code::kHLPCW; }

/// 2 for 61h, 64h, 65h, 66h; 3 for 62h, 67h; 4 for 63h, 68h.
int axes_wanted(std::uint8_t code) {
  if (is_arc(code)) return 2;
  return 2 + (is_pattern(code) ? code - code::kBHK2 : code - code::kLHK2);
}

}  // namespace

bool Chip::check_speed(std::size_t axis, const Command& command, Place place, SpeedSetting& setting) {
  const Axis& a = (*axes_)[axis];
  const Setting &sv = a.get(code::kSV), &dv = a.get(code::kDV), &ac = a.get(code::kAC), &dc = a.get(code::kDC);
  const char* missing = !dv.set ? "drive speed (05h)" : !sv.set ? "initial speed (04h)" : nullptr;
  if (missing == nullptr && sv.value < dv.value && !ac.set) missing = "acceleration (02h), which it needs because the initial speed is below the drive speed";
  if (missing != nullptr) {
    error(place, fmt::format("{}: axis {} has no {}", named(command), axis_name(axis), missing));
    return false;
  }
  setting.initial_pps = sv.value;
  setting.drive_pps = dv.value;
  setting.accel_pps2 = ac.value;
  setting.decel_pps2 = dc.value;
  return true;
}

bool Chip::check_finish(std::size_t axis, Place place) {
  const Setting& finish = (*axes_)[axis].get(code::kTP);
  if (!finish.set) {
    error(place, fmt::format("axis {} has no finish point; write it by {}06h", axis_name(axis), 1 << axis));
    return false;
  }
  if (std::abs(finish.value) <= kLargestDistance) return true;
  error(finish.place, fmt::format("{} is out of range for a finish point: -1073741823 to 1073741823", finish.value));
  return false;
}

// --- single axes --------------------------------------------------------------------------------------------------------------------

void Chip::start_axes(const Command& command, std::uint32_t axes, Place place) {
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    if (has_axis(axes, axis)) start_axis(command, axis, place);
}

void Chip::start_axis(const Command& command, std::size_t axis, Place place) {
  axes_used_ |= 1u << axis;
  const Running* busy = single_[axis] ? single_[axis].get() : interpolation_ && has_axis(interpolation_->record.axes, axis) ? interpolation_.get() : nullptr;
  if (busy != nullptr)
    return error(place, fmt::format("drive command while driving: axis {} drives since line {}; wait idle before", axis_name(axis), busy->record.place.line));
  SpeedSetting speed;
  if (!check_speed(axis, command, place, speed)) return;
  speed.decelerates = true;
  Segment segment;
  segment.code = command.code;
  segment.axes = 1u << axis;
  segment.place = place;
  if (command.code == code::kCONTP || command.code == code::kCONTM) {
    segment.pulses = std::make_unique<Endless>(static_cast<int>(axis), command.code == code::kCONTP ? 1 : -1);
  } else {
    const Setting& pulses = (*axes_)[axis].get(code::kTP);
    if (!pulses.set) return error(place, fmt::format("{}: axis {} has no pulse number; write it by {}06h", named(command), axis_name(axis), 1 << axis));
    AxisCounts finish{};
    finish[axis] = command.code == code::kREL ? pulses.value : command.code == code::kCREL ? -pulses.value : pulses.value - position_[axis];
    segment.pulses = std::make_unique<Line>(finish);
    if (segment.pulses->done()) return problem(false, place, fmt::format("{} of axis {} has no pulses to make", named(command), axis_name(axis)));
  }
  begin(std::move(segment), speed);
}

// --- interpolation ------------------------------------------------------------------------------------------------------------------

/// Axes and vector speed of the interpolation mode suit the command.
bool Chip::check_mode(const Command& command, Place place) {
  const auto refuse = [&](const std::string& why) {
    error(place, fmt::format("{}: {}", named(command), why));
    return false;
  };
  if (!mode_.set) return refuse("the interpolation mode (2Ah) has not been written");
  const int enabled = count_of(mode_axes());
  if (is_helix(command.code)) {
    if ((mode_axes() & 3u) != 3u || enabled < 3) return refuse(fmt::format("the interpolation mode enables {}; X, Y and Z or U or both are wanted", axes_text(mode_axes())));
  } else if (enabled != axes_wanted(command.code)) {
    return refuse(fmt::format("the interpolation mode enables {}; {} axes are wanted", axes_text(mode_axes()), axes_wanted(command.code)));
  }
  const VectorSpeed vector = vector_speed();
  const bool of_two = vector == VectorSpeed::kTwoAxes || vector == VectorSpeed::kTwoAxesAccurate;
  if (of_two && enabled > 2 && !is_helix(command.code)) return refuse("constant vector speed of 2 axes (D7-D6) with more axes is not simulated; use 3 axes (10) or off (00)");
  if (vector == VectorSpeed::kThreeAxes && enabled > 3 && !is_helix(command.code)) return refuse("constant vector speed of 3 axes (D7-D6) with 4 axes is not simulated; switch it off (00)");
  return true;
}

struct Chip::ArcData : ArcSetting {};

std::optional<Chip::ArcData> Chip::arc_data(const Command& command, int first, int second, Place place) {
  ArcData data;
  data.clockwise = is_clockwise(command.code);
  const bool swapped = (mode_.value & 0x10) != 0;
  data.axis = swapped ? std::array<int, 2>{second, first} : std::array<int, 2>{first, second};
  const auto axis = [&](int i) { return static_cast<std::size_t>(data.axis[static_cast<std::size_t>(i)]); };
  bool good = true;
  for (int i = 0; i < 2; ++i) {
    good = check_finish(axis(i), place) && good;
    if ((*axes_)[axis(i)].get(code::kCP).set) continue;
    error(place, fmt::format("axis {} has no circular centre; write it by {}08h", axis_name(axis(i)), 1 << axis(i)));
    good = false;
  }
  if (!good) return std::nullopt;
  data.center = {(*axes_)[axis(0)].get(code::kCP).value, (*axes_)[axis(1)].get(code::kCP).value};
  data.finish = {(*axes_)[axis(0)].get(code::kTP).value, (*axes_)[axis(1)].get(code::kTP).value};
  if (data.center.ax1 != 0 || data.center.ax2 != 0) return data;
  error(place, fmt::format("{}: the circular centre is (0,0), the start point itself", named(command)));
  return std::nullopt;
}

std::unique_ptr<Interpolator> Chip::make_arc(const Command& command, Place place) {
  const int first = lowest_of(mode_axes()), second = lowest_of(mode_axes() & (mode_axes() - 1));
  const auto data = arc_data(command, first, second, place);
  if (!data) return nullptr;
  const bool is_full = data->finish.ax1 == 0 && data->finish.ax2 == 0;
  const double off = is_full ? 0 : finish_off_circle(*data);
  if (std::abs(off) > 1) problem(false, place, fmt::format("the finish point lies {:.2f} pulses {} the circle; the drive ends where the short axis reaches it", std::abs(off), off > 0 ? "outside" : "inside"));
  return std::make_unique<Arc>(*data);
}

void Chip::calculate_helix(const Command& command, Place place) {
  if (!check_mode(command, place)) return;
  auto data = arc_data(command, 0, 1, place);
  if (!data) return;
  data->further_turns = static_cast<int>(rotations_.value);
  helix_value_ = {true, static_cast<std::int64_t>(Arc(*data).remaining()), place};
}

std::unique_ptr<Interpolator> Chip::make_helix(const Command& command, Place place) {
  auto data = arc_data(command, 0, 1, place);
  AxisCounts along{};
  bool good = data.has_value();
  for (std::size_t axis = 2; axis < kAxes; ++axis) {
    if (!has_axis(mode_axes(), axis)) continue;
    if (!check_finish(axis, place)) good = false;
    else along[axis] = (*axes_)[axis].get(code::kTP).value;
  }
  if (!helix_value_.set) {
    error(place, fmt::format("{}: there is no helical calculation value; let {} calculate it, or write it by 1Bh", named(command), is_clockwise(command.code) ? "006Bh" : "006Ch"));
    good = false;
  }
  for (std::size_t axis = 2; good && axis < kAxes; ++axis)
    if (std::abs(along[axis]) > helix_value_.value) {
      error(place, fmt::format("{}: {} pulses of axis {} in {} events of the circle; there may be no more than one an event", named(command), std::abs(along[axis]), axis_name(axis), helix_value_.value));
      good = false;
    }
  if (!good) return nullptr;
  data->further_turns = static_cast<int>(rotations_.value);
  const auto events = static_cast<std::int64_t>(Arc(*data).remaining());
  if (events != helix_value_.value) problem(false, place, fmt::format("the helical calculation value is {}, the circle has {} events; the other axes do not end with it", helix_value_.value, events));
  return std::make_unique<Helix>(*data, along, helix_value_.value);
}

std::unique_ptr<Interpolator> Chip::make_line(const Command& command, Place place) {
  AxisCounts finish{};
  bool good = true;
  std::int64_t longest = 0;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (!has_axis(mode_axes(), axis)) continue;
    if (!check_finish(axis, place)) good = false;
    else finish[axis] = (*axes_)[axis].get(code::kTP).value;
    longest = std::max(longest, std::abs(finish[axis]));
  }
  const bool manual = (mode_.value & 0x1000) != 0;
  if (good && manual && (!max_finish_.set || max_finish_.value < longest)) {
    error(place, max_finish_.set ? fmt::format("the maximum finish point (19h) is {}, less than the {} pulses of an axis", max_finish_.value, longest)
                                 : "D12 of the interpolation mode wants a maximum finish point; write it by 0019h");
    good = false;
  }
  if (!good) return nullptr;
  if (longest == 0) problem(false, place, fmt::format("{} has no pulses to make", named(command)));
  return std::make_unique<Line>(finish, manual ? max_finish_.value : 0);
}

std::unique_ptr<Interpolator> Chip::make_pattern() {
  std::array<BitPattern::Bits, kAxes> bits{};
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const auto both = static_cast<std::uint32_t>((*axes_)[axis].get(code::kTP).value);
    if (has_axis(mode_axes(), axis)) bits[axis] = {static_cast<std::uint16_t>(both & 0xffff), static_cast<std::uint16_t>(both >> 16)};
  }
  return std::make_unique<BitPattern>(bits);
}

std::unique_ptr<Interpolator> Chip::make_interpolator(const Command& command, Place place) {
  if (is_arc(command.code)) return make_arc(command, place);
  if (is_helix(command.code)) return make_helix(command, place);
  if (is_pattern(command.code)) return make_pattern();
  return make_line(command, place);
}

void Chip::start_interpolation(const Command& command, Place place) {
  if (error_pending()) return error(place, fmt::format("{}: an error is pending in RR2; clear it by {:X}79h", named(command), mode_axes()));
  if (!check_mode(command, place)) return;
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    if (has_axis(mode_axes(), axis) && single_[axis])
      return error(place, fmt::format("drive command while driving: axis {} drives since line {}; wait idle before", axis_name(axis), single_[axis]->record.place.line));
  if (interpolation_ && refused_mode_line_ > 0)
    return error(place, fmt::format("drive command while driving: {} interpolate since line {}, and the mode of line {} could not be taken; wait idle before",
                                    axes_text(mode_axes()), interpolation_->record.place.line, refused_mode_line_));
  if (interpolation_ && !fresh_segment_data_)
    return error(place, fmt::format("drive command while driving: {} interpolate since line {}, and no finish point has been written for a next segment; wait idle before",
                                    axes_text(mode_axes()), interpolation_->record.place.line));
  if (queue_.size() >= kPreBuffer)
    return error(place, fmt::format("drive command while driving: the pre-buffer is full with {} segments; wait next before", kPreBuffer));
  SpeedSetting speed;
  const bool has_speed = check_speed(static_cast<std::size_t>(lowest_of(mode_axes())), command, place, speed);
  std::unique_ptr<Interpolator> pulses = make_interpolator(command, place);
  if (!has_speed || !pulses) return;
  if (interpolation_ && speed.drive_pps > kContinuousLimit_pps)
    return error(place, fmt::format("continuous interpolation at {} pulses/s; the limit is {}", speed.drive_pps, kContinuousLimit_pps));
  speed.vector = vector_speed();
  speed.decelerates = decelerates_;
  fresh_segment_data_ = false;
  const std::uint32_t stretching = is_helix(command.code) && speed.vector != VectorSpeed::kThreeAxes ? 3u : mode_axes();
  Segment segment{std::move(pulses), command.code, mode_axes(), stretching, place};
  if (!interpolation_) return begin(std::move(segment), speed);
  interpolation_->remaining += interpolation_->counts_remaining ? segment.pulses->remaining() : 0;
  queue_.push_back(std::move(segment));
}

}  // namespace pmac::drives::mcx514
