#include "runtime/drives/silverlode/host.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {

Host::Host(const Table& table, const NetworkSetup& setup, std::vector<Device>& devices, NetworkResult& result)
    : table_(table), setup_(setup), devices_(devices), result_(result) {
  const auto frames = host_frames(table, setup);
  if (!table.entries.empty()) script_.assign(frames.begin(), frames.end());
  std::int64_t longest = 0;
  for (const Entry& entry : table.entries) longest = std::max<std::int64_t>(longest, entry.ticks);
  full_limit_s_ = 1 + 2 * static_cast<double>(longest) * kTick_s;
}

double Host::line_time_s(const std::string& bytes) const { return static_cast<double>(bytes.size()) * setup_.bits_per_byte / setup_.baud; }

std::string Host::name_of(const CommandFrame& frame) const { return describe(frame, setup_.commands); }

void Host::run_to(double now_s) {
  while (time_s_ <= now_s) {
    if (state_ == State::kSending) frame_arrives();
    else if (state_ == State::kWaiting) reply_arrives();
    else if (!begin_next(now_s)) return;
  }
}

/// The line is free: a button that has been pressed, then the next frame. False where there is nothing to send.
bool Host::begin_next(double now_s) {
  const bool pressed = next_action_ < setup_.actions.size() && setup_.actions[next_action_].time_s <= (script_.empty() ? now_s : time_s_);
  if (pressed) {
    time_s_ = std::max(time_s_, setup_.actions[next_action_].time_s);
    press(setup_.actions[next_action_++]);
  }
  if (script_.empty()) {
    if (!pressed) time_s_ = now_s;
    return pressed;
  }
  begin_frame();
  return true;
}

void Host::begin_frame() {
  time_s_ += setup_.host_delay_s;
  const std::string bytes = encode(script_.front());
  result_.frames.push_back({time_s_, bytes, {}});
  result_.bytes += bytes.size();
  time_s_ += line_time_s(bytes);
  state_ = State::kSending;
  ++sent_;
}

/// The CR is there: whoever has the address executes the frame and answers.
void Host::frame_arrives() {
  state_ = State::kWaiting;
  reply_.clear();
  collision_ = false;
  const bool lost = std::find(setup_.lost_frames.begin(), setup_.lost_frames.end(), sent_) != setup_.lost_frames.end();
  std::string bytes = result_.frames.back().bytes;
  bytes.pop_back();
  const auto decoded = decode_command(bytes);
  if (const auto* frame = std::get_if<CommandFrame>(&decoded); frame != nullptr && !lost)
    for (Device& device : devices_) {
      if (device.id() != frame->address) continue;
      collision_ = !reply_.empty();
      reply_ = encode(device.handle(*frame));
    }
  result_.frames.back().reply = collision_ ? std::string() : reply_;
  result_.bytes += reply_.size();
  time_s_ += reply_.empty() || collision_ ? setup_.reply_timeout_s : setup_.reply_delay_s + line_time_s(reply_);
}

void Host::reply_arrives() {
  state_ = State::kFree;
  if (reply_.empty() || collision_) return nobody_answers();
  const auto reply = decode_reply(std::string_view(reply_).substr(0, reply_.size() - 1));
  if (const auto* frame = std::get_if<ReplyFrame>(&reply))
    if (const Nak* nak = std::get_if<Nak>(frame)) return refused(*nak);
  script_.pop_front();
  tries_ = 0;
  full_since_s_ = -1;
}

void Host::nobody_answers() {
  ++result_.unanswered;
  const std::string what = name_of(script_.front());
  if (tries_++ < setup_.retries) {
    report(false, fmt::format("{}: {}; it is sent again", what, collision_ ? "two servos answer at once" : "no answer"));
    return;
  }
  give_up(fmt::format("{}: {} after {} tries; check the ids of the servos and of the host", what, collision_ ? "two servos answer at once" : "no answer", tries_));
}

void Host::refused(const Nak& nak) {
  ++result_.refusals;
  if (nak.code != static_cast<int>(NakCode::kBufferFull))
    return give_up(fmt::format("{}: refused, {} ({})", name_of(script_.front()), text_of(static_cast<NakCode>(nak.code)), nak.code));
  if (++result_.full_queue_refusals == 1)
    report(false, fmt::format("{}: refused, {} ({}); it is sent again until there is room", name_of(script_.front()), text_of(NakCode::kBufferFull), nak.code));
  if (full_since_s_ < 0) full_since_s_ = time_s_;
  if (time_s_ - full_since_s_ > full_limit_s_)
    give_up(fmt::format("{}: the queue has been full for {:.3f} s and does not move on", name_of(script_.front()), time_s_ - full_since_s_));
}

void Host::give_up(const std::string& why) {
  report(true, why + "; the host gives up");
  result_.gave_up = true;
  script_.clear();
  tries_ = 0;
  full_since_s_ = -1;
}

void Host::send_to_all(CommandName name, std::vector<std::int64_t> parameters) {
  for (std::size_t a = 0; a < table_.axes.size(); ++a) script_.push_back({setup_.host_ids[a], setup_.commands.number(name), parameters});
}

void Host::move_to(std::size_t axis, std::int64_t position, double speed_counts_s) {
  const auto acc = std::clamp<std::int64_t>(std::llround(sau_from_counts_s2(setup_.panel_accel_counts_s2)), 1, kMostAcceleration);
  const auto vel = std::clamp<std::int64_t>(std::llround(std::abs(svu_from_counts_s(speed_counts_s))), 0, kMostVelocity);
  script_.push_back({setup_.host_ids[axis], setup_.commands.number(CommandName::kMAV), {position, acc, vel, 0, 0}});
}

void Host::press(const PanelAction& action) {
  using Kind = PanelAction::Kind;
  last_action_s_ = time_s_;
  const bool moves_by_queue = !script_.empty() || std::any_of(devices_.begin(), devices_.end(), [](const Device& d) { return d.phase() == Phase::kQueue; });
  const bool stops = action.kind == Kind::kStop || action.kind == Kind::kRestart;
  if (!stops && moves_by_queue) return report(true, "jog and centre wait for the end of the move; press STOP first");
  if (stops) {
    ended_by_panel_ = true;
    if (!script_.empty()) report(false, fmt::format("the move is broken off with {} frames to send", script_.size()));
    script_.clear();
  }
  switch (action.kind) {
    case Kind::kStop: report(false, "STOP: STP to every axis"); return send_to_all(CommandName::kSTP, {0});
    case Kind::kRestart: report(false, "Restart: RST to every axis"); return send_to_all(CommandName::kRST, {});
    case Kind::kCenter:
      report(false, "GOTO Center: every axis to position 0");
      for (std::size_t a = 0; a < table_.axes.size(); ++a) move_to(a, 0, action.speed_counts_s);
      return;
    case Kind::kJog: break;
  }
  report(false, fmt::format("jog of {} at {} counts/s", table_.axes[action.axis], action.speed_counts_s));
  if (action.speed_counts_s == 0) script_.push_back({setup_.host_ids[action.axis], setup_.commands.number(CommandName::kSTP), {0}});
  else move_to(action.axis, action.speed_counts_s > 0 ? kFarPosition : -kFarPosition, action.speed_counts_s);
}

}  // namespace pmac::drives::silverlode
