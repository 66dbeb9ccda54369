// The command line of pmac-run.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runtime/motion/types.h"
#include "runtime/tool/acr_options.h"

namespace pmac::tool {

enum class JsonDetail { kNone, kMoves, kSummary };

/// --kin-check: how poses are sampled and judged.
struct KinCheckOptions {
  bool enabled = false;
  int samples = 10'000;
  std::uint64_t seed = 1;
  std::vector<std::string> ranges;      // "X=-300:300" or "&2.X=-300:300"
  double tolerance_uu = 1e-6;           // forward(inverse(pose)) against the pose
  double condition = 1e4;               // a pose with a condition number above it is singular
};

struct RunOptions {
  std::vector<std::string> files;
  std::vector<std::string> include_dirs;
  int max_include_depth = 64;
  std::vector<std::pair<std::string, std::string>> defines;
  std::vector<std::string> commands;                          // -e, in order, at time 0
  std::vector<std::pair<double, std::string>> timed_commands; // --at seconds, text
  std::optional<double> until_s;                              // absent: until idle
  double max_time_s = 3600;
  bool max_time_given = false;
  std::uint64_t max_instructions = 20'000'000'000;
  std::uint64_t max_moves = 1'000'000'000;
  std::uint64_t max_memory_mib = 8192;
  std::uint64_t max_output_mib = 262'144;                     // of all files and stage records together
  std::uint64_t min_free_mib = 1024;                          // of the disks that grow fuller by the run
  std::string record, gather;
  std::string trace;                                          // a file, or - for standard output
  bool trace_instructions = false;
  bool record_actual = false;                                 // Motor[].ActPos in records
  std::uint64_t trace_limit = 1'000'000;                      // records
  std::vector<std::string> plots;
  std::string emit;
  bool stats = false, check_limits = false, quiet = false;
  bool console = false, realtime = false;
  double console_step_ms = 10;                                // simulated time that passes after a line of the console
  JsonDetail json = JsonDetail::kNone;
  motion::FineInterpolation fine = motion::FineInterpolation::kThrough;
  motion::RampRule ramp_rule = motion::RampRule::kPower;
  bool limit_jerk = false;
  std::vector<std::string> robots;                            // --kinematics, "1=scara:upper_arm_mm=350"
  KinCheckOptions kin_check;
  std::string drive;                                          // --drive NAME, and NAME=VALUE after the colon
  std::vector<std::pair<std::string, std::string>> drive_settings;
  std::string drive_record;                                   // table of what the simulated drive did
  CardRunOptions cards;                                       // of ACR1000 runs
};

inline constexpr int kExitOk = 0, kExitProgramError = 1, kExitUsage = 2, kExitFault = 3, kExitLimit = 4, kExitInternal = 70,
                     kExitInterrupted = 130;

/// Reads the command line. Returns an exit code where the run is over already (help, version, usage error).
std::optional<int> parse_options(int argc, char** argv, RunOptions& options);

}  // namespace pmac::tool
