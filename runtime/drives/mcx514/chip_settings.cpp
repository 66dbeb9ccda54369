// Commands that write data, read it back, or act on what runs.
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "runtime/drives/mcx514/chip_state.h"

namespace pmac::drives::mcx514 {

/// WR7 and WR6 as the command takes them: signed, where its range is.
std::int64_t Chip::data(const Command& command) const {
  if (command.data_bytes == 2) return command.least < 0 ? static_cast<std::int16_t>(latch_low_) : latch_low_;
  const std::uint32_t both = static_cast<std::uint32_t>(latch_high_) << 16 | latch_low_;
  const bool is_unsigned = command.most > std::numeric_limits<std::int32_t>::max();
  return is_unsigned ? static_cast<std::int64_t>(both) : static_cast<std::int32_t>(both);
}

namespace {

std::string out_of_range(const Command& command, std::int64_t value) {
  return fmt::format("{} is out of range for {:02X}h ({}): {} to {}", value, command.code, command.meaning, command.least, command.most);
}

bool fits(const Command& command, std::int64_t value) { return value >= command.least && value <= command.most; }

}  // namespace

void Chip::set_data(const Command& command, std::uint32_t axes, Place place) {
  const std::int64_t value = data(command);
  if (!fits(command, value)) return error(place, out_of_range(command, value));
  const bool is_segment_data = command.code == code::kTP || command.code == code::kCP;
  if (interpolation_ && is_segment_data && (axes & mode_axes()) != 0) {
    fresh_segment_data_ = true;
    fresh_place_ = place;
  }
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (!has_axis(axes, axis)) continue;
    if (command.code == code::kLP) position_[axis] = value;
    else if (command.code == code::kRP) (*axes_)[axis].real_position = value;
    else (*axes_)[axis].settings[command.code] = {true, value, place};
    if (command.code == code::kDV) change_drive_speed(axis, value);
  }
}

/// Of a drive that runs under this axis' speed.
void Chip::change_drive_speed(std::size_t axis, std::int64_t pps) {
  if (single_[axis]) single_[axis]->speed.change_drive_speed(pps);
  if (interpolation_ && (mode_axes() & -mode_axes()) == 1u << axis) interpolation_->speed.change_drive_speed(pps);
}

void Chip::set_common(const Command& command, Place place) {
  const std::int64_t value = data(command);
  if (!fits(command, value)) return error(place, out_of_range(command, value));
  switch (command.code) {
    case code::kTX: max_finish_ = {true, value, place}; return;
    case code::kHLN: rotations_ = {true, value, place}; return;
    case code::kHLV: helix_value_ = {true, value, place}; return;
    default: return set_mode(static_cast<std::uint16_t>(value), place);
  }
}

void Chip::set_mode(std::uint16_t mode, Place place) {
  if (interpolation_) {
    refused_mode_line_ = place.line;
    return error(place, "the interpolation mode is written while an interpolation drive runs; wait idle before");
  }
  refused_mode_line_ = 0;
  if ((mode & 0x2020u) != 0) return error(place, fmt::format("interpolation mode {:04X}h: D5 and D13 are 0", mode));
  if ((mode & 0x0c00u) != 0) error(place, "interpolation over several chips (D11-D10 of the interpolation mode) is not simulated");
  if ((mode & 0x0200u) != 0) error(place, "single-step interpolation (D9 of the interpolation mode) is not simulated");
  if ((mode & 0x0100u) != 0) error(place, "short axis pulse equalisation (D8 of the interpolation mode) is not simulated");
  if ((mode & 0xc000u) != 0) warn_once("interrupt", place, "the simulated chip raises no interrupts (D15, D14 of the interpolation mode)");
  mode_ = {true, mode & 0x10df, place};
  axes_used_ |= mode_axes();
}

