#include "runtime/drives/silverlode/device.h"

#include <cmath>

#include <fmt/format.h>

#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {
namespace {

constexpr int kStartRegister = 11;
constexpr int kFirstProfileRegister = 20;   // 20 to 23: the entry that executes; 18 is used by the queue as well
constexpr int kRegisters = 40, kFirstUserRegister = 10;
constexpr std::uint32_t kImmediateDone = 1u << 15, kProgramDone = 1u << 13, kCommandError = 1u << 12, kMovingError = 1u << 8;

bool in_range(std::int64_t value, std::int64_t least, std::int64_t most) { return value >= least && value <= most; }

bool is_reserved(std::int64_t number) { return number == 18 || in_range(number, kFirstProfileRegister, kFirstProfileRegister + 3); }

bool is_move(std::int64_t pos, std::int64_t acc, std::int64_t vel) {
  return in_range(pos, INT32_MIN, INT32_MAX) && in_range(acc, 0, kMostAcceleration) && in_range(vel, 0, kMostVelocity);
}

AxisMove move_of(std::int64_t pos, std::int64_t acc, std::int64_t vel) {
  return {static_cast<std::int32_t>(pos), static_cast<std::int32_t>(acc), static_cast<std::int32_t>(vel)};
}

}  // namespace

Device::Device(DeviceSetup setup, const CommandSet& commands, Report report)
    : setup_(std::move(setup)), commands_(commands), report_(std::move(report)), registers_(kRegisters, 0) {
  profile_.position = std::llround(setup_.start_counts * kUnitsPerCount);
}

ReplyFrame Device::handle(const CommandFrame& frame) {
  const CommandRow* row = commands_.find(frame.command);
  Answer answer = Refused{NakCode::kBadCommand};
  if (row != nullptr) answer = static_cast<int>(frame.parameters.size()) == row->parameters ? execute(*row, frame) : Answer(Refused{NakCode::kBadFormat});
  if (const auto* refused = std::get_if<Refused>(&answer)) {
    command_error_ = true;
    return Nak{setup_.id, frame.command, static_cast<int>(refused->code)};
  }
  if (const auto* data = std::get_if<Data>(&answer)) return *data;
  return Ack{setup_.id};
}

Device::Answer Device::execute(const CommandRow& row, const CommandFrame& frame) {
  switch (row.name) {
    case CommandName::kPOL: return Data{setup_.id, frame.command, {static_cast<std::uint16_t>(status())}};
    case CommandName::kCPL:
    case CommandName::kCIS: ran_dry_ = command_error_ = false; return Ack{};
    case CommandName::kHLT: begin_stop(0); return Ack{};
    case CommandName::kSTP:
      if (!in_range(frame.parameters[0], 0, kMostAcceleration)) return Refused{NakCode::kBadFormat};
      begin_stop(frame.parameters[0] > 0 ? frame.parameters[0] : present_.move.acc);
      return Ack{};
    case CommandName::kRST:
      begin_stop(present_.move.acc);
      queue_.clear();
      registers_.assign(kRegisters, 0);
      role_ = Role::kNone;
      return Ack{};
    case CommandName::kRRG: return read_register(frame);
    case CommandName::kMAV: return plain_move(frame, false);
    case CommandName::kMRV: return plain_move(frame, true);
    case CommandName::kWRI: return write_register(frame);
    case CommandName::kRUN: return load_program(frame);
    case CommandName::kIMS: return start_queue_by_host();
    case CommandName::kIMW: return append(frame);
    case CommandName::kIMQ: queue_.clear(); return Ack{};
  }
  return Refused{NakCode::kBadCommand};
}

Device::Answer Device::append(const CommandFrame& frame) {
  const auto& p = frame.parameters;
  if (!in_range(p[0], 0, kMostTicks) || !is_move(p[1], p[2], p[3])) return Refused{NakCode::kBadFormat};
  if (queue_.size() >= setup_.queue_depth) return Refused{NakCode::kBufferFull};
  queue_.push_back({static_cast<std::int32_t>(p[0]), move_of(p[1], p[2], p[3])});
  return Ack{};
}

/// Position or distance, acceleration, velocity, stop enable, stop state; stops on inputs are not simulated.
Device::Answer Device::plain_move(const CommandFrame& frame, bool relative) {
  const auto& p = frame.parameters;
  const std::int64_t here = std::llround(static_cast<double>(profile_.position) / kUnitsPerCount);
  const std::int64_t pos = relative ? here + p[0] : p[0];
  if (!is_move(pos, p[1], p[2]) || p[1] == 0 || p[3] != 0) return Refused{NakCode::kBadFormat};
  if (phase_ == Phase::kQueue || phase_ == Phase::kStopping) return Refused{NakCode::kBusy};
  present_ = {0, move_of(pos, p[1], p[2])};
  phase_ = Phase::kPlain;
  return Ack{};
}

