#include "runtime/drives/mcx514/interpolator.h"

namespace pmac::drives::mcx514 {

std::string_view stop_text(Stop stop) {
  switch (stop) {
    case Stop::kRunning: return "running";
    case Stop::kFinishPoint: return "finish point";
    case Stop::kShortAxis: return "short axis";
    case Stop::kEndOfQuadrant: return "end of quadrant";
    case Stop::kEndOfPattern: return "end of pattern";
    case Stop::kDecelerated: return "decelerating stop";
    case Stop::kInstant: return "instant stop";
    case Stop::kUnderrun: return "underrun";
  }
  return "?";
}

const std::vector<int>& Interpolator::quadrants() const {
  static const std::vector<int> none;
  return none;
}

}  // namespace pmac::drives::mcx514
