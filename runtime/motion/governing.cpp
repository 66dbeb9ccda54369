#include "runtime/motion/governing.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pmac::motion {
namespace {

/// A limit of which this much is used holds the motion back.
constexpr double kGoverns = 0.98;
/// Programmed time that runs at this rate runs freely.
constexpr double kFullRate = 1 - 1e-6;

}  // namespace

std::string_view time_rule_name(TimeRule rule) {
  switch (rule) {
    case TimeRule::kFeed: return "F";
    case TimeRule::kMoveTime: return "tm";
    case TimeRule::kInverseTime: return "F (inverse time)";
    case TimeRule::kSecondFeedAxes: return "F over frax2";
    case TimeRule::kAltFeedRate: return "AltFeedRate";
    case TimeRule::kMaxFeedRate: return "MaxFeedRate";
    case TimeRule::kMaxCirAccel: return "MaxCirAccel";
    case TimeRule::kRamps: return "ta and ts";
    case TimeRule::kMotorSpeed: return "MaxSpeed";
    case TimeRule::kSegment: return "SegMoveTime";
    case TimeRule::kOwnTime: return "its own time";
  }
  return "";
}

void Governing::reset(std::vector<MotorLimits> limits, std::vector<int> motors) {
  limits_ = std::move(limits);
  motors_ = std::move(motors);
  accounts_.clear();
}

/// The motor limit of which most is used, if it is used up; the lookahead's reserve where programmed time runs slower all the same.
GoverningShare Governing::limit_of(const TimedSegment& timed) const {
  GoverningShare result{GoverningLimit::kProgram, -1, timed.duration_ms};
  double most = kGoverns, slowest = 1;
  for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double d = part * timed.segment.duration_ms;
    const double rate2 = timed.rate2_after(d), rate = std::sqrt(rate2);
    slowest = std::min(slowest, rate);
    for (std::size_t m = 0; m < std::min(limits_.size(), timed.segment.motor.size()); ++m) {
      const MotorCubic& q = timed.segment.motor[m];
      const double speed = std::abs(q.velocity(d)) * rate;
      const double accel = std::abs(q.acceleration(d) * rate2 + q.velocity(d) * timed.slope_after(d));
      const auto consider = [&](double share, GoverningLimit limit) {
        if (share < most) return;
        most = share;
        result.limit = limit;
        result.motor = motors_[m];
      };
      if (limits_[m].max_speed_mu_ms > 0) consider(speed / limits_[m].max_speed_mu_ms, GoverningLimit::kMaxSpeed);
      consider(accel * limits_[m].inv_amax_ms2_mu, GoverningLimit::kInvAmax);
    }
  }
  if (result.limit == GoverningLimit::kProgram && slowest < kFullRate) result.limit = GoverningLimit::kLookahead;
  return result;
}

void Governing::cover(const TimedSegment& segment) {
  if (accounts_.empty() || accounts_.back().command != segment.segment.command) accounts_.push_back({segment.segment.command, {}});
  std::vector<GoverningShare>& shares = accounts_.back().shares;
  const GoverningShare now = limit_of(segment);
  const auto same = std::find_if(shares.begin(), shares.end(), [&](const auto& s) { return s.limit == now.limit && s.motor == now.motor; });
  if (same == shares.end()) shares.push_back(now);
  else same->time_ms += now.time_ms;
}

std::vector<GoverningShare> Governing::take(std::uint64_t command) {
  while (!accounts_.empty() && accounts_.front().command < command) accounts_.pop_front();
  if (accounts_.empty() || accounts_.front().command != command) return {};
  std::vector<GoverningShare> shares = std::move(accounts_.front().shares);
  accounts_.pop_front();
  std::stable_sort(shares.begin(), shares.end(), [](const auto& a, const auto& b) { return a.time_ms > b.time_ms; });
  return shares;
}

}  // namespace pmac::motion
