#include "runtime/motion/jerk_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pmac::motion {
namespace {

/// Parts of the limits that a plan may use.
constexpr double kAccel = 0.997, kJerk = 0.99;
/// And how much more the solution may turn out to use of these.
constexpr double kSpeedRoom = 1.001, kAccelRoom = 1.001, kJerkRoom = 1.035;
constexpr double kLongestStep_ms = 5, kStepsPerRamp = 8, kStepsPerStretch = 44;
/// Cells in which the acceleration changes by this part of its limit are divided in so many, if they take so many times the finest step.
constexpr double kMuchChange = 0.12, kRefineFrom = 1.5;
constexpr int kParts = 3, kRefinements = 4;
constexpr double kRoughGap = 0.02, kGap = 1e-3;   // of the time, from the fastest profile
constexpr double kStops = 3;              // so many times as long as a stop takes is what lies ahead felt
constexpr double kRestSteps = 2;          // the cell from or to rest takes so many steps
constexpr double kFirstGuess = 0.6;       // of the estimated square of the speed
constexpr double kNear = 2.5;             // servo periods: third differences of samples reach no further
constexpr double kStep = 1e-6;            // of a limit: smaller steps of acceleration between cells are none

double between(double a, double b, double part) { return a + (b - a) * part; }

/// The tangent turns as its derivative, the curvature, says.
double tangent_at(const PathCell& cell, std::size_t m, double part) {
  const double t0 = cell.start.tangent[m], t1 = cell.end.tangent[m], rise = t1 - t0;
  const double off0 = cell.start.curvature_mu[m] * cell.length_mu - rise, off1 = rise - cell.end.curvature_mu[m] * cell.length_mu;
  return t0 + part * rise + part * (1 - part) * ((1 - part) * off0 + part * off1);
}

double curvature_at(const PathCell& cell, std::size_t m, double part) { return between(cell.start.curvature_mu[m], cell.end.curvature_mu[m], part); }

/// On curves a motor's part of the speed is at most the mean of its squares at the ends; that is safe where ends differ little.
double max_speed2_at(const PathCell& cell, double offset_mu) {
  const double part = offset_mu / cell.length_mu, start = cell.start.max_speed2, end = cell.end.max_speed2;
  const bool alike = std::max(start, end) < 1.5 * std::min(start, end);
  return cell.is_straight || !alike ? between(start, end, part) : 1 / between(1 / start, 1 / end, part);
}

/// Square of the speed that the acceleration and the jerk reach over a length from rest.
double from_rest2(const PathCell& cell, double length_mu) {
  double result = std::numeric_limits<double>::infinity();
  if (cell.inv_accel_ms2_mu > 0) result = 2 * length_mu / cell.inv_accel_ms2_mu;
  if (cell.inv_jerk_ms3_mu > 0) result = std::min(result, std::pow(6 * length_mu, 4.0 / 3) / (4 * std::pow(cell.inv_jerk_ms3_mu, 2.0 / 3)));
  return result;
}

double gained2(const PathCell& cell, double length_mu) {
  return cell.inv_accel_ms2_mu > 0 ? 2 * length_mu / cell.inv_accel_ms2_mu : std::numeric_limits<double>::infinity();
}

}  // namespace

JerkPlan::JerkPlan(const JerkPath& path, double servo_period_ms) : path_(path), shortest_step_ms_(servo_period_ms / 2) {}

void JerkPlan::start_at(std::size_t cell) {
  state_ = {cell, 0, 0, 0};
  cells_.clear();
  profile_ = {};
  next_ = 0;
}

bool JerkPlan::ends_at_stop() const { return !cells_.empty() && path_.cell(cells_.back().cell).stops; }

CellMotion JerkPlan::advance() {
  const PlannedCell& cell = cells_[next_];
  const double x0 = profile_.speed2[next_], y0 = profile_.slope[next_], x1 = profile_.speed2[next_ + 1], y1 = profile_.slope[next_ + 1];
  ++next_;
  state_ = {cell.cell, cell.to_mu, x1, y1};
  return motion_through(cell.to_mu - cell.from_mu, x0, y0, x1, y1);
}

