#include "runtime/tool/acr_run.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "compiler/bytecode/object_file.h"
#include "compiler/compiler.h"
#include "runtime/acr1000/image.h"
#include "runtime/acr1000/path_lookahead.h"
#include "runtime/acr1000/print.h"
#include "runtime/gather/output_file.h"
#include "runtime/motion/print.h"
#include "runtime/tool/acr_cards.h"
#include "runtime/tool/acr_console.h"
#include "runtime/tool/acr_options.h"
#include "runtime/tool/acr_outputs.h"
#include "runtime/tool/acr_report.h"
#include "runtime/tool/load.h"

namespace pmac::tool {
namespace {

using acr1000::CardSystem;
using acr1000::SystemEnd;

bool is_stream(const std::string& name) { return name.ends_with(".bin"); }
bool is_object(const std::string& name) { return name.ends_with(".pmx"); }
bool is_card_source(const std::string& name) { return name.ends_with(".acr") || name.ends_with(".sys"); }

int usage(const std::string& message) {
  std::fprintf(stderr, "pmac-run: %s\n", message.c_str());
  return kExitUsage;
}

/// An option of Power PMAC runs that has no meaning for cards, or empty.
std::string foreign_option(const RunOptions& o) {
  if (!o.robots.empty()) return "--kinematics";
  if (o.kin_check.enabled) return "--kin-check";
  if (o.limit_jerk) return "--limit-jerk";
  if (!o.drive.empty()) return "--drive";
  if (!o.drive_record.empty()) return "--drive-record";
  if (!o.trace.empty()) return "--trace";
  if (o.fine != motion::FineInterpolation::kThrough) return "--fine";
  if (o.ramp_rule != motion::RampRule::kPower) return "--ramp";
  if (!o.include_dirs.empty()) return "-I";
  if (!o.defines.empty()) return "-D";
  return "";
}

std::string stage_problem(const RunOptions& o) {
  const bool stretched = o.emit == "segments" || o.emit == "lookahead";
  if (stretched && !o.cards.lookahead) return fmt::format("--emit={}: cards have this stage with --lookahead only", o.emit);
  return "";
}

// --- loading ---------------------------------------------------------------------------------------------------------------

/// The compiled cards, or an exit code.
struct Loaded { std::shared_ptr<const bytecode::Module> module; int code = kExitOk; };

Loaded load_object(const std::string& name) {
  std::string bytes;
  if (!read_file(name, bytes)) return {nullptr, usage(fmt::format("cannot read {}: {}", name, std::strerror(errno)))};
  auto loaded = bytecode::load({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  if (const auto* error = std::get_if<bytecode::ObjectFileError>(&loaded)) return {nullptr, usage(name + ": " + error->message)};
  return {std::make_shared<const bytecode::Module>(std::move(std::get<bytecode::Module>(loaded))), kExitOk};
}

Loaded compile_sources(const std::vector<std::string>& names, compiler::Session& session) {
  std::vector<compiler::InputFile> files;
  for (const std::string& name : names) {
    files.push_back({name, ""});
    if (!read_file(name, files.back().text)) return {nullptr, usage(fmt::format("cannot read {}: {}", name, std::strerror(errno)))};
  }
  auto module = session.compile(std::move(files));
  const bool errors = print_diagnostics(session);
  if (!module || errors) return {nullptr, kExitProgramError};
  if (const std::string reason = bytecode::verify(*module); !reason.empty()) {
    std::fprintf(stderr, "pmac-run: internal error: the compiler produced an invalid module: %s\n", reason.c_str());
    return {nullptr, kExitInternal};
  }
  return {std::make_shared<const bytecode::Module>(std::move(*module)), kExitOk};
}

/// Sources are compiled together; an object file is a whole system. Files of blocks alone need no module.
Loaded load_module(const RunOptions& options, compiler::Session& session) {
  std::vector<std::string> sources;
  for (const std::string& name : options.files)
    if (!is_stream(name)) sources.push_back(name);
  if (sources.empty()) return {};
  if (std::none_of(sources.begin(), sources.end(), is_object)) return compile_sources(sources, session);
  if (sources.size() > 1) return {nullptr, usage("an object file of cards is a whole system; it runs alone or with .bin files")};
  return load_object(sources.front());
}

// --- the cards -------------------------------------------------------------------------------------------------------------

/// A run: cards, what is told of them, and what becomes of their samples.
class CardRun {
 public:
  CardRun(const RunOptions& options, compiler::Session& session) : options_(options), session_(session), system_(observers()) {}
  int run(const Loaded& loaded, std::function<bool()> interrupted);

 private:
  acr1000::SystemObservers observers();
  void add_card(const acr1000::CardImage& image);
  int add_streams();
  int set_limits();
  void send(const std::string& text, const char* origin);
  void print(std::size_t card, std::string_view text);
  void emit_begun(const acr1000::PlannedMove& move, std::size_t card, std::uint64_t coordinated) const;
  void emit_header() const;
  CardLineCompiler line_compiler();
  CardStation& station(std::size_t card) { return static_cast<CardStation&>(*system_.card(card).driver); }
  std::optional<std::size_t> card_named(const std::string& axis) const;
  acr1000::SystemLimits limits(std::function<bool()> interrupted) const;
  void open_sampling();
  int finish(const acr1000::SystemOutcome& outcome, double wall_s);
  std::string status_of(const acr1000::SystemOutcome& outcome) const;
  void explain_end(const acr1000::SystemOutcome& outcome) const;
  int exit_code(const acr1000::SystemOutcome& outcome) const;

  const RunOptions& options_;
  compiler::Session& session_;
  acr1000::SystemImage image_;
  std::vector<std::string> files_;
  CardSystem system_;
  std::vector<acr1000::AxisLimits> limits_;
  double period_s_ = 1e-3;
  std::optional<CardReport> report_;
  std::optional<CardOutputs> outputs_;
  std::optional<acr1000::Sampler> sampler_;
  std::optional<acr1000::PathLookahead> lookahead_;
};

acr1000::SystemObservers CardRun::observers() {
  acr1000::SystemObservers o;
  o.begun = [this](const acr1000::PlannedMove& move, std::size_t card, std::uint64_t coordinated) { emit_begun(move, card, coordinated); };
  o.move = [this](const acr1000::CardMoveRecord& move) { report_->add(move); };
  o.notice = [this](const acr1000::CardNotice& notice) { report_->add(notice); };
  o.stretch = [this](double from_s, double to_s) {
    if (sampler_) sampler_->stretch(from_s, to_s);
    if (lookahead_) lookahead_->stretch(from_s, to_s);
  };
  return o;
}

void CardRun::emit_begun(const acr1000::PlannedMove& move, std::size_t card, std::uint64_t coordinated) const {
  const std::string& name = system_.card(card).name();
  if (options_.emit == "commands") std::printf("%s\n", acr1000::command_text(name, move, coordinated).c_str());
  if (options_.emit == "path") std::printf("%s\n", acr1000::path_text(name, move).c_str());
}

void CardRun::emit_header() const {
  if (options_.emit == "commands") std::printf("%s\n", acr1000::command_header().c_str());
  if (options_.emit == "path") std::printf("%s\n", acr1000::path_header().c_str());
  if (options_.emit == "segments") std::printf("%s\n", motion::segment_header().c_str());
  if (options_.emit == "lookahead") std::printf("%s\n", motion::timed_segment_header().c_str());
}

/// What a card sends to its host: on standard output, with its name where there are several.
void CardRun::print(std::size_t card, std::string_view text) {
  if (options_.quiet) return;
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
  const std::string name = system_.size() > 1 ? system_.card(card).name() + ": " : "";
  const bool machine_format = options_.json != JsonDetail::kNone || !options_.emit.empty();
  std::fprintf(machine_format ? stderr : stdout, "%s%.*s\n", name.c_str(), static_cast<int>(text.size()), text.data());
}

CardLineCompiler CardRun::line_compiler() {
  return [this](const std::string& line) -> std::variant<runtime::ProgramHandle, std::string> {
    auto compiled = online_compiler(session_)(line, "-e");
    if (auto* reason = std::get_if<std::string>(&compiled)) return std::move(*reason);
    const auto module = std::make_shared<const bytecode::Module>(std::move(std::get<bytecode::Module>(compiled)));
    if (module->load_order.empty()) return std::string("nothing to execute");
    return runtime::ProgramHandle{module, &module->programs[module->load_order.front()]};
  };
}

void CardRun::add_card(const acr1000::CardImage& image) {
  const std::size_t index = system_.size();
  acr1000::Card& card = system_.add(image.config);
  auto station = std::make_unique<CardStation>(card, [this, index](std::string_view text) { print(index, text); }, line_compiler());
  if (image.script) station->start(image.script);
  card.driver = std::move(station);
}

std::optional<std::size_t> CardRun::card_named(const std::string& axis) const {
  for (std::size_t k = 0; k < system_.size(); ++k)
    if (system_.card(k).name() == axis) return k;
  return std::nullopt;
}

/// A file of blocks goes to the card of its name; one without a program gets a card of its own.
int CardRun::add_streams() {
  for (const std::string& name : options_.files) {
    if (!is_stream(name)) continue;
    const std::string axis = axis_of_file(name).empty() ? "X" : axis_of_file(name);
    if (!card_named(axis)) {
      if (system_.size() == acr1000::kMaxCards) return usage(name + ": a system has at most 16 cards");
      acr1000::CardImage image;
      if (!image_.cards.empty()) image.config = image_.cards.front().config;
      image.config.name = axis;
      image.config.start_pulses = 0;
      image.config.relays.clear();
      add_card(image);
      image_.cards.push_back(image);
    }
    acr1000::ByteSource source = open_stream(name);
    if (!source) return usage(fmt::format("cannot read {}: {}", name, std::strerror(errno)));
    acr1000::Place place;
    place.source.file = static_cast<std::int32_t>(files_.size());
    files_.push_back(name);
    station(*card_named(axis)).read_stream(std::move(source), place);
  }
  return kExitOk;
}

/// Limits of the files, and --axis-limit over them.
int CardRun::set_limits() {
  std::vector<std::string> axes;
  for (std::size_t k = 0; k < system_.size(); ++k) axes.push_back(system_.card(k).name());
  for (const acr1000::CardImage& card : image_.cards)
    limits_.push_back({card.max_speed_pulses_s.value_or(0), card.max_accel_pulses_s2.value_or(0)});
  if (const auto problem = read_axis_limits(options_.cards.axis_limits, axes, limits_)) return usage(*problem);
  const bool limited = std::any_of(limits_.begin(), limits_.end(), [](const auto& l) { return l.speed_pulses_s > 0 || l.accel_pulses_s2 > 0; });
  if (options_.cards.lookahead && !limited) return usage("--lookahead needs limits: --axis-limit X=SPEED,ACCEL, or MAXSPEED= and MAXACCEL= in the AXIS line");
  return kExitOk;
}

void CardRun::send(const std::string& text, const char* origin) {
  const AddressedLine addressed = split_address(text);
  if (!addressed.axis.empty() && !card_named(addressed.axis)) return report_->add_refusal(text, fmt::format("{}: there is no axis {}", origin, addressed.axis));
  for (std::size_t k = 0; k < system_.size(); ++k) {
    if (!addressed.axis.empty() && system_.card(k).name() != addressed.axis) continue;
    if (is_halt(addressed.line)) {
      system_.abandon(k);
      continue;
    }
    if (const auto reason = station(k).send(addressed.line)) return report_->add_refusal(text, *reason);
    system_.wake(k);
  }
}

void CardRun::open_sampling() {
  outputs_.emplace(options_, system_, period_s_, limits_);
  if (outputs_->is_idle() && options_.emit != "segments" && options_.emit != "lookahead") return;
  const auto taker = [this](double time_s, std::span<const acr1000::MotionPoint> cards) { outputs_->take(time_s, cards); };
  if (!options_.cards.lookahead) {
    sampler_.emplace(system_, period_s_, taker);
    return;
  }
  lookahead_.emplace(system_, limits_, period_s_, taker, [this](const motion::TimedSegment& timed) {
    if (options_.emit == "segments") std::printf("%s\n", motion::to_text(timed.segment).c_str());
    if (options_.emit == "lookahead") std::printf("%s\n", motion::to_text(timed).c_str());
  });
}

acr1000::SystemLimits CardRun::limits(std::function<bool()> interrupted) const {
  const RunOptions defaults;
  acr1000::SystemLimits l;
  l.has_until = options_.until_s.has_value();
  if (l.has_until) l.until_s = *options_.until_s;
  l.max_s = options_.max_time_s == defaults.max_time_s ? image_.max_time_s.value_or(options_.max_time_s) : options_.max_time_s;
  l.max_commands = options_.max_instructions == defaults.max_instructions ? image_.max_commands.value_or(options_.max_instructions) : options_.max_instructions;
  l.interrupted = std::move(interrupted);
  return l;
}

int CardRun::run(const Loaded& loaded, std::function<bool()> interrupted) {
  if (loaded.module) {
    image_ = acr1000::read_image(loaded.module);
    files_ = loaded.module->files;
  }
  const auto period = period_seconds(options_.cards.period);
  if (!period) return usage(fmt::format("--period: '{}' is no time of a microsecond or more", options_.cards.period));
  period_s_ = *period;
  for (const acr1000::CardImage& image : image_.cards) add_card(image);
  if (const int code = add_streams(); code != kExitOk) return code;
  if (system_.size() == 0) return usage("the files have no card");
  if (const int code = set_limits(); code != kExitOk) return code;
  report_.emplace(system_, files_, options_.json == JsonDetail::kMoves || options_.stats);
  emit_header();
  open_sampling();
  for (const std::string& text : options_.commands) send(text, "-e");
  for (const auto& [time_s, text] : options_.timed_commands) system_.at(time_s, [this, text = text] { send(text, "--at"); });

  const auto wall_start = std::chrono::steady_clock::now();
  const acr1000::SystemOutcome outcome = system_.run(limits(std::move(interrupted)));
  if (sampler_) sampler_->finish(outcome.time_s);
  if (lookahead_) lookahead_->finish();
  return finish(outcome, std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count());
}

// --- the end ---------------------------------------------------------------------------------------------------------------

std::string CardRun::status_of(const acr1000::SystemOutcome& outcome) const {
  switch (outcome.end) {
    case SystemEnd::kTimeLimit: return "time-limit";
    case SystemEnd::kBudget: return "budget";
    case SystemEnd::kInterrupted: return "interrupted";
    case SystemEnd::kIdle:
    case SystemEnd::kUntil: break;
  }
  if (system_.any_error()) return "fault";
  return outcome.end == SystemEnd::kUntil ? "until" : "idle";
}

int CardRun::exit_code(const acr1000::SystemOutcome& outcome) const {
  switch (outcome.end) {
    case SystemEnd::kTimeLimit:
    case SystemEnd::kBudget: return kExitLimit;
    case SystemEnd::kInterrupted: return kExitInterrupted;
    default: return system_.any_error() || report_->any_refused() ? kExitFault : kExitOk;
  }
}

void CardRun::explain_end(const acr1000::SystemOutcome& outcome) const {
  if (outcome.end == SystemEnd::kTimeLimit) std::fprintf(stderr, "pmac-run: the time limit is reached at %g s (--max-time, MAXTIME)\n", outcome.time_s);
  if (outcome.end == SystemEnd::kBudget) std::fprintf(stderr, "pmac-run: the limit of instructions is reached at %g s (--max-instructions, MAXCMDS)\n", outcome.time_s);
  if (outcome.end == SystemEnd::kInterrupted) std::fprintf(stderr, "pmac-run: interrupted at %.6f s\n", outcome.time_s);
  if (options_.quiet || outcome.end != SystemEnd::kIdle) return;
  for (const std::size_t k : system_.endless_loops())
    std::fprintf(stderr, "pmac-run: axis %s loops for ever (last at %s) and nothing more can happen; the run ends here\n", system_.card(k).name().c_str(),
                 acr1000::text_of(system_.card(k).driver->place()).c_str());
}

int CardRun::finish(const acr1000::SystemOutcome& outcome, double wall_s) {
  std::fputs(report_->repeated().c_str(), stderr);
  explain_end(outcome);
  const bool written = outputs_->finish();
  CardRunResult result;
  result.status = status_of(outcome);
  result.time_s = lookahead_ ? lookahead_->end_s() : outcome.time_s;
  result.commands = outcome.commands;
  result.statistics = outputs_->statistics();
  if (options_.check_limits) result.limits = outputs_->limit_rows();
  result.stretched_s = [this](double time_s) { return lookahead_ ? lookahead_->stretched_s(time_s) : time_s; };
  std::FILE* out = options_.json == JsonDetail::kNone && options_.emit.empty() ? stdout : stderr;
  if (options_.stats) std::fputs(report_->text(result, wall_s).c_str(), out);
  if (options_.check_limits) std::fputs(report_->limit_text(result).c_str(), out);
  if (options_.json != JsonDetail::kNone) std::fputs(report_->json(result, options_.json).c_str(), stdout);
  runtime::flush_standard_output();
  if (!written) return kExitUsage;
  const bool kept = std::all_of(result.limits.begin(), result.limits.end(), [](const auto& row) { return row.keeps_limits(); });
  const int code = exit_code(outcome);
  return code == kExitOk && !kept ? kExitFault : code;
}

}  // namespace

bool is_card_run(const RunOptions& options) {
  if (!options.cards.dialect.empty()) return options.cards.dialect == "acr1000";
  const bool all = std::all_of(options.files.begin(), options.files.end(), [](const auto& name) { return is_card_source(name) || is_stream(name); });
  if (!options.files.empty() && all) return true;
  const bool object = std::any_of(options.files.begin(), options.files.end(), is_object);
  if (!object || std::any_of(options.files.begin(), options.files.end(), [](const auto& name) { return !is_object(name) && !is_stream(name); })) return false;
  for (const std::string& name : options.files) {
    std::string bytes;
    if (!is_object(name) || !read_file(name, bytes)) continue;
    const auto loaded = bytecode::load({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    if (const auto* module = std::get_if<bytecode::Module>(&loaded)) return acr1000::is_card_module(*module);
  }
  return false;
}

int run_cards(const RunOptions& options, std::function<bool()> interrupted) {
  if (const std::string option = foreign_option(options); !option.empty()) return usage(option + " has no meaning for ACR1000 cards");
  if (const std::string problem = stage_problem(options); !problem.empty()) return usage(problem);
  if (options.console) {
    if (!options.files.empty() || options.realtime) return usage("--console of a card takes neither files nor --realtime; send the lines to its standard input");
    return run_card_console({options.cards.settings, options.console_step_ms / 1000, options.max_time_s});
  }
  compiler::Options compile_options;
  compile_options.dialect = compiler::Dialect::kAcr1000;
  compile_options.card_settings = options.cards.settings;
  compiler::Session session(compile_options);
  const Loaded loaded = load_module(options, session);
  if (loaded.code != kExitOk) return loaded.code;
  return CardRun(options, session).run(loaded, std::move(interrupted));
}

}  // namespace pmac::tool
