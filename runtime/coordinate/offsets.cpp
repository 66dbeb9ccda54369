// Renaming positions without motion: the selected transformation and the position bias of pset. Source: Software Reference Manual
// p71; that tsel gives the present point its new name at once, as TSEL does in the Turbo family, is inferred.
#include <cmath>

#include <fmt/format.h>

#include "runtime/state.h"

namespace pmac::runtime {

using bytecode::ControlVerb;

/// The program position of where the pipeline stands. Answers a refusal or empty.
std::string CoordSystem::rename_position() {
  const auto program = frame_.to_program(machine_.elements, calculated_uu_);
  if (!program) return fmt::format("error #39: NOT READY TO RUN: the matrix Tdata[{}] is singular; it has no program position", frame_.transform);
  program_uu_ = placed_uu_ = *program;
  return {};
}

std::optional<Fault> CoordSystem::select_transform(double number, bytecode::SourceLine source) {
  if (!(number >= -1 && number < kTransformCount) || number != std::floor(number))
    return Fault{FaultKind::kBadTarget, source, fmt::format("tsel {} selects no matrix; they are 0 to {}, and -1 for none", number_text(number), kTransformCount - 1)};
  if (auto fault = refuse_while_compensating("tsel", source)) return fault;
  frame_.transform = static_cast<int>(number);
  if (const std::string refusal = rename_position(); !refusal.empty())
    return Fault{FaultKind::kBadTarget, source, fmt::format("the matrix Tdata[{}] is singular; start it with tinit or set Diag to 1", frame_.transform)};
  return std::nullopt;
}

std::string CoordSystem::change_positions(double time_ms, const PositionChange& change) {
  if (change.verb == ControlVerb::kPstore) {
    frame_.stored_bias_uu = frame_.position_bias_uu;
    return {};
  }
  if (std::string refusal = match_positions(time_ms); !refusal.empty()) return refusal;
  if (phase_ == Phase::kPaused) note_pause(time_ms);
  if (change.verb == ControlVerb::kPclr) frame_.position_bias_uu.fill(0);
  if (change.verb == ControlVerb::kPload) frame_.position_bias_uu = frame_.stored_bias_uu;
  frame_.bias_changed();
  if (change.verb == ControlVerb::kPset) {
    if (!std::isfinite(change.value)) return fmt::format("error #21: ILLEGAL PARAMETER: pset {}{}", bytecode::axis_name(change.axis), number_text(change.value));
    AxisVector values{};
    values[static_cast<std::size_t>(change.axis)] = change.value;
    frame_.rename(machine_.elements, program_uu_, 1u << change.axis, values);
  }
  if (phase_ == Phase::kPaused) pause_here(time_ms);  // the paused program goes on from the new position
  return rename_position();
}

Flow CoordSystem::change_positions(Thread& thread, const PositionChange& change) {
  if (change.verb != ControlVerb::kPstore)
    if (auto fault = refuse_while_compensating(control_verb_name(change.verb), thread.source())) return give_up(thread, *fault);
  position_change_ = change;
  return stop_item(thread, AfterRest::kPositions);
}

}  // namespace pmac::runtime
