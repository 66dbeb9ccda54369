#include "runtime/motion/timings.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pmac::motion {
namespace {

constexpr double kSamePlace_ms = 1e-6;

/// Places that differ by less are the same: little also where programmed time hardly runs.
double same_place_ms(const TimedSegment& segment) {
  return kSamePlace_ms * std::min(1.0, segment.segment.duration_ms / segment.duration_ms);
}

}  // namespace

void Timings::reset(bool sync_on_segments) {
  *this = Timings{};
  sync_on_segments_ = sync_on_segments;
}

void Timings::start_sequence(double start_ms) {
  covered_programmed_ms_ = 0;
  covered_ms_ = start_ms;
}

void Timings::add(const MoveBegin& begin) {
  Record record{begin.id, begin.length_uu, {begin.sync_ms, 0, true}, {begin.start_ms, 0, true}, {}, begin.rule};
  ++unknown_starts_;
  cover_now(record.sync);
  cover_now(record.start);
  note_start(record);
  records_.push_back(record);
}

void Timings::add(const MoveEnd& end) {
  for (std::size_t i = records_.size(); i-- > 0;) {
    Record& record = records_[i];
    if (record.id != end.id) continue;
    record.end = {end.end_ms, 0, true};
    cover_now(record.end);
    break;
  }
  deliver();
}

void Timings::note_start(const Record& record) {
  if (!record.start.known) return;
  starts_ms_.push_back(record.start.time_ms);
  --unknown_starts_;
}

void Timings::cover_now(Place& place) const {
  if (!place.given || place.known || place.programmed_ms > covered_programmed_ms_ + kSamePlace_ms) return;
  place.known = true;
  place.time_ms = covered_ms_;
}

void Timings::cover_place(Place& place, const TimedSegment& segment, bool round_up) const {
  const double end_ms = segment.segment.start_ms + segment.segment.duration_ms;
  if (!place.given || place.known || place.programmed_ms > end_ms + same_place_ms(segment)) return;
  place.known = true;
  const double d = std::clamp(place.programmed_ms - segment.segment.start_ms, 0.0, segment.segment.duration_ms);
  const bool at_end = round_up || d >= segment.segment.duration_ms - same_place_ms(segment);
  place.time_ms = segment.start_ms + (at_end ? segment.duration_ms : time_at(segment, d));
}

void Timings::cover(const TimedSegment& segment) {
  const double end_ms = segment.segment.start_ms + segment.segment.duration_ms;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    Record& record = records_[i];
    if (record.sync.programmed_ms > end_ms + kSamePlace_ms) break;
    const bool start_was_known = record.start.known;
    if (!record.sync.known) cover_place(record.sync, segment, sync_on_segments_);
    if (!start_was_known) cover_place(record.start, segment, false);
    if (record.end.given && !record.end.known) cover_place(record.end, segment, false);
    if (!start_was_known) note_start(record);
  }
  covered_programmed_ms_ = end_ms;
  covered_ms_ = segment.start_ms + segment.duration_ms;
  deliver();
}

void Timings::end_sequence() {
  for (std::size_t i = 0; i < records_.size(); ++i) {
    Record& record = records_[i];
    const bool start_was_known = record.start.known;
    for (Place* place : {&record.sync, &record.start, &record.end})
      if (!place->known) *place = {place->programmed_ms, covered_ms_, true, true};
    if (!start_was_known) note_start(record);
  }
  deliver();
}

int Timings::ahead(double time_ms) const {
  const std::size_t first = starts_ms_.first_not([&](double start_ms) { return start_ms <= time_ms; });
  return unknown_starts_ + static_cast<int>(starts_ms_.size() - first);
}

double Timings::ahead_until_ms(int moves) const {
  const int missing = moves - unknown_starts_;
  if (missing <= 0) return std::numeric_limits<double>::infinity();
  if (missing > static_cast<int>(starts_ms_.size())) return -std::numeric_limits<double>::infinity();
  return starts_ms_[starts_ms_.size() - static_cast<std::size_t>(missing)];
}

void Timings::prune(double time_ms) {
  while (!starts_ms_.empty() && starts_ms_.front() <= time_ms) starts_ms_.pop_front();
}

void Timings::deliver() {
  for (; sync_delivered_ < records_.size() && records_[sync_delivered_].sync.known; ++sync_delivered_)
    sync_times_.push_back({records_[sync_delivered_].id, records_[sync_delivered_].sync.time_ms});
  while (!records_.empty() && records_.front().sync.known && records_.front().start.known && records_.front().end.known) {
    const Record& record = records_.front();
    finished_.push_back({record.id, record.sync.time_ms, record.start.time_ms, record.end.time_ms, record.length_uu, record.rule});
    records_.pop_front();
    --sync_delivered_;
  }
}

void Timings::take_sync_times(std::vector<SyncTime>& out) {
  out.insert(out.end(), sync_times_.begin(), sync_times_.end());
  sync_times_.clear();
}

void Timings::take(std::vector<MoveTiming>& out) {
  out.insert(out.end(), finished_.begin(), finished_.end());
  finished_.clear();
}

}  // namespace pmac::motion