void Chip::read_data(const Command& command, std::uint32_t axes, Place place) {
  std::size_t axis = 0;
  while (axis + 1 < kAxes && !has_axis(axes, axis)) ++axis;
  const Axis& a = (*axes_)[axis];
  const auto setting = [&a](std::uint8_t code) { return a.get(code).value; };
  std::int64_t value = 0;
  switch (command.code) {
    case code::kRLP: value = position_[axis]; break;
    case code::kRRP: value = a.real_position; break;
    case code::kRCV: {
      const Running* running = single_[axis] ? single_[axis].get() : interpolation_ && has_axis(interpolation_->record.axes, axis) ? interpolation_.get() : nullptr;
      value = running ? std::llround(running->speed.now_pps()) : 0;
      break;
    }
    case code::kRMR0: case code::kRMR1: case code::kRMR2: case code::kRMR3:
      value = setting(static_cast<std::uint8_t>(code::kMR0 + (command.code - code::kRMR0)));
      break;
    case code::kRTX: value = max_finish_.value; break;
    case code::kRHLN: value = rotations_.value; break;
    case code::kRHLV: value = helix_value_.value; break;
    case code::kRWR1: case code::kRWR2: case code::kRWR3: value = a.mode[static_cast<std::size_t>(1 + command.code - code::kRWR1)]; break;
    case code::kRMRM: case code::kRP1M: case code::kRP2M: value = setting(static_cast<std::uint8_t>(code::kMRM + (command.code - code::kRMRM))); break;
    case code::kRAC: value = setting(code::kAC); break;
    case code::kRSV: value = setting(code::kSV); break;
    case code::kRDV: value = setting(code::kDV); break;
    case code::kRTP: value = setting(code::kTP); break;
    case code::kRSP1: value = setting(code::kSP1); break;
    default: return error(place, fmt::format("{:02X}h ({}) is not simulated", command.code, command.meaning));
  }
  result_low_ = static_cast<std::uint16_t>(value & 0xffff);
  result_high_ = static_cast<std::uint16_t>(value >> 16 & 0xffff);
}

void Chip::act(const Command& command, std::uint32_t axes, Place place) {
  switch (command.code) {
    case code::kDSTOP: case code::kISTOP: return stop_axes(command, axes);
    case code::kDECEN: case code::kDECDIS:
      decelerates_ = command.code == code::kDECEN;
      if (interpolation_) set_deceleration(*interpolation_);
      return;
    case code::kTXCLR: max_finish_ = {}; return;
    case code::kR2CLR:
      for (std::size_t axis = 0; axis < kAxes; ++axis)
        if (has_axis(axes, axis)) (*axes_)[axis].status = 0;
      return;
    case code::kVINC: case code::kVDEC:
      for (std::size_t axis = 0; axis < kAxes; ++axis) {
        if (!has_axis(axes, axis)) continue;
        const Setting& step = (*axes_)[axis].get(code::kIV);
        Setting& drive = (*axes_)[axis].settings[code::kDV];
        if (!step.set || !drive.set) {
          error(place, fmt::format("axis {} has no {}", axis_name(axis), step.set ? "drive speed (05h)" : "speed step (15h)"));
          continue;
        }
        drive.value = std::clamp<std::int64_t>(drive.value + (command.code == code::kVINC ? step.value : -step.value), 1, 8'000'000);
        change_drive_speed(axis, drive.value);
      }
      return;
    case code::kRST: return reset();
    default: return;  // selection of axes, pages of RR3
  }
}

void Chip::stop_axes(const Command& command, std::uint32_t axes) {
  const bool at_once = command.code == code::kISTOP;
  const auto stop = [&](std::unique_ptr<Running>& drive) {
    drive->speed.begin_stop();
    if (at_once || drive->speed.finished()) end_now(drive, at_once ? Stop::kInstant : Stop::kDecelerated);
  };
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    if (has_axis(axes, axis) && single_[axis]) stop(single_[axis]);
  if (!interpolation_ || (interpolation_->record.axes & axes) == 0) return;
  queue_.clear();
  fresh_segment_data_ = false;
  stop(interpolation_);
}

void Chip::reset() {
  for (std::unique_ptr<Running>& drive : single_)
    if (drive) end_now(drive, Stop::kInstant);
  queue_.clear();
  if (interpolation_) end_now(interpolation_, Stop::kInstant);
  *axes_ = {};
  mode_ = max_finish_ = rotations_ = helix_value_ = {};
  latch_low_ = latch_high_ = result_low_ = result_high_ = 0;
  selected_ = 1;
  decelerates_ = fresh_segment_data_ = false;
  position_ = {};
}

}  // namespace pmac::drives::mcx514
