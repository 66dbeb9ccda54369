// Five-axis machines with tool-centre-point: X Y Z is the tip of the tool in the coordinates of the work, wherever the rotary axes
// stand. Three linear slides carry what turns: a head (Rt turns the tool), a table (Rw turns the work), or one axis each.
//
//      o pivot of the head                q = Rw (P - centre) + centre + Rt (0,0,tool) - (0,0,tool)
//      | tool_mm                          P = Rw^-1 (q + (0,0,tool) - Rt (0,0,tool) - centre) + centre
//      v tip = P
//
// A, B and C count as the tool turns against the work, so that a table turns the other way round (ISO 841: A', C'). At 0 all three
// machines have q = P. Source: R.-S. Lee, C.-H. She, Developing a postprocessor for three types of five-axis machine tools, 1997.
// Settings: tool_mm 150 (head: pivot to tip), table_x_mm 0, table_y_mm 0 (axis of the table's C),
// tilt_y_mm 0, tilt_z_mm -50 (axis of the trunnion's A).
#include "kinematics/stock/geometry.h"
#include "kinematics/stock/makers.h"

namespace pmac::kinematics::stock {
namespace {

/// What turns, by the two rotary angles: first is A or B, second is C.
enum class Kind { kHead, kTable, kHeadTable };

class FiveAxis : public Robot {
 public:
  FiveAxis(Kind kind, RobotSettings& s) : kind_(kind) {
    if (kind != Kind::kTable) tool_mm_.z() = s.number("tool_mm", 150);
    if (kind != Kind::kHead) table_mm_ = {s.number("table_x_mm", 0), s.number("table_y_mm", 0), 0};
    if (kind == Kind::kTable) tilt_mm_ = {0, s.number("tilt_y_mm", 0), s.number("tilt_z_mm", -50)};
  }
  int joint_count() const override { return 5; }
  std::uint32_t axes() const override { return 7u << axis::kX | axis::bit(first_axis()) | axis::bit(axis::kC); }

  std::string forward(std::span<const double> joint, AxisVector& axis_uu) const override {
    const double first_deg = joint[3], c_deg = joint[4];
    const Eigen::Vector3d tip = Eigen::Vector3d(joint[0], joint[1], joint[2]) + tool_mm_ - tool_turn(first_deg, c_deg) * tool_mm_;
    const Eigen::Vector3d p = work_turn(c_deg).transpose() * (tilt_turn(first_deg).transpose() * (tip - tilt_mm_) + tilt_mm_ - table_mm_) + table_mm_;
    for (int i = 0; i < 3; ++i) axis_uu[static_cast<std::size_t>(axis::kX + i)] = p(i);
    axis_uu[static_cast<std::size_t>(first_axis())] = first_deg;
    axis_uu[axis::kC] = c_deg;
    return {};
  }
  std::string inverse(const AxisVector& axis_uu, std::span<const double>, std::span<double> joint) const override {
    const double first_deg = axis_uu[static_cast<std::size_t>(first_axis())], c_deg = axis_uu[axis::kC];
    const Eigen::Vector3d p(axis_uu[axis::kX], axis_uu[axis::kY], axis_uu[axis::kZ]);
    const Eigen::Vector3d tip = tilt_turn(first_deg) * (work_turn(c_deg) * (p - table_mm_) + table_mm_ - tilt_mm_) + tilt_mm_;
    const Eigen::Vector3d slide = tip + tool_turn(first_deg, c_deg) * tool_mm_ - tool_mm_;
    for (int i = 0; i < 3; ++i) joint[static_cast<std::size_t>(i)] = slide(i);
    joint[3] = first_deg;
    joint[4] = c_deg;
    return {};
  }

 private:
  int first_axis() const { return kind_ == Kind::kTable ? axis::kA : axis::kB; }
  Eigen::Matrix3d tool_turn(double first_deg, double c_deg) const {
    if (kind_ == Kind::kHead) return turn_z(c_deg) * turn_y(first_deg);
    return kind_ == Kind::kHeadTable ? turn_y(first_deg) : Eigen::Matrix3d::Identity();
  }
  Eigen::Matrix3d work_turn(double c_deg) const { return kind_ == Kind::kHead ? Eigen::Matrix3d::Identity() : turn_z(-c_deg); }
  Eigen::Matrix3d tilt_turn(double first_deg) const { return kind_ == Kind::kTable ? turn_x(-first_deg) : Eigen::Matrix3d::Identity(); }

  Kind kind_;
  Eigen::Vector3d tool_mm_ = Eigen::Vector3d::Zero(), table_mm_ = Eigen::Vector3d::Zero(), tilt_mm_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::unique_ptr<Robot> make_five_axis_head(RobotSettings& settings) { return std::make_unique<FiveAxis>(Kind::kHead, settings); }
std::unique_ptr<Robot> make_five_axis_table(RobotSettings& settings) { return std::make_unique<FiveAxis>(Kind::kTable, settings); }
std::unique_ptr<Robot> make_five_axis_head_table(RobotSettings& settings) { return std::make_unique<FiveAxis>(Kind::kHeadTable, settings); }

}  // namespace pmac::kinematics::stock
