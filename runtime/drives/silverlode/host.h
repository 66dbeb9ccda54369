// The host's side of the line: sends one frame, waits for its reply, goes on; buttons of the panel come in between.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "runtime/drives/silverlode/network.h"

namespace pmac::drives::silverlode {

class Host {
 public:
  Host(const Table& table, const NetworkSetup& setup, std::vector<Device>& devices, NetworkResult& result);

  /// Everything on the line up to now.
  void run_to(double now_s);
  bool done() const { return state_ == State::kFree && script_.empty() && next_action_ == setup_.actions.size(); }
  std::size_t script_size() const { return script_.size(); }
  double last_action_s() const { return last_action_s_; }
  /// A stop or restart has ended the move.
  bool ended_by_panel() const { return ended_by_panel_; }

 private:
  enum class State { kFree, kSending, kWaiting };

  bool begin_next(double now_s);
  void begin_frame();
  void frame_arrives();
  void reply_arrives();
  void nobody_answers();
  void refused(const Nak& nak);
  void give_up(const std::string& why);
  void press(const PanelAction& action);
  void send_to_all(CommandName name, std::vector<std::int64_t> parameters);
  void move_to(std::size_t axis, std::int64_t position, double speed_counts_s);
  void report(bool is_error, std::string text) { result_.events.push_back({time_s_, is_error, std::move(text)}); }
  double line_time_s(const std::string& bytes) const;
  std::string name_of(const CommandFrame& frame) const;

  const Table& table_;
  const NetworkSetup& setup_;
  std::vector<Device>& devices_;
  NetworkResult& result_;
  std::deque<CommandFrame> script_;        // front: being sent, or next
  State state_ = State::kFree;
  double time_s_ = 0;                      // of the next event on the line
  std::string reply_;                      // on its way; empty: silence
  bool collision_ = false;
  int tries_ = 0;
  double full_since_s_ = -1, full_limit_s_ = 0;
  std::size_t sent_ = 0, next_action_ = 0;
  double last_action_s_ = 0;
  bool ended_by_panel_ = false;
};

}  // namespace pmac::drives::silverlode
