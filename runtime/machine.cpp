// The machine as its owner sees it: loading, commands, sinks. Time is in schedule.cpp.
#include "runtime/machine.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "runtime/interpreter/fuse.h"
#include "runtime/interruption.h"
#include "runtime/state.h"
#include "runtime/trace.h"

namespace pmac::runtime {
namespace {

constexpr std::uint64_t kLoadBudget = 1'000'000'000;  // instructions of one load script
constexpr std::uint64_t kLoadSlice = 1'000'000;       // between two looks at an interruption

constexpr std::size_t kMostWarningsOfALine = 8;

/// The number of "error #20: ILLEGAL CMD"; 20 where the reason has none.
int error_number(const std::string& reason) {
  const std::size_t at = reason.find("error #");
  int number = 20;
  if (at != std::string::npos) std::from_chars(reason.data() + at + 7, reason.data() + reason.size(), number);
  return number;
}

/// Makes the module's file numbers those of the machine, which knows every file once.
void adopt_files(bytecode::Module& module, std::vector<std::string>& files) {
  std::vector<std::int32_t> number;
  for (const std::string& name : module.files) {
    const auto known = std::find(files.begin(), files.end(), name);
    number.push_back(static_cast<std::int32_t>(known - files.begin()));
    if (known == files.end()) files.push_back(name);
  }
  const auto shift = [&number](bytecode::SourceLine& source) {
    if (source.file >= 0 && static_cast<std::size_t>(source.file) < number.size()) source.file = number[static_cast<std::size_t>(source.file)];
  };
  for (bytecode::Program& program : module.programs) {
    shift(program.source);
    for (bytecode::LineEntry& line : program.lines) shift(line.source);
  }
}

}  // namespace

Machine::State::State(MachineOptions o)
    : options(std::move(o)), p(bytecode::kPCount, 0.0), i_values(bytecode::kICount, 0.0), host(make_host(*this)) {
  for (int n = 0; n < bytecode::kMaxMotors; ++n) motors[static_cast<std::size_t>(n)].number = n;
  for (int n = 0; n < bytecode::kMaxCoords; ++n) coords.push_back(std::make_unique<CoordSystem>(*this, n));
  online = std::make_unique<Runner>(RunnerKind::kOnline, 0, p.data(), coord(1).q.data());
  online->thread.coord = online->thread.motor = 1;
  if (options.trace != TraceDetail::kNone) tracer = std::make_unique<Tracer>(*this);
}

Machine::State::~State() = default;

std::string Machine::State::place(bytecode::SourceLine source) const {
  if (source.file < 0 || static_cast<std::size_t>(source.file) >= files.size()) return "<no source>";
  return fmt::format("{}:{}", files[static_cast<std::size_t>(source.file)], source.line);
}

void Machine::State::answer(const std::string& text) {
  if (options.observers.answer) options.observers.answer(text);
}

void Machine::State::warn(bytecode::SourceLine source, const std::string& text) {
  std::set<std::string>& texts = warned[{source.file, source.line}];
  if (options.observers.warning && texts.size() < kMostWarningsOfALine && texts.insert(text).second) options.observers.warning(source, text);
}

void Machine::State::refuse(const std::string& text, const std::string& reason) {
  any_refused = true;
  last_error = error_number(reason);
  if (!options.observers.refused) return;
  if (!executing_queued) return options.observers.refused(text, reason);
  const std::string sent = fmt::format("{}: cmd \"{}\"", place(executing_queued->source), executing_queued->text);
  options.observers.refused(text == executing_queued->text ? sent : sent + ": " + text, reason);
}

void Machine::State::report_fault(const FaultRecord& record) {
  any_fault = true;
  if (options.observers.fault) options.observers.fault(record);
}

bool Machine::State::executes(bytecode::ProgramKind kind, std::uint32_t number) const {
  if (kind == bytecode::ProgramKind::kPlc) return number < plcs.size() && plcs[number].active;
  if (kind == bytecode::ProgramKind::kForward || kind == bytecode::ProgramKind::kInverse)
    return number < coords.size() && coords[number]->program_running();
  const auto& table = kind == bytecode::ProgramKind::kSubprog ? subprogs : progs;
  const auto it = table.find(number);
  if (it == table.end()) return false;
  return std::any_of(coords.begin(), coords.end(), [&](const auto& c) { return c->executes(it->second.program); });
}

void Machine::State::install(ProgramHandle handle) {
  const std::uint32_t number = handle.program->number;
  switch (handle.program->kind) {
    case bytecode::ProgramKind::kPlc: plc_programs[number] = handle; break;
    case bytecode::ProgramKind::kSubprog: subprogs[number] = handle; break;
    case bytecode::ProgramKind::kForward:
      if (number < coords.size()) coords[number]->forward = handle;
      break;
    case bytecode::ProgramKind::kInverse:
      if (number < coords.size()) coords[number]->inverse = handle;
      break;
    default: progs[number] = handle; break;
  }
}

void Machine::State::run_load_script(ProgramHandle program) {
  Thread& thread = online->thread;
  thread.begin(program);
  const std::size_t locals = program.program->local_count;
  online_locals.resize(std::max(online_locals.size(), locals));
  for (std::size_t i = 0; i < locals; ++i) thread.local(static_cast<int>(i)) = online_locals[i];
  thread.reset_jump_backs();
  RunResult result;
  for (std::uint64_t used = 0; used < kLoadBudget; used += std::max<std::uint64_t>(result.instructions, 1)) {
    poll_interruption();
    result = thread.run(*host, std::min(kLoadBudget - used, kLoadSlice), 0);
    instructions += result.instructions;
    if (result.stop == RunStop::kEnded || result.stop == RunStop::kFault) break;
  }
  if (result.fault) refuse(place(result.fault->source), result.fault->detail);
  else if (result.stop == RunStop::kBudget) refuse(place(thread.source()), "the command does not come to an end");
  thread.stop();
  for (std::size_t i = 0; i < locals; ++i) online_locals[i] = thread.local(static_cast<int>(i));
}

void Machine::State::load(bytecode::Module module) {
  adopt_files(module, files);
  if (tracer) tracer->learn_names(module);
  else fuse(module);
  const auto shared = std::make_shared<const bytecode::Module>(std::move(module));
  for (std::uint32_t index : shared->load_order) {
    loading = shared;
    run_load_script({shared, &shared->programs[index]});
  }
  loading.reset();
}

void Machine::State::command(std::string_view text, std::string_view name) {
  if (!options.compile_online) return refuse(std::string(text), "no compiler for on-line commands is attached");
  auto compiled = options.compile_online(text, name);
  if (const auto* reason = std::get_if<std::string>(&compiled)) return refuse(std::string(text), *reason);
  load(std::move(std::get<bytecode::Module>(compiled)));
}

/// The program that queued a command, while it still is there.
Runner* Machine::State::sender_of(const QueuedCommand& queued_command) {
  for (Plc& plc : plcs)
    if (plc.runner && sender_key(*plc.runner) == queued_command.sender) return plc.runner.get();
  for (const auto& c : coords)
    if (sender_key(c->runner()) == queued_command.sender) return &c->runner();
  return nullptr;
}

/// One command with the addresses of its sender; Ldata.CmdStatus of the sender says how it went: 0 when the last one is done, minus
/// the error number where one was refused.
void Machine::State::execute_queued(const QueuedCommand& next) {
  Thread& thread = online->thread;
  Addresses& addresses = command_addresses[next.sender];
  const Addresses own{thread.coord, thread.motor};
  thread.coord = addresses.coord;
  thread.motor = addresses.motor;
  thread.q = coord(thread.coord).q.data();
  last_error = 0;
  executing_queued = &next;
  command(next.text, "cmd");
  executing_queued = nullptr;
  addresses = {thread.coord, thread.motor};
  thread.coord = own.coord;
  thread.motor = own.motor;
  thread.q = coord(thread.coord).q.data();
  Runner* sender = sender_of(next);
  if (!sender) return;
  int& status = sender->thread.command_status;
  const bool more = std::any_of(queued.begin(), queued.end(), [&](const QueuedCommand& other) { return other.sender == next.sender; });
  if (last_error != 0) status = -last_error;
  else if (!more && status > 0) status = 0;
}

void Machine::State::execute_queued_commands() {
  while (!queued.empty()) {
    const QueuedCommand next = std::move(queued.front());
    queued.pop_front();
    execute_queued(next);
  }
}

// --- the owner's side -----------------------------------------------------------------------------------------------------

Machine::Machine(MachineOptions options) : state_(std::make_unique<State>(std::move(options))) {}
Machine::~Machine() = default;

void Machine::load(bytecode::Module module) { state_->load(std::move(module)); }
void Machine::command(std::string_view text, std::string_view name) { state_->command(text, name); }

void Machine::at(double time_ms, std::string text) {
  auto& timed = state_->timed;
  const auto later = [](double t, const TimedCommand& c) { return t < c.time_ms; };
  timed.insert(std::upper_bound(timed.begin(), timed.end(), time_ms, later), {time_ms, std::move(text)});
}

void Machine::add_sink(SampleSink* sink) { state_->sinks.push_back(sink); }
void Machine::set_gather_sink(GatherSink sink) { state_->gather.sink = std::move(sink); }

void Machine::observe_stages(int coord, motion::StageObservers observers) { state_->coord(coord).observe(std::move(observers)); }

RunOutcome Machine::run(const RunLimits& limits) { return state_->run(limits); }

double Machine::time_ms() const { return state_->now_ms; }
double Machine::servo_period_ms() const { return state_->period_ms(); }
const std::vector<std::string>& Machine::files() const { return state_->files; }
std::string Machine::place(bytecode::SourceLine source) const { return state_->place(source); }
bool Machine::any_fault() const { return state_->any_fault; }
bool Machine::any_refused() const { return state_->any_refused; }

std::vector<int> Machine::motors_in_use() const {
  std::vector<int> used;
  for (const Motor& m : state_->motors)
    if (m.in_use) used.push_back(m.number);
  return used;
}

std::vector<int> Machine::coords_in_use() const {
  std::vector<int> used;
  for (int n = 0; n < bytecode::kMaxCoords; ++n)
    if (!state_->coord(n).motors().empty()) used.push_back(n);
  return used;
}

std::uint32_t Machine::axes_of(int coord) const { return state_->coord(coord).axes_with_motors(); }

bool Machine::axes_from_motors(int coord, std::span<const double> motor_mu, motion::AxisVector& axis_uu, std::string* why) {
  return state_->coord(coord).axes_from_motors(motor_mu, axis_uu, why);
}

const kinematics::AxisMap* Machine::linear_axes(int coord) const {
  const CoordSystem& c = state_->coord(coord);
  return c.has_forward() || !c.map().solvable() ? nullptr : &c.map();
}

void Machine::set_robot(int coord, std::shared_ptr<const kinematics::Robot> robot, std::vector<double> motor_mu_per_joint) {
  state_->coord(coord).robot = {std::move(robot), std::move(motor_mu_per_joint)};
}

bool Machine::has_kinematics(int coord) const { return !kinematic_motors(coord).empty(); }

std::vector<int> Machine::kinematic_motors(int coord) const {
  std::vector<int> motors;
  for (const auto& d : state_->coord(coord).map().definitions())
    if (d.kind == kinematics::MotorDefinition::Kind::kInverse) motors.push_back(d.motor);
  return motors;
}

std::optional<std::pair<double, double>> Machine::motor_range_mu(int motor) const {
  const double low = state_->elements.get(bytecode::ElementId::kMotorMinPos, static_cast<unsigned>(motor));
  const double high = state_->elements.get(bytecode::ElementId::kMotorMaxPos, static_cast<unsigned>(motor));
  return high > low ? std::optional(std::pair(low, high)) : std::nullopt;
}

std::optional<Fault> Machine::motors_from_axes(int coord, const motion::AxisVector& axis_uu, std::span<double> motor_mu) {
  CoordSystem& c = state_->coord(coord);
  const std::vector<int> motors = c.served_motors();
  std::vector<double> positions(motors.size());
  if (auto fault = c.motors_from_axes(axis_uu, positions.data(), {})) return fault;
  for (std::size_t i = 0; i < motors.size(); ++i) motor_mu[static_cast<std::size_t>(motors[i])] = positions[i];
  return std::nullopt;
}

}  // namespace pmac::runtime
