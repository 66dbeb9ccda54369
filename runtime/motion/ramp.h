// The acceleration ramp shared by rapid, jog, linear and circle moves: how the speed goes from one value to another. It knows
// times and speeds only; what moves is the callers' business. Manual: User's Manual p727 (Power PMAC), Turbo Software
// Reference TA/TS (the Turbo rule).
//
//      r(t)
//   1 -              ___----
//                 ./            three parts: jerk +, constant acceleration, jerk -
//               ./              their ends: 0, ts, ta, ta + ts
//   0 -  ___--'
//        |  ts |  ..  | ts |    r = t^2/(2 ts ta), then (t - ts/2)/ta, then mirrored
#pragma once

#include <array>

#include "runtime/motion/types.h"

namespace pmac::motion {

/// ta and ts as a program sets them. >= 0: times in ms. ta < 0: |ta| is an inverse acceleration (ms^2/unit), and then
/// ts < 0 an inverse jerk (ms^3/unit) or 0. ts < 0 with ta >= 0: S-curve time from an inverse jerk. Units are those of the
/// speed change that goes with it.
struct RampSetting { double ta; double ts; };

/// A ramp in effect: peak acceleration is speed change / ta_ms, peak jerk speed change / (ta_ms * ts_ms).
/// 0 <= ts_ms <= ta_ms. Both 0: a step in speed.
struct Ramp {
  double ta_ms = 0;
  double ts_ms = 0;
  double total_ms() const { return ta_ms + ts_ms; }
};

/// One of up to three polynomial parts of a ramp, at its start: r, its derivatives and its integral.
/// r(t) = value + slope d + curvature d^2/2 and integral(t) = integral_ms + value d + slope d^2/2 + curvature d^3/6, d = t - start_ms.
struct RampPart { double start_ms, duration_ms, integral_ms, value, slope, curvature; };
struct RampParts { std::array<RampPart, 3> part; int count = 0; };

/// ts > 0 together with ta < 0 has no meaning and is refused; so is anything that is not finite.
bool is_valid(const RampSetting& setting);

/// The ramp for a change of speed of |speed_change| (units/ms).
/// kPower: T_acc = ta + ts, 2 ts where ts >= ta. kTurbo: T_acc = max(ta, 2 ts). Rates are the same in both.
Ramp make_ramp(const RampSetting& setting, double speed_change, RampRule rule);

/// The ramp made longer where |speed_change| would ask more of a motor than it has. Zero limits are off.
/// Manual: p727-729; the jerk rule does not touch a ramp without S-curve (ts 0), so that ts0 stays a pure trapezoid.
Ramp lengthened(Ramp ramp, double speed_change, double inv_amax, double inv_jmax);

/// The same shape squeezed or stretched to total_ms >= 0.
Ramp scaled_to(const Ramp& ramp, double total_ms);

/// r(t): 0 before, 1 after.
double ramp_value(const Ramp& ramp, double time_ms);
/// Integral of r from 0 to time_ms (ms); t - total/2 after the end.
double ramp_integral_ms(const Ramp& ramp, double time_ms);
RampParts ramp_parts(const Ramp& ramp);

/// Distance while the speed goes from start_speed to end_speed: mean speed times time, as the ramp is symmetric.
double ramp_distance(double start_speed, double end_speed, const Ramp& ramp);

}  // namespace pmac::motion
