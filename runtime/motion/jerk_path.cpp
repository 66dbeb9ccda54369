#include "runtime/motion/jerk_path.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pmac::motion {
namespace {

/// Parts of the square of a motor's limit of speed that are used: the tangent turns a little within a cell.
constexpr double kSpeedShare = 0.998, kSpeedShareOnCurves = 0.996;
constexpr double kTurn_rad = 0.05;    // of the tangent in one cell
constexpr double kChange = 0.3;       // of the curvature in one cell, of its greatest,
constexpr double kSlightTurn_rad = 0.01;   // where the tangent turns by more than this
constexpr double kShortestTime = 0.25;  // of a servo period: of cells that are made because of that
constexpr double kOffJerk = 0.03, kOffAccel = 0.001;   // of the limits: what the curvature is off in the middle of a cell, taken as even
constexpr int kHalvings = 30;         // of a segment into cells
constexpr double kKink_rad = 0.1, kStraight_rad = 1e-9;
constexpr double kUneven = 0.02;      // of the square of the program's speed in the middle, against its ends; halved so many times at most
constexpr int kHalvingsForSpeed = 3;
constexpr double kSmallStep = 0.15;   // of acceleration, over the jerk limit times a servo period: jerk is reserved for smaller ones, others are joins
constexpr double kSlightStep = 0.02;  // of the curvature: no join, however much acceleration it means
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

/// Cubics of time from or to rest have a curvature without bound there. The tangent turns as far in the cell, with a curvature that changes evenly.
void even_out_at_rest(PathPlace& at_rest, const PathPlace& other, double turn_sign, double length_mu) {
  for (std::size_t m = 0; m < at_rest.tangent.size(); ++m) {
    const double mean = turn_sign * (other.tangent[m] - at_rest.tangent[m]) / length_mu;
    at_rest.curvature_mu[m] = other.rests ? mean : 2 * mean - other.curvature_mu[m];
  }
}

}  // namespace

JerkPath::JerkPath(std::vector<MotorLimits> limits, double servo_period_ms) : limits_(std::move(limits)), servo_period_ms_(servo_period_ms) {
  constexpr double kUnfelt = 0.005;
  double speed_mu_ms = 1e300;   // that the limits let build up in a servo period
  for (const MotorLimits& limit : limits_) {
    if (limit.inv_amax_ms2_mu > 0) speed_mu_ms = std::min(speed_mu_ms, servo_period_ms / limit.inv_amax_ms2_mu);
    if (limit.inv_jmax_ms3_mu > 0) speed_mu_ms = std::min(speed_mu_ms, servo_period_ms * servo_period_ms / limit.inv_jmax_ms3_mu);
  }
  if (speed_mu_ms > 1e100) return;
  unfelt_mu_ms_ = kUnfelt * speed_mu_ms;
  unfelt_mu_ = unfelt_mu_ms_ * servo_period_ms;
}

void JerkPath::clear() {
  cells_.clear();
  segments_.clear();
  first_cell_ = first_segment_ = 0;
}

/// Derivatives at at_ms, seen from the side of toward_ms: where the program rests the direction is that of leaving or arriving.
PathPlace JerkPath::place(const Segment& segment, double at_ms, double toward_ms, double share) const {
  constexpr double kInside = 0.05;
  const bool rests = speed2_at(segment, at_ms) < kInside * kInside * speed2_at(segment, (at_ms + toward_ms) / 2);
  const double seen_ms = rests ? at_ms + kInside * (toward_ms - at_ms) : at_ms, speed = std::sqrt(speed2_at(segment, seen_ms));
  PathPlace result;
  result.rests = rests;
  result.max_speed2 = speed2_at(segment, at_ms);
  double along = 0, steady2 = 1e300;
  for (const MotorCubic& q : segment.motor) along += q.velocity(seen_ms) / speed * q.acceleration(seen_ms);
  for (std::size_t m = 0; m < segment.motor.size(); ++m) {
    const MotorCubic& q = segment.motor[m];
    const double tangent = q.velocity(seen_ms) / speed, curvature = (q.acceleration(seen_ms) - tangent * along) / (speed * speed);
    result.tangent.push_back(tangent);
    result.curvature_mu.push_back(curvature);
    if (m >= limits_.size()) continue;
    const double speed_limit = limits_[m].max_speed_mu_ms, inv_accel = limits_[m].inv_amax_ms2_mu / share;
    if (speed_limit > 0 && tangent != 0) result.max_speed2 = std::min(result.max_speed2, (curvature == 0 ? kSpeedShare : kSpeedShareOnCurves) * speed_limit * speed_limit / (tangent * tangent));
    if (inv_accel > 0 && curvature != 0) steady2 = std::min(steady2, 1 / (inv_accel * std::abs(curvature)));
  }
  result.steady_speed2 = std::min(result.max_speed2, steady2);
  return result;
}

