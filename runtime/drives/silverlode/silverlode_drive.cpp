#include "runtime/drives/silverlode/silverlode_drive.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/drives/silverlode/commanded.h"
#include "runtime/drives/silverlode/drive_settings.h"
#include "runtime/drives/silverlode/motion_table.h"
#include "runtime/drives/silverlode/path_table.h"
#include "runtime/drives/silverlode/units.h"

namespace pmac::drives {
namespace silverlode {
namespace {

constexpr std::size_t kMostRows = 2'000'000;      // of the record: a row a tick up to four minutes, then fewer

/// Whole even ticks, at least so long.
double even_ticks(double seconds) { return 2 * std::ceil(seconds / kTick_s / 2 - 1e-9); }

class SilverlodeDrive : public Drive {
 public:
  explicit SilverlodeDrive(DriveSettings settings) : settings_(std::move(settings)) {}

  void take(const runtime::SampleBlock& block) override { commanded_.take(block); }
  using Drive::take;

  std::optional<std::string> encode() override;
  void frames(const std::function<void(const Frame&)>& sink) const override;
  Execution execute() override { return std::move(execution_); }

 private:
  std::optional<std::string> check_axes() const;
  std::optional<std::string> fit_motion();
  std::optional<std::string> make_table();
  void run_frames();
  void add_row(std::int64_t tick, std::span<const Profile> servos);
  void add_figures(const NetworkResult& result);
  void add_events(const NetworkResult& result);

