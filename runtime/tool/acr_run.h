// pmac-run for ACR1000 programs: cards instead of a controller. docs/acr1000.md tells what its options mean here.
#pragma once

#include <functional>

#include "runtime/tool/options.h"

namespace pmac::tool {

/// The files are for cards: by --dialect, or by their endings (.acr, .sys, .bin).
bool is_card_run(const RunOptions& options);

/// Loads the files, runs the cards and writes what came of it. Answers the exit code.
int run_cards(const RunOptions& options, std::function<bool()> interrupted);

}  // namespace pmac::tool
