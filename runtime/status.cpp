// Status elements: what a program reads of motors, coordinate systems and the clock at the present time. Source: status bits,
// User's Manual p683-694; in-position, training material.
#include <algorithm>
#include <cmath>

#include "compiler/bytecode/element.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

bool motor_in_position(const Machine::State& s, const Motor& m) {
  if (!m.closed_loop || m.moving()) return false;
  if (m.coord >= 0 && s.coords[static_cast<std::size_t>(m.coord)]->dwelling()) return false;
  const double band_mu = s.elements.get(ElementId::kMotorInPosBand, static_cast<unsigned>(m.number));
  const double checks = s.elements.get(ElementId::kMotorInPosTime, static_cast<unsigned>(m.number)) + 1;
  if (m.has_plant) return static_cast<double>(m.cycles_in_band) >= checks;
  return band_mu >= 0 && m.checks_at_rest(s.now_ms, s.period_ms()) >= checks;
}

/// Of the last servo interrupt; a motor without a plant has one in open loop only.
double servo_output(const Machine::State& s, const Motor& m) {
  if (m.has_plant) return m.loop.output();
  return m.closed_loop ? 0 : m.open_loop_share * s.elements.get(ElementId::kMotorMaxDac, static_cast<unsigned>(m.number));
}

double motor_value(Machine::State& s, ElementId id, const Motor& m) {
  const double raw_mu = m.home_position_mu + m.position_at(s.now_ms);
  switch (id) {
    case ElementId::kMotorDesPos: return raw_mu;
    case ElementId::kMotorActPos: return m.home_position_mu + m.actual_at(s.now_ms);
    case ElementId::kMotorHomePos: return m.home_position_mu;
    case ElementId::kMotorDesVel: return m.velocity_at(s.now_ms) * s.period_ms();
    case ElementId::kMotorActVel: return m.actual_velocity_at(s.now_ms, s.period_ms());
    case ElementId::kMotorPosError: return m.following_error_mu();
    case ElementId::kMotorFeFatal: return m.following_fatal;
    case ElementId::kMotorFeWarn: return m.following_warning;
    case ElementId::kMotorAmpFault: return m.amplifier_fault;
    case ElementId::kMotorPlusLimit: return m.plus_limit;
    case ElementId::kMotorMinusLimit: return m.minus_limit;
    case ElementId::kMotorLimitStop: return m.limit_stop != Motor::LimitStop::kNone;
    case ElementId::kMotorSoftLimit: return m.limit_stop == Motor::LimitStop::kPlusPosition || m.limit_stop == Motor::LimitStop::kMinusPosition;
    case ElementId::kMotorSoftPlusLimit: return m.limit_stop == Motor::LimitStop::kPlusPosition;
    case ElementId::kMotorSoftMinusLimit: return m.limit_stop == Motor::LimitStop::kMinusPosition;
    case ElementId::kMotorInPos: return motor_in_position(s, m);
    case ElementId::kMotorDesVelZero: return !m.moving();
    case ElementId::kMotorClosedLoop: return m.closed_loop;
    case ElementId::kMotorAmpEna: return m.amplifier_enabled;
    case ElementId::kMotorHomeComplete: return m.home_complete;
    case ElementId::kMotorHomeInProgress: return m.homing();
    case ElementId::kMotorTriggerMove: return m.seeks_trigger();
    case ElementId::kMotorTriggerNotFound: return m.trigger_not_found;
    case ElementId::kMotorServoOut: return servo_output(s, m);
    case ElementId::kMotorCsolve: return m.coord >= 0 && s.coord(m.coord).map().solvable();
    case ElementId::kMotorCoord: return std::max(m.coord, 0);
    default: return s.elements.get(id, static_cast<unsigned>(m.number));
  }
}

/// AND of a motor status bit over the motors of a coordinate system.
bool all_motors(Machine::State& s, const CoordSystem& c, ElementId id) {
  for (int motor : c.motors())
    if (motor_value(s, id, s.motors[static_cast<std::size_t>(motor)]) == 0) return false;
  return true;
}

bool any_motor(Machine::State& s, const CoordSystem& c, ElementId id) {
  for (int motor : c.motors())
    if (motor_value(s, id, s.motors[static_cast<std::size_t>(motor)]) != 0) return true;
  return false;
}

