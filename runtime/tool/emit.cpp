#include "runtime/tool/emit.h"

#include <cstdio>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "runtime/motion/pipeline.h"
#include "runtime/motion/print.h"

namespace pmac::tool {
namespace {

/// The header before the first line of a coordinate system, then the line.
void print_line(int coord, int& last_coord, const std::string& header, const std::string& line) {
  if (coord != last_coord) std::printf("# coordinate system %d\n%s\n", coord, header.c_str());
  last_coord = coord;
  std::printf("%s\n", line.c_str());
}

}  // namespace

void Emitter::attach(runtime::MachineObservers& observers) {
  if (stage_ != "commands") return;
  observers.motion_command = [last = -1](int coord, const motion::MotionCommand& command) mutable {
    print_line(coord, last, motion::command_header(), motion::to_text(command));
  };
}

void Emitter::attach(runtime::Machine& machine, Recorder& recorder, DriveRun& drive) {
  if (stage_ == "servo") {
    recorder.add_sink({[](const std::vector<std::string>& names) { std::printf("%s\n", fmt::format("{}", fmt::join(names, " ")).c_str()); },
                       [&recorder](std::span<const double> rows) {
                         const std::size_t width = recorder.width();
                         for (std::size_t i = 0; i < rows.size(); i += width)
                           std::printf("%s\n", fmt::format("{}", fmt::join(rows.subspan(i, width), " ")).c_str());
                       }});
  }
  auto last = std::make_shared<int>(-1);
  for (int coord = 0; coord < bytecode::kMaxCoords; ++coord) {
    motion::StageObservers stages;
    if (stage_ == "path")
      stages.path = [coord, last](const motion::PathPiece& r) { print_line(coord, *last, motion::path_header(), motion::to_text(r)); };
    if (stage_ == "segments")
      stages.segment = [coord, last](const motion::Segment& r) { print_line(coord, *last, motion::segment_header(), motion::to_text(r)); };
    if (stage_ == "lookahead")
      stages.timed_segment = [coord, last](const motion::TimedSegment& r) {
        print_line(coord, *last, motion::timed_segment_header(), motion::to_text(r));
      };
    machine.observe_stages(coord, drive.observed(coord, std::move(stages)));
  }
}

}  // namespace pmac::tool
