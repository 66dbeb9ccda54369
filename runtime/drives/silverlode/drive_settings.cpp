#include "runtime/drives/silverlode/drive_settings.h"

#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

namespace pmac::drives::silverlode {
namespace {

/// What is wrong with a setting, for the user.
struct Refused : std::runtime_error { using std::runtime_error::runtime_error; };

double number_of(const std::string& name, std::string_view text, double least, double most) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) throw Refused(fmt::format("{}: '{}' is not a number", name, text));
  if (value < least || value > most) throw Refused(fmt::format("{}: {} is not from {:g} to {:g}", name, text, least, most));
  return value;
}

std::vector<double> numbers_of(const std::string& name, std::string_view text, double least, double most) {
  std::vector<double> values;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t slash = std::min(text.find('/', at), text.size());
    values.push_back(number_of(name, text.substr(at, slash - at), least, most));
    at = slash + 1;
  }
  return values;
}

int whole_of(const std::string& name, std::string_view text, int least, int most) {
  const double value = number_of(name, text, least, most);
  if (value != std::floor(value)) throw Refused(fmt::format("{}: '{}' is not a whole number", name, text));
  return static_cast<int>(value);
}

bool switch_of(const std::string& name, std::string_view text) { return whole_of(name, text, 0, 1) == 1; }

constexpr double kTiny = 1e-9, kHuge = 1e9;

void apply(DriveSettings& s, const std::string& name, const std::string& text) {
  NetworkSetup& n = s.network;
  if (name == "max_speed") s.max_speed_rpm = numbers_of(name, text, kTiny, 4000);
  else if (name == "max_accel") s.max_accel_rpm_s = numbers_of(name, text, kTiny, kHuge);
  else if (name == "scale") {
    s.counts_per_mu = numbers_of(name, text, -kHuge, kHuge);
    for (const double value : s.counts_per_mu)
      if (value == 0) throw Refused("scale: 0 counts per motor unit move nothing");
  }
  else if (name == "min_slice") s.min_slice_s = number_of(name, text, 0.00024, 60);
  else if (name == "tolerance") s.tolerance_counts = number_of(name, text, 0, kHuge);
  else if (name == "id") for (const double id : numbers_of(name, text, 1, kMostAddress)) s.ids.push_back(whole_of(name, fmt::format("{}", id), 1, kMostAddress));
  else if (name == "queue_depth") n.queue_depth = static_cast<std::size_t>(whole_of(name, text, 1, 1'000'000));
  else if (name == "baud") n.baud = number_of(name, text, 300, 1e8);
  else if (name == "start_latency") n.start_latency_ticks = whole_of(name, text, 0, 1'000'000);
  else if (name == "compensate_start") n.compensate_start = switch_of(name, text);
  else if (name == "wired") n.wired = switch_of(name, text);
  else if (name == "reply_delay") n.reply_delay_s = number_of(name, text, 0, 60);
  else if (name == "host_delay") n.host_delay_s = number_of(name, text, 0, 60);
  else if (name == "reply_timeout") n.reply_timeout_s = number_of(name, text, 0, 60);
  else if (name == "retries") n.retries = whole_of(name, text, 0, 1000);
  else if (name == "lose") for (const double frame : numbers_of(name, text, 1, kHuge)) n.lost_frames.push_back(static_cast<std::size_t>(frame));
  else if (n.commands.find(name) != nullptr) {
    if (const auto why = n.commands.set_number(name, whole_of(name, text, 0, kMostCommandNumber))) throw Refused(*why);
  }
  else throw Refused(fmt::format("there is no setting '{}'; max_speed max_accel scale min_slice tolerance id queue_depth baud start_latency compensate_start wired reply_delay host_delay "
                                 "reply_timeout retries lose WRI RUN IMS IMW IMQ", name));
}

}  // namespace

std::variant<DriveSettings, std::string> read_settings(const Settings& settings) {
  DriveSettings result;
  result.network.compensate_start = true;
  try {
    for (const auto& [name, text] : settings) apply(result, name, text);
  } catch (const Refused& refused) {
    return std::string(refused.what());
  }
  return result;
}

}  // namespace pmac::drives::silverlode
