// The verbs of the Control instruction.
#pragma once

#include "compiler/bytecode/bytecode.h"

namespace pmac::bytecode {

/// Verbs of Control. Unless said otherwise argument 0 is the number of the coordinate system, program or motor; missing
/// means "the one addressed by this thread" (executing coordinate system, Ldata.Coord, Ldata.Motor, or & and #), all
/// means all of them (the list *). missing.h has these two.
enum class ControlVerb : std::uint16_t {
  // coordinate systems
  kAbort, kBegin /* coord, program[.label] */, kRun, kStep, kStart /* coord, program */, kPause, kHold, kResume,
  kQuickStop, kRetrace, kForward, kEnable, kDisable, kDelayedDisable, kAbortDisable, kTimeBase /* coord, percent */,
  kPmatch, kPset /* axis index, value */, kPclr, kPstore, kPload,
  // axis values to D(axis index), their mask to D32 (coord, mask of the wanted axes; missing: all)
  kPread, kVread, kDread, kFread, kTread,
  kDefineLookahead /* coord, segments */, kDeleteLookahead,
  // motors; a missing position or distance means Motor[].ProgJogPos
  kJogPlus, kJogMinus, kJogStop, kJogTo /* motor, position mu */, kJogBy /* motor, distance mu from commanded */,
  kJogByActual /* motor, distance mu from actual */, kJogToAndKeep /* motor, position */, kJogReturn,
  // the same until the trigger (motor, position or distance, distance from the trigger mu)
  kJogToTrigger, kJogByTrigger, kJogByActualTrigger,
  kHome, kHomeAlso /* together with the kHome that follows */, kHomeZero, kKill, kDelayedKill, kPhase, kOpenLoop /* motor, percent */,
  // PLC programs (argument 0: number)
  kEnablePlc, kDisablePlc, kPausePlc, kResumePlc, kStepPlc,
  // reports of the on-line stream (motor or coord)
  kReportPosition, kReportVelocity, kReportDesired, kReportFollowingError, kReportStatus,
  kReportCoordPosition, kReportCoordVelocity, kReportCoordDesired, kReportCoordFollowingError, kReportCoordTarget,
  kReportCoordDistanceToGo, kReportCoordStatus, kReportTimeBase,
  kReportAxisDefinition /* motor */, kReportAlias /* I number */, kReportGlobalStatus /* no argument */,
  kReportPointer /* M number */,
  kSendAllCommands /* no argument: what cmd has queued is executed before the next statement */,
  kReset, kSave,
  kCount
};
std::string_view control_verb_name(ControlVerb verb);
/// Exact number of arguments of a verb, including the number of the thing it acts on.
int control_argument_count(ControlVerb verb);

}  // namespace pmac::bytecode
