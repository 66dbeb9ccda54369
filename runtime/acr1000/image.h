// What a compiled module says about the cards of a system: settings, and what each card is sent.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/acr1000/card.h"
#include "runtime/interpreter/interpreter.h"

namespace pmac::acr1000 {

struct CardImage {
  CardConfig config;
  double scale_pulses_per_unit = 1;
  std::string unit;                             // of the scale; empty: pulses
  std::optional<double> max_speed_pulses_s, max_accel_pulses_s2;
  runtime::ProgramHandle script;                // the commands without a number, in order; installs and runs the stored program
};

struct SystemImage {
  std::vector<CardImage> cards;                 // in the order of the command line
  std::string version;
  std::optional<double> max_time_s;             // MAXTIME
  std::optional<std::uint64_t> max_commands;    // MAXCMDS
};

/// Whether the module was compiled from ACR1000 programs.
bool is_card_module(const bytecode::Module& module);

/// module: verified. A setting whose text is no number is as if it were not there; the compiler writes none.
SystemImage read_image(const std::shared_ptr<const bytecode::Module>& module);

}  // namespace pmac::acr1000