Device::Answer Device::write_register(const CommandFrame& frame) {
  const std::int64_t number = frame.parameters[0], value = frame.parameters[1];
  if (!in_range(number, kFirstUserRegister, kRegisters - 1) || is_reserved(number) || !in_range(value, INT32_MIN, INT32_MAX)) return Refused{NakCode::kBadFormat};
  registers_[static_cast<std::size_t>(number)] = static_cast<std::int32_t>(value);
  return Ack{};
}

Data Device::words(int command, std::uint32_t value) const {
  return {setup_.id, command, {static_cast<std::uint16_t>(value >> 16), static_cast<std::uint16_t>(value & 0xFFFF)}};
}

Device::Answer Device::read_register(const CommandFrame& frame) const {
  const std::int64_t number = frame.parameters[0];
  const std::int32_t profile[] = {present_.ticks, present_.move.pos, present_.move.acc, present_.move.vel};
  if (in_range(number, kFirstProfileRegister, kFirstProfileRegister + 3))
    return words(frame.command, static_cast<std::uint32_t>(profile[number - kFirstProfileRegister]));
  if (!in_range(number, kFirstUserRegister, kRegisters - 1)) return Refused{NakCode::kBadFormat};
  return words(frame.command, static_cast<std::uint32_t>(registers_[static_cast<std::size_t>(number)]));
}

/// Loading a program again is harmless.
Device::Answer Device::load_program(const CommandFrame& frame) {
  if (frame.parameters[0] != 1 && frame.parameters[0] != 2) return Refused{NakCode::kBadFormat};
  if (is_moving()) return Refused{NakCode::kBusy};
  role_ = frame.parameters[0] == 1 ? Role::kLeader : Role::kFollower;
  phase_ = Phase::kWaiting;
  output1_ = true;
  return Ack{};
}

Device::Answer Device::start_queue_by_host() {
  if (is_moving()) return Refused{NakCode::kBusy};
  start_queue();
  return Ack{};
}

std::uint32_t Device::status() const {
  std::uint32_t word = 0;
  if (!is_moving()) word |= kImmediateDone;
  if (phase_ == Phase::kHalted) word |= kProgramDone;
  if (command_error_) word |= kCommandError;
  if (ran_dry_) word |= kMovingError;
  return word;
}

bool Device::is_jogging() const { return phase_ == Phase::kPlain && std::abs(std::int64_t{present_.move.pos}) == kFarPosition; }

void Device::begin_stop(std::int64_t acc) {
  stop_acc_ = acc;
  phase_ = Phase::kStopping;
}

void Device::start_queue() {
  if (started_at_ < 0) started_at_ = cycle_;
  phase_ = Phase::kQueue;
  ticks_left_ = 0;
}

void Device::step(bool io1) {
  step_program(io1);
  switch (phase_) {
    case Phase::kQueue: step_queue(); break;
    case Phase::kPlain: step_plain(); break;
    case Phase::kStopping:
      step_to_rest(profile_, stop_acc_);
      if (profile_.velocity == 0) phase_ = Phase::kHalted;
      break;
    case Phase::kHalted:
    case Phase::kWaiting:
    case Phase::kWaitingForEnd: break;
  }
  ++cycle_;
}

/// The lines of the servo program that wait.
void Device::step_program(bool io1) {
  const bool is_leader = role_ == Role::kLeader;
  const bool run = is_leader ? registers_[kStartRegister] != 0 : !io1;
  if (phase_ == Phase::kWaitingForEnd && !run) {
    if (is_leader) output1_ = true;
    phase_ = Phase::kWaiting;
  } else if (phase_ == Phase::kWaiting && role_ != Role::kNone && run) {
    if (is_leader) output1_ = false;
    start_queue();
  }
}

void Device::step_queue() {
  if (ticks_left_ == 0) {
    if (queue_.empty()) return queue_is_empty();
    present_ = queue_.front();
    queue_.pop_front();
    ++executed_;
    ticks_left_ = duration_ticks(present_.ticks);
  }
  silverlode::step(profile_, present_.move);
  --ticks_left_;
}

/// At rest this is how a motion ends; at speed the motion stops and the program halts.
void Device::queue_is_empty() {
  if (profile_.velocity == 0) {
    phase_ = role_ == Role::kNone ? Phase::kHalted : Phase::kWaitingForEnd;
    return;
  }
  ran_dry_ = true;
  report_(true, fmt::format("{}: the queue ran dry after entry {} at a velocity of {} SVU ({:.1f} counts/s); the motion stops and the servo program halts", setup_.axis, executed_,
                            profile_.velocity, counts_s_from_svu(static_cast<double>(profile_.velocity))));
  begin_stop(present_.move.acc);
  step_to_rest(profile_, stop_acc_);
  if (profile_.velocity == 0) phase_ = Phase::kHalted;
}

void Device::step_plain() {
  silverlode::step(profile_, present_.move);
  const bool arrived = profile_.velocity == 0 && profile_.position == std::int64_t{present_.move.pos} * kUnitsPerCountInt;
  if (arrived) phase_ = Phase::kHalted;
}

}  // namespace pmac::drives::silverlode
