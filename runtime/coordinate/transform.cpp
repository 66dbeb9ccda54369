#include "runtime/coordinate/transform.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/motion/axis_vector.h"
#include "runtime/motion/circle.h"
#include "runtime/motion/curve.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using motion::MotionCommand;

/// Rounding of a matrix that a program has computed with sines and cosines.
constexpr double kTolerance = 1e-9;

Matrix3d matrix_of(const std::array<std::array<double, 3>, 3>& block) {
  Matrix3d m;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) m(row, column) = block[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  return m;
}

Vector3d vector_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

Vector3d axes_of(const AxisVector& v, int first_axis) { return Eigen::Map<const Vector3d>(v.data() + first_axis); }

bool is_singular(const Matrix3d& m) { return !(std::abs(m.determinant()) > 1e-12 * std::pow(m.norm(), 3)); }

}  // namespace

Transform::Transform() { diag_.fill(1); }

Transform Transform::read(const ElementStore& e, int number) {
  Transform t;
  const auto n = static_cast<unsigned>(number);
  for (unsigned axis = 0; axis < bytecode::kAxisCount; ++axis) {
    t.diag_[axis] = e.get(ElementId::kTdataDiag, n, axis);
    t.bias_[axis] = e.get(ElementId::kTdataBias, n, axis);
  }
  constexpr std::array<ElementId, 4> kOff{ElementId::kTdataUVW, ElementId::kTdataXYZ, ElementId::kTdataUUVVWW, ElementId::kTdataXXYYZZ};
  for (std::size_t b = 0; b < kOff.size(); ++b)
    for (unsigned i = 0; i < 6; ++i) t.off_[b][i] = e.get(kOff[b], n, i);
  return t;
}

Transform::Block Transform::block(int first_axis) const {
  const auto b = static_cast<std::size_t>(std::find(kFirstAxes.begin(), kFirstAxes.end(), first_axis) - kFirstAxes.begin());
  const auto& o = off_[b];
  const auto* d = diag_.data() + first_axis;
  return {{{d[0], o[0], o[1]}, {o[2], d[1], o[3]}, {o[4], o[5], d[2]}}};
}

AxisVector Transform::velocity(const AxisVector& p) const {
  AxisVector base;
  for (std::size_t axis = 0; axis < base.size(); ++axis) base[axis] = diag_[axis] * p[axis];
  for (std::size_t b = 0; b < kFirstAxes.size(); ++b) {
    const auto f = static_cast<std::size_t>(kFirstAxes[b]);
    const auto& o = off_[b];
    base[f] += o[0] * p[f + 1] + o[1] * p[f + 2];
    base[f + 1] += o[2] * p[f] + o[3] * p[f + 2];
    base[f + 2] += o[4] * p[f] + o[5] * p[f + 1];
  }
  return base;
}

std::optional<AxisVector> Transform::to_program(const AxisVector& base_uu) const {
  AxisVector program;
  for (std::size_t axis = 0; axis < program.size(); ++axis) program[axis] = (base_uu[axis] - bias_[axis]) / diag_[axis];
  std::uint32_t in_blocks = 0;
  for (const int first : kFirstAxes) {
    const Matrix3d m = matrix_of(block(first));
    if (is_singular(m)) return std::nullopt;
    in_blocks |= 7u << first;
    if (m.isDiagonal(0)) continue;  // the quotients above are exact
    const Vector3d solution = m.fullPivLu().solve(axes_of(base_uu, first) - axes_of(bias_, first));
    for (int i = 0; i < 3; ++i) program[static_cast<std::size_t>(first + i)] = solution[i];
  }
  for (std::size_t axis = 0; axis < program.size(); ++axis)
    if (!(in_blocks >> axis & 1u) && diag_[axis] == 0) return std::nullopt;
  return program;
}

std::array<double, 3> Transform::direction(const std::array<double, 3>& v, int first_axis) const {
  const Vector3d image = matrix_of(block(first_axis)) * vector_of(v);
  return {image[0], image[1], image[2]};
}

AxisVector Transform::to_base(const AxisVector& program_uu) const {
  AxisVector base = velocity(program_uu);
  for (std::size_t axis = 0; axis < base.size(); ++axis) base[axis] += bias_[axis];
  return base;
}

