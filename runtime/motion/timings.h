// When each move was executed: places on the programmed time of a sequence are turned into pipeline time as the segments that
// cover them are committed.
#pragma once

#include <vector>

#include "runtime/motion/planner.h"
#include "runtime/motion/ring.h"
#include "runtime/motion/segment.h"

namespace pmac::motion {

class Timings {
 public:
  /// sync_on_segments: synchronous assignments wait for the next segment boundary.
  void reset(bool sync_on_segments);
  /// Programmed time 0 is start_ms.
  void start_sequence(double start_ms);
  void add(const MoveBegin& begin);
  void add(const MoveEnd& end);
  /// Segments in order.
  void cover(const TimedSegment& segment);
  /// The sequence is covered; what is still open lies at its end.
  void end_sequence();

  /// Moves that begin after time_ms, or at a time that is not known yet.
  int ahead(double time_ms) const;
  /// Until when ahead() stays at `moves` or more, as far as is known now; -inf if it does not.
  double ahead_until_ms(int moves) const;
  /// Forgets what ahead() does not need for times from here on.
  void prune(double time_ms);
  void take(std::vector<MoveTiming>& out);
  void take_sync_times(std::vector<SyncTime>& out);

 private:
  friend class LinePath;   // does the same for plain lines
  struct Place { double programmed_ms = 0, time_ms = 0; bool given = false, known = false; };
  struct Record { std::uint64_t id = 0; double length_uu = 0; Place sync, start, end; TimeRule rule = TimeRule::kFeed; };
  void cover_place(Place& place, const TimedSegment& segment, bool round_up) const;
  void cover_now(Place& place) const;
  void note_start(const Record& record);
  void deliver();

  bool sync_on_segments_ = false;
  Ring<Record> records_;          // not yet delivered
  Ring<double> starts_ms_;        // known, ascending
  int unknown_starts_ = 0;
  std::size_t sync_delivered_ = 0;      // first records whose sync time has been handed on
  double due_ms_ = 0;                   // no place before this is still to be covered
  void find_due();
  std::vector<SyncTime> sync_times_;
  std::vector<MoveTiming> finished_;
  double covered_programmed_ms_ = 0, covered_ms_ = 0;
};

}  // namespace pmac::motion
