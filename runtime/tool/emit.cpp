#include "runtime/tool/emit.h"

#include <cstdio>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "runtime/motion/pipeline.h"
#include "runtime/motion/print.h"

namespace pmac::tool {

void Emitter::print(const std::string& line) {
  std::fwrite(line.data(), 1, line.size(), stdout);
  std::fputc('\n', stdout);
  printed_ += line.size() + 1;
}

/// The header before the first line of a coordinate system, then the line.
void Emitter::print_line(int coord, const std::string& header, const std::string& line) {
  if (coord != last_coord_) print(fmt::format("# coordinate system {}\n{}", coord, header));
  last_coord_ = coord;
  print(line);
}

void Emitter::attach(runtime::MachineObservers& observers) {
  if (stage_ != "commands") return;
  observers.motion_command = [this](int coord, const motion::MotionCommand& command) { print_line(coord, motion::command_header(), motion::to_text(command)); };
}

void Emitter::attach(runtime::Machine& machine, Recorder& recorder, DriveRun& drive) {
  if (stage_ == "servo") {
    recorder.add_sink({[this](const std::vector<std::string>& names) { print(fmt::format("{}", fmt::join(names, " "))); },
                       [this, &recorder](std::span<const double> rows) {
                         const std::size_t width = recorder.width();
                         for (std::size_t i = 0; i < rows.size() && std::ferror(stdout) == 0; i += width) print(fmt::format("{}", fmt::join(rows.subspan(i, width), " ")));
                       }});
  }
  for (int coord = 0; coord < bytecode::kMaxCoords; ++coord) {
    motion::StageObservers stages;
    if (stage_ == "path") stages.path = [this, coord](const motion::PathPiece& r) { print_line(coord, motion::path_header(), motion::to_text(r)); };
    if (stage_ == "segments") stages.segment = [this, coord](const motion::Segment& r) { print_line(coord, motion::segment_header(), motion::to_text(r)); };
    if (stage_ == "lookahead")
      stages.timed_segment = [this, coord](const motion::TimedSegment& r) { print_line(coord, motion::timed_segment_header(), motion::to_text(r)); };
    machine.observe_stages(coord, drive.observed(coord, std::move(stages)));
  }
}

}  // namespace pmac::tool
