// Functions of transformations, on the elements of Tdata[]: four blocks of three axes have a full 3 x 3 matrix, every other axis
// has a factor, so that products and inverses are taken block by block. Source: Software Reference Manual p61.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Core>
#include <Eigen/LU>
#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "compiler/bytecode/function.h"
#include "runtime/interpreter/core.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;
using bytecode::Function;
using Block = Eigen::Matrix3d;

/// The four blocks: their first axis and the element of their off-diagonal (12 13 21 23 31 32).
struct BlockRow { int first_axis; ElementId off_diagonal; };
constexpr std::array<BlockRow, 4> kBlocks = {{{3, ElementId::kTdataUVW}, {6, ElementId::kTdataXYZ}, {26, ElementId::kTdataUUVVWW}, {29, ElementId::kTdataXXYYZZ}}};

bool is_in_block(int axis) {
  return std::any_of(kBlocks.begin(), kBlocks.end(), [axis](const BlockRow& row) { return axis >= row.first_axis && axis < row.first_axis + 3; });
}

/// base = M * program + bias. diag counts for the axes outside of blocks.
struct Transformation {
  std::array<double, bytecode::kAxisCount> diag{}, bias{};
  std::array<Block, kBlocks.size()> blocks;

  static Transformation identity() {
    Transformation t;
    t.diag.fill(1);
    for (Block& block : t.blocks) block.setIdentity();
    return t;
  }

  double determinant() const {
    double product = 1;
    for (int axis = 0; axis < bytecode::kAxisCount; ++axis)
      if (!is_in_block(axis)) product *= diag[static_cast<std::size_t>(axis)];
    for (const Block& block : blocks) product *= block.determinant();
    return product;
  }

  /// M * vector.
  std::array<double, bytecode::kAxisCount> linear(const std::array<double, bytecode::kAxisCount>& vector) const {
    std::array<double, bytecode::kAxisCount> result{};
    for (std::size_t axis = 0; axis < result.size(); ++axis) result[axis] = diag[axis] * vector[axis];
    for (std::size_t b = 0; b < kBlocks.size(); ++b) {
      const auto first = static_cast<std::size_t>(kBlocks[b].first_axis);
      const Eigen::Vector3d image = blocks[b] * Eigen::Vector3d(vector[first], vector[first + 1], vector[first + 2]);
      for (std::size_t i = 0; i < 3; ++i) result[first + i] = image[static_cast<Eigen::Index>(i)];
    }
    return result;
  }

  /// This transformation after another one.
  Transformation after(const Transformation& inner) const {
    Transformation t;
    t.bias = linear(inner.bias);
    for (std::size_t axis = 0; axis < t.bias.size(); ++axis) {
      t.bias[axis] += bias[axis];
      t.diag[axis] = diag[axis] * inner.diag[axis];
    }
    for (std::size_t b = 0; b < blocks.size(); ++b) t.blocks[b] = blocks[b] * inner.blocks[b];
    return t;
  }

  std::optional<Transformation> inverse() const {
    if (!std::isfinite(1 / determinant())) return std::nullopt;
    Transformation t;
    for (std::size_t axis = 0; axis < diag.size(); ++axis) t.diag[axis] = 1 / diag[axis];
    for (std::size_t b = 0; b < blocks.size(); ++b) t.blocks[b] = blocks[b].inverse();
    t.bias = t.linear(bias);
    for (double& value : t.bias) value = 0.0 - value;
    return t;
  }
};

constexpr int kRows[] = {0, 0, 1, 1, 2, 2}, kColumns[] = {1, 2, 0, 2, 0, 1};  // of the off-diagonal elements

Transformation read(Host& host, Thread& thread, std::uint32_t number) {
  const auto element = [&](ElementId id, int i) { return host.read_element(thread, {id, {number, static_cast<std::uint32_t>(i), 0}}); };
  Transformation t;
  for (int axis = 0; axis < bytecode::kAxisCount; ++axis) {
    t.diag[static_cast<std::size_t>(axis)] = element(ElementId::kTdataDiag, axis);
    t.bias[static_cast<std::size_t>(axis)] = element(ElementId::kTdataBias, axis);
  }
  for (std::size_t b = 0; b < kBlocks.size(); ++b) {
    for (int i = 0; i < 3; ++i) t.blocks[b](i, i) = t.diag[static_cast<std::size_t>(kBlocks[b].first_axis + i)];
    for (int i = 0; i < 6; ++i) t.blocks[b](kRows[i], kColumns[i]) = element(kBlocks[b].off_diagonal, i);
  }
  return t;
}

void write(Host& host, Thread& thread, std::uint32_t number, const Transformation& t) {
  const auto set = [&](ElementId id, int i, double value) { (void)host.write_element(thread, {id, {number, static_cast<std::uint32_t>(i), 0}}, value); };
  for (int axis = 0; axis < bytecode::kAxisCount; ++axis) {
    set(ElementId::kTdataDiag, axis, t.diag[static_cast<std::size_t>(axis)]);
    set(ElementId::kTdataBias, axis, t.bias[static_cast<std::size_t>(axis)]);
  }
  for (std::size_t b = 0; b < kBlocks.size(); ++b) {
    for (int i = 0; i < 3; ++i) set(ElementId::kTdataDiag, kBlocks[b].first_axis + i, t.blocks[b](i, i));
    for (int i = 0; i < 6; ++i) set(kBlocks[b].off_diagonal, i, t.blocks[b](kRows[i], kColumns[i]));
  }
}

}  // namespace

bool InterpreterCore::transform_function(Function function, const double* x, double& result) {
  const int count = bytecode::function_info(function).argument_count;
  const int limit = bytecode::element_info(ElementId::kTdataBias).index_counts[0];
  std::array<std::uint32_t, 3> number{};
  for (int i = 0; i < count; ++i) {
    if (!(x[i] > -1.0 && x[i] < limit)) return refuse_memory(fmt::format("there is no Tdata[{}]; the numbers are 0 to {}", x[i], limit - 1));
    number[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(x[i]);
  }
  std::optional<Transformation> made;
  switch (function) {
    case Function::kTdet: result = read(host_, thread_, number[0]).determinant(); break;
    case Function::kTinv: {
      const Transformation of = read(host_, thread_, number[1]);
      made = of.inverse();
      result = made ? of.determinant() : 0.0;
      break;
    }
    case Function::kTprop:
      made = read(host_, thread_, number[1]).after(read(host_, thread_, number[2]));
      result = made->determinant();
      break;
    default:  // tinit
      made = Transformation::identity();
      result = 1;
      break;
  }
  if (made) write(host_, thread_, number[0], *made);
  return !host_failed();
}

}  // namespace pmac::runtime
