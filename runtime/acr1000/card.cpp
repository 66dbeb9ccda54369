#include "runtime/acr1000/card.h"

#include <cmath>

namespace pmac::acr1000 {
namespace {

/// Cards that compute the same move in two ways end it at the same instant within this.
constexpr double kSameInstantS = 1e-9;

}  // namespace

Card::Card(CardConfig config)
    : config_(std::move(config)), own_parameters_(config_.parameter_count), parameters_(own_parameters_), relays_(config_.relays), position_(static_cast<double>(config_.start_pulses)), commanded_(config_.start_pulses) {}

bool Card::relay(int number) const {
  if (number == config_.busy_relay) return moves();
  if (number == config_.run_relay) return driver && driver->program_runs();
  const auto at = relays_.find(number);
  return at != relays_.end() && at->second;
}

void Card::set_relay(int number, bool on) {
  if (number == config_.busy_relay || number == config_.run_relay) return;
  if (on) relays_[number] = true;
  else relays_.erase(number);
}

std::optional<Finding> Card::request(const MoveRequest& request) {
  if (auto refusal = refusal_of(request, commanded_)) return refusal;
  waiting_ = request;
  return std::nullopt;
}

std::optional<Finding> Card::request(const MoveBlock& block, const Place& place) {
  if (block.wide_velocity && !config_.wide_velocity)
    return Finding{DiagnosticId::kBadBlock, "velocities of 24 bits need executive version 4.x; set VERSION=4"};
  if (block.velocity) rates.vel = *block.velocity;
  if (parameters_.size() > kEndPointParameter) {
    parameters_[kMasterLengthParameter] = block.master_distance;
    if (block.is_circle) parameters_[kEndPointParameter] = block.end_point;
  }
  MoveRequest move;
  move.kind = block.is_circle ? MoveKind::kCircle : block.incremental ? MoveKind::kMoveBy : MoveKind::kMoveTo;
  move.distance = block.distance;
  if (block.is_circle) move.circle = circle_of(block);
  move.end_point = block.end_point;
  move.end_point_is_relative = block.incremental;
  move.master_length = block.master_distance;
  move.rates = rates;
  move.place = place;
  return request(move);
}

MoveEntry Card::entry_at(double time_s) const {
  if (carried_ && time_s - ended_s_ <= kSameInstantS) return *carried_;
  MoveEntry entry;
  entry.position_pulses = position_;
  return entry;
}

std::vector<Finding> Card::begin(double time_s) {
  const MoveEntry entry = entry_at(time_s);
  active_ = plan_move(*waiting_, config_.units, entry, time_s);
  waiting_.reset();
  carried_.reset();
  commanded_ = static_cast<std::int64_t>(active_->law.end_pulses);
  memory_.count_move();
  return oddities_of(*active_, entry);
}

void Card::end() {
  const PlannedMove& move = *active_;
  position_ = move.law.end_pulses;
  ended_s_ = move.end_s();
  if (waits()) {
    const double exit_speed = move.profile.exit_speed_pulses_s;
    const double axis_speed = move.profile.length_pulses > 0 ? acr1000::at(move.law, 1).d1 * exit_speed / move.profile.length_pulses : 0;
    carried_ = MoveEntry{position_, exit_speed, axis_speed, !move.law.is_circle};
  }
  active_.reset();
}

void Card::stop_dead(double time_s) {
  position_ = std::round(at(time_s).position_pulses);
  commanded_ = static_cast<std::int64_t>(position_);
  active_.reset();
  carried_.reset();
}

MotionPoint Card::path_at(double time_s) const {
  return active_ ? acr1000::path_at(*active_, time_s) : MotionPoint{position_, 0, 0, 0};
}

MotionPoint Card::at(double time_s) const {
  return active_ ? acr1000::at(*active_, time_s) : MotionPoint{position_, 0, 0, 0};
}

}  // namespace pmac::acr1000
