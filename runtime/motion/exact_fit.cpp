// Linear maps: motor velocities are the map's image of the exact axis velocities, so the cubic meets position and velocity of
// the path at both nodes. Error on an arc: V^4 T^4 / (384 R^3).
#include "runtime/motion/node_fit.h"

namespace pmac::motion {

void add_hermite_segment(const MotorNode& from, const MotorNode& to, const Row<double>& p0, const Row<double>& v0, const Row<double>& p1,
                         const Row<double>& v1, std::vector<Segment>& out) {
  Segment& segment = out.emplace_back();
  segment.command = to.command;
  segment.source = to.source;
  segment.start_ms = from.time_ms;
  segment.duration_ms = to.time_ms - from.time_ms;
  segment.passed_ms = to.passed_ms;
  segment.motor.resize(p0.size());
  for (std::size_t m = 0; m < p0.size(); ++m) segment.motor[m] = hermite_cubic(p0[m], v0[m], p1[m], v1[m], segment.duration_ms);
}

namespace {

class ExactFit : public NodeFit {
 public:
  void add(MotorNode& node, std::vector<Segment>& out) override {
    if (is_open_) add_hermite_segment(last_, node, last_.position_mu, last_.after.velocity_mu_ms, node.position_mu, node.before.velocity_mu_ms, out);
    std::swap(last_, node);
    is_open_ = true;
  }
  void finish(std::vector<Segment>&) override { is_open_ = false; }

 private:
  MotorNode last_;
  bool is_open_ = false;
};

}  // namespace

std::unique_ptr<NodeFit> make_exact_fit() { return std::make_unique<ExactFit>(); }

}  // namespace pmac::motion
