#include "runtime/drives/silverlode/network.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/drives/silverlode/host.h"
#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {
namespace {

/// The servos on their line, with the wire of I/O 1.
class Servos {
 public:
  Servos(const Table& table, const NetworkSetup& setup, std::function<void(bool, const std::string&)> report) : setup_(setup), levels_(static_cast<std::size_t>(setup.start_latency_ticks) + 1, true) {
    for (std::size_t a = 0; a < table.axes.size(); ++a) {
      const int id = setup.servo_ids.empty() ? setup.host_ids[a] : setup.servo_ids[a];
      devices_.emplace_back(DeviceSetup{table.axes[a], id, setup.queue_depth, table.start_counts[a]}, setup.commands, report);
    }
    profiles_.resize(devices_.size());
  }

  /// The levels of I/O 1 travel to the followers in start_latency_ticks; without a wire they see it high.
  void step() {
    devices_.front().step(true);
    std::rotate(levels_.begin(), levels_.end() - 1, levels_.end());
    levels_.front() = devices_.front().output1();
    for (std::size_t a = 1; a < devices_.size(); ++a) devices_[a].step(!setup_.wired || levels_.back());
  }

  std::span<const Profile> profiles() {
    for (std::size_t a = 0; a < devices_.size(); ++a) profiles_[a] = devices_[a].profile();
    return profiles_;
  }
  bool any_moves() const { return std::any_of(devices_.begin(), devices_.end(), [](const Device& d) { return d.is_moving(); }); }
  bool any_jogs() const { return std::any_of(devices_.begin(), devices_.end(), [](const Device& d) { return d.is_jogging(); }); }
  std::vector<Device>& devices() { return devices_; }

 private:
  const NetworkSetup& setup_;
  std::vector<Device> devices_;
  std::vector<bool> levels_;            // of the leader's output; front: now
  std::vector<Profile> profiles_;
};

/// What each axis executed, and what that says about the run.
void conclude(NetworkResult& result, const Table& table, const NetworkSetup& setup, Servos& servos, double time_s, bool ended_by_panel) {
  const auto report = [&](bool is_error, std::string text) { result.events.push_back({time_s, is_error, std::move(text)}); };
  const std::int64_t leader = servos.devices().front().cycles_since_start();
  for (std::size_t a = 0; a < table.axes.size(); ++a) {
    const Device& device = servos.devices()[a];
    const std::int64_t own = device.cycles_since_start();
    const bool both = own >= 0 && leader >= 0;
    result.start_ticks.push_back(both ? leader - own : own >= 0 ? 0 : -1);
    result.executed.push_back(device.executed());
    result.left.push_back(device.queued());
    result.ran_dry.push_back(device.ran_dry());
    if (ended_by_panel) continue;
    if (own < 0) report(true, fmt::format("{} never started; its servo program waits", table.axes[a]));
    else if (both && leader != own)
      report(false, fmt::format("{} started {} ticks ({:.3f} ms) after {}{}", table.axes[a], leader - own, static_cast<double>(leader - own) * kTick_s * 1000, table.axes[0],
                                setup.compensate_start ? ", which waited for it" : ""));
    if (device.queued() > 0) report(true, fmt::format("{} entries of {} were not executed", device.queued(), table.axes[a]));
  }
}

/// Motion that nobody will end: a jog whose slider is not let go.
constexpr double kJogAfterLastAction_s = 1;

double latest_end_s(const Table& table, const NetworkSetup& setup, std::size_t frames) {
  const double line_s = static_cast<double>(frames) * (static_cast<double>(kMostFrameBytes) * 2 * setup.bits_per_byte / setup.baud + setup.host_delay_s + setup.reply_delay_s + setup.reply_timeout_s);
  const double actions_s = setup.actions.empty() ? 0 : setup.actions.back().time_s + 3600;
  return 100 + 3 * (static_cast<double>(table.ticks()) * kTick_s + line_s) + actions_s;
}

}  // namespace

