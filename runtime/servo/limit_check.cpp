// A deceleration is judged when it is over: only then is it known whether it was a stop, which may have a limit of its own.
#include "runtime/servo/limit_check.h"

#include <algorithm>
#include <cmath>

namespace pmac::runtime {
namespace {

/// A third difference reaches over so many samples; until then the limits of what the motor did before hold, too.
constexpr int kReach = 3;
/// Rounding of positions that lie on their limit, of their size.
constexpr double kPositionRoom = 1e-9;

bool is_worse(double value, double limit, const WorstValue& worst) {
  const double share = value / limit, known = worst.share();
  return share > known || (share == known && value > worst.value);
}

/// The wider of the limits now and before where a difference reaches over both. Rest has none: its differences are of the motion before.
double limit_in_force(const MotorActivity& now, const MotorActivity& before, int since_change, double MotorActivity::*limit) {
  if (now.kind == MotorActivity::Kind::kRest) return before.*limit;
  const bool reaches_back = since_change < kReach && before.kind != MotorActivity::Kind::kRest;
  return reaches_back ? std::max(now.*limit, before.*limit) : now.*limit;
}

bool same_limits(const MotorActivity& a, const MotorActivity& b) {
  return a.kind == b.kind && a.max_speed_mu_ms == b.max_speed_mu_ms && a.max_accel_mu_ms2 == b.max_accel_mu_ms2 &&
         a.max_stop_mu_ms2 == b.max_stop_mu_ms2 && a.max_jerk_mu_ms3 == b.max_jerk_mu_ms3;
}

}  // namespace

bool LimitCheck::Row::keeps_limits() const {
  const bool in_place = position.room_mu >= -kPositionRoom * std::max(1.0, std::abs(position.limit_mu));
  return speed.share() <= kSpeedRoom && accel.share() <= kAccelRoom && jerk.share() <= kJerkRoom && in_place;
}

void LimitCheck::take(const SampleBlock& block) {
  while (!joins_.empty() && joins_.front().time_ms < block.time_ms(0) - 10 * block.period_ms) joins_.pop_front();
  for (const int motor : block.motors) {
    if (states_.size() <= static_cast<std::size_t>(motor)) states_.resize(static_cast<std::size_t>(motor) + 1);
    begin_block(states_[static_cast<std::size_t>(motor)], motor, block);
  }
  for (int k = 0; k < block.count; ++k) {
    for (std::size_t m = 0; m < block.motors.size(); ++m)
      take_sample(states_[static_cast<std::size_t>(block.motors[m])], block.at(static_cast<int>(m), k), block.time_ms(k), block.period_ms);
    for (const int motor : block.motors) {
      State& s = states_[static_cast<std::size_t>(motor)];
      if (s.is_braking && s.speed == 0) end_braking(s);
    }
  }
}

void LimitCheck::begin_block(State& s, int motor, const SampleBlock& block) {
  s.row.motor = motor;
  const MotorActivity next = ask_(motor, block.time_ms(0));
  if (!same_limits(next, s.now)) {
    s.before = s.now;
    s.since_change = 0;
  }
  s.now = next;
}

void LimitCheck::take_sample(State& s, double position_mu, double time_ms, double period_ms) {
  const double p0 = position_mu + s.now.home_mu, h = period_ms;
  if (!s.seen) s.p1 = s.p2 = s.p3 = p0;
  s.seen = true;
  s.speed = (p0 - s.p1) / h;
  const auto limit = [&](double MotorActivity::*which) { return limit_in_force(s.now, s.before, s.since_change, which); };
  note(s, s.row.speed, std::abs(s.speed), limit(&MotorActivity::max_speed_mu_ms), time_ms);
  take_acceleration(s, (p0 - 2 * s.p1 + s.p2) / (h * h), (s.p1 - s.p2) / h, time_ms - h);
  const double jerk = (p0 - 3 * s.p1 + 3 * s.p2 - s.p3) / (h * h * h);
  if (!spans_join(s.now.coord, time_ms - 3 * h, time_ms))
    note(s, s.row.jerk, std::abs(jerk), limit(&MotorActivity::max_jerk_mu_ms3), time_ms - h);
  take_position(s, position_mu, time_ms);
  s.p3 = s.p2;
  s.p2 = s.p1;
  s.p1 = p0;
  ++s.since_change;
}

bool LimitCheck::spans_join(int coord, double from_ms, double to_ms) const {
  return std::any_of(joins_.begin(), joins_.end(), [&](const Join& j) { return j.coord == coord && j.time_ms >= from_ms && j.time_ms <= to_ms; });
}

void LimitCheck::take_acceleration(State& s, double accel, double speed_before, double time_ms) {
  const double limit = limit_in_force(s.now, s.before, s.since_change, &MotorActivity::max_accel_mu_ms2);
  if (accel * speed_before >= 0) {
    if (s.is_braking) end_braking(s);
    return note(s, s.row.accel, std::abs(accel), limit, time_ms);
  }
  if (!s.is_braking) s.braking = {};
  s.is_braking = true;
  note(s, s.braking, std::abs(accel), limit, time_ms);
}

void LimitCheck::end_braking(State& s) {
  s.is_braking = false;
  const bool stops = s.speed == 0 && (s.now.coord < 0 || all_rest(s.now.coord));
  if (stops) s.braking.limit = limit_in_force(s.now, s.before, s.since_change, &MotorActivity::max_stop_mu_ms2);
  if (is_worse(s.braking.value, s.braking.limit, s.row.accel)) s.row.accel = s.braking;
}

void LimitCheck::take_position(State& s, double position_mu, double time_ms) {
  const double below = position_mu - s.now.min_mu, above = s.now.max_mu - position_mu, room = std::min(below, above);
  if (room >= s.row.position.room_mu) return;
  s.row.position = {position_mu, below < above ? s.now.min_mu : s.now.max_mu, room, time_ms, ask_(s.row.motor, time_ms).source};
}

void LimitCheck::note(const State& s, WorstValue& worst, double value, double limit, double time_ms) const {
  if (!is_worse(value, limit, worst)) return;
  const bytecode::SourceLine source = ask_(s.row.motor, time_ms).source;
  worst = {value, limit, time_ms, source.line > 0 ? source : s.now.source.line > 0 ? s.now.source : s.before.source};
}

bool LimitCheck::all_rest(int coord) const {
  return std::all_of(states_.begin(), states_.end(), [&](const State& s) { return !s.seen || s.now.coord != coord || s.speed == 0; });
}

std::vector<LimitCheck::Row> LimitCheck::rows() {
  std::vector<Row> rows;
  for (State& s : states_) {
    if (!s.seen) continue;
    if (s.is_braking) end_braking(s);
    rows.push_back(s.row);
  }
  return rows;
}

}  // namespace pmac::runtime
