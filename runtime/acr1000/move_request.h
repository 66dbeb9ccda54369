// What a motion command asked for, with everything that it latches when it is issued: programs change rates and parameters for the
// next move while this one still runs.
#pragma once

#include "runtime/acr1000/axis_law.h"
#include "runtime/acr1000/diagnostic.h"
#include "runtime/acr1000/rates.h"

namespace pmac::acr1000 {

/// Parameters that motion commands read.
inline constexpr std::size_t kMasterLengthParameter = 28, kEndPointParameter = 29;

enum class MoveKind : std::uint8_t { kMoveTo, kMoveBy, kCircle };

struct MoveRequest {
  MoveKind kind = MoveKind::kMoveTo;
  std::int64_t distance = 0;           // target of kMoveTo, increment of kMoveBy
  CircleArguments circle;              // of kCircle
  std::int64_t end_point = 0;          // P29, of kCircle
  bool end_point_is_relative = false;  // incremental arc blocks: P29 counts from the start [assumed]
  std::int64_t master_length = 0;      // P28; 0: the axis moves by itself
  RateSettings rates;
  Place place;
  bool is_coordinated() const { return master_length != 0; }
};

}  // namespace pmac::acr1000
