// A move is: ramp to a peak speed, cruise, ramp to rest. Only the peak has to be found; everything else is closed form.
//
//   distance(peak) = (v0 + peak)/2 * T(peak - v0) + peak/2 * T(peak),  T = length of the ramp for that change of speed
//
// A peak of the other sign is the overshoot-and-return of a destination that is too near to stop at.
//
// A start with acceleration a0 under jerk J: where the ramp goes on in the direction of a0 it is the ramp that began with no
// acceleration |a0|/J earlier; otherwise the acceleration is first brought to 0.
#include "runtime/motion/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/motion/ramp.h"

namespace pmac::motion {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

Ramp jog_ramp(double speed_change, const JogParameters& jog) {
  return make_ramp({jog.ta, jog.ts}, speed_change, RampRule::kPower);
}

double ramp_time_ms(double speed_change, const JogParameters& jog) { return jog_ramp(speed_change, jog).total_ms(); }

/// Where a move begins: speed and acceleration, and the jerk that may change the acceleration (0: it has none).
struct Start {
  double speed = 0, accel = 0, jerk = 0;

  double settle_ms() const { return jerk > 0 ? std::abs(accel) / jerk : 0; }
  double speed_change() const { return accel * settle_ms() / 2; }         // while the acceleration settles
  double settled_speed() const { return speed + speed_change(); }
  double settle_distance() const { return settle_ms() * (speed + accel * settle_ms() / 3); }
  /// The ramp to peak goes on with the acceleration that there is.
  bool continues_to(double peak) const { return accel != 0 && (peak - settled_speed()) * accel > 0; }
  double virtual_speed() const { return speed - speed_change(); }         // settle_ms() earlier
  double virtual_distance() const { return settle_ms() * (virtual_speed() + accel * settle_ms() / 6); }
};

Start make_start(double speed, double accel, const JogParameters& jog) {
  if (jog.ta >= 0 || jog.ts >= 0) return {speed, 0, 0};
  const double limit = -1 / jog.ta;
  return {speed, std::clamp(accel, -limit, limit), -1 / jog.ts};
}

/// Distance of the ramp from the start to a speed.
double distance_to_speed(const Start& start, double speed, const JogParameters& jog) {
  if (start.continues_to(speed)) {
    const double from = start.virtual_speed();
    return ramp_distance(from, speed, jog_ramp(speed - from, jog)) - start.virtual_distance();
  }
  const double from = start.settled_speed();
  return start.settle_distance() + ramp_distance(from, speed, jog_ramp(speed - from, jog));
}

/// Distance of start -> peak -> rest without cruise.
double distance_over_peak(const Start& start, double peak, const JogParameters& jog) {
  return distance_to_speed(start, peak, jog) + ramp_distance(peak, 0, jog_ramp(peak, jog));
}

/// Zero of a function that is <= 0 at `low` and >= 0 at `high`, to the last bit.
template <class Function>
double bisect(double low, double high, const Function& function) {
  for (int i = 0; i < 200; ++i) {
    const double middle = low + (high - low) / 2;
    if (middle == low || middle == high) break;
    (function(middle) <= 0 ? low : high) = middle;
  }
  return low;
}

/// Peak speed (signed) of the move over distance_mu from the start. A peak toward minus is the mirrored problem.
double peak_speed(const Start& start, double distance_mu, const JogParameters& jog) {
  const double stop_distance = distance_to_speed(start, 0, jog);
  if (distance_mu < stop_distance) return -peak_speed({-start.speed, -start.accel, start.jerk}, -distance_mu, jog);
  const auto missing = [&](double peak) { return distance_over_peak(start, peak, jog) - distance_mu; };
  const double limit = jog.speed_mu_ms;
  const double settled = start.settled_speed();
  if (missing(limit) <= 0) return limit;
  const bool faster_helps = settled > 0 && settled < limit && missing(settled) <= 0;
  return bisect(faster_helps ? settled : 0, limit, missing);
}

/// Peak of a rest-to-rest move that never reaches the jog speed, |distance| > 0; closed forms for times and rates.
double short_move_peak(double distance, const JogParameters& jog) {
  if (jog.ta >= 0 && jog.ts >= 0) return distance / ramp_time_ms(jog.speed_mu_ms, jog);
  if (jog.ta >= 0) return peak_speed({}, distance, jog);
  const double inv_a = -jog.ta;
  const double ts = -jog.ts / inv_a;
  if (distance < 2 * ts * ts / inv_a) return std::cbrt(distance * distance / (4 * -jog.ts));
  return (std::sqrt(ts * ts + 4 * distance * inv_a) - ts) / (2 * inv_a);
}

}  // namespace

