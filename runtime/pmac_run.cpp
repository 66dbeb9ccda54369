// pmac-run: loads programs into a simulated controller, runs simulated time, and writes what came of it.
#include <atomic>
#include <chrono>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>

#include <unistd.h>

#include "compiler/compiler.h"
#include "runtime/machine.h"
#include "runtime/tool/acr_run.h"
#include "runtime/tool/budget.h"
#include "runtime/tool/console.h"
#include "runtime/tool/drive_run.h"
#include "runtime/tool/emit.h"
#include "runtime/tool/kin_check.h"
#include "runtime/tool/limit_report.h"
#include "runtime/tool/load.h"
#include "runtime/tool/mcx_run.h"
#include "runtime/tool/options.h"
#include "runtime/tool/outputs.h"
#include "runtime/tool/recorder.h"
#include "runtime/tool/report.h"
#include "runtime/tool/robots.h"
#include "runtime/tool/trace_writer.h"

namespace {

using namespace pmac;
using namespace pmac::tool;

std::atomic<bool> g_interrupted{false};

/// The first signal ends the run in an orderly way; another one, while that still writes, at once.
void interrupt(int) {
  if (g_interrupted.exchange(true)) _exit(kExitInterrupted);
}

void catch_signals() {
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
}

bool shows_progress(const RunOptions& options) { return !options.quiet && isatty(STDERR_FILENO) != 0; }

/// Messages of the machine, as they come: faults and refusals on standard error, answers on standard output.
runtime::MachineObservers observers(const RunOptions& options, Report& report, Budget& budget, runtime::Machine*& machine, Console& console,
                                    runtime::LimitCheck*& excuse, DriveRun& drive) {
  runtime::MachineObservers o;
  const bool answers_to_stderr = options.trace == "-" || options.json != JsonDetail::kNone || !options.emit.empty() || options.console;
  o.answer = [quiet = options.quiet, answers_to_stderr, &console](const std::string& text) {
    if (console.executing()) console.answer(text);
    else if (!quiet) std::fprintf(answers_to_stderr ? stderr : stdout, "%s\n", text.c_str());
  };
  o.refused = [&report, &console](const std::string& text, const std::string& reason) {
    if (console.executing()) return console.refuse(reason);
    if (report.add_refusal(text, reason)) std::fprintf(stderr, "refused: %s: %s\n", text.c_str(), reason.c_str());
  };
  o.warning = [&machine](bytecode::SourceLine source, const std::string& text) {
    std::fprintf(stderr, "%s: warning: %s\n", machine->place(source).c_str(), text.c_str());
  };
  o.move = [&report, &budget, &drive](const runtime::MoveRecord& move) {
    budget.count_move();
    report.add(move);
    drive.take(move);
  };
  o.output = [&report](const runtime::OutputChange& change) { report.add(change); };
  o.jerk_join = [&report, &excuse](const runtime::JerkJoin& join) {
    report.add(join);
    if (excuse) excuse->excuse_jerk(join.coord, join.time_ms);
  };
  o.fault = [&report, &machine](const runtime::FaultRecord& record) {
    report.add(record);
    const std::string who = record.plc >= 0 ? "PLC " + std::to_string(record.plc) : record.coord < 0 ? "motor " + std::to_string(record.motor) : "coordinate system " + std::to_string(record.coord);
    std::fprintf(stderr, "%s: fault at %.6f s, %s: %s\n", machine->place(record.fault.source).c_str(), record.time_ms / 1000.0,
                 who.c_str(), record.fault.detail.c_str());
  };
  if (shows_progress(options))
    o.progress = [last = std::chrono::steady_clock::now()](double time_ms) mutable {
      const auto now = std::chrono::steady_clock::now();
      if (now - last < std::chrono::milliseconds(200)) return;
      last = now;
      std::fprintf(stderr, "\r%.0f s simulated ", time_ms / 1000.0);
    };
  return o;
}

runtime::RunLimits limits(const RunOptions& options, Budget& budget) {
  runtime::RunLimits l;
  if (options.until_s) l.until_ms = *options.until_s * 1000.0;
  l.max_ms = options.max_time_s * 1000.0;
  l.interrupted = [] { return g_interrupted.load(std::memory_order_relaxed) || std::ferror(stdout) != 0; };
  l.over_budget = [&budget] { return !budget.reached().empty(); };
  return l;
}

/// False: what went to standard output is not whole, which is said.
bool flush_output() {
  try {
    runtime::flush_standard_output();
    return true;
  } catch (const runtime::OutputError& e) {
    std::fprintf(stderr, "pmac-run: %s\n", e.what());
    return false;
  }
}

/// Says why a run that did not come to its own end was ended.
void explain_end(const RunOptions& options, Budget& budget, const runtime::RunOutcome& outcome) {
  if (outcome.end == runtime::RunEnd::kTimeLimit)
    std::fprintf(stderr, "pmac-run: the time limit of %g s is reached (--max-time)\n", options.max_time_s);
  else if (outcome.end == runtime::RunEnd::kBudget && !budget.reached().empty())
    std::fprintf(stderr, "pmac-run: %s\n", budget.reached().c_str());
  else if (outcome.end == runtime::RunEnd::kBudget)
    std::fprintf(stderr, "pmac-run: the limit of %llu instructions is reached (--max-instructions)\n",
                 static_cast<unsigned long long>(options.max_instructions));
  else if (outcome.end == runtime::RunEnd::kInterrupted && !g_interrupted)
    return;   // nobody reads standard output any more
  else if (outcome.end == runtime::RunEnd::kInterrupted)
    std::fprintf(stderr, "pmac-run: interrupted at %.6f s\n", outcome.time_ms / 1000.0);
  else
    return;
  for (const std::string& program : outcome.running) std::fprintf(stderr, "  still running: %s\n", program.c_str());
}

int exit_code(const runtime::Machine& machine, const Report& report, const runtime::RunOutcome& outcome) {
  switch (outcome.end) {
    case runtime::RunEnd::kTimeLimit:
    case runtime::RunEnd::kBudget: return kExitLimit;
    case runtime::RunEnd::kInterrupted: return kExitInterrupted;
    default: return machine.any_fault() || report.any_refused() ? kExitFault : kExitOk;
  }
}

/// The console first, until its input ends; then the run goes on as without one.
runtime::RunOutcome run_machine(const RunOptions& options, Budget& budget, runtime::Machine& machine, Console& console) {
  if (!options.console) return machine.run(limits(options, budget));
  runtime::RunLimits rest = limits(options, budget);
  const runtime::RunOutcome outcome = console.run(machine, rest);
  if (outcome.end == runtime::RunEnd::kInterrupted) return outcome;
  const bool over = outcome.end == runtime::RunEnd::kBudget || outcome.end == runtime::RunEnd::kTimeLimit;
  if (!over) return machine.run(rest);
  rest.until_ms = machine.time_ms();  // closes what is open
  runtime::RunOutcome closed = machine.run(rest);
  closed.end = outcome.end;
  return closed;
}

int run(const RunOptions& options) {
  compiler::Options compile_options;
  compile_options.include_dirs = options.include_dirs;
  compile_options.max_include_depth = options.max_include_depth;
  compile_options.defines = options.defines;
  compiler::Session session(compile_options);
  Budget budget(options);
  Report report(options.json == JsonDetail::kMoves || options.stats);
  runtime::Machine* place = nullptr;
  runtime::LimitCheck* excuse = nullptr;
  DriveRun drive(options);
  runtime::MachineOptions machine_options;
  machine_options.fine = options.fine;
  machine_options.ramp_rule = options.ramp_rule;
  machine_options.limit_jerk = options.limit_jerk;
  machine_options.max_instructions = options.max_instructions;
  machine_options.note_governing = options.stats;
  Console console(options);
  machine_options.compile_online = online_compiler(session, &console.error_place());
  machine_options.source_text = [lines = source_lines(session), &console](const std::string& file, int line) {
    const auto typed = file == Console::kName ? console.typed_line(line) : std::nullopt;
    return typed ? typed : lines(file, line);
  };
  machine_options.observers = observers(options, report, budget, place, console, excuse, drive);
  TraceWriter trace(options, machine_options.source_text);
  trace.attach(machine_options);
  machine_options.observers.trace = [&trace, &place](const runtime::TraceRecord& record) {
    const auto file = static_cast<std::size_t>(record.source.file);
    trace.write(record, record.source.file >= 0 && file < place->files().size() ? place->files()[file] : "", place->place(record.source));
  };
  Emitter emitter(options.emit);
  budget.add_output([&emitter] { return emitter.printed(); });
  emitter.attach(machine_options.observers);
  runtime::Machine machine(machine_options);
  place = &machine;

  runtime::MotionStatistics statistics;
  Recorder recorder(machine, options.record_actual);
  Outputs outputs(options, machine, recorder);
  budget.add_output([&outputs] { return outputs.size(); });
  if (options.json != JsonDetail::kNone || options.stats) machine.add_sink(&statistics);
  runtime::LimitCheck limit_check([&machine](int motor, double time_ms) { return machine.activity(motor, time_ms); });
  if (options.check_limits) machine.add_sink(&limit_check);
  excuse = &limit_check;
  if (const int code = drive.set_up(machine); code != kExitOk) return code;
  emitter.attach(machine, recorder, drive);
  if (recorder.has_sinks()) machine.add_sink(&recorder);
  if (drive.active()) machine.add_sink(&drive);

  if (!options.trace.empty()) catch_signals();   // its file is open while files load
  if (const int code = set_robots(options, machine); code != kExitOk) return code;
  if (const int code = load_files(options, session, machine); code != kExitOk) return code;
  for (const std::string& text : options.commands) machine.command(text, "-e");
  if (options.kin_check.enabled) return check_kinematics(options, machine);
  for (const auto& [time_s, text] : options.timed_commands) machine.at(time_s * 1000.0, text);

  catch_signals();
  const auto wall_start = std::chrono::steady_clock::now();
  const runtime::RunOutcome outcome = run_machine(options, budget, machine, console);
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
  if (shows_progress(options)) std::fprintf(stderr, "\r                              \r");
  recorder.finish();
  for (const int motor : recorder.late_motors())
    std::fprintf(stderr, "pmac-run: warning: motor %d moved for the first time when the columns of the record stood already, and is not in it\n", motor);
  std::fputs(report.repeated_refusals().c_str(), stderr);
  explain_end(options, budget, outcome);
  const bool idle_from_start = outcome.end == runtime::RunEnd::kIdle && report.move_count() == 0 && outcome.time_ms < 11;
  if (idle_from_start && options.commands.empty() && options.timed_commands.empty() && !options.console && !options.quiet && exit_code(machine, report, outcome) == kExitOk)
    std::fprintf(stderr, "pmac-run: loaded, and nothing was started; use -e '&1 b1r' to run program 1 in coordinate system 1\n");
  const bool trace_written = trace.finish();
  const bool written = outputs.finish() && trace_written;
  const int drive_code = drive.finish();
  std::FILE* out = options.json == JsonDetail::kNone && options.emit.empty() && options.trace != "-" ? stdout : stderr;
  if (options.stats) {
    std::fputs(report.text(machine, outcome, statistics, wall_s).c_str(), out);
    std::fputs(report.move_log(machine).c_str(), out);
    std::fputs(report.output_log(machine).c_str(), out);
    std::fputs(drive_text(drive).c_str(), out);
  }
  const std::vector<runtime::LimitCheck::Row> limit_rows = limit_check.rows();
  const bool limits_kept = all_keep_limits(limit_rows);
  report.add_limits(limit_rows);
  report.add_drive(drive);
  if (options.check_limits) std::fputs(limit_text(machine, limit_rows).c_str(), out);
  if (options.json != JsonDetail::kNone) std::fputs(report.json(machine, outcome, statistics, options.json).c_str(), stdout);
  if (!flush_output() || !written) return kExitUsage;
  const int code = exit_code(machine, report, outcome);
  if (code != kExitOk) return code;
  return limits_kept ? drive_code : kExitFault;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    RunOptions options;
    if (const auto code = parse_options(argc, argv, options)) return *code;
    if (options.robots.size() == 1 && options.robots[0] == "list") return list_robots();
    if (options.drive == "list") {
      std::fputs(drives::drive_list().c_str(), stdout);
      runtime::flush_standard_output();
      return kExitOk;
    }
    if (const std::string file = unknown_ending(options); !file.empty()) {
      std::fprintf(stderr, "pmac-run: %s: unknown ending; tables are .csv, .npz or .txt, pictures .svg, .png or .html\n", file.c_str());
      return kExitUsage;
    }
    if (const std::string file = clashing_file(options); !file.empty()) {
      std::fprintf(stderr, "pmac-run: %s is an output and something else as well; choose another name\n", file.c_str());
      return kExitUsage;
    }
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);   // a file beyond its limit is an error of writing, as on a full disk
    if (is_register_script(options)) return run_register_script(options);
    if (is_card_run(options)) {
      catch_signals();
      return run_cards(options, [] { return g_interrupted.load(); });
    }
    return run(options);
  } catch (const runtime::OutputError& e) {
    std::fprintf(stderr, "pmac-run: %s\n", e.what());
    return kExitUsage;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "pmac-run: internal error: %s\n", e.what());
    return kExitInternal;
  }
}
