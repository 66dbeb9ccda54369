#include "runtime/drives/mcx514/mcx514_drive.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/drives/mcx514/collector.h"
#include "runtime/drives/mcx514/encoder.h"

namespace pmac::drives {
namespace mcx514 {
namespace {

constexpr double kShortestPause_s = 1e-6;
constexpr std::uint64_t kMostRows = 200'000;   // of the table of an execution

/// Follows the pulses and measures how far they are from the path.
class PathCheck : public PulseSink {
 public:
  PathCheck(const CollectedPath& path, const std::vector<std::size_t>& items, std::uint64_t events, const Chip& chip, Execution& execution)
      : path_(path), items_(items), stride_(events / kMostRows + 1), chip_(chip), execution_(execution) {}

  void pulses(Time time, const Event&, const AxisCounts& position, const Interpolator&) override {
    Point p{};
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = static_cast<double>(position[i]);
    const Point on_path = nearest_on_path(p);
    const double error = distance(p, on_path);
    worst = std::max(worst, error);
    sum += error;
    if (count++ % stride_ != 0) return;
    execution_.times_s.push_back(seconds(time));
    execution_.error_counts.push_back(error);
    for (std::size_t axis = 0; axis < path_.motors.size(); ++axis) {
      execution_.position_counts[axis].push_back(p[axis] + path_.origin_mu[axis]);
      execution_.commanded_counts[axis].push_back(on_path[axis] + path_.origin_mu[axis]);
    }
  }

  double worst = 0, sum = 0;
  std::uint64_t count = 0;

 private:
  /// On the item that the running drive command belongs to, or on its neighbours where those are nearer.
  Point nearest_on_path(const Point& p) {
    const std::size_t item = items_[std::min(chip_.drives().size(), items_.size() - 1)];
    if (item != item_) hint_ = 0;
    item_ = item;
    Point best = nearest(path_.items[item], p, hint_);
    double off = distance(p, best);
    for (const std::size_t other : {item > 0 ? item - 1 : item, std::min(item + 1, path_.items.size() - 1)}) {
      if (other == item || off <= 0.5) continue;
      std::size_t hint = other < item && !path_.items[other].points.empty() ? path_.items[other].points.size() - 2 : 0;
      const Point candidate = nearest(path_.items[other], p, hint);
      if (distance(p, candidate) >= off) continue;
      off = distance(p, candidate);
      best = candidate;
    }
    return best;
  }

  const CollectedPath& path_;
  const std::vector<std::size_t>& items_;
  std::uint64_t stride_;
  const Chip& chip_;
  Execution& execution_;
  std::size_t item_ = 0, hint_ = 0;
};

class Mcx514Drive : public Drive {
 public:
  Mcx514Drive(const EncoderSetting& setting, DriveContext context) : context_(context), collector_(std::move(context)), setting_(setting) {}

  void take(int coord, const motion::PathPiece& piece) override { collector_.take(coord, piece); }
  void take(const runtime::SampleBlock& block) override { collector_.take(block); }
  void take(const runtime::MoveRecord& move) override { collector_.take(move); }

  std::optional<std::string> encode() override;
  void frames(const std::function<void(const Frame&)>& sink) const override {
    for (const ScriptLine& line : encoder_->lines()) sink({line.time_s, line.text});
  }
  Execution execute() override;

 private:
  Execution empty_execution() const;
  void add_figures(const Chip& chip, const PathCheck& check, Execution& execution) const;

