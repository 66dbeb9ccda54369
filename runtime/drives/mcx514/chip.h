// One MCX514: its registers, what writes to them do, and the pulses that follow. Time is the chip's own and advances only when it is told to:
// writes take none.
//
//     Chip chip;
//     chip.observe(&sink);
//     for (...) chip.write(reg, value, {line, column});
//     chip.run_until_idle();
//     chip.drives(), chip.problems(), chip.position()
//
// Writes to WR6 and WR7 are kept until a command in WR0 uses them. What a command refuses is a Problem with the place of the write, and the
// command then does nothing.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "runtime/drives/mcx514/command.h"
#include "runtime/drives/mcx514/interpolator.h"
#include "runtime/drives/mcx514/script.h"
#include "runtime/drives/mcx514/speed.h"

namespace pmac::drives::mcx514 {

/// Place of a write, for messages.
struct Place { int line = 0; int column = 1; };

/// Takes the pulses as they happen.
class PulseSink {
 public:
  virtual ~PulseSink() = default;
  /// One event. position: logical positions after it. by: what made it, for its error_now().
  virtual void pulses(Time time, const Event& event, const AxisCounts& position, const Interpolator& by) = 0;
};

/// What became of one drive command.
struct DriveRecord {
  Place place;
  std::uint8_t code = 0;
  std::uint32_t axes = 0;            // mask, bit 0: X
  Time start = 0, end = 0;
  std::uint64_t events = 0;
  AxisCounts pulses{};               // by axis, without sign
  AxisCounts start_position{}, end_position{};   // logical positions
  std::vector<int> quadrants;
  Stop stop = Stop::kRunning;
  std::optional<ErrorRange> error;   // nullopt: not looked at every event
};

/// Something that went wrong in the simulated chip while it ran, or that it would tell its host.
struct ChipEvent { Time time = 0; bool is_error = false; Place place; std::string text; };

/// A value that the script asked for.
struct ReadRecord { Time time = 0; Place place; int reg = 0; std::uint16_t value = 0; };

/// A setting and where it was written.
struct Setting { bool set = false; std::int64_t value = 0; Place place; };

class Chip {
 public:
  Chip();
  ~Chip();
  Chip(const Chip&) = delete;

  /// Takes every event from here on; without, events may be passed over. nullptr: no more.
  void observe(PulseSink* sink) { sink_ = sink; }
  /// Without a sink: drives of at most so many events are executed one event at a time, so that their error is known.
  void set_closely_followed(std::uint64_t events) { closely_followed_ = events; }

  void write(int reg, std::uint16_t value, Place place);
  /// RR0 to RR7. Reading RR1 clears it.
  std::uint16_t read(int reg, Place place);

  /// Executes until this time, until nothing drives, until the next segment may be written. False: `interrupted` said so, or the time
  /// of `latest` came.
  bool run_until(Time time);
  bool run_until_idle();
  bool run_until_next();
  void set_latest(Time latest) { latest_ = latest; }
  void set_interrupted(std::function<bool()> interrupted) { interrupted_ = std::move(interrupted); }

  Time now() const { return now_; }
  bool driving() const;
  /// A drive runs that has no end of its own (52h, 53h).
  bool drives_endlessly() const;
  /// An error of the script that is none of a write.
  void refuse(Place place, std::string text) { problem(true, place, std::move(text)); }
  bool error_pending() const;
  const AxisCounts& position() const { return position_; }
  const std::vector<DriveRecord>& drives() const { return drives_; }
  const std::vector<Problem>& problems() const { return problems_; }
  const std::vector<ChipEvent>& events() const { return events_; }
  const std::vector<ReadRecord>& reads() const { return reads_; }
  /// Axes that any drive has used, or was asked to.
  std::uint32_t axes_used() const { return axes_used_; }

 private:
  struct Axis;          // settings and status of an axis
  struct Running;       // a drive under way
  struct Segment;       // an interpolation drive that has been accepted

