#include "runtime/motion/segmenter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/interruption.h"

namespace pmac::motion {
namespace {

using runtime::Fault;

/// Largest turn of an arc within one segment: the cubic is then within R * 0.1^4 / 384 of it.
constexpr double kMaxTurn_rad = 0.1;
/// Nodes are not placed nearer to one another: second differences of positions would be all rounding.
constexpr double kMinGap_ms = 1e-3;
/// Differences of a kinematic routine: short beside a segment, and long beside what an iterating routine leaves undecided.
constexpr double kLongestDifference_ms = 1, kDifferencesPerSegment = 8;
/// Nodes of one curve in a row that tell the velocities at all of them (stencil_fit.cpp).
constexpr std::size_t kNodesThatTell = 6;

double turn_rad(const PathPiece& piece, double from_ms, double to_ms) {
  double turn = 0;
  for (int i = 0; i < piece.part_count; ++i) {
    const PathPart& part = piece.part[static_cast<std::size_t>(i)];
    if (part.curve->is_arc)
      turn = std::max(turn, part.curve->sweep_rad * std::abs(parameter(part, to_ms) - parameter(part, from_ms)));
  }
  return turn;
}

bool same_stretch(const PathPiece& a, const PathPiece& b) {
  return a.part_count == b.part_count && a.part[0].curve == b.part[0].curve &&
         (a.part_count == 1 || a.part[1].curve == b.part[1].curve);
}

/// Longest segment on a straight line at constant speed. Time-optimal lookahead with limits for all motors divides it itself where it has to.
double longest_line_ms(const PipelineConfig& config, const MotorKinematics& kinematics) {
  constexpr int kSegments = 16;
  const bool all_limited = !config.limits.empty() && std::all_of(config.limits.begin(), config.limits.end(), [](const MotorLimits& l) { return l.inv_amax_ms2_mu > 0; });
  if (!config.lookahead || config.limit_jerk || !kinematics.is_linear() || !all_limited) return 0;
  return std::min(kSegments, config.lookahead_segments / 8) * config.segment_time_ms;
}

std::unique_ptr<NodeFit> make_fit(const PipelineConfig& config, const MotorKinematics& kinematics) {
  if (config.fine == FineInterpolation::kBspline) return make_bspline_fit();
  return kinematics.is_linear() ? make_exact_fit() : make_stencil_fit();
}

}  // namespace

Segmenter::Segmenter(const PipelineConfig& config, const MotorKinematics& kinematics)
    : config_(config), kinematics_(kinematics), fit_(make_fit(config, kinematics)), uniform_(config.fine == FineInterpolation::kBspline),
      longest_ms_(longest_line_ms(config, kinematics)) {}

std::optional<Fault> Segmenter::add(const PathPiece& piece, std::vector<Segment>& out) {
  if (is_open_ && (piece.starts_at_rest || piece.step_at_start || stands_still(piece)))
    if (auto fault = close_gap(out)) return fault;
  if (is_open_ && piece.starts_at_rest)
    if (auto fault = finish(out)) return fault;
  if (!is_open_)
    if (auto fault = start_chain(piece)) return fault;
  place_nodes(piece);
  has_few_nodes_ = places_.size() + 1 < kNodesThatTell;
  enter_piece(piece);
  if (stands_still(piece))
    if (auto fault = stand_still(piece)) return fault;
  for (const Place& place : places_)
    if (auto fault = add_node(piece, place, out)) return fault;
  end_is_open_ = open().time_ms != piece.start_ms + piece.duration_ms;
  previous_ = piece;
  has_previous_ = true;
  return std::nullopt;
}

std::optional<Fault> Segmenter::finish(std::vector<Segment>& out) {
  if (!is_open_) return std::nullopt;
  if (auto fault = close_gap(out)) return fault;
  fit_->add(open(), out);
  fit_->finish(out);
  is_open_ = has_previous_ = false;
  return std::nullopt;
}

/// First node of a chain.
std::optional<Fault> Segmenter::start_chain(const PathPiece& piece) {
  MotorNode& node = open();
  node.time_ms = piece.start_ms;
  node.passed_ms = 0;
  node.command = piece.command;
  node.source = piece.source;
  node.position_mu.resize(kinematics_.count());
  PathMotion point;
  evaluate(piece, 0, kinematics_.axes(), point);
  if (auto fault = kinematics_.position(point.position, node.position_mu.data(), piece.source)) return fault;
  ++stretch_;
  stretch_start_ms_ = piece.start_ms;
  node.step = true;
  fill_side(node.before, piece, 0, point);
  node.before.stretch = 0;
  node.before.z_rate = 0;
  is_open_ = true;
  origin_ms_ = piece.start_ms;
  next_grid_ = 1;
  end_is_open_ = false;
  return std::nullopt;
}

/// The far side of the open node is the beginning of this piece.
void Segmenter::enter_piece(const PathPiece& piece) {
  if (has_previous_ && !same_stretch(previous_, piece)) {
    ++stretch_;
    stretch_start_ms_ = piece.start_ms;
  }
  const bool is_new_side = !has_previous_ || piece.step_at_start || !kinematics_.is_linear();
  const double local_ms = open().time_ms - piece.start_ms;
  if (is_new_side) {
    PathMotion point;
    evaluate(piece, local_ms, kinematics_.axes(), point);
    const bool known = !kinematics_.is_linear() && !piece.step_at_start && !open().before.velocity_mu_ms.empty();
    fill_side(open().after, piece, local_ms, point, known ? &open().before.velocity_mu_ms : nullptr);
  }
  if (!is_new_side) open().after = open().before;
  open().step = open().step || piece.step_at_start;
}

/// The motors stand still on this piece: a delay, or moves of axes that no motor follows.
bool Segmenter::stands_still(const PathPiece& piece) const {
  return !uniform_ && piece.part_count == 1 && (piece.part[0].curve->moved & kinematics_.axes()) == 0;
}

/// What the blend before the piece leaves of velocity and distance is rounding: the open node is exactly where the motors stand.
std::optional<Fault> Segmenter::stand_still(const PathPiece& piece) {
  MotorNode& node = open();
  PathMotion point;
  evaluate(piece, 0, kinematics_.axes(), point);
  if (auto fault = kinematics_.position(point.position, node.position_mu.data(), piece.source)) return fault;
  node.after.velocity_mu_ms.assign(kinematics_.count(), 0);
  if (!node.step) node.before.velocity_mu_ms = node.after.velocity_mu_ms;
  return std::nullopt;
}

/// Velocities where neighbouring nodes do not tell them: in corners, along which positions are no smooth function of one parameter, and on
/// pieces with too few nodes: the nodes of the next piece of the same curve may help, or there may be none.
void Segmenter::take_differences(NodeSide& side, const PathPiece& piece, const PathMotion& point) const {
  if (uniform_ || (piece.part_count == 1 && !has_few_nodes_)) return;
  side.velocity_mu_ms.assign(kinematics_.count(), 0);
  if (point.velocity == AxisVector{}) return;   // at rest
  const double step_ms = std::min(kLongestDifference_ms, config_.segment_time_ms / kDifferencesPerSegment);
  if (!kinematics_.rate_by_differences(point.position, point.velocity, step_ms, side.velocity_mu_ms.data(), piece.source)) side.velocity_mu_ms.clear();
}

/// point: the path at local_ms. velocity_mu_ms: if it is known.
void Segmenter::fill_side(NodeSide& side, const PathPiece& piece, double local_ms, const PathMotion& point, const Row<double>* velocity_mu_ms) const {
  side.stretch = stretch_;
  const bool corner = piece.part_count > 1;
  side.z = corner ? piece.start_ms + local_ms - stretch_start_ms_ : parameter(piece.part[0], local_ms);
  side.z_rate = corner ? 1 : parameter_rate(piece.part[0], local_ms);
  if (!kinematics_.is_linear()) {
    side.velocity_mu_ms.clear();
    if (velocity_mu_ms) side.velocity_mu_ms = *velocity_mu_ms;
    else take_differences(side, piece, point);
    return;
  }
  side.velocity_mu_ms.resize(kinematics_.count());
  kinematics_.rate(point.velocity, side.velocity_mu_ms.data());
}

/// On this piece the motors run straight at constant speed, and segments may be longer than the segment time.
bool Segmenter::passes_nodes(const PathPiece& piece) const {
  const PathPart& part = piece.part[0];
  return longest_ms_ > config_.segment_time_ms && piece.part_count == 1 && part.curve->moved != 0 && !part.curve->is_arc && !part.curve->rates && part.u[2] == 0 && part.u[3] == 0;
}

/// Fills places_ with the nodes of this piece, without the one at its start.
void Segmenter::place_nodes(const PathPiece& piece) {
  places_.clear();
  const bool passes = passes_nodes(piece);
  double passed_ms = 0;
  const double step_ms = config_.segment_time_ms;
  const double end_ms = piece.start_ms + piece.duration_ms;
  for (;;) {
    const double time_ms = origin_ms_ + static_cast<double>(next_grid_) * step_ms;
    if (time_ms > end_ms + (uniform_ ? 0 : -kMinGap_ms)) break;
    ++next_grid_;
    if (time_ms < open().time_ms + kMinGap_ms && !uniform_) continue;
    const double last_ms = places_.empty() ? open().time_ms : piece.start_ms + places_.back().local_ms;
    if (passes && time_ms + step_ms - last_ms <= longest_ms_) {
      if (passed_ms == 0) passed_ms = time_ms;
      continue;
    }
    add_turn_nodes(piece, time_ms - piece.start_ms);
    places_.back().passed_ms = std::exchange(passed_ms, 0.0);
  }
  if (uniform_) return;
  if (end_ms - open().time_ms >= kMinGap_ms) {
    add_turn_nodes(piece, piece.duration_ms);
    places_.back().passed_ms = passed_ms;
  }
  if (origin_ms_ + static_cast<double>(next_grid_) * step_ms <= end_ms + kMinGap_ms) ++next_grid_;
}

/// The node at end_ms, and before it as many as the turn of an arc asks for.
void Segmenter::add_turn_nodes(const PathPiece& piece, double end_ms) {
  const double start_ms = places_.empty() ? std::max(0.0, open().time_ms - piece.start_ms) : places_.back().local_ms;
  const double parts = uniform_ ? 1 : std::max(1.0, std::ceil(turn_rad(piece, start_ms, end_ms) / kMaxTurn_rad - 1e-9));
  for (double i = 1; i < parts; ++i) places_.push_back({start_ms + (end_ms - start_ms) * i / parts, 0});
  places_.push_back({end_ms, 0});
}

std::optional<Fault> Segmenter::add_node(const PathPiece& piece, const Place& place, std::vector<Segment>& out) {
  runtime::poll_interruption();
  const double local_ms = place.local_ms;
  MotorNode& node = nodes_[1 - open_at_];
  node.passed_ms = place.passed_ms;
  node.step = false;
  node.time_ms = local_ms == piece.duration_ms ? piece.start_ms + piece.duration_ms : piece.start_ms + local_ms;
  node.command = piece.command;
  node.source = piece.source;
  node.position_mu.resize(kinematics_.count());
  PathMotion point;
  evaluate(piece, local_ms, kinematics_.axes(), point);
  if (stands_still(piece)) node.position_mu = open().position_mu;
  else if (auto fault = kinematics_.position(point.position, node.position_mu.data(), piece.source)) return fault;
  fill_side(node.before, piece, local_ms, point);
  node.after = node.before;
  fit_->add(open(), out);
  open_at_ = 1 - open_at_;
  return std::nullopt;
}

/// Puts a node on the end of the last piece where it has none; one that nearly coincides moves there.
std::optional<Fault> Segmenter::close_gap(std::vector<Segment>& out) {
  if (!end_is_open_) return std::nullopt;
  end_is_open_ = false;
  const PathPiece& piece = previous_;
  const double end_ms = piece.start_ms + piece.duration_ms;
  const bool is_first = open().before.stretch == 0;
  if (is_first || end_ms - open().time_ms >= kMinGap_ms) return add_node(piece, {piece.duration_ms, 0}, out);
  PathMotion point;
  evaluate(piece, piece.duration_ms, kinematics_.axes(), point);
  if (auto fault = kinematics_.position(point.position, open().position_mu.data(), piece.source)) return fault;
  open().time_ms = end_ms;
  fill_side(open().before, piece, piece.duration_ms, point);
  open().after = open().before;
  return std::nullopt;
}

void Segmenter::abandon(std::vector<Segment>& out) {
  if (!is_open_) return;
  fit_->add(open(), out);
  fit_->finish(out);
  is_open_ = has_previous_ = false;
}

}  // namespace pmac::motion
