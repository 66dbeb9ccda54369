#include "runtime/tool/options.h"

#include <algorithm>
#include <cmath>

#include <CLI/CLI.hpp>

namespace pmac::tool {
namespace {

constexpr const char* kFooter = R"(Examples:
  pmac-run setup.cfg oval.pmc -e '&1 b5r' --plot oval.svg
  pmac-run contour.pmx -e '&1 b4r' --stats --record contour.csv
  pmac-run laser.pmc -e 'LoopCtrlInput=1 &1 b3r' --at 2.5 'LoopCtrlInput=0' --json
  pmac-run moves.pmc -e '&1 b1r' --emit=path
  pmac-run contour.pmc -e '&1 b4r' --drive silverlode:max_speed=3000,max_accel=3000 --emit=frames

Exit codes: 0 ok, 1 errors in the program, 2 usage or unreadable file, 3 simulated fault, limit or refused command,
4 a limit of time, instructions, moves, memory or output reached, 70 internal error, 130 interrupted.)";

constexpr double kMaxSeconds = 1e9;
constexpr std::uint64_t kMaxMib = 1u << 30;

std::string check_seconds(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool number = !text.empty() && *end == '\0' && std::isfinite(value) && value >= 0 && value <= kMaxSeconds;
  return number ? std::string() : "'" + text + "' is not a time in seconds";
}

void add_kinematics_options(CLI::App& app, RunOptions& o) {
  app.add_option("--kinematics", o.robots, "stock kinematics in place of the routines of coordinate system N; 'list' lists them")
      ->type_name("N=ROBOT[:SETTINGS]")
      ->allow_extra_args(false);
  KinCheckOptions& check = o.kin_check;
  app.add_flag("--kin-check", check.enabled, "check kinematics instead of running: forward(inverse(pose)), what is out of reach, singular poses");
  app.add_option("--kin-range", check.ranges, "poses to check")->type_name("[&N.]AXIS=LOW:HIGH")->allow_extra_args(false);
  app.add_option("--kin-samples", check.samples, "number of poses")->check(CLI::Range(1, 1'000'000))->capture_default_str();
  app.add_option("--kin-seed", check.seed, "seed of the random poses")->capture_default_str();
  app.add_option("--kin-tolerance", check.tolerance_uu, "allowed error in axis units")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--kin-condition", check.condition, "condition number above which a pose counts as singular")->check(CLI::Range(1.0, 1e15))->capture_default_str();
}

void add_drive_options(CLI::App& app, RunOptions& o) {
  app.add_option("--drive", o.drive, "encode the motion for a drive and execute it on the simulated drive; 'list' lists drives and settings")
      ->type_name("DRIVE[:NAME=VALUE,...]");
  app.add_option("--drive-record", o.drive_record, "write what the simulated drive did to a .csv, .npz or .txt file")->type_name("FILE");
}

/// Parts the text of --drive into name and settings. Returns what is wrong with it, or nothing.
std::string split_drive(RunOptions& o) {
  const std::size_t colon = o.drive.find(':');
  std::string rest = colon == std::string::npos ? std::string() : o.drive.substr(colon + 1);
  o.drive.resize(std::min(colon, o.drive.size()));
  for (std::size_t at = 0; at < rest.size();) {
    const std::size_t comma = std::min(rest.find(',', at), rest.size());
    const std::string part = rest.substr(at, comma - at);
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals == 0) return "'" + part + "' is no setting; write NAME=VALUE";
    o.drive_settings.emplace_back(part.substr(0, equals), part.substr(equals + 1));
    at = comma + 1;
  }
  if (colon != std::string::npos && o.drive.empty()) return "the name of the drive is missing";
  return {};
}

/// What does not go together around --drive, or nothing.
std::string drive_misuse(RunOptions& o) {
  if (const std::string bad = split_drive(o); !bad.empty()) return "--drive: " + bad;
  if (!o.drive.empty()) return {};
  if (o.emit == "frames") return "--emit=frames goes with --drive";
  if (!o.drive_record.empty()) return "--drive-record goes with --drive";
  return {};
}

}  // namespace

