#include "runtime/motion/jerk_path.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pmac::motion {
namespace {

/// Parts of a motor's acceleration and jerk that the path's own shape may take at its highest speed; the rest is for changes of the speed.
constexpr double kSpeedShare = 0.998, kAccelShare = 0.9965, kJerkShare = 0.9;
constexpr double kTurn_rad = 0.05;    // of the tangent in one cell
constexpr double kChange = 0.3;       // of the curvature in one cell, of its greatest,
constexpr double kSlightTurn_rad = 0.01;   // where the tangent turns by more than this
constexpr int kHalvings = 12;         // of a segment into cells
constexpr double kRest = 1e-4;        // and rests below this
constexpr double kShortest_mu = 1e-9; // segments that move less do not move

double speed2_at(const Segment& segment, double at_ms) {
  double sum = 0;
  for (const MotorCubic& q : segment.motor) sum += q.velocity(at_ms) * q.velocity(at_ms);
  return sum;
}

/// Length of the path between two programmed times: Gauss-Legendre with five places.
double length_between(const Segment& segment, double from_ms, double to_ms) {
  constexpr std::array<double, 5> kAt{-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 5> kWeight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const double middle = (from_ms + to_ms) / 2, half = (to_ms - from_ms) / 2;
  double sum = 0;
  for (std::size_t i = 0; i < kAt.size(); ++i) sum += kWeight[i] * std::sqrt(speed2_at(segment, middle + half * kAt[i]));
  return sum * half;
}

/// Where the program is slowest in the segment.
double slowest_ms(const Segment& segment) {
  constexpr int kSteps = 16;
  double best = 0;
  for (int i = 1; i <= kSteps; ++i)
    if (speed2_at(segment, i * segment.duration_ms / kSteps) < speed2_at(segment, best)) best = i * segment.duration_ms / kSteps;
  double low = std::max(0.0, best - segment.duration_ms / kSteps), high = std::min(segment.duration_ms, best + segment.duration_ms / kSteps);
  for (int i = 0; i < 60; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (speed2_at(segment, a) < speed2_at(segment, b) ? high : low) = speed2_at(segment, a) < speed2_at(segment, b) ? b : a;
  }
  return (low + high) / 2;
}

struct Bend { double turn_rad, change; };   // of a cell: how far the tangent turns, and the change of curvature over its greatest

Bend bend_of(const PathPlace& from, const PathPlace& to) {
  double turn2 = 0, change2 = 0, from2 = 0, to2 = 0;
  for (std::size_t m = 0; m < from.tangent.size(); ++m) {
    turn2 += std::pow(to.tangent[m] - from.tangent[m], 2);
    change2 += std::pow(to.curvature_mu[m] - from.curvature_mu[m], 2);
    from2 += from.curvature_mu[m] * from.curvature_mu[m];
    to2 += to.curvature_mu[m] * to.curvature_mu[m];
  }
  const double greatest2 = std::max(from2, to2);
  return {std::sqrt(turn2), greatest2 > 0 ? std::sqrt(change2 / greatest2) : 0};
}

}  // namespace

JerkPath::JerkPath(std::vector<MotorLimits> limits, double servo_period_ms) : limits_(std::move(limits)) {
  constexpr double kUnfelt = 0.002, kPart = 0.01;
  double accel = 1e300, jerk = 1e300;
  for (const MotorLimits& limit : limits_) {
    if (limit.inv_amax_ms2_mu > 0) accel = std::min(accel, 1 / limit.inv_amax_ms2_mu);
    if (limit.inv_jmax_ms3_mu > 0) jerk = std::min(jerk, 1 / limit.inv_jmax_ms3_mu);
  }
  const double unfelt_mu_ms = kUnfelt * std::min(accel * servo_period_ms, jerk * servo_period_ms * servo_period_ms);
  if (!(unfelt_mu_ms > 0 && unfelt_mu_ms < 1e100)) return;
  sharpest_mu_ = kPart * std::min(accel, 1e100) / (unfelt_mu_ms * unfelt_mu_ms);
  sharpest_rate_ = kPart * std::min(jerk, 1e100) / (unfelt_mu_ms * unfelt_mu_ms * unfelt_mu_ms);
}

void JerkPath::clear() {
  cells_.clear();
  segments_.clear();
  first_cell_ = first_segment_ = 0;
  end_mu_ = 0;
}

/// Derivatives at at_ms, seen from the side of toward_ms: where the program rests the direction is that of leaving or arriving.
PathPlace JerkPath::place(const Segment& segment, double at_ms, double toward_ms, double share) const {
  constexpr double kInside = 0.05;
  const bool rests = speed2_at(segment, at_ms) < kInside * kInside * speed2_at(segment, (at_ms + toward_ms) / 2);
  const double seen_ms = rests ? at_ms + kInside * (toward_ms - at_ms) : at_ms, speed = std::sqrt(speed2_at(segment, seen_ms));
  PathPlace result;
  result.max_speed2 = speed2_at(segment, at_ms);
  double along = 0;
  for (const MotorCubic& q : segment.motor) along += q.velocity(seen_ms) / speed * q.acceleration(seen_ms);
  for (std::size_t m = 0; m < segment.motor.size(); ++m) {
    const MotorCubic& q = segment.motor[m];
    const double tangent = q.velocity(seen_ms) / speed, curvature = std::clamp((q.acceleration(seen_ms) - tangent * along) / (speed * speed), -sharpest_mu_, sharpest_mu_);
    result.tangent.push_back(tangent);
    result.curvature_mu.push_back(curvature);
    if (m >= limits_.size()) continue;
    const double speed_limit = limits_[m].max_speed_mu_ms, inv_accel = limits_[m].inv_amax_ms2_mu / share;
    if (speed_limit > 0 && tangent != 0) result.max_speed2 = std::min(result.max_speed2, kSpeedShare * speed_limit * speed_limit / (tangent * tangent));
    if (inv_accel > 0 && curvature != 0) result.max_speed2 = std::min(result.max_speed2, kAccelShare / (inv_accel * std::abs(curvature)));
  }
  return result;
}

void JerkPath::add_cell(const Segment& segment, double from_ms, double to_ms, double share, double start_speed2) {
  PathCell cell;
  cell.from_mu = end_mu_;
  cell.length_mu = length_between(segment, from_ms, to_ms);
  cell.from_ms = from_ms;
  cell.accel_share = share;
  cell.to_ms = to_ms;
  cell.segment = first_segment_ + segments_.size() - 1;
  cell.start = place(segment, from_ms, to_ms, share);
  cell.end = place(segment, to_ms, from_ms, share);
  cell.start.max_speed2 = std::min(cell.start.max_speed2, start_speed2);
  for (std::size_t m = 0; m < cell.start.tangent.size(); ++m) {
    const double rate = std::clamp((cell.end.curvature_mu[m] - cell.start.curvature_mu[m]) / cell.length_mu, -sharpest_rate_, sharpest_rate_);
    cell.curvature_rate.push_back(rate);
    const double inv_jerk = m < limits_.size() ? limits_[m].inv_jmax_ms3_mu : 0;
    if (inv_jerk <= 0 || rate == 0) continue;
    const double speed = std::cbrt(kJerkShare / (inv_jerk * std::abs(rate)));
    cell.start.max_speed2 = std::min(cell.start.max_speed2, speed * speed);
    cell.end.max_speed2 = std::min(cell.end.max_speed2, speed * speed);
  }
  constexpr double kKink = 0.1;
  const bool kinks = !cells_.empty() && !cells_.back().stops && bend_of(cells_.back().end, cell.start).turn_rad > kKink;
  if (kinks && !(start_speed2 < 1e299)) stop_here();   // a bend too small for a cell
  end_mu_ = cell.end_mu();
  cells_.push_back(std::move(cell));
}

/// Halves until the derivatives change evenly.
void JerkPath::add_cells(const Segment& segment, double from_ms, double to_ms, double share, double start_speed2, int halvings) {
  const double middle_ms = (from_ms + to_ms) / 2, length_mu = length_between(segment, from_ms, to_ms);
  if (!(length_mu > kShortest_mu)) return;   // nothing moves there
  const PathPlace from = place(segment, from_ms, middle_ms, share), to = place(segment, to_ms, middle_ms, share);
  const Bend bend = bend_of(from, to);
  const bool bends = bend.turn_rad > kTurn_rad || (bend.turn_rad > kSlightTurn_rad && bend.change > kChange);
  const bool rests = speed2_at(segment, from_ms) == 0 || speed2_at(segment, to_ms) == 0;
  if (halvings == 0 || length_mu < 4 * kShortest_mu || (!bends && !(halvings == kHalvings && !rests && bend.turn_rad > 0)))
    return add_cell(segment, from_ms, to_ms, share, start_speed2);
  add_cells(segment, from_ms, middle_ms, share, start_speed2, halvings - 1);
  add_cells(segment, middle_ms, to_ms, share, 1e300, halvings - 1);
}

bool JerkPath::add(PreparedSegment prepared) {
  const double length_mu = length_between(prepared.segment, 0, prepared.segment.duration_ms);
  if (prepared.stops_at_start || !(length_mu > kShortest_mu)) stop_here();
  if (!(length_mu > kShortest_mu)) return false;
  segments_.push_back(std::move(prepared.segment));
  const Segment& segment = segments_.back();
  const double slowest = slowest_ms(segment), slow_speed2 = speed2_at(segment, slowest);
  const double mean = length_mu / segment.duration_ms;
  const double room_ms = 1e-6 * segment.duration_ms;
  const bool rests = slow_speed2 < kRest * kRest * mean * mean && slowest > room_ms && slowest < segment.duration_ms - room_ms;
  const double start_speed2 = prepared.max_start_rate * prepared.max_start_rate * speed2_at(segment, 0);
  add_cells(segment, 0, rests ? slowest : segment.duration_ms, prepared.accel_share, start_speed2, kHalvings);
  if (rests && slowest < segment.duration_ms) {
    stop_here();
    add_cells(segment, slowest, segment.duration_ms, prepared.accel_share, 1e300, kHalvings);
  }
  if (speed2_at(segment, segment.duration_ms) < kRest * kRest * mean * mean) stop_here();
  return true;
}

void JerkPath::stop_here() {
  if (cells_.empty()) return;
  cells_.back().stops = true;
}

void JerkPath::forget_before(std::size_t cell) {
  while (first_cell_ < cell && !cells_.empty()) {
    cells_.pop_front();
    ++first_cell_;
  }
  while (!segments_.empty() && (cells_.empty() || cells_.front().segment > first_segment_)) {
    segments_.pop_front();
    ++first_segment_;
  }
}

double JerkPath::programmed_ms(std::size_t index, double at_mu) const {
  const PathCell& c = cell(index);
  const Segment& owner = segment(c.segment);
  const double wanted_mu = std::clamp(at_mu - c.from_mu, 0.0, c.length_mu);
  double low = c.from_ms, high = c.to_ms, at_ms = low + (high - low) * wanted_mu / c.length_mu;
  for (int i = 0; i < 60; ++i) {
    const double off_mu = length_between(owner, c.from_ms, at_ms) - wanted_mu;
    (off_mu > 0 ? high : low) = at_ms;
    const double speed = std::sqrt(speed2_at(owner, at_ms));
    double next_ms = speed > 0 ? at_ms - off_mu / speed : (low + high) / 2;
    if (!(next_ms > low && next_ms < high)) next_ms = (low + high) / 2;
    if (std::abs(next_ms - at_ms) <= 1e-15 * (c.to_ms + 1) || high - low <= 1e-15 * (c.to_ms + 1)) return next_ms;
    at_ms = next_ms;
  }
  return at_ms;
}

}  // namespace pmac::motion