void JerkPath::add_cell(const Segment& segment, double from_ms, double to_ms, double share, double start_speed2) {
  PathCell cell;
  cell.length_mu = length_between(segment, from_ms, to_ms);
  cell.from_ms = from_ms;
  cell.accel_share = share;
  cell.to_ms = to_ms;
  cell.segment = first_segment_ + segments_.size() - 1;
  cell.start = place(segment, from_ms, to_ms, share);
  cell.end = place(segment, to_ms, from_ms, share);
  if (cell.start.rests) even_out_at_rest(cell.start, cell.end, 1, cell.length_mu);
  if (cell.end.rests) even_out_at_rest(cell.end, cell.start, -1, cell.length_mu);
  cell.start.max_speed2 = std::min(cell.start.max_speed2, start_speed2);
  judge(cell);
  const bool follows = !cells_.empty() && !cells_.back().stops;
  const bool kinks = follows && bend_of(cells_.back().end, cell.start).turn_rad > kKink_rad && !(start_speed2 < 1e299);
  const double slow2 = std::max(unfelt_mu_ms_ * unfelt_mu_ms_, 1e-30);
  if (kinks || cell.start.max_speed2 <= slow2) stop_here();   // a bend too small for a cell
  cell.stops = cell.end.max_speed2 <= slow2 || bend_of(cell.start, cell.end).turn_rad > kKink_rad;
  if (follows && !cells_.back().stops) reserve_for_step(cells_.back(), cell);
  cells_.push_back(std::move(cell));
}

/// The cubics of neighbouring segments of one arc have slightly different curvatures where they meet. What that takes of the jerk at servo rate
/// is left free there.
void JerkPath::reserve_for_step(PathCell& before, PathCell& cell) const {
  const double speed2 = std::min(before.end.steady_speed2, cell.start.steady_speed2);
  double step_mu2 = 0, change = 0, greatest = 0;
  for (std::size_t m = 0; m < std::min(limits_.size(), cell.start.curvature_mu.size()); ++m) {
    const double from = before.end.curvature_mu[m], to = cell.start.curvature_mu[m];
    step_mu2 = std::max(step_mu2, std::abs(to - from) * limits_[m].inv_jmax_ms3_mu / servo_period_ms_);
    change = std::max(change, std::abs(to - from));
    greatest = std::max({greatest, std::abs(from), std::abs(to)});
  }
  if (step_mu2 * speed2 > kSmallStep && change > kSlightStep * greatest) return;
  cell.start_step_mu2 = before.end_step_mu2 = step_mu2;
}