std::uint32_t Transform::base_axes(std::uint32_t axes) const {
  std::uint32_t result = axes;
  for (std::size_t b = 0; b < kFirstAxes.size(); ++b) {
    constexpr std::array<std::array<int, 2>, 6> kPlace{{{0, 1}, {0, 2}, {1, 0}, {1, 2}, {2, 0}, {2, 1}}};  // row, column
    for (std::size_t i = 0; i < 6; ++i)
      if (off_[b][i] != 0 && axes >> (kFirstAxes[b] + kPlace[i][1]) & 1u) result |= 1u << (kFirstAxes[b] + kPlace[i][0]);
  }
  return result;
}

void Transform::shift(const AxisVector& base_uu) {
  for (std::size_t axis = 0; axis < bias_.size(); ++axis) bias_[axis] += base_uu[axis];
}

double Transform::determinant() const {
  double product = 1;
  std::uint32_t in_blocks = 0;
  for (const int first : kFirstAxes) {
    product *= matrix_of(block(first)).determinant();
    in_blocks |= 7u << first;
  }
  for (std::size_t axis = 0; axis < diag_.size(); ++axis)
    if (!(in_blocks >> axis & 1u)) product *= diag_[axis];
  return product;
}

Transform::PlaneImage Transform::plane_image(const std::array<double, 3>& normal, int first_axis) const {
  const Matrix3d m = matrix_of(block(first_axis));
  const Vector3d n = vector_of(normal).normalized();
  const Vector3d u = n.unitOrthogonal(), v = n.cross(u);
  const Vector3d mu = m * u, mv = m * v;
  const double scale = mu.norm(), tolerance = kTolerance * std::max(scale, 1e-300);
  const bool in_plane = std::abs(mu.dot(n)) <= tolerance && std::abs(mv.dot(n)) <= tolerance;
  const bool similar = std::abs(mv.norm() - scale) <= tolerance && std::abs(mu.dot(mv)) <= tolerance * scale;
  const bool lift_stays = (m * n).cross(n).norm() <= kTolerance * std::max((m * n).norm(), 1e-300);
  return {in_plane && similar && lift_stays && scale > 0, scale, mu.cross(mv).dot(n) < 0};
}

