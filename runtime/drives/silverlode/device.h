// One servo on the line: commands in, replies out, a servo program that waits for the start, the queue of moves, the profile.
//
//     leader    wait until register 11 is not 0; clear output 1; IMS; wait until register 11 is 0; set output 1; again
//     follower  wait until I/O 1 is low;                          IMS; wait until I/O 1 is high;                  again
//
// Source: application note "Make Circles", Performing the Circle Move; technical document TD044 (queue). Assumed: depth of the queue, the
// refusal of a full one, the ramp to rest of a queue that has run dry.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "runtime/drives/silverlode/protocol.h"
#include "runtime/drives/silverlode/servo.h"

namespace pmac::drives::silverlode {

struct QueuedMove {
  std::int32_t ticks = 0;
  AxisMove move;
};

/// What the servo does at a tick.
enum class Phase : std::uint8_t {
  kHalted,         // no program runs
  kWaiting,        // the program waits for its start
  kQueue,          // IMS: entries of the queue
  kWaitingForEnd,  // the queue has come to rest; the program waits until the leader may begin again
  kStopping,       // on the way to rest, then halted
  kPlain,          // a plain move or jog
};

enum class Role : std::uint8_t { kNone, kLeader, kFollower };

struct DeviceSetup {
  std::string axis;                   // for messages
  int id = 0;
  std::size_t queue_depth = 10;       // assumed
  double start_counts = 0;
};

class Device {
 public:
  using Report = std::function<void(bool is_error, const std::string& text)>;

  Device(DeviceSetup setup, const CommandSet& commands, Report report);

  /// A frame for this address. The servo's reply.
  ReplyFrame handle(const CommandFrame& frame);
  /// One servo cycle; io1: the level of I/O 1 as this servo sees it.
  void step(bool io1);

  int id() const { return setup_.id; }
  const std::string& axis() const { return setup_.axis; }
  const Profile& profile() const { return profile_; }
  Phase phase() const { return phase_; }
  bool is_moving() const { return phase_ == Phase::kQueue || phase_ == Phase::kStopping || phase_ == Phase::kPlain; }
  /// A plain move that has no end.
  bool is_jogging() const;
  /// Level of output 1; only a leader drives it.
  bool output1() const { return output1_; }
  std::size_t queued() const { return queue_.size(); }
  std::size_t executed() const { return executed_; }
  bool ran_dry() const { return ran_dry_; }
  /// Cycles since IMS was started for the first time; -1: never.
  std::int64_t cycles_since_start() const { return started_at_ < 0 ? -1 : cycle_ - started_at_; }

 private:
  struct Refused { NakCode code; };
  using Answer = std::variant<Ack, Data, Refused>;

  Answer execute(const CommandRow& row, const CommandFrame& frame);
  Answer append(const CommandFrame& frame);
  Answer plain_move(const CommandFrame& frame, bool relative);
  Answer write_register(const CommandFrame& frame);
  Answer read_register(const CommandFrame& frame) const;
  Answer load_program(const CommandFrame& frame);
  Answer start_queue_by_host();
  Data words(int command, std::uint32_t value) const;
  std::uint32_t status() const;

  void step_program(bool io1);
  void step_queue();
  void step_plain();
  void start_queue();
  void queue_is_empty();
  void begin_stop(std::int64_t acc);

  DeviceSetup setup_;
  const CommandSet& commands_;
  Report report_;
  Profile profile_;
  Phase phase_ = Phase::kHalted;
  Role role_ = Role::kNone;
  bool output1_ = true;               // high: do not run
  std::deque<QueuedMove> queue_;
  QueuedMove present_;                // registers 20 to 23
  std::int64_t ticks_left_ = 0;
  std::int64_t stop_acc_ = 0;
  std::vector<std::int32_t> registers_;
  std::int64_t cycle_ = 0, started_at_ = -1;
  std::size_t executed_ = 0;
  bool ran_dry_ = false, command_error_ = false;
};

}  // namespace pmac::drives::silverlode