/// What the motors' limits come to along the cell.
void JerkPath::judge(PathCell& cell) const {
  const Bend bend = bend_of(cell.start, cell.end);
  cell.is_straight = bend.turn_rad < kStraight_rad;
  for (std::size_t m = 0; m < std::min(limits_.size(), cell.start.tangent.size()); ++m) {
    const double tangent = std::max(std::abs(cell.start.tangent[m]), std::abs(cell.end.tangent[m])), inv_jerk = limits_[m].inv_jmax_ms3_mu;
    cell.inv_accel_ms2_mu = std::max(cell.inv_accel_ms2_mu, tangent * limits_[m].inv_amax_ms2_mu / cell.accel_share);
    cell.inv_jerk_ms3_mu = std::max(cell.inv_jerk_ms3_mu, tangent * inv_jerk);
    const double rate = std::abs(cell.end.curvature_mu[m] - cell.start.curvature_mu[m]) / cell.length_mu;
    if (inv_jerk <= 0 || rate == 0) continue;
    const double steady2 = std::pow(inv_jerk * rate, -2.0 / 3);
    cell.start.steady_speed2 = std::min(cell.start.steady_speed2, steady2);
    cell.end.steady_speed2 = std::min(cell.end.steady_speed2, steady2);
  }
}

/// Whether motion as fast as the place allows would have much more acceleration or jerk than with a curvature that changes evenly. Not in
/// cells that take less than a servo period, for the acceleration a part of it.
bool JerkPath::bends_unevenly(const PathPlace& from, const PathPlace& middle, const PathPlace& to, double length_mu) const {
  const double speed2 = std::min({from.steady_speed2, middle.steady_speed2, to.steady_speed2}), speed = std::sqrt(speed2);
  if (length_mu < kShortestTime * speed * servo_period_ms_) return false;
  double off_accel = 0, off_jerk = 0;
  for (std::size_t m = 0; m < std::min(limits_.size(), from.tangent.size()); ++m) {
    const double off = std::abs(middle.curvature_mu[m] - (from.curvature_mu[m] + to.curvature_mu[m]) / 2) * speed2;
    off_accel = std::max(off_accel, off * limits_[m].inv_amax_ms2_mu);
    off_jerk = std::max(off_jerk, 4 * off * speed / length_mu * limits_[m].inv_jmax_ms3_mu);
  }
  return off_accel > kOffAccel || (off_jerk > kOffJerk && length_mu > speed * servo_period_ms_);
}

/// Halves until the derivatives and the program's speed change evenly, or it is too short for bends to be felt.
void JerkPath::add_cells(const Segment& segment, double from_ms, double to_ms, double share, double start_speed2, int halvings) {
  const double middle_ms = (from_ms + to_ms) / 2, length_mu = length_between(segment, from_ms, to_ms);
  if (!(length_mu > kShortest_mu)) return;   // nothing moves there
  const PathPlace from = place(segment, from_ms, middle_ms, share), to = place(segment, to_ms, middle_ms, share);
  const Bend bend = bend_of(from, to);
  const bool bends = bend.turn_rad > kTurn_rad || (bend.turn_rad > kSlightTurn_rad && bend.change > kChange);
  const double mean2 = (speed2_at(segment, from_ms) + speed2_at(segment, to_ms)) / 2;
  const bool uneven = halvings > kHalvings - kHalvingsForSpeed && std::abs(speed2_at(segment, middle_ms) - mean2) > kUneven * mean2;
  const bool whole_turn = halvings == kHalvings && bend.turn_rad > kStraight_rad && !uneven;   // and back again
  const bool off = bend.turn_rad > kStraight_rad && bends_unevenly(from, place(segment, middle_ms, to_ms, share), to, length_mu);
  if (halvings == 0 || length_mu < 2 * unfelt_mu_ || length_mu < 4 * kShortest_mu || (!bends && !uneven && !whole_turn && !off))
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

double JerkPath::programmed_ms(std::size_t index, double offset_mu) const {
  const PathCell& c = cell(index);
  const Segment& owner = segment(c.segment);
  if (offset_mu <= 0) return c.from_ms;
  if (offset_mu >= c.length_mu) return c.to_ms;
  double low = c.from_ms, high = c.to_ms, at_ms = low + (high - low) * offset_mu / c.length_mu;
  for (int i = 0; i < 60; ++i) {
    const double off_mu = length_between(owner, c.from_ms, at_ms) - offset_mu;
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
