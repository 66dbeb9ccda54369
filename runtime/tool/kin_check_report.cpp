// What --kin-check has found, as text and as JSON.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/tool/kin_check.h"

namespace pmac::tool {
namespace {

using nlohmann::json;

std::string pose_text(const std::vector<AxisRange>& ranges, const std::vector<double>& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) text += fmt::format("{}{}{:.6g}", i ? " " : "", bytecode::axis_name(ranges[i].axis), values[i]);
  return text;
}

std::string box_text(const std::vector<AxisRange>& box) {
  std::string text;
  for (const AxisRange& side : box) text += fmt::format("{}{} {:.4g}:{:.4g}", text.empty() ? "" : ", ", bytecode::axis_name(side.axis), side.low_uu, side.high_uu);
  return text;
}

json pose_json(const std::vector<AxisRange>& ranges, const std::vector<double>& values) {
  json pose = json::object();
  for (std::size_t i = 0; i < values.size(); ++i) pose[std::string(bytecode::axis_name(ranges[i].axis))] = values[i];
  return pose;
}

json box_json(const std::vector<AxisRange>& box) {
  json object = json::object();
  for (const AxisRange& side : box) object[std::string(bytecode::axis_name(side.axis))] = {side.low_uu, side.high_uu};
  return object;
}

/// JSON has no infinity.
json finite(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json result_json(const KinCheckResult& r) {
  json out_of_reach = json::array();
  for (const OutOfReach& group : r.out_of_reach)
    out_of_reach.push_back({{"reason", group.reason}, {"count", group.count}, {"box", box_json(group.box)}, {"first", pose_json(r.ranges, group.first_uu)}});
  json error = {{"tolerance", r.tolerance_uu}, {"worst", nullptr}};
  if (r.worst_axis >= 0)
    error.update({{"worst", finite(r.worst_error_uu)}, {"axis", std::string(bytecode::axis_name(r.worst_axis))}, {"pose", pose_json(r.ranges, r.worst_uu)}});
  return {{"coord", r.coord},
          {"status", r.ok() ? "ok" : "fault"},
          {"samples", r.samples},
          {"seed", r.seed},
          {"sampled", r.by_motors ? "motors" : "axes"},
          {"ranges", box_json(r.ranges)},
          {"solved", r.solved},
          {"out_of_reach", out_of_reach},
          {"error", error},
          {"singular", {{"limit", r.condition_limit}, {"count", r.singular}, {"at_edge", r.at_edge},
                        {"worst", finite(r.worst_condition)}, {"pose", pose_json(r.ranges, r.worst_condition_uu)}}}};
}

}  // namespace

std::string kin_check_text(const KinCheckResult& r) {
  std::string text = fmt::format("coordinate system {}: {} poses, seed {}, {}{}\n", r.coord, r.samples, r.seed,
                                 r.by_motors ? "motors within MinPos and MaxPos, " : "", box_text(r.ranges));
  text += fmt::format("  solved {}, out of reach {}\n", r.solved, r.samples - r.solved);
  for (const OutOfReach& group : r.out_of_reach) {
    text += fmt::format("    {} poses: {}\n", group.count, group.reason);
    if (!group.first_uu.empty()) text += fmt::format("      within {}; first {}\n", box_text(group.box), pose_text(r.ranges, group.first_uu));
  }
  if (r.worst_axis < 0) return text + "  nothing is in reach: FAULT\n";
  text += fmt::format("  forward(inverse) off by at most {:.3g} in {} at {} (tolerance {:g}): {}\n", r.worst_error_uu, bytecode::axis_name(r.worst_axis),
                      pose_text(r.ranges, r.worst_uu), r.tolerance_uu, r.ok() ? "ok" : "FAULT");
  if (r.worst_condition > 0)
    text += fmt::format("  singular: {} poses with a condition number above {:g}; worst {:.3g} at {}\n", r.singular, r.condition_limit,
                        r.worst_condition, pose_text(r.ranges, r.worst_condition_uu));
  if (r.at_edge > 0) text += fmt::format("  {} poses at the edge of the reach, without a condition number\n", r.at_edge);
  return text;
}

std::string kin_check_json(const std::vector<KinCheckResult>& results) {
  json list = json::array();
  for (const KinCheckResult& result : results) list.push_back(result_json(result));
  return json{{"kin_check", list}}.dump(2) + "\n";
}

}  // namespace pmac::tool
