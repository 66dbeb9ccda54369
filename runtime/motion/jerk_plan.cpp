#include "runtime/motion/jerk_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pmac::motion {
namespace {

/// Parts of the limits that a plan may use. What lies between the places that are looked at is in the rest.
constexpr double kSpeed = 0.999, kAccel = 0.9985, kJerk = 0.997;
/// Of these, what braking uses: a plan has room for being followed from a slightly other state.
constexpr double kBrake = 0.999;
/// It lets go where that takes this part of the jerk limit.
constexpr double kWholeRelease = 0.9;
/// And passes a place at this part of the speed that is allowed there.
constexpr double kBelow = 1 - 1e-4;
constexpr double kStepsPerChange = 64, kLongestStep_ms = 20, kLongestTrial_ms = 5;
constexpr double kRounding = 1e-9;
constexpr int kBisections = 44, kHalvings = 12, kMostSteps = 20'000, kMostDips = 16;

double between(double a, double b, double part) { return a + (b - a) * part; }

/// Values of x for which |rest_m + factor_m x| <= bound for every m, or for the root of the sum of the squares.
struct Room {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  double rest2 = 0, mixed = 0, factor2 = 0;

  void add(double rest, double factor, double bound) {
    rest2 += rest * rest;
    mixed += rest * factor;
    factor2 += factor * factor;
    if (factor == 0) return;
    const double a = (-bound - rest) / factor, b = (bound - rest) / factor;
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  /// The second; false where there is none.
  bool together(double bound) {
    const double under_root = mixed * mixed - factor2 * (rest2 - bound * bound);
    if (factor2 == 0) return rest2 <= bound * bound;
    if (under_root < 0) return false;
    low = (-mixed - std::sqrt(under_root)) / factor2;
    high = (-mixed + std::sqrt(under_root)) / factor2;
    return true;
  }
};

/// When a place after from_ms is reached, at most h.
double time_at(const PathState& state, double jerk, double at_mu, double from_ms, double h) {
  double low = from_ms, high = h, t = (low + high) / 2;
  for (int i = 0; i < 30 && high - low > 1e-9 * h; ++i) {
    const double off = state.at.at_mu + t * (state.speed_mu_ms + t * (state.accel_mu_ms2 / 2 + t * jerk / 6)) - at_mu;
    const double speed = state.speed_mu_ms + t * (state.accel_mu_ms2 + t * jerk / 2);
    (off > 0 ? high : low) = t;
    const double next = speed > 0 ? t - off / speed : low;
    if (std::abs(next - t) < 1e-9 * h) return std::clamp(next, low, high);
    t = next > low && next < high ? next : (low + high) / 2;
  }
  return t;
}

}  // namespace

/// Whether the motors' limits allow this motion at a place of the cell.
bool JerkPlan::passes(const PathCell& cell, double at_mu, double speed, double accel, double jerk) {
  const double part = std::clamp((at_mu - cell.from_mu) / cell.length_mu, 0.0, 1.0);
  const double max_speed2 = between(cell.start.max_speed2, cell.end.max_speed2, part);
  bool good = speed * speed <= max_speed2 * (1 + kRounding) + 1e-24;
  const auto& limits = path_.limits();
  for (std::size_t m = 0; good && m < std::min(limits.size(), cell.start.tangent.size()); ++m) {
    const double t = between(cell.start.tangent[m], cell.end.tangent[m], part);
    const double k = between(cell.start.curvature_mu[m], cell.end.curvature_mu[m], part);
    const double motor_accel = k * speed * speed + t * accel;
    const double motor_jerk = cell.curvature_rate[m] * speed * speed * speed + 3 * k * speed * accel + t * jerk;
    const bool slow = limits[m].max_speed_mu_ms <= 0 || std::abs(t) * speed <= limits[m].max_speed_mu_ms * kSpeed;
    good = slow && std::abs(motor_accel) * limits[m].inv_amax_ms2_mu <= kAccel * cell.accel_share + kRounding && std::abs(motor_jerk) * limits[m].inv_jmax_ms3_mu <= kJerk + kRounding;
  }
  if (!good) trouble_ = {at_mu, std::sqrt(max_speed2), false};
  return good;
}

/// The highest speed of a step in which speeding up ends.
bool JerkPlan::peak_passes(const PathState& state, double jerk) {
  const double v = state.speed_mu_ms, a = state.accel_mu_ms2, t = -a / jerk, at_mu = state.at.at_mu + t * (v + t * (a / 2 + t * jerk / 6));
  std::size_t at = state.at.cell;
  while (at_mu > path_.cell(at).end_mu() && at + 1 < path_.cell_end()) ++at;
  return passes(path_.cell(at), at_mu, v + a * t / 2, 0, jerk);
}

/// Runs the step from the state; false, with the trouble noted, where it breaks a limit or leaves the known path.
bool JerkPlan::advance(PathState& state, const JerkStep& step) {
  const double h = step.duration_ms, j = step.jerk_mu_ms3, v0 = state.speed_mu_ms, a0 = state.accel_mu_ms2;
  const double v1 = v0 + h * (a0 + h * j / 2), a1 = a0 + h * j, from_mu = state.at.at_mu;
  const double to_mu = from_mu + h * (v0 + h * (a0 / 2 + h * j / 6));
  if (v1 < -kRounding * (v0 + std::abs(a0) * h)) {
    trouble_ = {from_mu, v0, false};
    return false;
  }
  std::size_t at = state.at.cell;
  double t = 0;
  if (!passes(path_.cell(at), from_mu, v0, a0, j)) return false;
  if (a0 > 0 && a1 < 0 && !peak_passes(state, j)) return false;
  while (to_mu > path_.cell(at).end_mu()) {
    const PathCell& cell = path_.cell(at);
    t = time_at(state, j, cell.end_mu(), t, h);
    const double speed = std::max(0.0, v0 + t * (a0 + t * j / 2)), accel = a0 + t * j;
    const bool stands_past = cell.stops || at + 1 >= path_.cell_end();
    if (stands_past) {
      trouble_ = {cell.end_mu(), 0, at + 1 >= path_.cell_end() && !cell.stops};
      return false;
    }
    if (!passes(cell, cell.end_mu(), speed, accel, j)) return false;
    if (!passes(path_.cell(++at), cell.end_mu(), speed, accel, j)) return false;
  }
  if (!passes(path_.cell(at), to_mu, std::max(0.0, v1), a1, j)) return false;
  state = {{at, to_mu}, std::max(0.0, v1), a1};
  return true;
}

/// What the motors leave of acceleration and jerk along the path. False where there is nothing.
bool JerkPlan::ranges(const PathState& state, Within within, Ranges& out) const {
  const PathCell& cell = path_.cell(state.at.cell);
  const double part = std::clamp((state.at.at_mu - cell.from_mu) / cell.length_mu, 0.0, 1.0), v = state.speed_mu_ms;
  const auto& limits = path_.limits();
  Room accel, jerk;
  for (std::size_t m = 0; m < std::min(limits.size(), cell.start.tangent.size()); ++m) {
    const double t = between(cell.start.tangent[m], cell.end.tangent[m], part);
    const double k = between(cell.start.curvature_mu[m], cell.end.curvature_mu[m], part);
    const double inv_accel = limits[m].inv_amax_ms2_mu / cell.accel_share, inv_jerk = limits[m].inv_jmax_ms3_mu;
    accel.add(k * v * v * inv_accel, t * inv_accel, kAccel);
    jerk.add((cell.curvature_rate[m] * v * v * v + 3 * k * v * state.accel_mu_ms2) * inv_jerk, t * inv_jerk, kJerk);
  }
  const bool each = within == Within::kEach;
  if (!each && !(accel.together(kAccel) && jerk.together(kJerk))) return false;
  const bool any = accel.low <= accel.high && jerk.low <= jerk.high;
  out = {accel.low, accel.high, jerk.low, jerk.high};
  return any;
}

/// Steps are longer where changes of speed take long.
double JerkPlan::whole_step_ms(double speed_change, double accel) const {
  const double slow_ms = accel != 0 ? std::abs(speed_change / accel) / kStepsPerChange : 0;
  return std::max(step_ms_, std::min(slow_ms, kLongestStep_ms));
}

/// And what they leave at the end of a step, as it would be.
void JerkPlan::narrow_to_end(const PathState& state, const JerkStep& step, Within within, Ranges& ranges) const {
  const double h = step.duration_ms, j = step.jerk_mu_ms3, v = state.speed_mu_ms, a = state.accel_mu_ms2;
  PathState end{{state.at.cell, state.at.at_mu + h * (v + h * (a / 2 + h * j / 6))}, std::max(0.0, v + h * (a + h * j / 2)), a + h * j};
  while (end.at.at_mu > path_.cell(end.at.cell).end_mu() && end.at.cell + 1 < path_.cell_end()) ++end.at.cell;
  Ranges there;
  if (!this->ranges(end, within, there)) return;
  ranges.accel_low = std::max(ranges.accel_low, there.accel_low);
  ranges.accel_high = std::min(ranges.accel_high, there.accel_high);
  ranges.jerk_low = std::max(ranges.jerk_low, there.jerk_low);
  ranges.jerk_high = std::min(ranges.jerk_high, there.jerk_high);
}

/// Brakes as hard as the limits allow, and lets go in time to arrive at the speed with no acceleration left:
///
///   a  0 --\             /--      lets go with the jerk a^2 / 2(v - speed), as soon as it would take the limit
///           \___________/
bool JerkPlan::brake_to(PathState& state, double speed_mu_ms, Within within, std::vector<JerkStep>& steps) {
  Ranges room;
  for (int count = 0; count < kMostSteps; ++count) {
    const double over = state.speed_mu_ms - speed_mu_ms, a = state.accel_mu_ms2;
    const double nothing = kRounding * (speed_mu_ms + step_ms_ * std::abs(a)) + 1e-15;
    if (std::abs(over) <= nothing && std::abs(a) * step_ms_ <= 2 * nothing + 1e-12) return true;
    if (over <= 0 || !ranges(state, within, room)) {
      trouble_ = {state.at.at_mu, state.speed_mu_ms, false};
      return false;
    }
    const double whole_ms = whole_step_ms(over, room.accel_low);
    narrow_to_end(state, {whole_ms, std::max({room.jerk_low, (room.accel_low - a) / whole_ms, -1e12})}, within, room);
    const double brake = std::max(room.jerk_low * kBrake, -1e12), most = std::min(room.jerk_high * kBrake, 1e12);
    const auto can_let_go = [&](double v, double accel) { return v > 0 && (accel >= 0 || accel * accel <= 2 * v * most); };
    JerkStep step{whole_ms, brake};
    bool lets_go = true;
    for (int i = 0; i < kHalvings && lets_go; ++i) {
      step.duration_ms = whole_ms / (1 << i);
      step.jerk_mu_ms3 = std::max(brake, (room.accel_low * kBrake - a) / step.duration_ms);
      const double h = step.duration_ms, j = step.jerk_mu_ms3;
      lets_go = !can_let_go(over + h * (a + h * j / 2), a + h * j);
      if (a < 0 && a * a > 2 * over * most * kWholeRelease) break;
    }
    if (lets_go && a < 0) {
      const double j = a * a / (2 * over), left_ms = -2 * over / a;
      if (j <= most / kBrake * (1 + kRounding)) {
        step = {std::min(whole_ms, left_ms), j};
        const bool last = left_ms <= whole_ms * (1 + 1e-9);
        if (!advance(state, step)) return false;
        steps.push_back(step);
        if (last) {
          state.speed_mu_ms = speed_mu_ms;
          state.accel_mu_ms2 = 0;
          return true;
        }
        continue;
      }
      step.jerk_mu_ms3 = most;   // too late to arrive exactly; the speed falls short
      trouble_ = {state.at.at_mu, state.speed_mu_ms, false};
      return false;
    }
    if (!advance(state, step)) return false;
    steps.push_back(step);
  }
  trouble_ = {state.at.at_mu, state.speed_mu_ms, false};
  return false;
}

/// Goes on at the speed it has up to a place.
bool JerkPlan::coast_to(PathState& state, double to_mu, std::vector<JerkStep>& steps) {
  for (int count = 0; state.at.at_mu < to_mu; ++count) {
    if (count == kMostSteps || state.speed_mu_ms <= 0 || !advance(state, {step_ms_, 0})) return false;
    steps.push_back({step_ms_, 0});
  }
  return true;
}

/// Past a trouble, at the speed that is allowed there and a little further.
bool JerkPlan::pass(PathState& state, const Trouble& trouble, Within within, std::vector<JerkStep>& steps) {
  const std::size_t before = steps.size();
  double speed = std::min(state.speed_mu_ms, trouble.max_speed_mu_ms * kBelow);
  for (int i = 0; i < kMostDips && speed > 0; ++i) {
    PathState at = state;
    const bool slow = speed < state.speed_mu_ms ? brake_to(at, speed, within, steps) : at.accel_mu_ms2 == 0;
    if (slow && coast_to(at, trouble.at_mu, steps)) {
      state = at;
      return true;
    }
    steps.resize(before);
    if (!slow || !(trouble_.max_speed_mu_ms < speed)) return false;
    speed = trouble_.max_speed_mu_ms * kBelow;
  }
  return false;
}

/// A stop from the state: hard braking; where something is in the way, first down to the speed that is allowed there, past it, and on from there.
bool JerkPlan::stop_within(const PathState& state, Within within, std::vector<JerkStep>& steps) {
  PathState at = state;
  steps.clear();
  Trouble first;
  for (int i = 0; i < kMostDips; ++i) {
    PathState stopping = at;
    const std::size_t before = steps.size();
    if (brake_to(stopping, 0, within, steps)) return true;
    steps.resize(before);
    const Trouble trouble = trouble_;
    if (i == 0) first = trouble;
    if (trouble.at_end || !pass(at, trouble, within, steps)) break;
  }
  trouble_ = first;
  return false;
}

bool JerkPlan::stop_from(const PathState& state, std::vector<JerkStep>& steps) {
  if (stop_within(state, Within::kEach, steps)) return true;
  if (trouble_.at_end) return false;
  const Trouble first = trouble_;
  if (stop_within(state, Within::kTogether, steps)) return true;
  if (first.at_mu > trouble_.at_mu) trouble_ = first;
  return false;
}

/// A step after which there is a stop; the stop is in trial_, behind the step itself.
bool JerkPlan::try_step(const PathState& state, const JerkStep& step) {
  PathState after = state;
  if (!advance(after, step) || !stop_from(after, trial_)) return false;
  plan_.assign(1, step);
  plan_.insert(plan_.end(), trial_.begin(), trial_.end());
  used_ = 0;
  return true;
}

double JerkPlan::top_speed(const PathState& state) const {
  const PathCell& cell = path_.cell(state.at.cell);
  const double part = std::clamp((state.at.at_mu - cell.from_mu) / cell.length_mu, 0.0, 1.0);
  return std::sqrt(between(cell.start.max_speed2, cell.end.max_speed2, part));
}

/// The fastest step that is certain to have a stop; false where only the plan is left.
bool JerkPlan::try_fastest(const PathState& state) {
  follow_to_mu_ = -1;
  Ranges room;
  if (!ranges(state, Within::kEach, room)) return false;
  const double v = state.speed_mu_ms, a = state.accel_mu_ms2, top = top_speed(state), slack = top - v;
  const double whole_ms = std::min(whole_step_ms(v, room.accel_high), std::max(step_ms_, kLongestTrial_ms));
  if (v > 0 && std::abs(a) * whole_ms <= 1e-9 * top && slack <= 1e-6 * top && try_step(state, {whole_ms, 0})) return true;
  narrow_to_end(state, {whole_ms, std::min({room.jerk_high, (room.accel_high - a) / whole_ms, 1e12})}, Within::kEach, room);
  const double jerk = std::min({room.jerk_high, (room.accel_high - a) / whole_ms, 1e12});
  const double next_v = v + whole_ms * (a + whole_ms * jerk / 2), next_a = a + whole_ms * jerk;
  const bool overshoots = a > 0 && (next_v >= top || next_a * next_a > 2 * (top - next_v) * -room.jerk_low * kBrake);
  if (overshoots && slack > 0) {
    const double ease = -a * a / (2 * slack);
    if (ease >= room.jerk_low && try_step(state, {std::min(whole_ms, -a / ease), ease})) return true;
  }
  if (try_step(state, {whole_ms, jerk})) return true;
  Trouble why = trouble_;
  const JerkStep known = used_ < plan_.size() ? plan_[used_] : JerkStep{whole_ms, 0};
  double good = known.jerk_mu_ms3, bad = jerk;
  bool found = false;
  for (int i = 0; i < kBisections && std::abs(bad - good) > 1e-13 * (std::abs(good) + std::abs(bad)); ++i) {
    const double middle = (good + bad) / 2;
    if (try_step(state, {known.duration_ms, middle})) {
      good = middle;
      found = true;
    } else {
      bad = middle;
      why = trouble_;
    }
  }
  follow_to_mu_ = why.at_mu;
  end_binds_ = why.at_end;
  return found;
}

JerkStep JerkPlan::next(PathState& state) {
  const bool follows = used_ < plan_.size() && state.at.at_mu < follow_to_mu_;
  if (!follows) (void)try_fastest(state);
  if (used_ >= plan_.size()) return {};
  const JerkStep step = plan_[used_++];
  const bool last = used_ == plan_.size();
  (void)advance(state, step);
  if (last) state.speed_mu_ms = state.accel_mu_ms2 = 0;
  return step;
}

}  // namespace pmac::motion