void JerkPlan::take_felt() {
  double speed2 = 0, inv_accel = 0, inv_jerk = 0;
  for (std::size_t i = next_; i + 1 < profile_.nodes(); ++i) {
    const PathCell& cell = path_.cell(cells_[i].cell);
    speed2 = std::max(speed2, profile_.speed2[i]);
    inv_accel = std::max(inv_accel, cell.inv_accel_ms2_mu);
    inv_jerk = std::max(inv_jerk, cell.inv_jerk_ms3_mu);
  }
  const double speed = std::sqrt(speed2);
  felt_ms_ = kStops * (speed * inv_accel + (inv_accel > 0 ? inv_jerk / inv_accel : 2 * std::sqrt(speed * inv_jerk)));
}

void JerkPlan::renew() {
  first_ = state_.cell;
  if (state_.offset_mu >= path_.cell(first_).length_mu) state_ = {++first_, 0, state_.speed2, state_.slope};
  if (first_ >= path_.cell_end()) return;
  const std::size_t end = end_of_stretch(), kept = kept_cells();
  estimate(end);
  new_cells_.assign(cells_.begin() + static_cast<std::ptrdiff_t>(next_), cells_.begin() + static_cast<std::ptrdiff_t>(next_ + kept));
  divide(kLongestStep_ms, kept, end);
  guess(kept);
  const bool solved = solve_refined();
  if (!accept(solved)) return;
  std::swap(cells_, new_cells_);
  std::swap(profile_, new_profile_);
  next_ = 0;
  take_felt();
}

/// Roughly while cells are being divided.
bool JerkPlan::solve_refined() {
  for (int i = 0; i <= kRefinements; ++i) {
    make_problem();
    if (!solver_.solve(problem_, kRoughGap, new_profile_)) return false;
    if (i == kRefinements || !refine()) break;
  }
  return solver_.go_on(kGap, new_profile_);
}

/// Behind the last cell before the next rest.
std::size_t JerkPlan::end_of_stretch() const {
  std::size_t end = first_;
  while (end < path_.cell_end() && !path_.cell(end).stops) ++end;
  return std::min(end + 1, path_.cell_end());
}

/// Cells of the old plan that the new one has, too: up to where the old one brakes for its end.
std::size_t JerkPlan::kept_cells() const {
  if (is_done()) return 0;
  std::size_t braking = profile_.nodes() - 1;
  while (braking > next_ && profile_.slope[braking - 1] < 0) --braking;
  return braking - next_;
}

/// About the speed at the ends of the path's cells: what the place allows, and acceleration from and to slower places.
void JerkPlan::estimate(std::size_t end) {
  const std::size_t count = end - first_;
  auto& speed2 = stretch_.speed2;
  speed2.assign(count + 1, 0);
  stretch_.start_mu.assign(count + 1, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const PathCell& cell = path_.cell(first_ + i);
    stretch_.start_mu[i + 1] = stretch_.start_mu[i] + cell.length_mu;
    const double next2 = i + 1 < count ? path_.cell(first_ + i + 1).start.steady_speed2 : 0;
    speed2[i + 1] = std::min(cell.end.steady_speed2, next2);
  }
  stretch_.length_mu = stretch_.start_mu.back();
  const PathCell& first = path_.cell(first_);
  speed2[0] = state_.speed2 > 0 ? state_.speed2 + gained2(first, state_.offset_mu) : 0;
  for (std::size_t i = 0; i < count; ++i) speed2[i + 1] = std::min(speed2[i + 1], speed2[i] + gained2(path_.cell(first_ + i), path_.cell(first_ + i).length_mu));
  for (std::size_t i = count; i-- > 0;) speed2[i] = std::min(speed2[i], speed2[i + 1] + gained2(path_.cell(first_ + i), path_.cell(first_ + i).length_mu));
  if (state_.speed2 > 0) speed2[0] = std::max(speed2[0], state_.speed2);
}

double JerkPlan::estimate_at(std::size_t index, double offset_mu) const {
  const PathCell& cell = path_.cell(index);
  const std::size_t i = index - first_;
  const double left_mu = cell.length_mu - offset_mu, at_mu = stretch_.start_mu[i] + offset_mu;
  double result = between(cell.start.steady_speed2, cell.end.steady_speed2, offset_mu / cell.length_mu);
  result = std::min({result, stretch_.speed2[i] + gained2(cell, offset_mu), stretch_.speed2[i + 1] + gained2(cell, left_mu)});
  if (state_.speed2 == 0) result = std::min(result, from_rest2(cell, at_mu));
  return std::min(result, from_rest2(cell, stretch_.length_mu - at_mu));
}

