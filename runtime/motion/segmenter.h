// Hop 6 to 7: the path evaluated exactly at nodes, brought to motor space, and joined by cubics. Nodes lie on multiples of the
// segment time from the start of the sequence; fitting through the nodes adds one at each end of a path piece and on arcs one
// every 0.1 rad, so that every cubic follows one smooth piece. Manual: Turbo Software Reference Isx13, User's Manual p722. Where
// motion rests (start, end, a full stop) a new chain of nodes begins. On a straight line at constant speed with lookahead one segment stands for several: it
// says which nodes it passes.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "runtime/motion/motor_map.h"
#include "runtime/motion/node_fit.h"
#include "runtime/motion/path.h"

namespace pmac::motion {

class Segmenter {
 public:
  /// config and kinematics must outlive the segmenter.
  Segmenter(const PipelineConfig& config, const MotorKinematics& kinematics);

  /// The next piece; appends the segments that are now decided. A fault is that of the kinematic routine; the segments up to
  /// the place where it failed are appended, nothing more may be added.
  [[nodiscard]] std::optional<runtime::Fault> add(const PathPiece& piece, std::vector<Segment>& out);
  /// The sequence has ended at rest at the end of the last piece.
  [[nodiscard]] std::optional<runtime::Fault> finish(std::vector<Segment>& out);
  /// After a fault: appends what is known up to the last node and forgets the rest.
  void abandon(std::vector<Segment>& out);

 private:
  friend class LinePath;   // does the same for plain lines
  struct Place { double local_ms, passed_ms; };   // of a node; see Segment
  std::optional<runtime::Fault> start_chain(const PathPiece& piece);
  std::optional<runtime::Fault> add_node(const PathPiece& piece, const Place& place, std::vector<Segment>& out);
  std::optional<runtime::Fault> close_gap(std::vector<Segment>& out);
  MotorNode& open() { return nodes_[open_at_]; }
  void enter_piece(const PathPiece& piece);
  void fill_side(NodeSide& side, const PathPiece& piece, double local_ms, const PathMotion& point, const Row<double>* velocity_mu_ms = nullptr) const;
  void take_differences(NodeSide& side, const PathPiece& piece, const PathMotion& point) const;
  void place_nodes(const PathPiece& piece);
  void add_turn_nodes(const PathPiece& piece, double end_ms);
  bool stands_still(const PathPiece& piece) const;
  std::optional<runtime::Fault> stand_still(const PathPiece& piece);
  bool passes_nodes(const PathPiece& piece) const;

  const PipelineConfig& config_;
  const MotorKinematics& kinematics_;
  std::unique_ptr<NodeFit> fit_;
  bool uniform_;                        // nodes on the grid only
  double longest_ms_;                   // of a segment on a straight line at constant speed, where nodes may be passed
  std::array<MotorNode, 2> nodes_;      // the last one, whose far side is that of the next piece, and the one being made
  std::size_t open_at_ = 0;             // which is the last
  bool is_open_ = false;                // there is one
  PathPiece previous_;                  // last piece
  bool has_previous_ = false;           // there is one
  bool end_is_open_ = false;            // the end of previous_ has no node yet
  double origin_ms_ = 0;                // start of the chain
  std::int64_t next_grid_ = 1;          // next node at origin + next_grid * segment time
  std::uint64_t stretch_ = 0;
  double stretch_start_ms_ = 0;
  std::vector<Place> places_;           // of the piece
  bool has_few_nodes_ = false;          // the last piece: too few to tell velocities
};

}  // namespace pmac::motion
