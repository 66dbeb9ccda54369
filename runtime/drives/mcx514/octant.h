// The eight "quadrants" of the chip's circles: octant k covers 45k to 45(k+1) degrees about the centre, counted counter-clockwise from
// +ax1. The long axis is the one whose coordinate is larger; the short axis pulses at every event, the long axis as needed. MCX514
// manual p113.
//
//           ax2
//         \ 2 | 1 /
//        3  \ | /  0
//       ------+------ ax1
//        4  / | \  7
//         / 5 | 6 \          .
#pragma once

#include <cstdint>

namespace pmac::drives::mcx514 {

/// A position relative to the centre: [0] along ax1, [1] along ax2.
struct Plane { std::int64_t ax1 = 0, ax2 = 0; };

/// How a circle runs through an octant. Axes are 0 (ax1) and 1 (ax2); directions are +1 and -1.
struct OctantRun { int short_axis = 0; int short_step = 0, long_step = 0; bool outward = false; };  // outward: along the short axis

OctantRun octant_run(int octant, bool clockwise);

/// The octant that a motion through this point enters: on a boundary, the one ahead. The centre itself: octant 7 or 0.
int entered_octant(Plane point, bool clockwise);

/// The octant in which a motion arrives at this point: on a boundary, the one behind. [assumed: the manual leaves boundaries open]
inline int arrived_octant(Plane point, bool clockwise) { return entered_octant(point, !clockwise); }

}  // namespace pmac::drives::mcx514