/// Length that is gone in a time from rest.
double JerkPlan::rest_cell_mu(std::size_t index, double time_ms) const {
  const PathCell& cell = path_.cell(index);
  double result = std::sqrt(std::max(cell.start.steady_speed2, cell.end.steady_speed2)) * time_ms / 3;
  if (cell.inv_accel_ms2_mu > 0) result = std::min(result, time_ms * time_ms / (6 * cell.inv_accel_ms2_mu));
  if (cell.inv_jerk_ms3_mu > 0) result = std::min(result, std::pow(time_ms, 3) / (6 * cell.inv_jerk_ms3_mu));
  return result;
}

/// Time of the smallest cells: a part of that in which acceleration builds up.
double JerkPlan::finest_step_ms() const {
  double ramp_ms = 1e9;
  for (const MotorLimits& limit : path_.limits()) {
    if (limit.inv_jmax_ms3_mu <= 0) continue;
    if (limit.inv_amax_ms2_mu > 0) ramp_ms = std::min(ramp_ms, limit.inv_jmax_ms3_mu / limit.inv_amax_ms2_mu);
    else if (limit.max_speed_mu_ms > 0) ramp_ms = std::min(ramp_ms, std::sqrt(limit.max_speed_mu_ms * limit.inv_jmax_ms3_mu));
  }
  return std::clamp(ramp_ms / kStepsPerRamp, shortest_step_ms_, kLongestStep_ms);
}

/// Adds the cells behind the kept ones; smaller where motion is soon over.
void JerkPlan::divide(double step_ms, std::size_t kept, std::size_t end) {
  const std::size_t from_cell = kept > 0 ? new_cells_.back().cell : first_;
  const double from_mu = kept > 0 ? new_cells_.back().to_mu : state_.offset_mu;
  for (int attempt = 0; attempt < 3; ++attempt) {
    new_cells_.resize(kept);
    for (std::size_t i = from_cell; i < end; ++i)
      divide_cell(i, i == from_cell ? from_mu : 0, state_.speed2 == 0 && kept == 0 && i == first_, i + 1 == end, step_ms);
    const double count = static_cast<double>(new_cells_.size());
    if (kept > 0 || state_.speed2 > 0 || count >= kStepsPerStretch) return;
    step_ms *= std::max(0.02, 0.8 * count / kStepsPerStretch);
  }
}

/// Cells of equal time, as estimated; the first and the last one longer where motion rests.
void JerkPlan::divide_cell(std::size_t index, double from_mu, bool starts, bool ends, double step_ms) {
  const double length_mu = path_.cell(index).length_mu;
  double at_mu = from_mu, end_mu = length_mu;
  if (!(at_mu < length_mu)) return;
  const auto add_to = [&](double to_mu) {
    new_cells_.push_back({index, at_mu, to_mu});
    at_mu = to_mu;
  };
  if (ends) end_mu = std::max(length_mu - rest_cell_mu(index, kRestSteps * step_ms), between(at_mu, length_mu, starts ? 2.0 / 3 : 0.5));
  if (starts) add_to(std::min(at_mu + rest_cell_mu(index, kRestSteps * step_ms), between(at_mu, end_mu, ends ? 0.5 : 1.0)));
  while (at_mu < end_mu) {
    const double here = std::sqrt(estimate_at(index, at_mu));
    const double there = std::sqrt(estimate_at(index, std::min(end_mu, at_mu + step_ms * here)));
    double step_mu = step_ms * std::max(std::min(here, there), 1e-3 * std::max(here, there));
    if (at_mu == state_.offset_mu && index == first_ && state_.slope < 0) step_mu = std::min(step_mu, state_.speed2 / (-2 * state_.slope));
    const double left_mu = end_mu - at_mu;
    if (!(step_mu > 1e-4 * left_mu)) step_mu = 1e-4 * left_mu;
    add_to(left_mu < 1.5 * step_mu ? end_mu : left_mu < 2 * step_mu ? at_mu + left_mu / 2 : at_mu + step_mu);
  }
  if (ends) add_to(length_mu);
}

