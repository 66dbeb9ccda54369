#include "runtime/motion/segmenter.h"

#include <algorithm>
#include <cmath>

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
constexpr double kNodesThatTell = 4;

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

std::unique_ptr<NodeFit> make_fit(const PipelineConfig& config, const MotorKinematics& kinematics) {
  if (config.fine == FineInterpolation::kBspline) return make_bspline_fit();
  return kinematics.is_linear() ? make_exact_fit() : make_stencil_fit();
}

}  // namespace

Segmenter::Segmenter(const PipelineConfig& config, const MotorKinematics& kinematics)
    : config_(config), kinematics_(kinematics), fit_(make_fit(config, kinematics)), uniform_(config.fine == FineInterpolation::kBspline) {}

std::optional<Fault> Segmenter::add(const PathPiece& piece, std::vector<Segment>& out) {
  if (open_ && (piece.starts_at_rest || piece.step_at_start))
    if (auto fault = close_gap(out)) return fault;
  if (open_ && piece.starts_at_rest)
    if (auto fault = finish(out)) return fault;
  if (!open_)
    if (auto fault = start_chain(piece)) return fault;
  enter_piece(piece);
  place_nodes(piece);
  for (const double local_ms : local_times_)
    if (auto fault = add_node(piece, local_ms, out)) return fault;
  end_is_open_ = open_->time_ms != piece.start_ms + piece.duration_ms;
  previous_ = piece;
  return std::nullopt;
}

std::optional<Fault> Segmenter::finish(std::vector<Segment>& out) {
  if (!open_) return std::nullopt;
  if (auto fault = close_gap(out)) return fault;
  fit_->add(std::move(*open_), out);
  fit_->finish(out);
  open_.reset();
  previous_.reset();
  return std::nullopt;
}

/// First node of a chain.
std::optional<Fault> Segmenter::start_chain(const PathPiece& piece) {
  MotorNode node;
  node.time_ms = piece.start_ms;
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
  open_ = std::move(node);
  origin_ms_ = piece.start_ms;
  next_grid_ = 1;
  end_is_open_ = false;
  return std::nullopt;
}

/// The far side of the open node is the beginning of this piece.
void Segmenter::enter_piece(const PathPiece& piece) {
  if (previous_ && !same_stretch(*previous_, piece)) {
    ++stretch_;
    stretch_start_ms_ = piece.start_ms;
  }
  const bool is_new_side = !previous_ || piece.step_at_start || !kinematics_.is_linear();
  const double local_ms = open_->time_ms - piece.start_ms;
  if (is_new_side) {
    PathMotion point;
    evaluate(piece, local_ms, kinematics_.axes(), point);
    const bool known = !kinematics_.is_linear() && !piece.step_at_start && !open_->before.velocity_mu_ms.empty();
    fill_side(open_->after, piece, local_ms, point, known ? &open_->before.velocity_mu_ms : nullptr);
  }
  if (!is_new_side) open_->after = open_->before;
  open_->step = open_->step || piece.step_at_start;
}

/// Velocities where neighbouring nodes do not tell them: in corners, along which positions are no smooth function of one parameter, and on
/// curves with too few nodes.
void Segmenter::take_differences(NodeSide& side, const PathPiece& piece, const PathMotion& point) const {
  const double part_of_curve = parameter(piece.part[0], piece.duration_ms) - parameter(piece.part[0], 0);
  const bool has_few_nodes = piece.duration_ms < kNodesThatTell * config_.segment_time_ms * part_of_curve;
  if (uniform_ || (piece.part_count == 1 && !has_few_nodes)) return;
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
  side.velocity_mu_ms.clear();
  if (!kinematics_.is_linear()) {
    if (velocity_mu_ms) side.velocity_mu_ms = *velocity_mu_ms;
    else take_differences(side, piece, point);
    return;
  }
  side.velocity_mu_ms.resize(kinematics_.count());
  kinematics_.rate(point.velocity, side.velocity_mu_ms.data());
}

/// Fills local_times_ with the nodes of this piece, without the one at its start.
void Segmenter::place_nodes(const PathPiece& piece) {
  local_times_.clear();
  const double step_ms = config_.segment_time_ms;
  const double end_ms = piece.start_ms + piece.duration_ms;
  for (;;) {
    const double time_ms = origin_ms_ + static_cast<double>(next_grid_) * step_ms;
    if (time_ms > end_ms + (uniform_ ? 0 : -kMinGap_ms)) break;
    ++next_grid_;
    if (time_ms < open_->time_ms + kMinGap_ms && !uniform_) continue;
    add_turn_nodes(piece, time_ms - piece.start_ms);
  }
  if (uniform_) return;
  if (end_ms - open_->time_ms >= kMinGap_ms) add_turn_nodes(piece, piece.duration_ms);
  if (origin_ms_ + static_cast<double>(next_grid_) * step_ms <= end_ms + kMinGap_ms) ++next_grid_;
}

/// The node at end_ms, and before it as many as the turn of an arc asks for.
void Segmenter::add_turn_nodes(const PathPiece& piece, double end_ms) {
  const double start_ms = local_times_.empty() ? std::max(0.0, open_->time_ms - piece.start_ms) : local_times_.back();
  const double parts = uniform_ ? 1 : std::max(1.0, std::ceil(turn_rad(piece, start_ms, end_ms) / kMaxTurn_rad - 1e-9));
  for (double i = 1; i < parts; ++i) local_times_.push_back(start_ms + (end_ms - start_ms) * i / parts);
  local_times_.push_back(end_ms);
}

std::optional<Fault> Segmenter::add_node(const PathPiece& piece, double local_ms, std::vector<Segment>& out) {
  runtime::poll_interruption();
  MotorNode node;
  node.time_ms = local_ms == piece.duration_ms ? piece.start_ms + piece.duration_ms : piece.start_ms + local_ms;
  node.command = piece.command;
  node.source = piece.source;
  node.position_mu.resize(kinematics_.count());
  PathMotion point;
  evaluate(piece, local_ms, kinematics_.axes(), point);
  if (auto fault = kinematics_.position(point.position, node.position_mu.data(), piece.source)) return fault;
  fill_side(node.before, piece, local_ms, point);
  node.after = node.before;
  fit_->add(std::move(*open_), out);
  open_ = std::move(node);
  return std::nullopt;
}

/// Puts a node on the end of the last piece where it has none; one that nearly coincides moves there.
std::optional<Fault> Segmenter::close_gap(std::vector<Segment>& out) {
  if (!end_is_open_) return std::nullopt;
  end_is_open_ = false;
  const PathPiece& piece = *previous_;
  const double end_ms = piece.start_ms + piece.duration_ms;
  const bool is_first = open_->before.stretch == 0;
  if (is_first || end_ms - open_->time_ms >= kMinGap_ms) return add_node(piece, piece.duration_ms, out);
  PathMotion point;
  evaluate(piece, piece.duration_ms, kinematics_.axes(), point);
  if (auto fault = kinematics_.position(point.position, open_->position_mu.data(), piece.source)) return fault;
  open_->time_ms = end_ms;
  fill_side(open_->before, piece, piece.duration_ms, point);
  open_->after = open_->before;
  return std::nullopt;
}

void Segmenter::abandon(std::vector<Segment>& out) {
  if (!open_) return;
  fit_->add(std::move(*open_), out);
  fit_->finish(out);
  open_.reset();
  previous_.reset();
}

}  // namespace pmac::motion
