// The smoothing fit: nodes are control points Q of a cubic B-spline, here as the Hermite cubic between its values W and slopes V
// at the knots. The ends are clamped to rest at Q, so no time is added. Weights for unequal times as in the spline mode.
#include "runtime/motion/node_fit.h"

namespace pmac::motion {
namespace {

struct Knot { Row<double> value, slope; };

/// W and V at `node` with times a, b before and c, d after it (a, d: of the segments one further away).
Knot smoothed(const MotorNode& previous, const MotorNode& node, const MotorNode& next, double a, double b, double c, double d) {
  const double alpha = c * c / ((b + c) * (a + b + c)), gamma = b * b / ((b + c) * (b + c + d));
  const double in = 3 * c / ((b + c) * (a + b + c)), out = 3 * b / ((b + c) * (b + c + d));
  Knot knot{node.position_mu, Row<double>(node.position_mu.size())};
  for (std::size_t m = 0; m < knot.value.size(); ++m) {
    const double back = node.position_mu[m] - previous.position_mu[m], ahead = next.position_mu[m] - node.position_mu[m];
    knot.value[m] += gamma * ahead - alpha * back;
    knot.slope[m] = in * back + out * ahead;
  }
  return knot;
}

class BsplineFit : public NodeFit {
 public:
  void add(MotorNode& node, std::vector<Segment>& out) override {
    nodes_.push_back(std::move(node));
    if (nodes_.size() == 1) knot_ = at_rest(nodes_[0]);
    if (nodes_.size() == 4) emit_inner(out);
  }
  void finish(std::vector<Segment>& out) override {
    if (nodes_.size() == 3) emit_inner(out);
    if (nodes_.size() == 2) emit(nodes_[0], nodes_[1], at_rest(nodes_[1]), out);
    nodes_.clear();
    before_ms_ = 0;
  }

 private:
  static Knot at_rest(const MotorNode& node) { return {node.position_mu, Row<double>(node.position_mu.size(), 0.0)}; }

  /// The segment that ends at nodes_[1]; nodes_[0] is then forgotten. Times missing at the ends are those of the neighbours.
  void emit_inner(std::vector<Segment>& out) {
    const auto gap = [&](std::size_t from) { return nodes_[from + 1].time_ms - nodes_[from].time_ms; };
    const double b = gap(0), c = gap(1);
    const double a = before_ms_ > 0 ? before_ms_ : b;
    const double d = nodes_.size() == 4 ? gap(2) : c;
    emit(nodes_[0], nodes_[1], smoothed(nodes_[0], nodes_[1], nodes_[2], a, b, c, d), out);
    nodes_.pop_front();
    before_ms_ = b;
  }
  void emit(const MotorNode& from, const MotorNode& to, Knot end, std::vector<Segment>& out) {
    add_hermite_segment(from, to, knot_.value, knot_.slope, end.value, end.slope, out);
    knot_ = std::move(end);
  }

  std::deque<MotorNode> nodes_;
  Knot knot_;               // at the end of the last segment
  double before_ms_ = 0;    // time between nodes_[0] and the node before it, 0: none
};

}  // namespace

std::unique_ptr<NodeFit> make_bspline_fit() { return std::make_unique<BsplineFit>(); }

}  // namespace pmac::motion
