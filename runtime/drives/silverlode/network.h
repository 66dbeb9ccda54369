// Host, line and servos together: what "Make Circles" sends for its table, byte by byte at 57600 baud, and what the servos make of it.
//
// Host: load the servo programs, IMW of every entry to every axis, register 11 := 1 to the leader after the second entry, register 11 := 0 after
// the last. It waits for every reply; a full queue is tried again, silence is tried again and then given up.
//
// Source: application note "Make Circles"; assumed: time-outs, delays, how often is tried again, how programs are loaded.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "runtime/drives/silverlode/device.h"
#include "runtime/drives/silverlode/protocol.h"
#include "runtime/drives/silverlode/table.h"

namespace pmac::drives::silverlode {

/// A button of the note's main dialog.
struct PanelAction {
  enum class Kind : std::uint8_t { kStop, kRestart, kJog, kCenter };
  double time_s = 0;               // since the host began to send
  Kind kind = Kind::kStop;
  std::size_t axis = 0;            // jog
  double speed_counts_s = 0;       // jog and centre; a jog of 0 lets the slider go
};

struct NetworkSetup {
  CommandSet commands;
  std::vector<int> host_ids{16, 17, 18};    // [axis], whom the host addresses
  std::vector<int> servo_ids;               // [axis], who is there; empty: as host_ids
  std::size_t queue_depth = 10;             // assumed
  std::size_t entries_before_start = 2;
  int start_latency_ticks = 1;              // assumed: a follower sees the leader's output so much later
  bool compensate_start = false;            // the leader waits as long, by an entry at rest before its first
  bool wired = true;                        // I/O 1 of the leader reaches the followers
  double baud = 57600;
  double bits_per_byte = 11;                // start, 8 data, 2 stop
  double reply_delay_s = 0.00012;           // assumed: a servo answers a cycle after the CR
  double host_delay_s = 0;                  // assumed: the host's own time before each frame
  double reply_timeout_s = 0.05;            // assumed
  int retries = 2;                          // assumed, of a frame that nobody answered
  std::vector<std::size_t> lost_frames;     // frames (from 1, in order of sending, repeats included) that the line swallows
  std::vector<PanelAction> actions;         // in order of time
  double panel_accel_counts_s2 = 200'000;   // of jogs and centre
};

struct SentFrame {
  double time_s = 0;               // first bit, since the host began
  std::string bytes;               // with the CR
  std::string reply;               // with the CR; empty: none
};

struct NetworkEvent {
  double time_s = 0;               // since the host began
  bool is_error = false;
  std::string text;
};

struct NetworkResult {
  std::vector<SentFrame> frames;
  std::vector<NetworkEvent> events;
  double start_s = 0;                            // the leader's first cycle of motion; 0: it never started
  std::vector<std::int64_t> start_ticks;         // [axis], against the leader; -1: never started
  std::vector<std::size_t> executed, left;       // [axis], entries executed, entries left in the queue
  std::vector<bool> ran_dry;                     // [axis]
  std::size_t full_queue_refusals = 0, unanswered = 0, refusals = 0;
  std::size_t bytes = 0;                         // both ways
  double time_s = 0;                             // end of everything
  bool gave_up = false;
};

/// Called for every servo cycle once the leader has started (or a panel action has moved something), with the profiles [axis]; `tick` counts
/// from the first of them, 0 being the state before it.
using NetworkVisit = std::function<void(std::int64_t tick, std::span<const Profile> servos)>;

NetworkResult run_network(const Table& table, const NetworkSetup& setup, const NetworkVisit& visit);

/// Why a setup makes no sense, or nothing. axes: of the table.
std::optional<std::string> problem_of(const NetworkSetup& setup, std::size_t axes);

/// Time on the line of one entry to every axis, replies included; slices should not be shorter.
double link_time_per_entry_s(const Table& table, const NetworkSetup& setup);

/// Frames of the table in the host's order, without answers and repeats.
std::vector<CommandFrame> host_frames(const Table& table, const NetworkSetup& setup);

}  // namespace pmac::drives::silverlode