  DriveContext context_;
  Collector collector_;
  EncoderSetting setting_;
  CollectedPath path_;
  std::unique_ptr<Encoder> encoder_;
};

std::optional<std::string> Mcx514Drive::encode() {
  auto collected = collector_.finish();
  if (auto* why = std::get_if<std::string>(&collected)) return *why;
  path_ = std::move(std::get<CollectedPath>(collected));
  encoder_ = std::make_unique<Encoder>(setting_);
  double end_s = 0;
  for (const PathItem& item : path_.items) {
    if (item.start_s - end_s > kShortestPause_s) encoder_->pause(item.start_s - end_s);
    if (const auto why = encoder_->add(item)) return context_.place(item.source) + ": " + *why;
    end_s = item.start_s + item.duration_s;
  }
  encoder_->finish();
  return std::nullopt;
}

Execution Mcx514Drive::empty_execution() const {
  Execution execution;
  for (std::size_t axis = 0; axis < path_.motors.size(); ++axis) execution.axes.push_back(fmt::format("Motor[{}]", path_.motors[axis]));
  execution.position_counts.resize(path_.motors.size());
  execution.commanded_counts.resize(path_.motors.size());
  for (const std::string& note : path_.notes) execution.events.push_back({path_.end_s, true, note});
  return execution;
}

void Mcx514Drive::add_figures(const Chip& chip, const PathCheck& check, Execution& execution) const {
  std::uint64_t events = 0;
  AxisCounts pulses{};
  for (const DriveRecord& drive : chip.drives()) {
    events += drive.events;
    for (std::size_t axis = 0; axis < kAxes; ++axis) pulses[axis] += drive.pulses[axis];
  }
  std::vector<Figure>& figures = execution.figures;
  figures.push_back({"drive_commands", static_cast<double>(chip.drives().size())});
  figures.push_back({"writes_and_waits", static_cast<double>(encoder_->lines().size())});
  figures.push_back({"pulse_events", static_cast<double>(events)});
  for (std::size_t axis = 0; axis < path_.motors.size(); ++axis) {
    figures.push_back({fmt::format("pulses_{}", kAxisNames[axis]), static_cast<double>(pulses[axis])});
    figures.push_back({fmt::format("position_{}", kAxisNames[axis]), static_cast<double>(chip.position()[axis])});
  }
  figures.push_back({"program_time_s", path_.end_s});
  figures.push_back({"error_max_pulses", check.worst});
  figures.push_back({"error_mean_pulses", check.count > 0 ? check.sum / static_cast<double>(check.count) : 0});
  Point at{};
  for (std::size_t axis = 0; axis < kAxes; ++axis) at[axis] = static_cast<double>(chip.position()[axis]);
  figures.push_back({"end_error_pulses", path_.items.empty() ? 0 : distance(at, path_.items.back().end)});
}

/// Reads the lines as any script and executes them.
Execution Mcx514Drive::execute() {
  Execution execution = empty_execution();
  std::string text;
  for (const ScriptLine& line : encoder_->lines()) text += line.text + "\n";
  const Script script = read_script(text);
  Chip chip;
  PathCheck check(path_, encoder_->items(), encoder_->events(), chip, execution);
  chip.observe(&check);
  if (run_items(script, chip)) chip.run_until_idle();
  execution.time_s = seconds(chip.now());
  for (const Problem& problem : chip.problems())
    if (problem.is_error) execution.events.push_back({execution.time_s, true, fmt::format("frame {}: {}", problem.line, problem.text)});
  for (const ChipEvent& event : chip.events()) execution.events.push_back({seconds(event.time), event.is_error, fmt::format("frame {}: {}", event.place.line, event.text)});
  add_figures(chip, check, execution);
  return execution;
}

}  // namespace
}  // namespace mcx514

std::variant<std::unique_ptr<Drive>, std::string> make_mcx514(const Settings& settings, DriveContext context) {
  mcx514::EncoderSetting encoder;
  for (const auto& [name, value] : settings) {
    if (name == "speed" && (value == "program" || value == "duration")) encoder.keep_duration = value == "duration";
    else if (name == "continuous" && (value == "on" || value == "off")) encoder.continuous = value == "on";
    else if (name == "speed") return "speed is program or duration, not '" + value + "'";
    else if (name == "continuous") return "continuous is on or off, not '" + value + "'";
    else return "mcx514 has no setting '" + name + "'; there are speed and continuous";
  }
  return std::make_unique<mcx514::Mcx514Drive>(encoder, std::move(context));
}

}  // namespace pmac::drives
