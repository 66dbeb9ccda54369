// Registers and the distribution of commands. What settings and reads do is in chip_settings.cpp, drive commands in chip_drives.cpp, the
// pulses in chip_run.cpp.
#include "runtime/drives/mcx514/chip.h"

#include <algorithm>

#include <fmt/format.h>

#include "runtime/drives/mcx514/chip_state.h"

namespace pmac::drives::mcx514 {

std::string axes_text(std::uint32_t mask) {
  std::string text;
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    if (has_axis(mask, axis)) text += (text.empty() ? "" : ", ") + axis_name(axis);
  return text.empty() ? "no axis" : text;
}

Chip::Chip() : axes_(std::make_unique<std::array<Axis, kAxes>>()) {}
Chip::~Chip() = default;

void Chip::problem(bool is_error, Place place, std::string text) { problems_.push_back({is_error, place.line, place.column, std::move(text)}); }

void Chip::warn_once(const std::string& key, Place place, std::string text) {
  if (std::find(warned_.begin(), warned_.end(), key) != warned_.end()) return;
  warned_.push_back(key);
  problem(false, place, std::move(text));
}

namespace {

constexpr const char* kModeRegisterWarning[4] = {
    "", "WR1 is kept; the simulated chip raises no interrupts", "WR2 is kept; no stop, limit or alarm inputs are connected to the simulated chip",
    "WR3 is kept; the simulated chip knows constant speed and straight ramps with automatic deceleration, whatever WR3 says"};

}  // namespace

void Chip::write(int reg, std::uint16_t value, Place place) {
  switch (reg) {
    case 0: return command(value, place);
    case 4: case 5: outputs_[static_cast<std::size_t>(reg - 4)] = value; return;
    case 6: latch_low_ = value; return;
    case 7: latch_high_ = value; return;
    default: break;
  }
  if (value != 0) warn_once(fmt::format("WR{}", reg), place, kModeRegisterWarning[reg]);
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    if (has_axis(selected_, axis)) (*axes_)[axis].mode[static_cast<std::size_t>(reg)] = value;
}

void Chip::command(std::uint16_t value, Place place) {
  const auto code = static_cast<std::uint8_t>(value & 0xff);
  const std::uint32_t axes = value >> 8 & 0xfu;
  if ((value & 0xf000u) != 0) return error(place, fmt::format("{:04X}h is no command: D15 to D12 of WR0 are 0", value));
  const Command* known = find_command(code);
  if (known == nullptr) return error(place, fmt::format("there is no command {:02X}h", code));
  if (axes != 0) selected_ = axes;
  execute(*known, axes, place);
}

namespace {

bool needs_axes(CommandKind kind) {
  return kind == CommandKind::kSetting || kind == CommandKind::kStored || kind == CommandKind::kRead || kind == CommandKind::kAxisDrive ||
         kind == CommandKind::kAxisAction;
}

bool refuses_axes(const Command& command) {
  return command.kind == CommandKind::kInterpolation || command.code == code::kIPM || command.code == code::kDECEN || command.code == code::kDECDIS;
}

}  // namespace

bool Chip::check_axes(const Command& command, std::uint32_t axes, Place place) {
  if (needs_axes(command.kind) && axes == 0 && command.code != code::kNOP) {
    error(place, fmt::format("{:02X}h ({}) names no axis; set D8 (X) to D11 (U) of WR0", command.code, command.meaning));
    return false;
  }
  if (refuses_axes(command) && axes != 0) {
    error(place, fmt::format("{:02X}h ({}) takes no axis bits; write {:04X}h", command.code, command.meaning, command.code));
    return false;
  }
  if (command.kind == CommandKind::kRead && (axes & (axes - 1)) != 0) {
    error(place, fmt::format("{:02X}h reads one axis, not {}", command.code, axes_text(axes)));
    return false;
  }
  return true;
}

void Chip::execute(const Command& command, std::uint32_t axes, Place place) {
  if (!check_axes(command, axes, place)) return;
  switch (command.kind) {
    case CommandKind::kStored:
      warn_once(std::string(command.name), place, fmt::format("{:02X}h ({}) is kept; the simulated chip does not act on it", command.code, command.meaning));
      return set_data(command, axes, place);
    case CommandKind::kSetting: return set_data(command, axes, place);
    case CommandKind::kCommonSetting: return set_common(command, place);
    case CommandKind::kRead: case CommandKind::kCommonRead: return read_data(command, axes, place);
    case CommandKind::kAxisDrive: return start_axes(command, axes, place);
    case CommandKind::kInterpolation:
      if (command.code == code::kHLPCW || command.code == code::kHLPCCW) return calculate_helix(command, place);
      return start_interpolation(command, place);
    case CommandKind::kAxisAction: case CommandKind::kCommonAction: return act(command, axes, place);
    case CommandKind::kNotSimulated:
      return error(place, fmt::format("{:02X}h ({}) is not simulated", command.code, command.meaning));
  }
}

bool Chip::driving() const {
  return interpolation_ != nullptr || std::any_of(single_.begin(), single_.end(), [](const auto& drive) { return drive != nullptr; });
}

bool Chip::drives_endlessly() const {
  return std::any_of(single_.begin(), single_.end(), [](const auto& drive) {
    return drive && (drive->segment.code == code::kCONTP || drive->segment.code == code::kCONTM);
  });
}

bool Chip::error_pending() const {
  return std::any_of(axes_->begin(), axes_->end(), [](const Axis& axis) { return axis.status != 0; });
}

std::uint16_t Chip::read(int reg, Place place) {
  std::uint32_t value = 0;
  const auto selected = [this] {
    for (std::size_t axis = 0; axis < kAxes; ++axis)
      if (has_axis(selected_, axis)) return axis;
    return std::size_t{0};
  };
  switch (reg) {
    case 0:
      for (std::size_t axis = 0; axis < kAxes; ++axis) {
        const bool interpolates = interpolation_ && has_axis(interpolation_->record.axes, axis);
        if (single_[axis] || interpolates) value |= 1u << axis;
        if ((*axes_)[axis].status != 0) value |= 0x10u << axis;
      }
      if (interpolation_) {
        const std::vector<int>& quadrants = interpolation_->segment.pulses->quadrants();
        if (!quadrants.empty()) value |= static_cast<std::uint32_t>(quadrants.back()) << 8;
        if (queue_.size() < kPreBuffer) value |= 1u << 11;
        value |= static_cast<std::uint32_t>(queue_.size()) << 12;
      }
      break;
    case 2: value = (*axes_)[selected()].status; break;
    case 3: error(place, "RR3 is not simulated: no inputs are connected, and drive states are in RR0"); break;
    case 6: value = result_low_; break;
    case 7: value = result_high_; break;
    default: break;  // RR1: no interrupts; RR4, RR5: no inputs
  }
  reads_.push_back({now_, place, reg, static_cast<std::uint16_t>(value)});
  return static_cast<std::uint16_t>(value);
}

}  // namespace pmac::drives::mcx514
