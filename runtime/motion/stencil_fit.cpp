// Kinematic routines give positions only. Along one curve motor positions are a smooth function of the curve's own parameter z
// whatever the speed does, so dq/dz comes from the polynomial through neighbouring nodes of the same stretch, and the motor
// velocity is dq/dz * dz/dt with dz/dt exact. At rest it is exactly zero.
//
//     stretch 1 (line)        stretch 2 (arc)
//   --o-----o-----o-----o--|--o-----o---        a node between two stretches has an estimate of each side; where the path is
//                       ^ join                  smooth they are made one
//
// Velocities that the segmenter knows already (in corners, and where a stretch has few nodes) are taken as they are.
#include <algorithm>

#include "runtime/motion/node_fit.h"

namespace pmac::motion {
namespace {

constexpr int kStencilNodes = 6;
/// A node's velocity is decided when this many nodes follow it: then no later node can enter its stencil.
constexpr std::size_t kNodesAfter = kStencilNodes - 1;
constexpr std::size_t kNodesKept = 2 * kStencilNodes;

class StencilFit : public NodeFit {
 public:
  void add(MotorNode& node, std::vector<Segment>& out) override {
    nodes_.push_back(std::move(node));
    while (next_ + kNodesAfter < nodes_.size()) decide_next(out);
  }
  void finish(std::vector<Segment>& out) override {
    while (next_ < nodes_.size()) decide_next(out);
    nodes_.clear();
    next_ = 0;
  }

 private:
  struct Estimate { Row<double> velocity; int nodes = 0; };

  void decide_next(std::vector<Segment>& out) {
    make_velocities(next_);
    if (next_ > 0) {
      const MotorNode &from = nodes_[next_ - 1], &to = nodes_[next_];
      add_hermite_segment(from, to, from.position_mu, from.after.velocity_mu_ms, to.position_mu, to.before.velocity_mu_ms, out);
    }
    ++next_;
    if (next_ <= kNodesKept) return;
    nodes_.pop_front();
    --next_;
  }

  void make_velocities(std::size_t at) {
    MotorNode& node = nodes_[at];
    Row<double>&known_before = node.before.velocity_mu_ms, &known_after = node.after.velocity_mu_ms;
    if (!node.step && known_before.empty()) known_before = known_after;
    if (!node.step && known_after.empty()) known_after = known_before;
    if (!known_before.empty() && !known_after.empty()) return;
    Estimate before = estimate(at, false), after = estimate(at, true);
    if (!node.step) {
      if (before.nodes != after.nodes) (before.nodes < after.nodes ? before : after) = before.nodes < after.nodes ? after : before;
      for (std::size_t m = 0; m < before.velocity.size(); ++m)
        before.velocity[m] = after.velocity[m] = (before.velocity[m] + after.velocity[m]) / 2;
    }
    if (known_before.empty()) known_before = std::move(before.velocity);
    if (known_after.empty()) known_after = std::move(after.velocity);
  }

  double z_in(std::size_t at, std::uint64_t stretch) const {
    const MotorNode& node = nodes_[at];
    return node.after.stretch == stretch ? node.after.z : node.before.z;
  }
  bool belongs(std::size_t at, std::uint64_t stretch) const {
    return nodes_[at].before.stretch == stretch || nodes_[at].after.stretch == stretch;
  }

  /// Velocity on one side, from up to kStencilNodes nodes of its stretch around the node.
  Estimate estimate(std::size_t at, bool after) const {
    const NodeSide& side = after ? nodes_[at].after : nodes_[at].before;
    std::size_t first = at, last = at;
    while (static_cast<int>(last - first) + 1 < kStencilNodes) {
      const bool can_left = first > 0 && belongs(first - 1, side.stretch);
      const bool can_right = last + 1 < nodes_.size() && belongs(last + 1, side.stretch);
      if (!can_left && !can_right) break;
      const bool go_left = can_left && (!can_right || at - first <= last - at);
      go_left ? --first : ++last;
    }
    Estimate result{Row<double>(nodes_[at].position_mu.size(), 0.0), static_cast<int>(last - first) + 1};
    if (side.z_rate != 0) differentiate(at, first, last, side, result.velocity);
    return result;
  }

  /// sum of D_k (q_k - q_at): derivative at node `at` of the Lagrange polynomial through nodes first..last, times dz/dt.
  void differentiate(std::size_t at, std::size_t first, std::size_t last, const NodeSide& side, Row<double>& velocity) const {
    const double here = z_in(at, side.stretch);
    for (std::size_t k = first; k <= last; ++k) {
      if (k == at) continue;
      const double there = z_in(k, side.stretch);
      double weight = 1 / (there - here);
      for (std::size_t j = first; j <= last; ++j)
        if (j != k && j != at) weight *= (here - z_in(j, side.stretch)) / (there - z_in(j, side.stretch));
      for (std::size_t m = 0; m < velocity.size(); ++m)
        velocity[m] += weight * side.z_rate * (nodes_[k].position_mu[m] - nodes_[at].position_mu[m]);
    }
  }

  std::deque<MotorNode> nodes_;
  std::size_t next_ = 0;  // first node without velocities
};

}  // namespace

std::unique_ptr<NodeFit> make_stencil_fit() { return std::make_unique<StencilFit>(); }

}  // namespace pmac::motion