namespace {

/// A block's way in both coordinates, with what its arc adds.
struct Ways {
  AxisVector base, program;
  std::uint32_t circle_axes = 0;
  double base_arc_uu = 0, program_arc_uu = 0;  // lift along the normal included
};

/// A length in both coordinates.
struct Lengths {
  double base = 0, program = 0;
  bool counts() const { return base > 0 && program > 0; }
  double ratio() const { return base / program; }
};

double longest(const AxisVector& way, std::uint32_t axes) {
  double result = 0;
  motion::for_each_axis(axes, [&](std::size_t axis) { result = std::max(result, std::abs(way[axis])); });
  return result;
}

AxisVector difference(const AxisVector& a, const AxisVector& b) {
  AxisVector result;
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

/// Target and axes in base coordinates; axes that the matrix does not move keep their value to the last bit.
void place(const Transform& transform, const AxisVector& base_start, MotionCommand& command) {
  const AxisVector base_end = transform.to_base(command.target_uu);
  command.axes = transform.base_axes(command.axes);
  for (std::size_t axis = 0; axis < base_end.size(); ++axis) {
    const bool differs = std::abs(base_end[axis] - base_start[axis]) > kTolerance * std::max(1.0, std::abs(base_start[axis]));
    if (differs) command.axes |= 1u << axis;
    command.target_uu[axis] = command.axes >> axis & 1u ? base_end[axis] : base_start[axis];
  }
  command.start_velocity_uu_ms = transform.velocity(command.start_velocity_uu_ms);
  command.end_velocity_uu_ms = transform.velocity(command.end_velocity_uu_ms);
}

std::optional<Fault> place_circle(const Transform& transform, const AxisVector& base_start, MotionCommand& command, Ways& ways) {
  const int first_axis = command.second_set ? motion::kAxisXX : motion::kAxisX;
  const Transform::PlaneImage image = transform.plane_image(command.normal, first_axis);
  if (!image.exact)
    return Fault{FaultKind::kBadTarget, command.source,
                 fmt::format("the matrix Tdata[{}] makes no circle of this circle: it scales the axes of the plane differently or tilts the plane",
                             command.transform)};
  command.center_uu = transform.direction(command.center_uu, first_axis);
  if (image.mirrored) command.clockwise = !command.clockwise;
  const auto made = motion::make_arc(command, base_start, command.target_uu, {});
  const auto* arc = std::get_if<motion::Arc>(&made);
  if (!arc || !arc->curve.is_arc) return std::nullopt;
  const Vector3d normal = vector_of(command.normal).normalized();
  ways.circle_axes = 7u << first_axis;
  ways.base_arc_uu = std::hypot(arc->length_uu, axes_of(ways.base, first_axis).dot(normal));
  ways.program_arc_uu = std::hypot(arc->length_uu / image.scale, axes_of(ways.program, first_axis).dot(normal));
  return std::nullopt;
}

/// The way over a set of program feed axes; an arc belongs to the first set.
Lengths feed_lengths(const Transform& transform, const Ways& ways, std::uint32_t axes, bool with_arc) {
  const std::uint32_t program = axes & ~ways.circle_axes, base = transform.base_axes(program) & ~ways.circle_axes;
  const Lengths lengths{motion::norm(ways.base, base), motion::norm(ways.program, program)};
  return with_arc ? Lengths{std::hypot(lengths.base, ways.base_arc_uu), std::hypot(lengths.program, ways.program_arc_uu)} : lengths;
}

/// F and AltFeedRate count in program coordinates.
void scale_feed_rates(const Transform& transform, const Ways& ways, std::uint32_t named, MotionCommand& command) {
  const std::uint32_t program_others = named & ~(command.feed_axes | command.feed_axes2 | ways.circle_axes);
  const std::uint32_t base_others = transform.base_axes(program_others) & ~ways.circle_axes;
  const Lengths feed = feed_lengths(transform, ways, command.feed_axes, true);
  const Lengths feed2 = feed_lengths(transform, ways, command.feed_axes2, false);
  const Lengths others{longest(ways.base, base_others), longest(ways.program, program_others)};
  command.feed_axes = feed.counts() ? transform.base_axes(command.feed_axes) : command.feed_axes & ~base_others;
  command.feed_axes2 = transform.base_axes(command.feed_axes2) & ~command.feed_axes;
  const Lengths& leading = feed.counts() ? feed : feed2.counts() ? feed2 : others;
  if (!command.inverse_time && leading.counts()) command.feed_uu *= leading.ratio();
  if (others.counts()) command.alt_feed_uu *= others.ratio();
}

}  // namespace

std::optional<Fault> transform_command(const Transform& transform, const AxisVector& program_start, const AxisVector& base_start,
                                       MotionCommand& command) {
  const std::uint32_t named = command.axes;
  Ways ways;
  ways.program = difference(command.target_uu, program_start);
  place(transform, base_start, command);
  ways.base = difference(command.target_uu, base_start);
  const bool circle = command.kind == motion::CommandKind::kCircle && (command.has_center || command.has_radius);
  if (circle)
    if (auto fault = place_circle(transform, base_start, command, ways)) return fault;
  scale_feed_rates(transform, ways, named, command);
  return std::nullopt;
}

bool ProgramFrame::is_plain() const {
  bool biased = false;   // all are looked at, side by side
  for (const double bias : position_bias_uu) biased |= bias != 0;
  return transform < 0 && !biased;
}

Transform ProgramFrame::map(const ElementStore& elements) const {
  Transform map = transform < 0 ? Transform{} : Transform::read(elements, transform);
  map.shift(position_bias_uu);
  return map;
}

std::optional<AxisVector> ProgramFrame::to_program(const ElementStore& elements, const AxisVector& machine_uu) const {
  return is_plain() ? machine_uu : map(elements).to_program(machine_uu);
}

std::optional<Fault> ProgramFrame::place(const ElementStore& elements, const AxisVector& program_start, const AxisVector& machine_start,
                                         MotionCommand& command) const {
  if (is_plain() || command.kind == motion::CommandKind::kDelay) return std::nullopt;
  return transform_command(map(elements), program_start, machine_start, command);
}

bool ProgramFrame::scales_circles(const ElementStore& elements, const MotionCommand& command) const {
  const int first_axis = command.second_set ? motion::kAxisXX : motion::kAxisX;
  return transform >= 0 && std::abs(map(elements).plane_image(command.normal, first_axis).scale - 1) > kTolerance;
}

void ProgramFrame::rename(const ElementStore& elements, const AxisVector& program_uu, std::uint32_t axes, const AxisVector& values) {
  AxisVector change{};
  motion::for_each_axis(axes, [&](std::size_t axis) { change[axis] = program_uu[axis] - values[axis]; });
  const AxisVector shift = map(elements).velocity(change);
  for (std::size_t axis = 0; axis < shift.size(); ++axis) position_bias_uu[axis] += shift[axis];
}

}  // namespace pmac::runtime
