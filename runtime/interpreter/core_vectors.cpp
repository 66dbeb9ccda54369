// Functions of vectors and matrices. Everything is read before anything is written, so that source and destination may be the
// same. Argument orders: rows of function.def.
#include <cmath>

#include <fmt/format.h>

#include "compiler/bytecode/function.h"
#include "runtime/interpreter/core.h"
#include "runtime/interpreter/matrix.h"

namespace pmac::runtime {
namespace {

using bytecode::Function;

constexpr double kMostElements = 65536;   // of one vector or matrix

}  // namespace

/// A whole number of elements, rows or columns.
bool InterpreterCore::count_argument(double value, std::int64_t& count) {
  if (!(value > -1.0 && value <= kMostElements)) return refuse_memory(fmt::format("{} is no number of elements, rows or columns", number_text(value)));
  count = static_cast<std::int64_t>(value);
  return true;
}

bool InterpreterCore::step_argument(double value, std::int64_t& step) {
  if (!(std::abs(value) <= kMostElements)) return refuse_memory(fmt::format("{} is no step from element to element", number_text(value)));
  step = static_cast<std::int64_t>(value);
  return true;
}

/// The matrix at a, rows x columns of it; faults where it is larger than any array.
bool InterpreterCore::read_matrix(double address, std::int64_t rows, std::int64_t columns, std::vector<double>& values) {
  if (static_cast<double>(rows) * static_cast<double>(columns) > kMostElements)
    return refuse_memory(fmt::format("a matrix of {} x {} elements is larger than any array", rows, columns));
  return read_values(address, rows * columns, 1, values);
}

/// Functions of vectors; x: their arguments. work: elements touched.
bool InterpreterCore::vector_function(Function function, const double* x, double& result, std::int64_t& work) {
  std::vector<double> a, b, c;
  std::int64_t n = 0, step_a = 1, step_b = 1, step_c = 1, step_to = 1;
  switch (function) {
    case Function::kSincos:
    case Function::kSincosd: {
      const bool degrees = function == Function::kSincosd;
      const double pair[] = {apply_function(degrees ? Function::kSind : Function::kSin, {x, 1}, host_), apply_function(degrees ? Function::kCosd : Function::kCos, {x, 1}, host_)};
      result = pair[0];
      return write_values(x[1], 1, pair);
    }
    case Function::kSum:
      if (!count_argument(x[1], n) || !step_argument(x[2], step_a) || !read_values(x[0], n, step_a, a)) return false;
      result = 0;
      for (const double value : a) result += value;
      break;
    case Function::kSumprod:
      if (!count_argument(x[2], n) || !step_argument(x[3], step_a) || !step_argument(x[4], step_b)) return false;
      if (!read_values(x[0], n, step_a, a) || !read_values(x[1], n, step_b, b)) return false;
      result = 0;
      for (std::size_t i = 0; i < a.size(); ++i) result += a[i] * b[i];
      break;
    case Function::kVcopy:
      if (!count_argument(x[2], n) || !step_argument(x[3], step_to) || !step_argument(x[4], step_a)) return false;
      if (!read_values(x[1], n, step_a, a) || !write_values(x[0], step_to, a)) return false;
      result = static_cast<double>(n);
      break;
    case Function::kVscale:
      if (!count_argument(x[3], n) || !step_argument(x[4], step_to) || !step_argument(x[5], step_a) || !read_values(x[1], n, step_a, a)) return false;
      for (double& value : a) value *= x[2];
      if (!write_values(x[0], step_to, a)) return false;
      result = static_cast<double>(n);
      break;
    default:  // vmadd
      if (!count_argument(x[4], n) || !step_argument(x[5], step_to) || !step_argument(x[6], step_a) || !step_argument(x[7], step_b) || !step_argument(x[8], step_c)) return false;
      if (!read_values(x[1], n, step_a, a) || !read_values(x[2], n, step_b, b) || !read_values(x[3], n, step_c, c)) return false;
      for (std::size_t i = 0; i < a.size(); ++i) a[i] = a[i] * b[i] + c[i];
      if (!write_values(x[0], step_to, a)) return false;
      result = static_cast<double>(n);
      break;
  }
  work = n;
  return true;
}

bool InterpreterCore::matrix_function(Function function, const double* x, double& result, std::int64_t& work) {
  std::vector<double> a, b, c;
  std::int64_t rows = 0, inner = 0, columns = 1;
  const auto size = [](std::int64_t n) { return static_cast<std::size_t>(n); };
  const auto cube = [](std::int64_t n) { return n * n * n; };
  const auto keep = [&](double address, const std::vector<double>& values) { return write_values(address, 1, values); };
  switch (function) {
    case Function::kMdet:
      if (!count_argument(x[1], rows) || !read_matrix(x[0], rows, rows, a)) return false;
      result = determinant(a, size(rows));
      work = cube(rows);
      break;
    case Function::kMinv:
      if (!count_argument(x[2], rows) || !read_matrix(x[1], rows, rows, a)) return false;
      result = determinant(a, size(rows));
      if (!keep(x[0], solution(a, identity(size(rows)), size(rows), size(rows)))) return false;
      work = 2 * cube(rows);
      break;
    case Function::kMminor: {
      std::int64_t row = 0, column = 0;
      if (!count_argument(x[1], rows) || !count_argument(x[2], row) || !count_argument(x[3], column) || !read_matrix(x[0], rows, rows, a)) return false;
      if (row >= rows || column >= rows) return refuse_memory(fmt::format("row {} or column {} is not in a matrix of {} x {}", row, column, rows, rows));
      result = minor_determinant(a, size(rows), size(row), size(column));
      work = cube(rows);
      break;
    }
    case Function::kMsolve:
      if (!count_argument(x[3], rows) || !count_argument(x[4], columns)) return false;
      if (!read_matrix(x[1], rows, rows, a) || !read_matrix(x[2], rows, columns, b)) return false;
      result = determinant(a, size(rows));
      if (!keep(x[0], solution(a, b, size(rows), size(columns)))) return false;
      work = cube(rows) + rows * rows * columns;
      break;
    case Function::kMtrans:
      if (!count_argument(x[2], rows) || !count_argument(x[3], columns) || !read_matrix(x[1], rows, columns, a)) return false;
      if (!keep(x[0], transposed(a, size(rows), size(columns)))) return false;
      result = static_cast<double>(rows * columns);
      work = rows * columns;
      break;
    default: {  // mmul, mmadd
      const bool adds = function == Function::kMmadd;
      const double* sizes = x + (adds ? 4 : 3);
      if (!count_argument(sizes[0], rows) || !count_argument(sizes[1], inner) || !count_argument(sizes[2], columns)) return false;
      if (!read_matrix(x[1], rows, inner, a) || !read_matrix(x[2], inner, columns, b)) return false;
      if (!read_matrix(adds ? x[3] : x[0], rows, columns, c)) return false;  // also checks that the product fits its place
      std::vector<double> sum = product(a, b, size(rows), size(inner), size(columns));
      for (std::size_t i = 0; adds && i < sum.size(); ++i) sum[i] += c[i];
      if (!keep(x[0], sum)) return false;
      result = static_cast<double>(rows * columns);
      work = rows * inner * columns;
      break;
    }
  }
  return true;
}

}  // namespace pmac::runtime
