// A script is executed once to check it, without outputs; where nothing is wrong and a table or picture is wanted, once more for that.
#include "runtime/tool/mcx_run.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include "compiler/source/format.h"
#include "runtime/gather/output_file.h"
#include "runtime/tool/load.h"
#include "runtime/tool/mcx_output.h"

namespace pmac::tool {
namespace {

using namespace drives::mcx514;

/// Drives up to so many events are executed event by event even where nobody wants the pulses, so that the error is known.
constexpr std::uint64_t kCloselyFollowed = 100'000'000;

std::atomic<bool> g_stop{false};
void stop(int) { g_stop = true; }

/// What makes no sense for a register script, or nothing.
std::string misuse(const RunOptions& o) {
  if (o.files.size() != 1) return "a register script (.mcx) runs alone";
  if (!o.commands.empty() || !o.timed_commands.empty() || o.console) return "a register script takes no on-line commands (-e, --at, --console)";
  if (o.until_s) return "a register script runs until it is idle; use wait in the script, or --max-time";
  if (!o.gather.empty() || o.check_limits || o.kin_check.enabled || !o.robots.empty() || o.limit_jerk)
    return "a register script knows no --gather, --check-limits, --limit-jerk and kinematics";
  if (!o.drive.empty() || !o.emit.empty()) return "a register script is what --drive and --emit=frames make; it takes neither";
  return {};
}

class Pulses : public PulseSink {
 public:
  PulseTable* table = nullptr;
  PulsePicture* picture = nullptr;
  void pulses(Time time, const Event&, const AxisCounts& position, const Interpolator& by) override {
    if (table != nullptr) table->add(seconds(time), position);
    if (picture != nullptr) picture->add(seconds(time), position, by.error_now());
  }
};

constexpr std::size_t kMostProblems = 100;  // that are shown

/// In order of their place; of very many the first ones, and how many there are.
void print_problems(const std::string& name, const std::string& text, std::vector<Problem> problems) {
  source::SourceManager sources;
  const std::int32_t file = sources.add_file(name, text);
  std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) { return a.line < b.line; });
  const bool color = isatty(STDERR_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  const std::size_t hidden = problems.size() - std::min(problems.size(), kMostProblems);
  problems.resize(problems.size() - hidden);
  for (const Problem& problem : problems) {
    const auto line_start = static_cast<std::uint32_t>(sources.line_text(file, problem.line).data() - sources.file(file).text.data());
    const std::uint32_t begin = line_start + static_cast<std::uint32_t>(problem.column - 1);
    source::Diagnostic diagnostic;
    diagnostic.severity = problem.is_error ? source::Severity::kError : source::Severity::kWarning;
    diagnostic.span = {file, begin, begin + 1, -1};
    diagnostic.message = problem.text;
    std::fputs(source::format_text(sources, diagnostic, color).c_str(), stderr);
  }
  if (hidden > 0) std::fprintf(stderr, "%zu more problem(s) are not shown\n", hidden);
}

/// Executes the script on a chip; a continuous drive that nobody stops ends at the time limit.
bool execute(const Script& script, Chip& chip, const RunOptions& options) {
  chip.set_interrupted([] { return g_stop.load(); });
  const Time limit = time_from_seconds(options.max_time_s);
  if (options.max_time_given) chip.set_latest(limit);
  if (!run_items(script, chip)) return false;
  if (chip.drives_endlessly()) chip.set_latest(limit);
  return chip.run_until_idle();
}

/// Table and pictures, from a second execution. Returns what execute() does; throws OutputError.
bool write_outputs(const Script& script, const RunOptions& options, Chip& chip, const std::vector<std::size_t>& axes) {
  std::unique_ptr<PulseTable> table;
  PulsePicture picture(axes);
  Pulses sink;
  if (!options.record.empty()) table = std::make_unique<PulseTable>(options.record, axes);
  sink.table = table.get();
  if (!options.plots.empty()) sink.picture = &picture;
  chip.observe(&sink);
  const bool finished = execute(script, chip, options);
  if (table) table->finish();
  for (const std::string& file : options.plots) picture.draw(file, std::filesystem::path(options.files[0]).filename().string());
  return finished;
}

int fail(const std::string& message) {
  std::fprintf(stderr, "pmac-run: %s\n", message.c_str());
  return kExitUsage;
}

/// What went wrong in the chip. True: something did.
bool print_faults(const Chip& chip, const RunOptions& options) {
  bool any = false;
  for (const ChipEvent& event : chip.events()) {
    if (!event.is_error) continue;
    any = true;
    std::fprintf(stderr, "%s:%d: fault at %.9f s: %s\n", options.files[0].c_str(), event.place.line, seconds(event.time), event.text.c_str());
  }
  return any;
}

/// Exit code and, for the report, its word.
std::pair<int, std::string> outcome(const Chip& chip, bool finished, const RunOptions& options) {
  print_faults(chip, options);
  if (!finished && g_stop) return {kExitInterrupted, "interrupted"};
  if (!finished) std::fprintf(stderr, "pmac-run: the time limit of %g s is reached (--max-time); a continuous drive ends by 56h or 57h\n", options.max_time_s);
  if (!finished) return {kExitLimit, "time-limit"};
  const bool fault = std::any_of(chip.events().begin(), chip.events().end(), [](const ChipEvent& event) { return event.is_error; });
  return fault ? std::pair(kExitFault, std::string("fault")) : std::pair(kExitOk, std::string("idle"));
}

}  // namespace

