// A single motor's own motion: jog, rapid, home and abort profiles as exact polynomials of time. Manual: rapid and jog moves
// (User's Manual p712), rates and S-curves as in ramp.h.
//
//   speed   ___________
//          /           \        up to seven cubic pieces; a change of destination in mid-move starts from the
//      ___/             \___    present position, speed and acceleration
#pragma once

#include <array>

namespace pmac::motion {

/// Speed and ramps of a jog-like move. Times >= 0 in ms; negative values are inverse rates (ms^2/mu, ms^3/mu).
struct JogParameters { double speed_mu_ms; double ta; double ts; };

class MotorProfile {
 public:
  /// At rest at position_mu.
  static MotorProfile rest(double position_mu);
  /// From position and velocity at start_ms to rest at target_mu. Overshoots and returns where it cannot stop in time.
  /// accel_mu_ms2: present acceleration, continued under a jerk rate (ts < 0); otherwise the new ramp begins afresh.
  static MotorProfile move(double start_ms, double position_mu, double velocity_mu_ms, double target_mu, const JogParameters&,
                           double accel_mu_ms2 = 0);
  /// Ramps from velocity to +-speed (sign of direction) and stays there; horizon is endless.
  static MotorProfile jog(double start_ms, double position_mu, double velocity_mu_ms, int direction, const JogParameters&,
                          double accel_mu_ms2 = 0);
  /// Ramps to rest as soon as the parameters allow.
  static MotorProfile stop(double start_ms, double position_mu, double velocity_mu_ms, const JogParameters&, double accel_mu_ms2 = 0);

  double position_mu(double time_ms) const;
  double velocity_mu_ms(double time_ms) const;
  double accel_mu_ms2(double time_ms) const;
  /// First time at or after from_ms at which the position is position_mu, exactly; infinity if never.
  double first_time_at(double position_mu, double from_ms) const;
  double start_ms() const { return pieces_[0].start_ms; }
  double end_ms() const;      // infinity for a jog without end
  double target_mu() const;   // position at the end; the present one for a jog without end
  /// What it was made with. speed_mu_ms is 0 at rest and where it only stops.
  const JogParameters& parameters() const { return parameters_; }
  double start_velocity_mu_ms() const { return start_velocity_; }
  /// Time that it spends at its full speed before it ends.
  double cruise_ms() const;

 private:
  friend class ProfileBuilder;
  struct Piece { double start_ms; double position, velocity, half_accel, sixth_jerk; };  // cubic in t - start_ms
  std::array<Piece, 16> pieces_{};
  int count_ = 0;
  double end_ms_ = 0;
  JogParameters parameters_{0, 0, 0};
  double start_velocity_ = 0;
  int piece_at(double time_ms) const;
};

/// Total time of a rest-to-rest move of distance_mu, closed form.
double move_time_ms(double distance_mu, const JogParameters&);

}  // namespace pmac::motion
