// Source of the mathematics: Eigen's LU decompositions (partial pivoting for determinants, full pivoting for solutions).
#include "runtime/interpreter/matrix.h"

#include <limits>

#include <Eigen/Core>
#include <Eigen/LU>

namespace pmac::runtime {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MatrixView = Eigen::Map<const Matrix>;

MatrixView view(std::span<const double> values, std::size_t rows, std::size_t columns) {
  return {values.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns)};
}

std::vector<double> values_of(const Matrix& matrix) { return {matrix.data(), matrix.data() + matrix.size()}; }

}  // namespace

double determinant(std::span<const double> a, std::size_t n) {
  return n == 0 ? 1.0 : Matrix(view(a, n, n)).determinant() + 0.0;  // no -0
}

double minor_determinant(std::span<const double> a, std::size_t n, std::size_t row, std::size_t column) {
  std::vector<double> rest;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k)
      if (i != row && k != column) rest.push_back(a[i * n + k]);
  return determinant(rest, n - 1);
}

std::vector<double> product(std::span<const double> a, std::span<const double> b, std::size_t rows, std::size_t inner, std::size_t columns) {
  return values_of(view(a, rows, inner) * view(b, inner, columns));
}

std::vector<double> transposed(std::span<const double> a, std::size_t rows, std::size_t columns) {
  return values_of(view(a, rows, columns).transpose());
}

std::vector<double> solution(std::span<const double> a, std::span<const double> b, std::size_t n, std::size_t columns) {
  const Eigen::FullPivLU<Matrix> lu(view(a, n, n));
  if (!lu.isInvertible()) return std::vector<double>(n * columns, std::numeric_limits<double>::quiet_NaN());
  return values_of(lu.solve(view(b, n, columns)));
}

std::vector<double> identity(std::size_t n) {
  std::vector<double> one(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) one[i * (n + 1)] = 1.0;
  return one;
}

}  // namespace pmac::runtime
