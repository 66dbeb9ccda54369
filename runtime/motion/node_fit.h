// From nodes to segments: positions at the nodes are given, and a fit decides the velocities with which cubics join them.
// Three fits: exact velocities of a linear map, velocities estimated from neighbouring nodes (kinematic routines), and the
// smoothing B-spline.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "runtime/motion/segment.h"

namespace pmac::motion {

/// One side of a node. Within a stretch motor positions are a smooth function of z, and z of time.
struct NodeSide {
  std::uint64_t stretch = 0;
  double z = 0, z_rate = 0;             // 1/ms
  Row<double> velocity_mu_ms;           // where it is known: linear maps everywhere, routines in places
};

struct MotorNode {
  double time_ms = 0;                   // programmed time
  std::uint64_t command = 0;            // of the segment that ends here
  SourceLine source;
  Row<double> position_mu;
  NodeSide before, after;
  double passed_ms = 0;                 // see Segment
  bool step = false;                    // the velocity steps here: the sides are not to be made equal
};

class NodeFit {
 public:
  virtual ~NodeFit() = default;
  /// The next node of a chain; the first one opens it. Appends the segments that are now decided.
  /// What stands in `node` afterwards is of no meaning.
  virtual void add(MotorNode& node, std::vector<Segment>& out) = 0;
  /// The chain has come to rest at its last node.
  virtual void finish(std::vector<Segment>& out) = 0;
};

/// Cubics through the nodes with the given velocities of both sides.
std::unique_ptr<NodeFit> make_exact_fit();
/// Cubics through the nodes; velocities from polynomials through up to six nodes of the same stretch.
std::unique_ptr<NodeFit> make_stencil_fit();
/// Smoothing cubic B-spline with the nodes as control points; at rest exactly on the first and the last node.
std::unique_ptr<NodeFit> make_bspline_fit();

/// Appends the segment between two nodes with these end positions and velocities ([motor]).
void add_hermite_segment(const MotorNode& from, const MotorNode& to, const Row<double>& p0, const Row<double>& v0, const Row<double>& p1,
                         const Row<double>& v1, std::vector<Segment>& out);

}  // namespace pmac::motion
