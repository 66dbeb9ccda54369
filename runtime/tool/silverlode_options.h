// The command line of pmac-silverlode.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/drives/silverlode/circle.h"
#include "runtime/drives/silverlode/network.h"

namespace pmac::tool {

struct SilverlodeOptions {
  enum class Verb { kCircle, kDecode };
  Verb verb = Verb::kCircle;
  drives::silverlode::CircleSetup circle;
  bool literal = false;
  bool json = false, quiet = false;
  std::string record, table, frames;
  std::vector<std::string> plots;
  bool link = false;                              // execute through host and line instead of feeding the servos in time
  drives::silverlode::NetworkSetup network;
  std::vector<std::string> decoded_files;         // of decode
};

/// Reads the command line. Returns an exit code where the run is over already (help, version, usage error).
std::optional<int> parse_silverlode_options(int argc, char** argv, SilverlodeOptions& options);

}  // namespace pmac::tool