/// Where the solution begins: the old plan, and a part of the estimated speed.
void JerkPlan::guess(std::size_t kept) {
  guess_speed2_.clear();
  for (std::size_t i = 0; i < new_cells_.size(); ++i)
    guess_speed2_.push_back(i < kept ? profile_.speed2[next_ + i + 1] : kFirstGuess * estimate_at(new_cells_[i].cell, new_cells_[i].to_mu));
}

/// Divides the cells of the new plan in which acceleration changes much, and those beside them, in time. False where there are none.
bool JerkPlan::refine() {
  const double finest_ms = finest_step_ms();
  parts_.clear();
  part_speed2_.clear();
  for (std::size_t i = 0; i < new_cells_.size(); ++i) {
    const PlannedCell& cell = new_cells_[i];
    const bool divides = is_coarse(i, finest_ms) || (i > 0 && is_coarse(i - 1, finest_ms)) || (i + 1 < new_cells_.size() && is_coarse(i + 1, finest_ms));
    const CellMotion m = motion_through(cell.to_mu - cell.from_mu, new_profile_.speed2[i], new_profile_.slope[i], new_profile_.speed2[i + 1], new_profile_.slope[i + 1]);
    double from_mu = cell.from_mu;
    for (int k = 1; divides && k < kParts && m.duration_ms > kRefineFrom * finest_ms; ++k) {
      const double t = m.duration_ms * k / kParts, to_mu = cell.from_mu + m.place(t);
      if (!(to_mu > from_mu && to_mu < cell.to_mu)) continue;
      parts_.push_back({cell.cell, from_mu, to_mu});
      part_speed2_.push_back(std::max(m.speed_at(t) * m.speed_at(t), 1e-6 * std::max(new_profile_.speed2[i], new_profile_.speed2[i + 1])));
      from_mu = to_mu;
    }
    parts_.push_back({cell.cell, from_mu, cell.to_mu});
    part_speed2_.push_back(new_profile_.speed2[i + 1]);
  }
  const bool any = parts_.size() > new_cells_.size();
  if (!any) return false;
  std::swap(parts_, new_cells_);
  std::swap(part_speed2_, guess_speed2_);
  return true;
}

bool JerkPlan::is_coarse(std::size_t i, double finest_ms) const {
  const double change = std::abs(new_profile_.slope[i + 1] - new_profile_.slope[i]) / 2 * path_.cell(new_cells_[i].cell).inv_accel_ms2_mu;
  if (change < kMuchChange) return false;
  const double length_mu = new_cells_[i].to_mu - new_cells_[i].from_mu;
  return length_mu > kRefineFrom * finest_ms * (std::sqrt(new_profile_.speed2[i]) + std::sqrt(new_profile_.speed2[i + 1])) / 2;
}

void JerkPlan::make_problem() {
  problem_.clear();
  problem_.start_speed2 = state_.speed2;
  problem_.start_slope = state_.slope;
  problem_.max_speed2.push_back(0);
  problem_.guess_speed2.push_back(state_.speed2);
  for (std::size_t i = 0; i < new_cells_.size(); ++i) {
    const PlannedCell& planned = new_cells_[i];
    const PathCell& cell = path_.cell(planned.cell);
    const bool whole = planned.to_mu == cell.length_mu;
    add_rows(i);
    double max_speed2 = max_speed2_at(cell, planned.to_mu);
    if (whole && i + 1 < new_cells_.size()) max_speed2 = std::min(max_speed2, path_.cell(planned.cell + 1).start.max_speed2);
    problem_.max_speed2.push_back(max_speed2);
    problem_.middle_speed2.push_back(max_speed2_at(cell, (planned.from_mu + planned.to_mu) / 2));
    problem_.guess_speed2.push_back(guess_speed2_[i]);
  }
  problem_.guess_speed2.back() = 0;
}

