// Options of pmac-run that only ACR1000 cards have.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/acr1000/path_lookahead.h"

namespace CLI { class App; }

namespace pmac::tool {

struct CardRunOptions {
  std::string dialect;                    // --dialect; empty: by the endings of the files
  std::vector<std::string> settings;      // --card, "KEY=VALUE" as in a SYSTEM line
  std::string period = "1";               // of --record and all other samples: ms, or with a unit
  bool lookahead = false;
  std::vector<std::string> axis_limits;   // "X=20000,1e6": pulses/s and pulses/s^2
};

void add_card_options(CLI::App& app, CardRunOptions& options);

/// Seconds of "1", "0.5ms", "250us", "0.001s"; nullopt: no period above 0.
std::optional<double> period_seconds(const std::string& text);

/// The limits of --axis-limit by axis, in the order of the axes; "*" is every axis. Answers what is wrong with them, or nothing.
std::optional<std::string> read_axis_limits(const std::vector<std::string>& texts, const std::vector<std::string>& axes,
                                            std::vector<acr1000::AxisLimits>& limits);

}  // namespace pmac::tool