  // What a write does (chip.cpp, chip_settings.cpp)
  void command(std::uint16_t value, Place place);
  void execute(const Command& command, std::uint32_t axes, Place place);
  void set_data(const Command& command, std::uint32_t axes, Place place);
  void set_common(const Command& command, Place place);
  void set_mode(std::uint16_t mode, Place place);
  void read_data(const Command& command, std::uint32_t axes, Place place);
  void act(const Command& command, std::uint32_t axes, Place place);
  void change_drive_speed(std::size_t axis, std::int64_t pps);
  void stop_axes(const Command& command, std::uint32_t axes);
  void reset();
  bool check_axes(const Command& command, std::uint32_t axes, Place place);
  std::int64_t data(const Command& command) const;

  // Drive commands (chip_drives.cpp)
  void start_axes(const Command& command, std::uint32_t axes, Place place);
  void start_axis(const Command& command, std::size_t axis, Place place);
  void start_interpolation(const Command& command, Place place);
  void calculate_helix(const Command& command, Place place);
  std::unique_ptr<Interpolator> make_interpolator(const Command& command, Place place);
  std::unique_ptr<Interpolator> make_line(const Command& command, Place place);
  std::unique_ptr<Interpolator> make_arc(const Command& command, Place place);
  std::unique_ptr<Interpolator> make_helix(const Command& command, Place place);
  std::unique_ptr<Interpolator> make_pattern();
  struct ArcData;
  std::optional<ArcData> arc_data(const Command& command, int first, int second, Place place);
  bool check_mode(const Command& command, Place place);
  bool check_speed(std::size_t axis, const Command& command, Place place, SpeedSetting& setting);
  bool check_finish(std::size_t axis, Place place);
  void begin(Segment segment, const SpeedSetting& speed);

  // Running (chip_run.cpp)
  Running* earliest();
  bool advance(Time until);
  void make_event(Running& running);
  bool pass_events(Running& running, Time until);
  void open_record(Running& running);
  void close_record(Running& running, Stop stop);
  void finish_drive(Running& running, Stop stop);
  void end_now(std::unique_ptr<Running>& drive, Stop stop);
  void count_remaining(Running& running);
  void set_deceleration(Running& running);

  void problem(bool is_error, Place place, std::string text);
  void error(Place place, std::string text) { problem(true, place, std::move(text)); }
  void warn_once(const std::string& key, Place place, std::string text);
  void happen(bool is_error, Place place, std::string text) { events_.push_back({now_, is_error, place, std::move(text)}); }

  std::uint32_t mode_axes() const { return mode_.set ? static_cast<std::uint32_t>(mode_.value) & 0xfu : 0; }
  VectorSpeed vector_speed() const { return static_cast<VectorSpeed>(mode_.value >> 6 & 3); }

  std::uint16_t latch_low_ = 0, latch_high_ = 0;              // WR6, WR7
  std::uint16_t result_low_ = 0, result_high_ = 0;            // RR6, RR7
  std::array<std::uint16_t, 2> outputs_{};                    // WR4, WR5
  std::uint32_t selected_ = 1;                                // axes that WR1 to WR3 and RR1 to RR3 belong to
  std::unique_ptr<std::array<Axis, kAxes>> axes_;
  Setting mode_, max_finish_, rotations_, helix_value_;
  bool decelerates_ = false;                                  // 6Dh
  bool fresh_segment_data_ = false;                           // 06h or 08h was written since the last interpolation command
  Place fresh_place_;
  int refused_mode_line_ = 0;                                 // of an interpolation mode that was written while driving; 0: none

  Time now_ = 0, latest_ = time_from_clocks(std::numeric_limits<std::int64_t>::max());
  AxisCounts position_{};
  std::unique_ptr<Running> interpolation_;
  std::array<std::unique_ptr<Running>, kAxes> single_;
  std::deque<Segment> queue_;                                 // the pre-buffer
  std::vector<DriveRecord> drives_;
  std::vector<Problem> problems_;
  std::vector<std::string> warned_;
  std::vector<ChipEvent> events_;
  std::vector<ReadRecord> reads_;
  std::uint32_t axes_used_ = 0;
  PulseSink* sink_ = nullptr;
  std::uint64_t closely_followed_ = 0;
  std::function<bool()> interrupted_;
};

}  // namespace pmac::drives::mcx514
