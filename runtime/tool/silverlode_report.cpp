#include "runtime/tool/silverlode_report.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/drives/silverlode/units.h"

namespace pmac::tool {
namespace {

namespace sl = drives::silverlode;
using nlohmann::ordered_json;

ordered_json setup_json(const SilverlodeOptions& options) {
  const sl::CircleSetup& c = options.circle;
  ordered_json j{{"segments", c.segments}, {"radius", c.radius}, {"start_angle_deg", c.start_angle_deg}, {"offset", {c.offset_x, c.offset_y}},
                 {"distance_angle_deg", c.distance_angle_deg}, {"velocity", c.velocity}, {"scale", {c.scale_x, c.scale_y}}, {"min_slice_s", c.min_slice_s}};
  for (const sl::AxisLimits& limit : c.limits) {
    j["max_speed_rpm"].push_back(limit.max_speed_rpm);
    j["max_accel_rpm_s"].push_back(limit.max_accel_rpm_s);
  }
  if (c.knife_counts_deg) j["knife_counts_deg"] = *c.knife_counts_deg;
  return j;
}

ordered_json entries_json(const sl::Table& table) {
  ordered_json entries = ordered_json::array();
  for (const sl::Entry& entry : table.entries) {
    ordered_json j{{"ticks", entry.ticks}};
    for (std::size_t a = 0; a < table.axes.size(); ++a)
      j[table.axes[a]] = {{"pos", entry.axis[a].pos}, {"acc", entry.axis[a].acc}, {"vel", entry.axis[a].vel}};
    entries.push_back(std::move(j));
  }
  return entries;
}

ordered_json link_json(const sl::NetworkResult& link, const sl::Table& table) {
  ordered_json j{{"frames", link.frames.size()}, {"bytes", link.bytes}, {"start_s", link.start_s}, {"time_s", link.time_s},
                 {"full_queue_refusals", link.full_queue_refusals}, {"refusals", link.refusals}, {"unanswered", link.unanswered}, {"gave_up", link.gave_up}};
  for (std::size_t a = 0; a < table.axes.size(); ++a)
    j["axes"][table.axes[a]] = {{"start_ticks", link.start_ticks[a]}, {"executed", link.executed[a]}, {"left", link.left[a]}, {"underrun", static_cast<bool>(link.ran_dry[a])}};
  j["events"] = ordered_json::array();
  for (const sl::NetworkEvent& event : link.events) j["events"].push_back({{"time_s", event.time_s}, {"error", event.is_error}, {"text", event.text}});
  return j;
}

/// The dialog's list: number, time, then velocity and acceleration of every axis as sent.
std::string entry_list(const sl::Table& table) {
  std::string text = fmt::format("{:>8} {:>10}", "segment", "ticks");
  for (const std::string& axis : table.axes) text += fmt::format(" {:>12} {:>12} {:>12}", "pos " + axis, "acc " + axis, "vel " + axis);
  text += "\n";
  for (std::size_t i = 0; i < table.entries.size(); ++i) {
    const sl::Entry& entry = table.entries[i];
    text += fmt::format("{:>8} {:>10}", i + 1 == table.entries.size() ? "stop" : std::to_string(i + 1), entry.ticks);
    for (const sl::AxisMove& move : entry.axis) text += fmt::format(" {:>12} {:>12} {:>12}", move.pos, move.acc, move.vel);
    text += "\n";
  }
  return text;
}

}  // namespace

std::string circle_json(const CircleReport& r) {
  ordered_json j{{"builder", r.options.literal ? "literal" : "closed"}, {"axes", r.table.axes}, {"setup", setup_json(r.options)}};
  j["cells"] = {{"C32", r.sheet.circumference}, {"C33", r.sheet.arc}, {"C34", r.sheet.time_s}, {"C35", r.sheet.slice_s}, {"M2", r.sheet.rounded_slice_s}};
  j["start_counts"] = r.table.start_counts;
  j["end_counts"] = r.table.end_counts;
  j["time_s"] = r.figures.time_s;
  j["ticks"] = r.figures.ticks;
  const bool moved = r.figures.radial_min_counts <= r.figures.radial_max_counts;
  j["radial_error_counts"] = {{"min", moved ? r.figures.radial_min_counts : 0}, {"max", moved ? r.figures.radial_max_counts : 0}};
  j["closing_error_counts"] = r.figures.closing_counts;
  j["sagitta_counts"] = r.options.circle.radius * (1 - std::cos(std::abs(r.options.circle.distance_angle_deg) / static_cast<double>(r.options.circle.segments) / 2 * 3.141592653589793 / 180)) *
                        std::sqrt(std::abs(r.options.circle.scale_x * r.options.circle.scale_y));
  if (r.link) j["link"] = link_json(*r.link, r.table);
  j["entries"] = entries_json(r.table);
  return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string circle_text(const CircleReport& r) {
  std::string text = r.options.quiet ? std::string() : entry_list(r.table);
  text += fmt::format("{} builder: {} entries, {} ticks, {:.6f} s\n", r.options.literal ? "literal" : "closed", r.table.entries.size(), r.figures.ticks, r.figures.time_s);
  text += fmt::format("radial error {:.4f} .. {:.4f} counts, closing error {:.4f} counts\n", r.figures.radial_min_counts, r.figures.radial_max_counts, r.figures.closing_counts);
  if (r.link) text += fmt::format("link: {} frames, {} bytes, {} refused by a full queue, {} unanswered; {:.6f} s\n", r.link->frames.size(), r.link->bytes, r.link->full_queue_refusals, r.link->unanswered, r.link->time_s);
  return text;
}

std::string events_text(const sl::NetworkResult& link) {
  std::string text;
  for (const sl::NetworkEvent& event : link.events) text += fmt::format("{:>12.6f} s  {}{}\n", event.time_s, event.is_error ? "error: " : "", event.text);
  return text;
}

}  // namespace pmac::tool
