// Where one axis is while the master distance of its move runs from 0 to its end: MOV scales it straight, CIRCLE turns it into an
// angle. Two CIRCLE axes a quarter turn apart draw a circle or an ellipse, one beside a MOV a sine wave.
//
//   MOV      p = start + (end - start) u                                  u = master distance / master length, 0 .. 1
//   CIRCLE   p = start + I (cos theta - 1) + J sin theta                  theta = rot * distance / radius * u, radians
//
// I and J lead from the centre to the start point: for X they are Xs - Xc and Ys - Yc, for Y they are Ys - Yc and -(Xs - Xc). With them
// rot = +1 turns clockwise (X to the right, Y up), rot = -1 the other way with the same I and J. The radius only turns distance into
// angle; the swing is hypot(I, J). Source: ACR1000 manual, chapter 8.
#pragma once

#include <cstdint>

namespace pmac::acr1000 {

/// CIRCLE rot, radius, I, J, distance, all in pulses.
struct CircleArguments {
  int rot = 1;                  // +1 clockwise, -1 counter-clockwise
  std::int64_t radius = 0;      // > 0
  std::int64_t i = 0, j = 0;
  std::int64_t distance = 0;    // of arc, >= 0
  bool operator==(const CircleArguments&) const = default;
};

struct AxisLaw {
  bool is_circle = false;
  double start_pulses = 0;
  double end_pulses = 0;        // target of a MOV, P29 of a CIRCLE: where the axis is at u = 1, exactly
  CircleArguments circle;
};

/// Position and its derivatives with respect to u.
struct AxisPoint { double position_pulses, d1, d2; };

/// u is kept within 0 .. 1. At 1 the position is end_pulses; a CIRCLE comes there from computed_end().
AxisPoint at(const AxisLaw& law, double u);

/// Where the formula itself ends: the target of a MOV; for a CIRCLE up to a pulse beside P29 if its numbers are right.
double computed_end_pulses(const AxisLaw& law);

/// Length of the move in its own pulses: |end - start| of a MOV, the distance argument of a CIRCLE.
double own_length_pulses(const AxisLaw& law);

/// hypot(I, J): amplitude of the swing.
double amplitude_pulses(const CircleArguments& circle);

/// The axis coordinate of the centre.
double centre_pulses(const AxisLaw& law);

}  // namespace pmac::acr1000
