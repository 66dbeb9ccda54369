// The position loop of one motor and the mass that it drives, once a servo cycle. What the servo sees at cycle k decides its output, which
// holds until cycle k + 1:
//
//   DesPos --+--> error --> Kp ( error + Kvff*DesVel + Kaff*DesAcc + integral - Kvfb*ActVel ) --> limit --> mass --> ActPos
//            ^-                                                                                                       |
//            +-------------------------------------------------------------------------------------------------------+
//
// Velocities are motor units a servo cycle, as differences of positions. That Kp multiplies every term, that the integrator stops while
// the output is limited, and what MaxInt limits, are those of the Turbo PMAC Software Reference (Ixx30 to Ixx35, Ixx63): assumed.
#pragma once

namespace pmac::runtime {

/// Motor[].Servo. and Motor[].MaxDac. Outputs are in the units of the converter.
struct ServoGains {
  double kp = 4, ki = 0, kvfb = 40, kvff = 40, kaff = 0;
  double max_integral = 28000;        // of the integrator's part of the output; 0: no integrator
  double max_error_mu = 0;            // that the servo acts on; 0: no limit
  double max_output = 28000;
  bool integrates_at_rest_only = false;
  double open_output = 0;             // while the loop is open
};

/// Sim.Motor[].: acceleration = accel_gain * output - friction * velocity.
struct ServoPlant {
  double accel_gain_mu_ms2 = 0;
  double friction_per_ms = 0;         // >= 0
};

class ServoLoop {
 public:
  /// Of the last interrupt: the motor stands still, or moves, where it is commanded to be.
  void start(double position_mu, double velocity_mu_ms, double period_ms);
  /// A servo interrupt. desired_mu: commanded position at it. closed: false drives the mass with gains.open_output, whatever is commanded.
  void step(double desired_mu, bool closed, const ServoGains& gains, const ServoPlant& plant, double period_ms);

  /// At the last interrupt.
  double position_mu() const { return position_mu_; }
  double error_mu() const { return error_mu_; }
  double velocity_mu_cycle() const { return position_mu_ - previous_mu_; }
  double output() const { return output_; }
  double integral() const { return integral_mu_; }

 private:
  double control(double desired_mu, const ServoGains& gains);
  void move(const ServoPlant& plant, double period_ms);

  double next_mu_ = 0;                // where the mass is at the next interrupt
  double velocity_mu_ms_ = 0;         // and how fast
  double position_mu_ = 0, previous_mu_ = 0, error_mu_ = 0, output_ = 0, integral_mu_ = 0;
  double desired_mu_ = 0, desired_velocity_mu_ = 0;
  bool closed_ = false;               // at the last interrupt
};

}  // namespace pmac::runtime
