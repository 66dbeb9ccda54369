// Axis transformations (tsel): base = matrix * program + bias, where three 3x3 blocks and the UU VV WW block couple axes and the
// others are scaled one by one. Source: Tdata[], Software Reference Manual; the direction (program to base) is that of published
// programs.
//
//   | Xb |   | Diag[6] XYZ[0]  XYZ[1] |   | X |   | Bias[6] |
//   | Yb | = | XYZ[2]  Diag[7] XYZ[3] | * | Y | + | Bias[7] |
//   | Zb |   | XYZ[4]  XYZ[5]  Diag[8]|   | Z |   | Bias[8] |
#pragma once

#include <array>
#include <optional>

#include "runtime/element_store.h"
#include "runtime/motion/types.h"

namespace pmac::runtime {

using motion::AxisVector;

inline constexpr int kTransformCount = 256;

class Transform {
 public:
  Transform();  // identity
  /// Tdata[number] as it is now.
  static Transform read(const ElementStore& elements, int number);

  AxisVector to_base(const AxisVector& program_uu) const;
  /// nullopt where the matrix is singular.
  std::optional<AxisVector> to_program(const AxisVector& base_uu) const;
  /// The linear part alone, of a vector of the three axes from first_axis on (X or XX).
  std::array<double, 3> direction(const std::array<double, 3>& program_uu, int first_axis) const;
  /// The linear part of all axes.
  AxisVector velocity(const AxisVector& program) const;
  /// Base axes that depend on any of the program axes of `axes`.
  std::uint32_t base_axes(std::uint32_t axes) const;
  double determinant() const;
  /// Adds to the displacement.
  void shift(const AxisVector& base_uu);

  /// What the matrix does to the plane with this normal.
  struct PlaneImage {
    bool exact = false;      // circles in it become circles in it
    double scale = 1;        // of lengths in it
    bool mirrored = false;   // turns change their sense
  };
  PlaneImage plane_image(const std::array<double, 3>& normal, int first_axis) const;

 private:
  using Block = std::array<std::array<double, 3>, 3>;
  Block block(int first_axis) const;
  static constexpr std::array<int, 4> kFirstAxes{3, 6, 26, 29};  // U, X, UU, XX
  AxisVector diag_{}, bias_{};
  std::array<std::array<double, 6>, 4> off_{};  // by kFirstAxes
};

/// A command of program coordinates in base coordinates. program_start, base_start: where it begins in both.
///
/// The centre vector goes through the matrix, R does not, the normal stays; a mirrored plane turns the sense round. Feed rates
/// count in program coordinates: they are scaled by the ratio of the lengths, so that the block takes the time it would take
/// without transformation. Fault: a circle that would not be a circle any more.
std::optional<Fault> transform_command(const Transform& transform, const AxisVector& program_start, const AxisVector& base_start,
                                       motion::MotionCommand& command);

/// How the program's positions lie in those of the axis definitions: the selected matrix, then the position bias of pset.
///
///   machine = matrix * program + displacement + position bias
struct ProgramFrame {
  int transform = -1;                 // tsel; -1: none
  AxisVector position_bias_uu{};      // pset, pclr; bias_changed() after it
  bool is_biased = false;             // some of it is not 0
  AxisVector stored_bias_uu{};        // pstore, pload

  bool is_plain() const { return transform < 0 && !is_biased; }
  void bias_changed();
  Transform map(const ElementStore& elements) const;
  /// nullopt where the matrix is singular.
  std::optional<AxisVector> to_program(const ElementStore& elements, const AxisVector& machine_uu) const;
  /// A command of program coordinates in machine coordinates; see transform_command().
  std::optional<Fault> place(const ElementStore& elements, const AxisVector& program_start, const AxisVector& machine_start,
                             motion::MotionCommand& command) const;
  /// The matrix changes lengths in the plane of a circle command.
  bool scales_circles(const ElementStore& elements, const motion::MotionCommand& command) const;
  /// pset: the point that has the position program_uu gets `values` in `axes`.
  void rename(const ElementStore& elements, const AxisVector& program_uu, std::uint32_t axes, const AxisVector& values);
};

}  // namespace pmac::runtime
