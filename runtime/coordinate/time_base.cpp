#include "runtime/coordinate/time_base.h"

#include <algorithm>
#include <cmath>

namespace pmac::runtime {
namespace {

constexpr std::size_t kMostPieces = 100'000;  // older ones are forgotten; only times of a move that lasts through more would suffer

}  // namespace

const TimeBase::Piece& TimeBase::piece_at(double time_ms) const {
  auto next = std::partition_point(pieces_.begin(), pieces_.end(), [&](const Piece& p) { return p.start_ms <= time_ms; });
  return next == pieces_.begin() ? pieces_.front() : *(next - 1);
}

double TimeBase::path_on_pieces(double time_ms) const {
  const Piece& piece = piece_at(time_ms);
  const double d = time_ms - piece.start_ms;
  return piece.path_ms + d * (piece.rate + d * piece.slope / 2);
}

double TimeBase::rate_on_pieces(double time_ms) const {
  const Piece& piece = piece_at(time_ms);
  return std::max(0.0, piece.rate + (time_ms - piece.start_ms) * piece.slope);
}

double TimeBase::time_on_pieces(double path_ms) const {
  const auto later = std::partition_point(pieces_.begin(), pieces_.end(), [&](const Piece& p) { return p.path_ms < path_ms; });
  if (later == pieces_.begin()) return pieces_.front().start_ms;
  const Piece& piece = *(later - 1);
  const double left = path_ms - piece.path_ms;
  const double end_rate2 = std::max(0.0, piece.rate * piece.rate + 2 * piece.slope * left);
  const double rates = piece.rate + std::sqrt(end_rate2);   // mean rate on the way, doubled
  const double time_ms = rates > 0 ? piece.start_ms + 2 * left / rates : kNever;
  return later == pieces_.end() ? time_ms : std::min(time_ms, later->start_ms);
}

double TimeBase::steady_until_ms(double time_ms) const {
  if (real_time_) return kNever;
  const Piece& piece = piece_at(time_ms);
  if (piece.slope != 0) return time_ms;
  const auto i = static_cast<std::size_t>(&piece - pieces_.data());
  return i + 1 < pieces_.size() ? pieces_[i + 1].start_ms : kNever;
}

/// Forgets what lies after time_ms and begins a new piece there with the rate that holds.
void TimeBase::cut(double time_ms) {
  const double path_ms = path_at(time_ms), rate = rate_at(time_ms);
  if (real_time_) pieces_ = {{0, 0, 1, 0}};
  while (!pieces_.empty() && pieces_.back().start_ms >= time_ms) pieces_.pop_back();
  if (pieces_.size() >= kMostPieces) pieces_.erase(pieces_.begin(), pieces_.begin() + kMostPieces / 2);
  pieces_.push_back({time_ms, path_ms, rate, 0});
  real_time_ = false;
}

void TimeBase::restart(double time_ms) {
  if (real_time_) return;
  const double shift_ms = time_ms - path_at(time_ms);
  pieces_.erase(pieces_.begin(), pieces_.begin() + (&piece_at(time_ms) - pieces_.data()));
  for (Piece& piece : pieces_) piece.path_ms += shift_ms;
  if (hold_state(time_ms) == Hold::kNone) hold_ = Hold::kNone;
  real_time_ = pieces_.size() == 1 && pieces_.front().rate == 1 && pieces_.front().slope == 0 && hold_ == Hold::kNone;
}

void TimeBase::slew_to(double time_ms, double rate, double slope_per_ms) {
  const double from = rate_at(time_ms);
  if (from == rate && steady_until_ms(time_ms) == kNever) return;
  cut(time_ms);
  if (from == rate) return;
  Piece& slope = pieces_.back();
  slope.slope = std::copysign(slope_per_ms, rate - from);
  const double duration_ms = (rate - from) / slope.slope;
  pieces_.push_back({time_ms + duration_ms, slope.path_ms + (from + rate) / 2 * duration_ms, rate, 0});
}

void TimeBase::set_override(double time_ms, double rate, double slope_per_ms) {
  override_ = rate;
  const Hold hold = hold_state(time_ms);
  if (hold == Hold::kNone || hold == Hold::kResuming) slew_to(time_ms, rate, slope_per_ms);
}

void TimeBase::hold(double time_ms, double slope_per_ms) {
  hold_ = Hold::kSlowing;
  slew_to(time_ms, 0, slope_per_ms);
}

void TimeBase::release(double time_ms, double slope_per_ms) {
  hold_ = Hold::kResuming;
  slew_to(time_ms, override_, slope_per_ms);
}

void TimeBase::clear_hold(double time_ms) {
  shape_end(false);
  if (rate_at(time_ms) == override_ && steady_until_ms(time_ms) == kNever) return;
  force_rate(time_ms, override_);
}

void TimeBase::force_rate(double time_ms, double rate) {
  cut(time_ms);
  pieces_.back().rate = rate;
}

TimeBase::Hold TimeBase::hold_state(double time_ms) const {
  if (shaped_) return hold_;
  const bool settled = steady_until_ms(time_ms) == kNever;
  if (hold_ == Hold::kSlowing && settled && rate_at(time_ms) == 0) return Hold::kHeld;
  if (hold_ == Hold::kResuming && settled) return Hold::kNone;
  return hold_;
}

bool TimeBase::stands(double time_ms) const { return !real_time_ && rate_at(time_ms) == 0 && steady_until_ms(time_ms) == kNever; }

}  // namespace pmac::runtime