bool is_register_script(const RunOptions& options) {
  return std::any_of(options.files.begin(), options.files.end(), [](const std::string& file) { return file.ends_with(".mcx") || file.ends_with(".MCX"); });
}

int run_register_script(const RunOptions& options) {
  if (const std::string bad = misuse(options); !bad.empty()) return fail(bad);
  const std::string& name = options.files[0];
  std::string text;
  if (!read_file(name, text)) return fail("cannot read " + name + ": " + std::strerror(errno));
  std::signal(SIGINT, stop);
  std::signal(SIGTERM, stop);

  const Script script = read_script(text);
  const bool wants_pulses = !options.record.empty() || !options.plots.empty();
  auto chip = std::make_unique<Chip>();
  if (!wants_pulses) chip->set_closely_followed(kCloselyFollowed);
  bool finished = execute(script, *chip, options);
  std::vector<Problem> problems = script.problems;
  const bool writes = std::any_of(script.items.begin(), script.items.end(), [](const ScriptItem& item) { return item.kind == ScriptItem::Kind::kWrite; });
  if (!writes) problems.push_back({true, 1, 1, "this script writes no register; a write is a line such as  WR6 <- 1388h"});
  problems.insert(problems.end(), chip->problems().begin(), chip->problems().end());
  print_problems(name, text, problems);
  const bool wrong = std::any_of(problems.begin(), problems.end(), [](const Problem& problem) { return problem.is_error; });
  if (wrong) return print_faults(*chip, options) ? kExitFault : kExitProgramError;  // a fault of the chip is what a refused write behind it comes from
  if (chip->drives().empty() && !chip->driving() && !options.quiet) std::fprintf(stderr, "pmac-run: %s drives nothing\n", name.c_str());

  if (wants_pulses && !g_stop) {
    const std::vector<std::size_t> axes = shown_axes(*chip);
    chip = std::make_unique<Chip>();
    try {
      finished = write_outputs(script, options, *chip, axes);
    } catch (const runtime::OutputError& e) {
      return fail(e.what());
    }
  }
  const auto [code, status] = outcome(*chip, finished, options);
  if (options.stats) std::fputs(pulse_text(*chip).c_str(), options.json == JsonDetail::kNone ? stdout : stderr);
  if (options.json != JsonDetail::kNone) std::fputs(pulse_json(*chip, name, status, options.json).c_str(), stdout);
  runtime::flush_standard_output();
  return code;
}

}  // namespace pmac::tool
