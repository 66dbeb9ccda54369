// Vectors and matrices of script functions, as plain numbers: matrices row by row, sizes checked by the caller.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace pmac::runtime {

double determinant(std::span<const double> a, std::size_t n);
/// Determinant of a without one row and column, counted from 0; 1 for n = 1.
double minor_determinant(std::span<const double> a, std::size_t n, std::size_t row, std::size_t column);
/// a b: a has rows x inner elements, b inner x columns.
std::vector<double> product(std::span<const double> a, std::span<const double> b, std::size_t rows, std::size_t inner, std::size_t columns);
std::vector<double> transposed(std::span<const double> a, std::size_t rows, std::size_t columns);
/// x of a x = b, where b has n rows and `columns` columns; all nan where a is singular. The inverse is the solution for b = 1.
std::vector<double> solution(std::span<const double> a, std::span<const double> b, std::size_t n, std::size_t columns);
std::vector<double> identity(std::size_t n);

}  // namespace pmac::runtime