double move_time_ms(double distance_mu, const JogParameters& jog) {
  const double distance = std::abs(distance_mu);
  if (distance == 0) return 0;
  const double full_ramp_ms = ramp_time_ms(jog.speed_mu_ms, jog);
  if (distance >= jog.speed_mu_ms * full_ramp_ms) return distance / jog.speed_mu_ms + full_ramp_ms;
  return 2 * ramp_time_ms(short_move_peak(distance, jog), jog);
}

/// Appends the pieces of a profile and keeps the state at their end.
class ProfileBuilder {
 public:
  ProfileBuilder(double start_ms, double position, double velocity, const JogParameters& jog = {0, 0, 0})
      : time_(start_ms), position_(position), velocity_(velocity) {
    profile_.parameters_ = jog;
    profile_.start_velocity_ = velocity;
  }

  ProfileBuilder& ramp_to(double speed, const Ramp& ramp);
  /// Ramp from a start with acceleration.
  ProfileBuilder& ramp_from(const Start& start, double speed, const JogParameters& jog);
  ProfileBuilder& cruise(double duration_ms);
  MotorProfile rest_at(double position);
  MotorProfile cruise_for_ever();

 private:
  void add(double start_ms, double position, double velocity, double half_accel, double sixth_jerk) {
    profile_.pieces_[static_cast<std::size_t>(profile_.count_++)] = {start_ms, position, velocity, half_accel, sixth_jerk};
  }
  MotorProfile profile_;
  double time_, position_, velocity_;
};

ProfileBuilder& ProfileBuilder::ramp_to(double speed, const Ramp& ramp) {
  const double change = speed - velocity_;
  const RampParts parts = ramp_parts(ramp);
  for (int i = 0; i < parts.count; ++i) {
    const RampPart& part = parts.part[static_cast<std::size_t>(i)];
    add(time_ + part.start_ms, position_ + velocity_ * part.start_ms + change * part.integral_ms,
        velocity_ + change * part.value, change * part.slope / 2, change * part.curvature / 6);
  }
  time_ += ramp.total_ms();
  position_ += ramp_distance(velocity_, speed, ramp);
  velocity_ = speed;
  return *this;
}

ProfileBuilder& ProfileBuilder::ramp_from(const Start& start, double speed, const JogParameters& jog) {
  if (start.continues_to(speed)) {
    time_ -= start.settle_ms();
    position_ -= start.virtual_distance();
    velocity_ = start.virtual_speed();
  } else if (start.accel != 0) {
    add(time_, position_, start.speed, start.accel / 2, std::copysign(start.jerk, -start.accel) / 6);
    time_ += start.settle_ms();
    position_ += start.settle_distance();
    velocity_ = start.settled_speed();
  }
  return ramp_to(speed, jog_ramp(speed - velocity_, jog));
}

ProfileBuilder& ProfileBuilder::cruise(double duration_ms) {
  if (duration_ms <= 0) return *this;
  add(time_, position_, velocity_, 0, 0);
  time_ += duration_ms;
  position_ += velocity_ * duration_ms;
  return *this;
}

MotorProfile ProfileBuilder::rest_at(double position) {
  add(time_, position, 0, 0, 0);
  profile_.end_ms_ = time_;
  return profile_;
}

MotorProfile ProfileBuilder::cruise_for_ever() {
  add(time_, position_, velocity_, 0, 0);
  profile_.end_ms_ = kEndless;
  return profile_;
}