/// Of the jerk limits, that cells near small steps of acceleration may use.
double JerkPlan::jerk_share(std::size_t i) const {
  const PlannedCell& planned = new_cells_[i];
  const PathCell& cell = path_.cell(planned.cell);
  const double near_mu = kNear * 2 * shortest_step_ms_ * std::sqrt(std::max(cell.start.steady_speed2, cell.end.steady_speed2));
  double step_mu2 = planned.from_mu < near_mu ? cell.start_step_mu2 : 0;
  if (planned.to_mu > cell.length_mu - near_mu) step_mu2 = std::max(step_mu2, cell.end_step_mu2);
  const double steady2 = std::max(cell.start.steady_speed2, cell.end.steady_speed2), guess2 = std::max(i > 0 ? guess_speed2_[i - 1] : state_.speed2, guess_speed2_[i]);
  return jerk_share_beside(step_mu2 * std::min(steady2, guess2 / kFirstGuess));
}

/// What the motors make of a cell; along a straight line the tightest counts for all.
void JerkPlan::add_rows(std::size_t i) {
  const PlannedCell& planned = new_cells_[i];
  const PathCell& cell = path_.cell(planned.cell);
  const std::size_t before = problem_.rows.size() - (problem_.first_row.size() > 1 ? problem_.first_row[problem_.first_row.size() - 2] : 0);
  const ProfileRow* last = problem_.rows.empty() ? nullptr : problem_.rows.data() + problem_.first_row[problem_.first_row.size() - 2];
  const double from = planned.from_mu / cell.length_mu, to = planned.to_mu / cell.length_mu;
  const double share = jerk_share(i);
  std::vector<ProfileRow> rows;
  if (cell.is_straight) rows.push_back({cell.inv_accel_ms2_mu / kAccel, cell.inv_jerk_ms3_mu / (kJerk * share), 1, 0, 1, 1, 0, 0, true});
  for (std::size_t m = 0; !cell.is_straight && m < std::min(path_.limits().size(), cell.start.tangent.size()); ++m) {
    const MotorLimits& limit = path_.limits()[m];
    if (limit.inv_amax_ms2_mu <= 0 && limit.inv_jmax_ms3_mu <= 0) continue;
    rows.push_back({limit.inv_amax_ms2_mu / (kAccel * cell.accel_share), limit.inv_jmax_ms3_mu / (kJerk * share), tangent_at(cell, m, from), curvature_at(cell, m, from),
                    tangent_at(cell, m, (from + to) / 2), tangent_at(cell, m, to), curvature_at(cell, m, to),
                    (cell.end.curvature_mu[m] - cell.start.curvature_mu[m]) / cell.length_mu, false});
  }
  bool steps = last == nullptr || before != rows.size();
  for (std::size_t k = 0; !steps && k < rows.size(); ++k)
    steps = std::abs(rows[k].start_tangent - last[k].end_tangent) > kStep || rows[k].inv_accel > last[k].inv_accel ||
            std::abs(rows[k].start_curvature - last[k].end_curvature) * cell.start.max_speed2 * rows[k].inv_accel > kStep;
  problem_.steps_at_start.push_back(steps ? 1 : 0);
  problem_.length_mu.push_back(planned.to_mu - planned.from_mu);
  problem_.rows.insert(problem_.rows.end(), rows.begin(), rows.end());
  problem_.first_row.push_back(problem_.rows.size());
}

/// Whether the new profile keeps the limits; one from rest is made to.
bool JerkPlan::accept(bool solved) {
  const auto is_good = [&](const ProfileUse& use) { return use.speed2 <= kSpeedRoom && use.accel <= kAccelRoom && use.jerk <= kJerkRoom; };
  const ProfileUse use = use_of(problem_, new_profile_);
  if (solved && is_good(use)) return true;
  if (state_.speed2 > 0) return false;
  slow_down();
  return true;
}

/// Speeds k times as high take k^2 of the accelerations and k^3 of the jerk.
void JerkPlan::slow_down() {
  const ProfileUse use = use_of(problem_, new_profile_);
  const double factor = std::min({1.0, 1 / std::max(use.speed2, 1e-300), 1 / std::max(use.accel, 1e-300), std::pow(std::max(use.jerk, 1e-300), -2.0 / 3)});
  for (double& x : new_profile_.speed2) x *= factor;
  for (double& y : new_profile_.slope) y *= factor;
}

}  // namespace pmac::motion
