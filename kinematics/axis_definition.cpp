// Linear axis definitions: a matrix from axes to motors, and its inverse for the start position of a program. Singular and
// incomplete definitions are refused with the reason; gantries are allowed.
#include <algorithm>
#include <string_view>

#include <Eigen/Dense>

#include "kinematics/kinematics.h"

namespace pmac::kinematics {
namespace {

using Kind = MotorDefinition::Kind;

bool same_combination(const MotorDefinition& a, const MotorDefinition& b) {
  return a.coefficient_mu_uu == b.coefficient_mu_uu;
}

std::uint32_t named_axes(const std::vector<MotorDefinition>& definitions) {
  std::uint32_t mask = 0;
  for (const MotorDefinition& d : definitions) {
    if (d.kind != Kind::kLinear) continue;
    for (int axis = 0; axis < kAxisCount; ++axis)
      if (d.coefficient_mu_uu[axis] != 0) mask |= 1u << axis;
  }
  return mask;
}

/// Definitions that decide the axes: linear ones, without followers of a gantry.
std::vector<int> deciding_rows(const std::vector<MotorDefinition>& definitions) {
  std::vector<int> rows;
  for (int i = 0; i < static_cast<int>(definitions.size()); ++i) {
    if (definitions[i].kind != Kind::kLinear) continue;
    bool follows = false;
    for (int row : rows) follows = follows || same_combination(definitions[row], definitions[i]);
    if (!follows) rows.push_back(i);
  }
  return rows;
}

/// A B C U V W X Y Z, then AA BB ...
std::string axis_letters(int axis) {
  constexpr std::string_view single = "ABCUVWXYZ", twice = "ABCDEFGHLMNOPQRSTUVWXYZ";
  if (axis < static_cast<int>(single.size())) return std::string(1, single[static_cast<std::size_t>(axis)]);
  return std::string(2, twice[static_cast<std::size_t>(axis) - single.size()]);
}

std::string listed(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : " ") + item;
  return text;
}

/// Motors whose rows depend on one another: those that a vector of the left null space weighs.
std::vector<std::string> dependent_motors(const Eigen::MatrixXd& matrix, const std::vector<int>& rows, const std::vector<MotorDefinition>& definitions) {
  const Eigen::MatrixXd weights = matrix.transpose().fullPivLu().kernel();
  std::vector<std::string> motors;
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (weights.row(static_cast<Eigen::Index>(r)).cwiseAbs().maxCoeff() > 1e-9)
      motors.push_back(std::to_string(definitions[static_cast<std::size_t>(rows[r])].motor));
  return motors;
}

}  // namespace

AxisMap::AxisMap(std::vector<MotorDefinition> definitions) : definitions_(std::move(definitions)) { solve(); }

bool AxisMap::has_inverse_motors() const {
  for (const MotorDefinition& d : definitions_)
    if (d.kind == Kind::kInverse) return true;
  return false;
}

void AxisMap::solve() {
  linear_axes_ = named_axes(definitions_);
  rows_ = deciding_rows(definitions_);
  for (int axis = 0; axis < kAxisCount; ++axis)
    if (linear_axes_ >> axis & 1u) axes_.push_back(axis);
  if (axes_.empty()) return;
  solvable_ = false;
  if (rows_.size() < axes_.size()) {
    std::vector<std::string> names;
    for (const int axis : axes_) names.push_back(axis_letters(axis));
    reason_ = "fewer independent motors (" + std::to_string(rows_.size()) + ") than axes (" + listed(names) + ")";
    return;
  }
  Eigen::MatrixXd matrix(rows_.size(), axes_.size());
  for (std::size_t r = 0; r < rows_.size(); ++r)
    for (std::size_t c = 0; c < axes_.size(); ++c) matrix(r, c) = definitions_[rows_[r]].coefficient_mu_uu[axes_[c]];
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  if (qr.rank() < static_cast<Eigen::Index>(axes_.size())) {
    reason_ = "the axis definitions are singular: those of motors " + listed(dependent_motors(matrix, rows_, definitions_)) + " depend on one another";
    return;
  }
  const Eigen::MatrixXd inverse = qr.solve(Eigen::MatrixXd::Identity(rows_.size(), rows_.size()));
  inverse_uu_mu_.assign(axes_.size() * rows_.size(), 0.0);
  for (std::size_t c = 0; c < axes_.size(); ++c)
    for (std::size_t r = 0; r < rows_.size(); ++r) inverse_uu_mu_[c * rows_.size() + r] = inverse(c, r);
  solvable_ = true;
}

void AxisMap::motors_from_axes(const AxisVector& axis_uu, std::span<double> motor_mu) const {
  for (std::size_t i = 0; i < definitions_.size(); ++i) {
    const MotorDefinition& d = definitions_[i];
    if (d.kind != Kind::kLinear) continue;
    double sum = d.offset_mu;
    for (int axis : axes_) sum += d.coefficient_mu_uu[axis] * axis_uu[axis];
    motor_mu[i] = sum;
  }
}

void AxisMap::motor_rates_from_axis_rates(const AxisVector& axis_rate, std::span<double> motor_rate) const {
  for (std::size_t i = 0; i < definitions_.size(); ++i) {
    if (definitions_[i].kind != Kind::kLinear) continue;
    motor_rate[i] = 0;
    for (int axis : axes_) motor_rate[i] += definitions_[i].coefficient_mu_uu[axis] * axis_rate[axis];
  }
}

void AxisMap::axes_from_motors(std::span<const double> motor_mu, AxisVector& axis_uu) const {
  if (!solvable_) return;
  for (std::size_t c = 0; c < axes_.size(); ++c) {
    double sum = 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) sum += inverse_uu_mu_[c * rows_.size() + r] * (motor_mu[rows_[r]] - definitions_[rows_[r]].offset_mu);
    axis_uu[axes_[c]] = sum;
  }
}

bool AxisMap::axis_row_from_motor_rows(int axis, std::span<const double* const> motor_mu, std::span<double> axis_uu) const {
  const auto column = static_cast<std::size_t>(std::find(axes_.begin(), axes_.end(), axis) - axes_.begin());
  if (!solvable_ || column == axes_.size()) return false;
  std::fill(axis_uu.begin(), axis_uu.end(), 0.0);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const double factor = inverse_uu_mu_[column * rows_.size() + r], offset_mu = definitions_[rows_[r]].offset_mu;
    const double* row = motor_mu[rows_[r]];
    for (std::size_t k = 0; k < axis_uu.size(); ++k) axis_uu[k] += factor * (row[k] - offset_mu);
  }
  return true;
}

void AxisMap::axis_rates_from_motor_rates(std::span<const double> motor_rate, AxisVector& axis_rate) const {
  if (!solvable_) return;
  for (std::size_t c = 0; c < axes_.size(); ++c) {
    double sum = 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) sum += inverse_uu_mu_[c * rows_.size() + r] * motor_rate[rows_[r]];
    axis_rate[axes_[c]] = sum;
  }
}

}  // namespace pmac::kinematics
