#include "runtime/tool/acr_options.h"

#include <cmath>
#include <cstdlib>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace pmac::tool {
namespace {

constexpr double kShortestPeriod_s = 1e-6;

/// A number at the front of the text; what follows it is left in `rest`.
std::optional<double> number_at(const std::string& text, std::string& rest) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || !std::isfinite(value)) return std::nullopt;
  rest = end;
  return value;
}

/// "20000" or "20000,1e6", each >= 0.
std::optional<acr1000::AxisLimits> limits_of(const std::string& text) {
  std::string rest;
  const auto speed = number_at(text, rest);
  if (!speed || *speed < 0) return std::nullopt;
  if (rest.empty()) return acr1000::AxisLimits{*speed, 0};
  if (rest.front() != ',') return std::nullopt;
  const auto accel = number_at(rest.substr(1), rest);
  if (!accel || *accel < 0 || !rest.empty()) return std::nullopt;
  return acr1000::AxisLimits{*speed, *accel};
}

}  // namespace

void add_card_options(CLI::App& app, CardRunOptions& o) {
  app.add_option("--dialect", o.dialect, "language of the files; ACR1000 is known by .acr, .sys and .bin")->check(CLI::IsMember({"power-pmac", "acr1000"}));
  app.add_option("--card", o.settings, "ACR1000: a setting of all cards, as in a SYSTEM line")->type_name("KEY=VALUE")->allow_extra_args(false);
  app.add_option("--period", o.period, "ACR1000: time between samples in ms, or with a unit (0.5ms, 250us, 0.001s)")->type_name("T")->capture_default_str();
  app.add_flag("--lookahead", o.lookahead, "ACR1000: stretch the time of the cards' common path until every axis keeps its limits (--axis-limit)");
  app.add_option("--axis-limit", o.axis_limits, "ACR1000: limits of an axis ('*': of all) in pulses/s and pulses/s^2; 0: none")
      ->type_name("AXIS=SPEED[,ACCEL]")
      ->allow_extra_args(false);
}

/// A time between samples; nullopt for what is none, and for less than a microsecond.
std::optional<double> period_seconds(const std::string& text) {
  std::string unit;
  const auto value = number_at(text, unit);
  const double factor = unit.empty() || unit == "ms" ? 1e-3 : unit == "s" ? 1 : unit == "us" ? 1e-6 : 0;
  if (!value || *value * factor < kShortestPeriod_s) return std::nullopt;
  // A thousand times the wanted number over 1000 is what the decimal text means; 0.001 * 1 alone may be off by a bit.
  return factor == 1e-3 ? *value / 1e3 : factor == 1e-6 ? *value / 1e6 : *value;
}

std::optional<std::string> read_axis_limits(const std::vector<std::string>& texts, const std::vector<std::string>& axes,
                                            std::vector<acr1000::AxisLimits>& limits) {
  limits.resize(axes.size());
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string axis = text.substr(0, equals);
    const auto values = equals == std::string::npos ? std::nullopt : limits_of(text.substr(equals + 1));
    if (!values) return fmt::format("--axis-limit: '{}' is not AXIS=SPEED[,ACCEL]", text);
    bool known = false;
    for (std::size_t k = 0; k < axes.size(); ++k)
      if (axis == "*" || axis == axes[k]) {
        limits[k] = *values;
        known = true;
      }
    if (!known) return fmt::format("--axis-limit: there is no axis {}", axis);
  }
  return std::nullopt;
}

}  // namespace pmac::tool
