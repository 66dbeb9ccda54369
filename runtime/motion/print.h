// Stable text of the records between the hops, for --emit=commands|path|segments|lookahead: one line each. The header lines name
// columns and units. Numbers are the shortest that read back as the same value.
#pragma once

#include <string>

#include "runtime/motion/path.h"
#include "runtime/motion/segment.h"

namespace pmac::motion {

std::string command_header();
std::string path_header();
std::string segment_header();
std::string timed_segment_header();

std::string to_text(const MotionCommand& command);
std::string to_text(const PathPiece& piece);
std::string to_text(const Segment& segment);
std::string to_text(const TimedSegment& segment);

}  // namespace pmac::motion