double coord_value(Machine::State& s, const ElementAddress& a) {
  CoordSystem& c = s.coord(static_cast<int>(a.index[0]));
  switch (a.id) {
    case ElementId::kCoordInPos: return all_motors(s, c, ElementId::kMotorInPos);
    case ElementId::kCoordHomeComplete: return all_motors(s, c, ElementId::kMotorHomeComplete);
    case ElementId::kCoordDesVelZero: return all_motors(s, c, ElementId::kMotorDesVelZero);
    case ElementId::kCoordClosedLoop: return all_motors(s, c, ElementId::kMotorClosedLoop);
    case ElementId::kCoordAmpEna: return all_motors(s, c, ElementId::kMotorAmpEna);
    case ElementId::kCoordCsolve: return c.map().solvable();
    case ElementId::kCoordProgRunning: return c.program_running() && !c.at_limit();
    case ElementId::kCoordProgProceeding: return c.program_running() && (!c.time_base().stands(s.now_ms) || c.path_rate(s.now_ms) != 0);
    case ElementId::kCoordProgActive: return c.program_active();
    case ElementId::kCoordFeedHold: return static_cast<double>(c.time_base().hold_state(s.now_ms));
    case ElementId::kCoordTimeBase: return std::abs(c.path_rate(s.now_ms)) * s.period_ms();
    case ElementId::kCoordDesTimeBase: return c.time_base().override_rate() * s.period_ms();
    case ElementId::kCoordSegEnabled: return s.elements.get(ElementId::kCoordSegMoveTime, a.index[0]) > 0;
    case ElementId::kCoordLookAheadActive:
      return c.lookahead_buffer > 0 && s.elements.get(ElementId::kCoordLHDistance, a.index[0]) > 1 &&
             s.elements.get(ElementId::kCoordSegMoveTime, a.index[0]) > 0;
    case ElementId::kCoordLookAheadStop: return c.quick_stopped();
    case ElementId::kCoordLookAheadDir: return c.runs_backwards();
    case ElementId::kCoordCCMode: return c.modal.compensation_side;
    case ElementId::kCoordMoveMode: return static_cast<double>(c.modal.mode);
    case ElementId::kCoordPlusLimit: return any_motor(s, c, ElementId::kMotorPlusLimit);
    case ElementId::kCoordMinusLimit: return any_motor(s, c, ElementId::kMotorMinusLimit);
    case ElementId::kCoordFeFatal: return any_motor(s, c, ElementId::kMotorFeFatal);
    case ElementId::kCoordFeWarn: return any_motor(s, c, ElementId::kMotorFeWarn);
    case ElementId::kCoordAmpFault: return any_motor(s, c, ElementId::kMotorAmpFault);
    case ElementId::kCoordLimitStop: return any_motor(s, c, ElementId::kMotorLimitStop);
    case ElementId::kCoordSoftLimit: return any_motor(s, c, ElementId::kMotorSoftLimit);
    case ElementId::kCoordSoftPlusLimit: return any_motor(s, c, ElementId::kMotorSoftPlusLimit);
    case ElementId::kCoordSoftMinusLimit: return any_motor(s, c, ElementId::kMotorSoftMinusLimit);
    case ElementId::kCoordNumMotors: return static_cast<double>(c.motors().size());
    case ElementId::kCoordDesPos: return c.commanded_position(s.now_ms)[a.index[1]];
    case ElementId::kCoordCdPos: return c.calculated_position()[a.index[1]];
    case ElementId::kCoordQ: return c.q[a.index[1]];
    default: return s.elements.get(a);
  }
}

bool belongs_to(ElementId id, ElementId first, ElementId last) { return id >= first && id <= last; }

/// Triggers, limits and faults of a coordinate system: those of any of its motors.
struct AnyMotorRow { ElementId coord, motor; };
constexpr AnyMotorRow kAnyMotor[] = {
#define MOTOR_STATUS(bit, width, name)
#define COORD_STATUS(bit, width, name)
#define ANY_MOTOR_STATUS(bit, name) {ElementId::kCoord##name, ElementId::kMotor##name},
#define SYS_STATUS(bit, width, name)
#include "runtime/status_bit.def"
};

}  // namespace

double read_element_value(Machine::State& s, Runner& runner, const ElementAddress& a) {
  switch (a.id) {
    case ElementId::kSysTime:
    case ElementId::kSysRunTime: return s.now_ms / 1000.0;
    case ElementId::kSysServoCount: return static_cast<double>(std::max<std::int64_t>(s.tick, 0));
    case ElementId::kSysCdTimer: return std::max(0.0, s.elements.get(a) - s.now_ms);  // stored as the time at which it is 0
    case ElementId::kSysP: return s.p[a.index[0]];
    case ElementId::kSysCdata: return s.io.user().read<std::int8_t>(a.index[0]);
    case ElementId::kSysIdata: return s.io.user().read<std::int32_t>(4 * a.index[0]);
    case ElementId::kSysUdata: return s.io.user().read<std::uint32_t>(4 * a.index[0]);
    case ElementId::kSysFdata: return s.io.user().read<float>(4 * a.index[0]);
    case ElementId::kSysDdata: return s.io.user().read<double>(8 * a.index[0]);
    case ElementId::kLdataCoord: return runner.thread.coord;
    case ElementId::kLdataMotor: return runner.thread.motor;
    case ElementId::kLdataGoBack: return runner.thread.go_back;
    case ElementId::kLdataCmdStatus: return runner.thread.command_status;
    case ElementId::kLdataStatus: return runner.kind == RunnerKind::kKinematics && !runner.for_query ? 0x40 : 0;
    case ElementId::kGatherEnable: return s.gather.enable();
    case ElementId::kCoordLHSize: return s.coord(static_cast<int>(a.index[0])).lookahead_buffer;
    case ElementId::kGatherSamples: return static_cast<double>(s.gather.samples());
    case ElementId::kPlcActive: return s.plcs[a.index[0]].active;
    case ElementId::kPlcRunning: return s.plcs[a.index[0]].running;
    default: break;
  }
  if (bytecode::element_info(a.id).type == bytecode::ElementType::kSymbol) return encode_address(a);  // Sys.pushm is where it is
  if (belongs_to(a.id, ElementId::kMotorServoCtrl, ElementId::kMotorCoord)) return motor_value(s, a.id, s.motors[a.index[0]]);
  if (belongs_to(a.id, ElementId::kCoordTa, ElementId::kCoordCdPos)) return coord_value(s, a);
  for (const AnyMotorRow& row : kAnyMotor)
    if (row.coord == a.id) return any_motor(s, s.coord(static_cast<int>(a.index[0])), row.motor);
  return s.elements.get(a);
}

}  // namespace pmac::runtime
