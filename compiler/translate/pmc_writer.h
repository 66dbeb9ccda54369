// A path as a Power PMAC motion program with its set-up.
#pragma once

#include <string>
#include <vector>

#include "compiler/translate/path_merge.h"

namespace pmac::compiler::translate {

/// One coordinate system with a motor an axis.
struct PmcSystem {
  int coord = 1, first_motor = 1, program = 1;
  std::vector<CardPath> cards;      // axis names that the controller has
  std::vector<PathMove> moves;
};

/// What cannot be said in the other language is a warning ACR-W10.
std::string write_pmc(const std::vector<PmcSystem>& systems, const std::string& origin, source::Diagnostics& diagnostics);

}  // namespace pmac::compiler::translate