NetworkResult run_network(const Table& table, const NetworkSetup& setup, const NetworkVisit& visit) {
  NetworkResult result;
  double now_s = 0;
  Servos servos(table, setup, [&](bool is_error, const std::string& text) { result.events.push_back({now_s, is_error, text}); });
  Host host(table, setup, servos.devices(), result);
  const double limit_s = latest_end_s(table, setup, host.script_size());
  std::int64_t motion_tick = -1;
  bool was_moving = false;
  for (std::int64_t cycle = 0;; ++cycle) {
    now_s = static_cast<double>(cycle) * kTick_s;
    host.run_to(now_s);
    const auto before = servos.profiles();
    const std::vector<Profile> stood = motion_tick < 0 ? std::vector<Profile>(before.begin(), before.end()) : std::vector<Profile>();
    servos.step();
    if (motion_tick < 0 && servos.any_moves()) {
      motion_tick = 0;
      result.start_s = now_s;
      visit(0, stood);
    }
    if (motion_tick >= 0 && (servos.any_moves() || was_moving || !host.done())) visit(++motion_tick, servos.profiles());
    was_moving = servos.any_moves();
    if (host.done() && !was_moving) break;
    if (host.done() && servos.any_jogs() && now_s > host.last_action_s() + kJogAfterLastAction_s) {
      result.events.push_back({now_s, false, "a jog goes on; its slider was not let go"});
      break;
    }
    if (now_s > limit_s) {
      result.events.push_back({now_s, true, "the motion does not end; the run is broken off"});
      break;
    }
  }
  result.time_s = now_s;
  conclude(result, table, setup, servos, now_s, host.ended_by_panel());
  std::stable_sort(result.events.begin(), result.events.end(), [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  return result;
}

std::optional<std::string> problem_of(const NetworkSetup& setup, std::size_t axes) {
  const std::vector<int>& servo_ids = setup.servo_ids.empty() ? setup.host_ids : setup.servo_ids;
  if (setup.host_ids.size() < axes || servo_ids.size() < axes) return fmt::format("{} axes need as many ids", axes);
  for (const auto* ids : {&setup.host_ids, &servo_ids})
    for (std::size_t a = 0; a < axes; ++a)
      if ((*ids)[a] < 1 || (*ids)[a] > kMostAddress) return fmt::format("an id must be 1 to {}", kMostAddress);
  if (setup.queue_depth < setup.entries_before_start + (setup.compensate_start ? 1 : 0))
    return fmt::format("a queue of {} entries fills before the start after {}; make it deeper", setup.queue_depth, setup.entries_before_start + (setup.compensate_start ? 1 : 0));
  if (!(setup.baud >= 300 && setup.baud <= 1e8)) return "the baud rate must be 300 to 100000000";
  if (setup.start_latency_ticks < 0 || setup.start_latency_ticks > 1'000'000) return "the start latency must be 0 to 1000000 ticks";
  for (const double delay_s : {setup.reply_delay_s, setup.host_delay_s, setup.reply_timeout_s})
    if (!(delay_s >= 0 && delay_s <= 60)) return "delays must be 0 to 60 s";
  if (!(setup.reply_timeout_s > setup.reply_delay_s)) return "the host must wait longer than a servo takes to answer";
  if (!(setup.panel_accel_counts_s2 > 0)) return "the acceleration of jogs must be above 0";
  return std::nullopt;
}

double link_time_per_entry_s(const Table& table, const NetworkSetup& setup) {
  if (table.entries.empty()) return 0;
  const auto frames = host_frames(table, setup);
  double bytes = 0;
  for (const CommandFrame& frame : frames) bytes += static_cast<double>(encode(frame).size() + encode(ReplyFrame(Ack{frame.address})).size());
  const double frame_count = static_cast<double>(frames.size());
  return (bytes * setup.bits_per_byte / setup.baud + frame_count * (setup.reply_delay_s + setup.host_delay_s)) / static_cast<double>(table.entries.size());
}

std::vector<CommandFrame> host_frames(const Table& table, const NetworkSetup& setup) {
  const auto number = [&setup](CommandName name) { return setup.commands.number(name); };
  std::vector<CommandFrame> frames;
  for (std::size_t a = 0; a < table.axes.size(); ++a) frames.push_back({setup.host_ids[a], number(CommandName::kRUN), {a == 0 ? 1 : 2}});
  if (setup.compensate_start && setup.start_latency_ticks > 0)
    frames.push_back({setup.host_ids[0], number(CommandName::kIMW), {setup.start_latency_ticks, kFarPosition, 0, 0}});
  for (std::size_t i = 0; i < table.entries.size(); ++i) {
    const Entry& entry = table.entries[i];
    for (std::size_t a = 0; a < table.axes.size(); ++a)
      frames.push_back({setup.host_ids[a], number(CommandName::kIMW), {entry.ticks, entry.axis[a].pos, entry.axis[a].acc, entry.axis[a].vel}});
    if (i + 1 == std::min(setup.entries_before_start, table.entries.size())) frames.push_back({setup.host_ids[0], number(CommandName::kWRI), {11, 1}});
  }
  frames.push_back({setup.host_ids[0], number(CommandName::kWRI), {11, 0}});
  return frames;
}

}  // namespace pmac::drives::silverlode