namespace {

MotorProfile move_over_peak(double start_ms, double position_mu, const Start& start, double target_mu, double peak,
                            const JogParameters& jog) {
  const double left = target_mu - position_mu - distance_over_peak(start, peak, jog);
  ProfileBuilder builder(start_ms, position_mu, start.speed, jog);
  builder.ramp_from(start, peak, jog);
  if (peak != 0) builder.cruise(left / peak);
  return builder.ramp_to(0, jog_ramp(peak, jog)).rest_at(target_mu);
}

}  // namespace

MotorProfile MotorProfile::rest(double position_mu) { return ProfileBuilder(0, position_mu, 0).rest_at(position_mu); }

MotorProfile MotorProfile::move(double start_ms, double position_mu, double velocity_mu_ms, double target_mu,
                                const JogParameters& jog, double accel_mu_ms2) {
  const double distance = target_mu - position_mu;
  if (distance == 0 && velocity_mu_ms == 0) return ProfileBuilder(start_ms, position_mu, 0, jog).rest_at(target_mu);
  const Start start = make_start(velocity_mu_ms, accel_mu_ms2, jog);
  return move_over_peak(start_ms, position_mu, start, target_mu, peak_speed(start, distance, jog), jog);
}

MotorProfile MotorProfile::jog(double start_ms, double position_mu, double velocity_mu_ms, int direction,
                               const JogParameters& jog, double accel_mu_ms2) {
  const double speed = direction < 0 ? -jog.speed_mu_ms : jog.speed_mu_ms;
  return ProfileBuilder(start_ms, position_mu, velocity_mu_ms, jog)
      .ramp_from(make_start(velocity_mu_ms, accel_mu_ms2, jog), speed, jog)
      .cruise_for_ever();
}

MotorProfile MotorProfile::stop(double start_ms, double position_mu, double velocity_mu_ms, const JogParameters& jog,
                                double accel_mu_ms2) {
  const Start start = make_start(velocity_mu_ms, accel_mu_ms2, jog);
  ProfileBuilder builder(start_ms, position_mu, velocity_mu_ms, jog);
  if (velocity_mu_ms != 0) builder.ramp_from(start, 0, jog);
  const double target_mu = velocity_mu_ms != 0 ? position_mu + distance_to_speed(start, 0, jog) : position_mu;
  return builder.rest_at(target_mu);
}

int MotorProfile::piece_at(double time_ms) const {
  int index = 0;
  while (index + 1 < count_ && pieces_[static_cast<std::size_t>(index) + 1].start_ms <= time_ms) ++index;
  return index;
}

double MotorProfile::position_mu(double time_ms) const {
  const Piece& piece = pieces_[static_cast<std::size_t>(piece_at(time_ms))];
  const double d = std::max(0.0, time_ms - piece.start_ms);
  return piece.position + d * (piece.velocity + d * (piece.half_accel + d * piece.sixth_jerk));
}

double MotorProfile::velocity_mu_ms(double time_ms) const {
  const Piece& piece = pieces_[static_cast<std::size_t>(piece_at(time_ms))];
  const double d = std::max(0.0, time_ms - piece.start_ms);
  return piece.velocity + d * (2 * piece.half_accel + d * 3 * piece.sixth_jerk);
}

double MotorProfile::accel_mu_ms2(double time_ms) const {
  const Piece& piece = pieces_[static_cast<std::size_t>(piece_at(time_ms))];
  return 2 * piece.half_accel + 6 * piece.sixth_jerk * std::max(0.0, time_ms - piece.start_ms);
}

double MotorProfile::cruise_ms() const {
  double sum_ms = 0;
  for (int i = 0; i + 1 < count_; ++i) {
    const Piece& piece = pieces_[static_cast<std::size_t>(i)];
    const bool steady = piece.half_accel == 0 && piece.sixth_jerk == 0 && piece.velocity != 0;
    if (steady) sum_ms += pieces_[static_cast<std::size_t>(i) + 1].start_ms - piece.start_ms;
  }
  return sum_ms;
}

double MotorProfile::end_ms() const { return end_ms_; }

double MotorProfile::target_mu() const { return pieces_[static_cast<std::size_t>(std::max(0, count_ - 1))].position; }

}  // namespace pmac::motion