  DriveSettings settings_;
  Commanded commanded_;
  SplineFit fit_;
  Sheet sheet_;
  Table table_;
  std::vector<Frame> frames_;
  Execution execution_;
  std::int64_t row_step_ = 1, rows_seen_ = 0;
  double path_max_ = 0, timed_max_ = 0, path_square_ = 0, end_error_ = 0;
  double commanded_s_ = 0, stretch_ = 1;
};

std::optional<std::string> SilverlodeDrive::check_axes() const {
  if (!commanded_.moves()) return "no motor moves, so there is nothing to encode";
  const std::size_t axes = commanded_.axes();
  for (const auto& [name, values] : {std::pair("max_speed", &settings_.max_speed_rpm), std::pair("max_accel", &settings_.max_accel_rpm_s)})
    if (values->size() != 1 && values->size() != axes) return fmt::format("{} has {} values for {} axes that move; give one, or one an axis", name, values->size(), axes);
  for (std::size_t a = 0; a < axes; ++a)
    if (commanded_.furthest(a) >= static_cast<double>(kFarPosition))
      return fmt::format("Motor[{}] leaves the range of a servo, {} counts either side of 0; set scale", commanded_.motors()[a], kFarPosition);
  if (!settings_.ids.empty() && settings_.ids.size() != axes) return fmt::format("id has {} values for {} axes that move", settings_.ids.size(), axes);
  return std::nullopt;
}

/// Corners and ramps within the limits.
std::optional<std::string> SilverlodeDrive::fit_motion() {
  commanded_s_ = commanded_.duration_s();
  std::vector<CountLimits> limits;
  for (std::size_t a = 0; a < commanded_.axes(); ++a)
    limits.push_back({counts_s_from_rpm(of_axis(settings_.max_speed_rpm, a)), counts_s_from_rpm(of_axis(settings_.max_accel_rpm_s, a))});
  FitSetup fit;
  fit.tolerance_counts = settings_.tolerance_counts;
  fit.least_ticks = even_ticks(settings_.least_slice_s(commanded_.axes()));
  auto fitted = fit_within(commanded_, limits, fit);
  if (auto* why = std::get_if<std::string>(&fitted)) return *why;
  MotionFit& made = std::get<MotionFit>(fitted);
  commanded_ = std::move(made.motion);
  fit_ = std::move(made.fit);
  stretch_ = made.stretch;
  return std::nullopt;
}

std::optional<std::string> SilverlodeDrive::make_table() {
  const std::size_t n = fit_.ramp_ticks.size() - 2;
  std::vector<std::string> names;
  for (const int motor : commanded_.motors()) names.push_back(fmt::format("Motor[{}]", motor));
  sheet_ = empty_sheet(names, n);
  PathTable path;
  path.ramp_ticks = fit_.ramp_ticks;
  path.makes_up = true;
  for (std::size_t a = 0; a < names.size(); ++a) {
    path.limits.push_back({of_axis(settings_.max_speed_rpm, a), of_axis(settings_.max_accel_rpm_s, a)});
    AxisColumns& axis = sheet_.axis[a];
    for (std::size_t i = 0; i <= n; ++i) {
      if (std::abs(fit_.corner_counts[a][i]) >= static_cast<double>(kFarPosition)) return fmt::format("{} leaves the range of a servo, {} counts either side of 0; set scale", names[a], kFarPosition);
      axis.position[i] = fit_.corner_counts[a][i];
      if (i > 0) axis.delta[i] = axis.position[i] - axis.position[i - 1];
    }
    axis.position[n + 1] = axis.position[n];
  }
  if (auto why = fill_closed(sheet_, path)) return why;
  auto made = table_from(sheet_);
  if (auto* why = std::get_if<std::string>(&made)) return *why;
  table_ = std::move(std::get<Table>(made));
  return std::nullopt;
}

void SilverlodeDrive::add_row(std::int64_t tick, std::span<const Profile> servos) {
  const std::int64_t wait = settings_.network.compensate_start ? settings_.network.start_latency_ticks : 0;
  // The position moves by the velocity at the end of each cycle, half a cycle ahead of a motion in continuous time.
  const double wanted_s = (static_cast<double>(tick - wait) + 0.5) * kTick_s / stretch_;
  std::vector<double> position(servos.size()), wanted(servos.size());
  double square = 0;
  for (std::size_t a = 0; a < servos.size(); ++a) {
    position[a] = static_cast<double>(servos[a].position) / kUnitsPerCount;
    wanted[a] = commanded_.position(a, wanted_s);
    square += (position[a] - wanted[a]) * (position[a] - wanted[a]);
  }
  const double timed = std::sqrt(square), path = servos.size() > 1 ? std::min(timed, commanded_.distance(position, wanted_s)) : timed;
  path_max_ = std::max(path_max_, path);
  timed_max_ = std::max(timed_max_, timed);
  path_square_ += path * path;
  end_error_ = timed;
  if (rows_seen_++ % row_step_ != 0) return;
  execution_.times_s.push_back(static_cast<double>(tick) * kTick_s);
  execution_.error_counts.push_back(path);
  for (std::size_t a = 0; a < servos.size(); ++a) {
    execution_.position_counts[a].push_back(position[a]);
    execution_.commanded_counts[a].push_back(wanted[a]);
  }
}

void SilverlodeDrive::add_events(const NetworkResult& result) {
  const double slowed_s = commanded_.duration_s() * stretch_;
  if (slowed_s > commanded_s_ * 1.0001)
    execution_.events.push_back({0, false, fmt::format("the motion is slowed down along its path from {:.6f} s to {:.6f} s to keep max_speed and max_accel", commanded_s_, slowed_s)});
  for (const NetworkEvent& event : result.events) execution_.events.push_back({event.time_s, event.is_error, event.text});
}

void SilverlodeDrive::add_figures(const NetworkResult& result) {
  const double rows = static_cast<double>(std::max<std::int64_t>(rows_seen_, 1));
  execution_.figures = {{"error_max_counts", path_max_},
                        {"error_rms_counts", std::sqrt(path_square_ / rows)},
                        {"timed_error_max_counts", timed_max_},
                        {"end_error_counts", end_error_},
                        {"fit_error_max_counts", fit_.error_counts},
                        {"entries", static_cast<double>(table_.entries.size())},
                        {"ticks", static_cast<double>(table_.ticks())},
                        {"commanded_s", commanded_s_},
                        {"commanded_start_s", commanded_.start_s()},
                        {"table_s", static_cast<double>(table_.ticks()) * kTick_s},
                        {"frames", static_cast<double>(frames_.size())},
                        {"full_queue_refusals", static_cast<double>(result.full_queue_refusals)},
                        {"link_start_s", result.start_s},
                        {"link_s", result.time_s},
                        {"record_step_ticks", static_cast<double>(row_step_)}};
  execution_.time_s = execution_.times_s.empty() ? 0 : static_cast<double>(rows_seen_ - 1) * kTick_s;
}

void SilverlodeDrive::run_frames() {
  NetworkSetup network = settings_.network;
  network.host_ids = settings_.ids;
  for (std::size_t a = network.host_ids.size(); a < table_.axes.size(); ++a) network.host_ids.push_back(16 + static_cast<int>(a));
  row_step_ = 1 + table_.ticks() / static_cast<std::int64_t>(kMostRows);
  execution_.axes = table_.axes;
  execution_.position_counts.resize(table_.axes.size());
  execution_.commanded_counts.resize(table_.axes.size());
  const NetworkResult result = run_network(table_, network, [&](std::int64_t tick, std::span<const Profile> servos) { add_row(tick, servos); });
  for (const SentFrame& frame : result.frames) {
    const bool refused = frame.reply.starts_with('!');
    if (!refused) frames_.push_back({frame.time_s, frame.bytes.substr(0, frame.bytes.size() - 1)});
  }
  add_figures(result);
  add_events(result);
}

std::optional<std::string> SilverlodeDrive::encode() {
  commanded_.finish(settings_.counts_per_mu);
  if (auto why = check_axes()) return why;
  if (auto why = fit_motion()) return why;
  if (auto why = make_table()) return why;
  NetworkSetup network = settings_.network;
  network.host_ids.assign(table_.axes.size(), 16);
  if (auto why = problem_of(network, table_.axes.size())) return why;
  run_frames();
  return std::nullopt;
}

void SilverlodeDrive::frames(const std::function<void(const Frame&)>& sink) const {
  for (const Frame& frame : frames_) sink(frame);
}

}  // namespace
}  // namespace silverlode

std::variant<std::unique_ptr<Drive>, std::string> make_silverlode(const Settings& settings, DriveContext /*context*/) {
  auto read = silverlode::read_settings(settings);
  if (auto* why = std::get_if<std::string>(&read)) return "silverlode: " + *why;
  return std::make_unique<silverlode::SilverlodeDrive>(std::move(std::get<silverlode::DriveSettings>(read)));
}

}  // namespace pmac::drives
