// From a path in pulses to the register writes of a script, item by item. Every move is relative to where the chip really stands after the one
// before, which the encoder knows because it makes the same pulses. MCX514 manual p114 for the order of the writes.
//
// A line or an arc becomes one drive command where its pulses stay within a pulse of the path; else it is divided. What is neither (a blended
// corner, a curve of points) becomes short lines, each as long as it can be.
#pragma once

#include <string>
#include <vector>

#include "runtime/drives/mcx514/arc.h"
#include "runtime/drives/mcx514/chip.h"
#include "runtime/drives/mcx514/path_item.h"

namespace pmac::drives::mcx514 {

struct EncoderSetting {
  bool keep_duration = false;   // drive speed such that a move takes as long as in the program, instead of the programmed speed
  bool continuous = true;       // segments of one speed go through the pre-buffer
};

struct ScriptLine { double time_s = 0; std::string text; };

class Encoder {
 public:
  explicit Encoder(const EncoderSetting& setting);

  /// The next item of the path. The reason where the chip cannot make it.
  std::optional<std::string> add(const PathItem& item);
  /// Nothing moves for so long.
  void pause(double seconds);
  void finish();

  const std::vector<ScriptLine>& lines() const { return lines_; }
  /// By drive command in order: the index of the item that it belongs to.
  const std::vector<std::size_t>& items() const { return items_; }
  const AxisCounts& position() const { return position_; }
  std::uint64_t events() const { return events_; }

 private:
  struct Drive;
  bool add_line(const PathItem& item);
  bool add_arc(const PathItem& item);
  bool add_helix(const PathItem& item);
  void divide_arc(const PathItem& item);
  void add_points(const std::vector<Point>& points, const PathItem& item);
  void drive_line(const AxisCounts& to, const PathItem& item);
  void send(Drive drive, const PathItem& item);
  void prepare(const Drive& drive, std::int64_t speed_pps);
  std::optional<ArcSetting> fitting_arc(const PathItem& item) const;
  void write(int reg, std::uint16_t value, const std::string& comment = {});
  void write_data(std::int64_t value, std::uint16_t command, const std::string& comment);
  void line(const std::string& text);
  std::int64_t speed_for(const Drive& drive, const PathItem& item) const;

  EncoderSetting setting_;
  Chip chip_;                       // tells the time
  AxisCounts position_{};
  std::vector<ScriptLine> lines_;
  std::vector<std::size_t> items_;
  std::size_t item_ = 0;            // index of the next one
  std::uint64_t events_ = 0;
  std::uint16_t mode_ = 0;          // 0: none written
  std::int64_t speed_pps_ = 0;
  bool running_ = false;            // a drive may still run when the next line is sent
  std::string failure_;
};

}  // namespace pmac::drives::mcx514
