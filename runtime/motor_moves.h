// What a single motor is told to do by itself: jogs, home searches, moves until a trigger. Source: jog commands, Software Reference
// Manual p74; triggered moves, User's Manual p718-719. What the trigger is, servo/trigger.h; it stands for the capture input that the
// controller would have, and is caught exactly where the position passes it: the commanded one of a motor without a plant.
// Jogs end at software limits (Motor[].MaxPos, MinPos); a home search does not look at them until it has its trigger.
#pragma once

#include <optional>
#include <string>

#include "runtime/state.h"

namespace pmac::runtime {

/// Each answers a refusal ("error #21: ...") or empty. A motor that moves goes on from its position and speed.
/// trigger_distance_mu: until the trigger, and then to so far from it.
std::string jog_to(Machine::State& s, Motor& m, double target_mu, bytecode::SourceLine source, std::optional<double> trigger_distance_mu = {});
std::string jog_endless(Machine::State& s, Motor& m, int direction, bytecode::SourceLine source);
void jog_stop(Machine::State& s, Motor& m);
/// At HomeVel until the trigger, back to it and on to HomeOffset, which becomes position 0.
std::string home(Machine::State& s, Motor& m, bytecode::SourceLine source);

/// Where a move to target_mu ends: at a software limit, unless it leads back from beyond it.
double clip_target(const Machine::State& s, const Motor& m, double target_mu);
/// The motor follows a profile to clipped_mu instead of target_mu; its status will say so.
void note_clip(Motor& m, double clipped_mu, double target_mu);

/// To rest with AbortTa and AbortTs, by the machine's time.
void abort_motor(Machine::State& s, Motor& m);

/// The brake engages; the motor is killed Motor[].BrakeOnDelay later.
void delay_kill(Machine::State& s, Motor& m, double brake_ms);

/// The motor follows a profile until its trigger, and then goes to trigger_distance_mu from it.
void seek_trigger(Machine::State& s, Motor& m, double trigger_distance_mu, const motion::JogParameters& parameters);
/// The actual position has passed the trigger (raw), at this servo interrupt.
void trigger_captured(Machine::State& s, Motor& m, double place_raw_mu);
/// Its trigger lies elsewhere now.
void trigger_moved(Machine::State& s, Motor& m);

/// Time at the speed and in the ramps of the last profile, longest first; empty where nobody asks (MachineOptions::note_governing).
std::vector<motion::GoverningShare> governed_by_itself(const Machine::State& s, const Motor& m);

/// When service_motor() has something to do.
double next_motor_event_ms(const Motor& m);
/// A trigger that was passed, a profile that has ended.
void service_motor(Machine::State& s, Motor& m);

}  // namespace pmac::runtime
