#include "runtime/acr1000/card_host.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compiler/bytecode/card.h"
#include "compiler/bytecode/opcode.h"

namespace pmac::acr1000 {
namespace {

using bytecode::CardVerb;
using runtime::Flow;
using runtime::Thread;

constexpr double kLeastInteger = -2147483648.0, kMostInteger = 2147483647.0;
constexpr double kMaxRelay = 65535, kMaxAddress = 0xffff, kMaxByte = 0xff;
constexpr double kVel16 = 65535, kVel24 = 16777215;
constexpr std::size_t kMaxNesting = 250;  // the manual gives no limit; a little below the interpreter's own

/// Every stored line is a label, and they stand in ascending order.
int line_number_of(const Thread& thread) {
  if (!thread.program()) return -1;
  const std::vector<bytecode::LabelEntry>& labels = thread.program().program->labels;
  const auto next = std::upper_bound(labels.begin(), labels.end(), thread.pc(), [](std::uint32_t pc, const bytecode::LabelEntry& entry) { return pc < entry.pc; });
  return next == labels.begin() ? -1 : static_cast<int>(std::prev(next)->number);
}

Place place_of(const Thread& thread) { return {thread.source(), line_number_of(thread)}; }

}  // namespace

void CardHost::print(std::string_view text) {
  ++outputs_;
  if (print_) print_(text);
}

Flow CardHost::fail(Thread& thread, std::string id, std::string detail) {
  place = place_of(thread);
  fault_id = std::move(id);
  thread.set_host_fault({runtime::FaultKind::kRunTime, thread.source(), std::move(detail)});
  return Flow::kFault;
}

bool CardHost::whole(Thread& thread, double value, double least, double most, const char* what) {
  if (value >= least && value <= most) return true;
  fail(thread, "ACR-E04", fmt::format("{} is from {:.0f} to {:.0f}, and here it is {:.0f}", what, least, most, value));
  return false;
}

// --- what a card is asked for --------------------------------------------------------------------------------------------------

Flow CardHost::card(Thread& thread, CardVerb verb, std::span<const double> x) {
  place = place_of(thread);
  switch (verb) {
    case CardVerb::kVel:
    case CardVerb::kAcc:
    case CardVerb::kDec:
    case CardVerb::kStp: return set_rate(thread, verb, x[0]);
    case CardVerb::kMoveTo:
    case CardVerb::kMoveBy:
    case CardVerb::kCircle: return move(thread, verb, x);
    case CardVerb::kSetRelay: return change_relay(thread, true, x[0]);
    case CardVerb::kClearRelay: return change_relay(thread, false, x[0]);
    case CardVerb::kPrint: print(fmt::format("{:.0f}\r\n", x[0])); return Flow::kContinue;
    case CardVerb::kPoke:
      if (!whole(thread, x[0], 0, kMaxAddress, "an address") || !whole(thread, x[1], 0, kMaxByte, "a byte")) return Flow::kFault;
      card_.memory().poke(static_cast<std::uint16_t>(x[0]), static_cast<std::uint8_t>(x[1]));
      return Flow::kContinue;
    case CardVerb::kPeek: return ask_peek(thread, x[0], x[1]);
    case CardVerb::kCall:
      note_call(thread);
      if (thread.call_depth() < kMaxNesting) return Flow::kContinue;
      return fail(thread, "ACR-E08", fmt::format("subroutines call each other deeper than {}; a RET is missing", kMaxNesting));
    case CardVerb::kReturn:
      if (thread.call_depth() > 0) return Flow::kContinue;
      return fail(thread, "ACR-E08", "RET without a GSB; the program came here without a call");
    case CardVerb::kMissingLine: return fail(thread, "ACR-E07", fmt::format("line {:.0f} is not stored, and this branch goes there", x[0]));
    case CardVerb::kRun: return run(thread, x[0]);
    case CardVerb::kHalt: request = {ProgramRequest::Kind::kHalt, -1}; return Flow::kSuspend;
    case CardVerb::kNew: request = {ProgramRequest::Kind::kErase, -1}; return Flow::kSuspend;
    case CardVerb::kList:
    case CardVerb::kRenumber: return answer_from_memory(verb);
    case CardVerb::kCount: break;
  }
  return refuse(thread);
}

void CardHost::note_call(const Thread& thread) {
  call_sites_.resize(thread.call_depth());
  call_sites_.push_back(thread.pc());
}

std::span<const std::uint32_t> CardHost::call_sites(const Thread& thread) const {
  return std::span(call_sites_).first(std::min(call_sites_.size(), thread.call_depth()));
}

Flow CardHost::set_rate(Thread& thread, CardVerb verb, double value) {
  const bool is_velocity = verb == CardVerb::kVel;
  const double most = !is_velocity ? kMostInteger : card_.config().wide_velocity ? kVel24 : kVel16;
  const char* what = is_velocity ? "VEL" : verb == CardVerb::kAcc ? "ACC" : verb == CardVerb::kDec ? "DEC" : "STP";
  if (!whole(thread, value, 0, most, what)) return Flow::kFault;
  std::int64_t& rate = is_velocity ? card_.rates.vel : verb == CardVerb::kAcc ? card_.rates.acc : verb == CardVerb::kDec ? card_.rates.dec : card_.rates.stp;
  rate = static_cast<std::int64_t>(value);
  return Flow::kContinue;
}

Flow CardHost::move(Thread& thread, CardVerb verb, std::span<const double> x) {
  if (card_.waits()) return fail(thread, "ACR-E09", "the card waits for the motion before to end; this one cannot be taken now");
  for (const double value : x)
    if (!whole(thread, value, kLeastInteger, kMostInteger, "an argument of a motion")) return Flow::kFault;
  MoveRequest wanted;
  wanted.kind = verb == CardVerb::kCircle ? MoveKind::kCircle : verb == CardVerb::kMoveBy ? MoveKind::kMoveBy : MoveKind::kMoveTo;
  const auto argument = [&](std::size_t i) { return static_cast<std::int64_t>(x[i]); };
  if (verb == CardVerb::kCircle) wanted.circle = {static_cast<int>(argument(0)), argument(1), argument(2), argument(3), argument(4)};
  else wanted.distance = argument(0);
  wanted.end_point = parameter(kEndPointParameter);
  wanted.master_length = parameter(kMasterLengthParameter);
  wanted.rates = card_.rates;
  wanted.place = place;
  if (const auto refusal = card_.request(wanted)) return fail(thread, std::string(row_of(refusal->id).id), refusal->detail);
  return Flow::kSuspend;
}

Flow CardHost::change_relay(Thread& thread, bool on, double number) {
  if (!whole(thread, number, 0, kMaxRelay, "the number of a relay")) return Flow::kFault;
  card_.set_relay(static_cast<int>(number), on);
  return Flow::kContinue;
}

double CardHost::relay(Thread& thread, double number) {
  place = place_of(thread);
  return whole(thread, number, 0, kMaxRelay, "the number of a relay") && card_.relay(static_cast<int>(number)) ? 1 : 0;
}

Flow CardHost::run(Thread& thread, double line) {
  const runtime::ProgramHandle program = memory ? memory->program() : stored;
  const auto number = std::isnan(line) ? -1 : static_cast<std::int64_t>(line);
  if (memory) stored = program;
  if (number >= 0 && (!program || bytecode::find_label(*program.program, number) == nullptr))
    return fail(thread, "ACR-E07", fmt::format("line {} is not stored, and this branch goes there", number));
  request = {ProgramRequest::Kind::kRun, number};
  return Flow::kSuspend;
}

/// The card answers while nothing moves; until then the command waits.
Flow CardHost::ask_peek(Thread& thread, double address, double count) {
  const bool typed = thread.program().program->kind == bytecode::ProgramKind::kOnline;
  if (typed && program_runs) return fail(thread, "ACR-E09", "PEEK is answered only while no program runs; ctrl-L asks for the move counter at any time");
  if (!whole(thread, address, 0, kMaxAddress, "an address") || !whole(thread, count, 0, kMaxAddress + 1 - address, "the number of bytes")) return Flow::kFault;
  peek = PeekRequest{static_cast<std::uint32_t>(address), static_cast<std::uint32_t>(count)};
  return Flow::kSuspend;
}

Flow CardHost::answer_from_memory(CardVerb verb) {
  if (memory) print(verb == CardVerb::kList ? memory->listing() : memory->renumber());
  return Flow::kContinue;
}

Flow CardHost::send(Thread& thread, int, std::string_view text) {
  place = place_of(thread);
  print(text);
  return Flow::kContinue;
}

/// "hex 0480...": a fast move block of a file.
Flow CardHost::fast_block(Thread& thread, std::string_view digits) {
  if (card_.waits()) return fail(thread, "ACR-E09", "the card waits for the motion before to end; this one cannot be taken now");
  const auto bytes = bytes_from_hex(digits);
  if (!bytes) return fail(thread, "ACR-E12", "the bytes of a fast move block are pairs of hexadecimal digits");
  const auto decoded = decode_block(*bytes);
  if (const auto* error = std::get_if<BlockError>(&decoded)) return fail(thread, "ACR-E12", text_of(*error));
  if (const auto refusal = card_.request(std::get<DecodedBlock>(decoded).block, place)) return fail(thread, std::string(row_of(refusal->id).id), refusal->detail);
  return Flow::kSuspend;
}

Flow CardHost::online(Thread& thread, const bytecode::Module& module, const bytecode::Instruction& in, std::span<const double>) {
  constexpr std::string_view kBlock = "hex ";
  place = place_of(thread);
  const auto index = static_cast<std::size_t>(in.imm);
  if (in.op == bytecode::Opcode::kInstallProgram) {
    stored = {thread.program().module, &module.programs[index]};
    return Flow::kContinue;
  }
  if (in.op != bytecode::Opcode::kSystemCommand || !module.strings[index].starts_with(kBlock)) return refuse(thread);
  return fast_block(thread, std::string_view(module.strings[index]).substr(kBlock.size()));
}

// --- what only the other controller has ----------------------------------------------------------------------------------------

double CardHost::read_m(Thread& thread, int) { return refuse(thread), 0; }
void CardHost::write_m(Thread& thread, int, double) { refuse(thread); }
double CardHost::read_i(Thread& thread, int) { return refuse(thread), 0; }
void CardHost::write_i(Thread& thread, int, double) { refuse(thread); }
double CardHost::read_element(Thread& thread, const runtime::ElementAddress&) { return refuse(thread), 0; }
Flow CardHost::write_element(Thread& thread, const runtime::ElementAddress&, double) { return refuse(thread); }
double CardHost::element_address(Thread& thread, const runtime::ElementAddress&) { return refuse(thread), 0; }
Flow CardHost::motion(Thread& thread, const bytecode::Instruction&, std::span<const double>) { return refuse(thread); }
Flow CardHost::control(Thread& thread, bytecode::ControlVerb, std::span<const double>) { return refuse(thread); }
Flow CardHost::queue_assignment(Thread& thread, const bytecode::SyncTarget&, const runtime::ElementAddress&, double) { return refuse(thread); }
runtime::ProgramHandle CardHost::find_subprogram(std::uint32_t) { return {}; }
Flow CardHost::command(Thread& thread, std::string_view) { return refuse(thread); }
double CardHost::random(double) { return 0; }
void CardHost::seed_random(double) {}

}  // namespace pmac::acr1000