std::optional<int> parse_options(int argc, char** argv, RunOptions& o) {
  CLI::App app{"Runs motion programs on a simulated controller: files load in order, -e commands run at time 0.", "pmac-run"};
  app.footer(kFooter);
  app.set_version_flag("--version", "pmac-run 0.1.0");
  std::string until = "idle", fine = "through", ramp = "power", json, max_time = "3600";
  std::vector<std::string> defines, at;
  app.add_option("FILE", o.files, "programs, set-up files or compiled modules (.pmx), loaded in order");
  app.add_option("-e,--execute", o.commands, "on-line commands, executed at time 0")->type_name("COMMANDS")->allow_extra_args(false);
  app.add_option("--at", at, "on-line commands at a simulated time in seconds")->type_name("TIME COMMANDS")->type_size(2)->expected(0, 10'000'000)->allow_extra_args(false);
  app.add_option("--until", until, "run to this simulated time in seconds, or until idle")->type_name("idle|TIME")->capture_default_str();
  app.add_option("--max-time", max_time, "give up at this simulated time in seconds")->type_name("TIME")->capture_default_str();
  app.add_option("--max-instructions", o.max_instructions, "give up after so many instructions")->check(CLI::NonNegativeNumber)->capture_default_str();
  app.add_option("--max-moves", o.max_moves, "give up after so many moves")->check(CLI::NonNegativeNumber)->capture_default_str();
  app.add_option("--max-memory", o.max_memory_mib, "give up at so much memory")->type_name("MIB")->check(CLI::Range(std::uint64_t{1}, kMaxMib))->capture_default_str();
  app.add_option("--max-output", o.max_output_mib, "give up after so much output")->type_name("MIB")->check(CLI::Range(std::uint64_t{0}, kMaxMib))->capture_default_str();
  app.add_option("--min-free", o.min_free_mib, "give up when less is free on a disk that output goes to")->type_name("MIB")->check(CLI::Range(std::uint64_t{0}, kMaxMib))->capture_default_str();
  app.add_option("--record", o.record, "write every servo sample to a .csv, .npz or .txt file")->type_name("FILE");
  app.add_flag("--record-act", o.record_actual, "records hold where the motors are besides, Motor[n].ActPos");
  app.add_option("--gather", o.gather, "write what the program gathers to a .csv, .npz or .txt file")->type_name("FILE");
  app.add_option("--plot", o.plots, "draw path and motion to a .svg, .png or .html file")->type_name("FILE")->allow_extra_args(false);
  app.add_option("--emit", o.emit, "print every record of a stage")->type_name("STAGE")->check(CLI::IsMember({"commands", "path", "segments", "lookahead", "servo", "frames"}));
  app.add_flag("--trace{-}", o.trace, "print every executed line with its time and what it assigned; =FILE writes it to a file");
  app.add_flag("--trace-instructions", o.trace_instructions, "the trace shows every instruction besides");
  app.add_option("--trace-limit", o.trace_limit, "the trace ends after so many records; the run goes on")->type_name("N")->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000'000}))->capture_default_str();
  app.add_flag("--stats", o.stats, "print times, speeds and accelerations at the end");
  app.add_flag("--check-limits", o.check_limits, "hold every servo sample to the motors' limits; exit 3 where one is exceeded");
  app.add_flag("--json{moves}", json, "print one JSON object at the end; =summary leaves out moves and outputs");
  app.add_option("--fine", fine, "fine interpolation between segments")->check(CLI::IsMember({"through", "bspline"}))->capture_default_str();
  app.add_option("--ramp", ramp, "ramp rule: power adds Ts to Ta, turbo takes Ta as the whole ramp")->check(CLI::IsMember({"power", "turbo"}))->capture_default_str();
  app.add_flag("--limit-jerk", o.limit_jerk, "buffered lookahead keeps Motor[].InvJmax as well");
  add_kinematics_options(app, o);
  add_card_options(app, o.cards);
  add_drive_options(app, o);
  app.add_flag("--console", o.console, "read on-line commands from standard input and answer each line");
  app.add_option("--console-step", o.console_step_ms, "simulated time in ms that passes after each line")->type_name("MS")->check(CLI::Range(0.0, 1e9))->capture_default_str();
  app.add_flag("--realtime", o.realtime, "with --console: simulated time follows the clock on the wall");
  app.add_option("-I", o.include_dirs, "folder for #include")->type_name("DIR")->allow_extra_args(false);
  app.add_option("--max-include-depth", o.max_include_depth, "give up at #include nested so deep")->type_name("N")->check(CLI::Range(1, 200))->capture_default_str();
  app.add_option("-D", defines, "define a macro")->type_name("NAME[=TEXT]")->allow_extra_args(false);
  app.add_flag("-q,--quiet", o.quiet, "no progress, no answers of commands");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitOk : kExitUsage;
  }
  const auto usage = [](const std::string& message) {
    std::fprintf(stderr, "pmac-run: %s\nRun with --help for more information.\n", message.c_str());
    return kExitUsage;
  };
  const bool lists = (o.robots.size() == 1 && o.robots[0] == "list") || o.drive == "list";
  if (o.files.empty() && !o.console && !lists) return usage("FILE is required");
  if (o.kin_check.enabled && o.console) return usage("--kin-check runs nothing, and no --console");
  if (o.trace_instructions && o.trace.empty()) return usage("--trace-instructions goes with --trace");
  if (o.trace == "-" && (!o.emit.empty() || !json.empty())) return usage("--trace shares standard output with --json or --emit; name a file: --trace=FILE");
  if (o.realtime && !o.console) return usage("--realtime goes with --console");
  if (const std::string bad = drive_misuse(o); !bad.empty()) return usage(bad);
  if (at.size() % 2 != 0) return usage("--at needs a time and a command");
  for (std::size_t i = 0; i + 1 < at.size(); i += 2) {
    if (const std::string bad = check_seconds(at[i]); !bad.empty()) return usage("--at: " + bad);
    o.timed_commands.emplace_back(std::stod(at[i]), at[i + 1]);
  }
  if (until != "idle") {
    if (const std::string bad = check_seconds(until); !bad.empty()) return usage("--until: " + bad);
    o.until_s = std::stod(until);
  }
  if (const std::string bad = check_seconds(max_time); !bad.empty()) return usage("--max-time: " + bad);
  o.max_time_s = std::stod(max_time);
  o.max_time_given = app.count("--max-time") > 0;
  for (const std::string& define : defines) {
    const std::size_t equals = define.find('=');
    o.defines.emplace_back(define.substr(0, equals), equals == std::string::npos ? "1" : define.substr(equals + 1));
  }
  o.json = json.empty() ? JsonDetail::kNone : json == "summary" ? JsonDetail::kSummary : JsonDetail::kMoves;
  if (!json.empty() && json != "summary" && json != "moves") return usage("--json takes 'moves' or 'summary'");
  o.fine = fine == "bspline" ? motion::FineInterpolation::kBspline : motion::FineInterpolation::kThrough;
  o.ramp_rule = ramp == "turbo" ? motion::RampRule::kTurbo : motion::RampRule::kPower;
  return std::nullopt;
}

}  // namespace pmac::tool
