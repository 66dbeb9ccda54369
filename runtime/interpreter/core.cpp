// The dispatch loop. Code has been verified, so registers, tables and targets are used without looking. With GCC and Clang
// every instruction ends in its own indirect jump (labels as values), elsewhere the same bodies are the cases of a switch.
//
// The loop exists twice: once plain, once telling a watcher of every instruction.
//
// Instructions are counted where control leaves a straight run of them: the run began at `run_start`, so a jump taken at pc
// has executed pc + 1 - run_start instructions. The budget is looked at on backward jumps, calls and returns.
#include "runtime/interpreter/core.h"

#include <cmath>

#include "compiler/bytecode/function.h"
#include "compiler/bytecode/letters.h"
#include "compiler/bytecode/opcode.h"
#include "compiler/bytecode/operators.h"
#include "runtime/interpreter/fuse.h"

#if defined(__GNUC__) && !defined(PMAC_SWITCH_DISPATCH)
#define PMAC_COMPUTED_GOTO 1
#pragma GCC diagnostic ignored "-Wpedantic"
#else
#define PMAC_COMPUTED_GOTO 0
#endif

namespace pmac::runtime {

using bytecode::Opcode;

namespace {
constexpr unsigned kLetterF = 6;
}

RunResult InterpreterCore::run() {
  if (!thread_.active()) return {};
  const std::int64_t before = budget_;
  if (watcher_) {
    dispatch<true>();
    watcher_->after_run(thread_, thread_.active() ? std::span<const double>(registers(), register_count()) : std::span<const double>());
  } else {
    dispatch<false>();
  }
  result_.instructions = static_cast<std::uint64_t>(before - budget_);
  return std::move(result_);
}

/// Where run_line() has put a jump to itself, the line has not begun.
void InterpreterCore::watch(const Instruction& in, std::uint32_t pc) {
  const bool waits_here = thread_.one_line_ && in.op == Opcode::kLoop && in.imm == static_cast<std::int32_t>(pc);
  if (!waits_here) watcher_->before(thread_, pc, {registers(), register_count()});
}

InterpreterCore::Next InterpreterCore::end_program() {
  thread_.stop();
  end(RunStop::kEnded);
  return Next::kLeave;
}

InterpreterCore::Next InterpreterCore::fault(std::string detail) {
  return raise({FaultKind::kRunTime, thread_.source(), std::move(detail)});
}

InterpreterCore::Next InterpreterCore::raise(Fault fault) {
  if (fault.source == bytecode::SourceLine{}) fault.source = thread_.source();
  thread_.host_fault_.reset();
  thread_.stop();
  result_.fault = std::move(fault);
  end(RunStop::kFault);
  return Next::kLeave;
}

bool InterpreterCore::host_failed() {
  if (!thread_.host_fault_) return false;
  raise(std::move(*thread_.host_fault_));
  return true;
}

InterpreterCore::Next InterpreterCore::after(Flow flow) {
  if (host_failed()) return Next::kLeave;
  if (!thread_.active() || flow == Flow::kStop) return end_program();
  if (flow == Flow::kFault) return fault("the statement failed");
  if (flow == Flow::kContinue) return Next::kContinue;
  ++thread_.pc_;
  stand_at_next_row();
  end(RunStop::kSuspended);
  return Next::kLeave;
}

// Macros of the loop. ENTER takes place and window from the thread, SAVE stores the place for members and host.
#define ENTER()                                                       \
  do {                                                                \
    code = program().code.data();                                     \
    constants = thread_.program_.module->constants.data();            \
    r = registers();                                                  \
    pc = code + thread_.pc_;                                          \
    run_start = pc;                                                   \
  } while (false)
#define SAVE() (thread_.pc_ = static_cast<std::uint32_t>(pc - code))
#define COUNT_RUN() (budget -= pc + 1 - run_start)
#define LEAVE()        \
  do {                 \
    budget_ = budget;  \
    return;            \
  } while (false)
#define STOP_HERE(why) \
  do {                 \
    SAVE();            \
    end(why);          \
    LEAVE();           \
  } while (false)
#define JUMP()                \
  do {                        \
    COUNT_RUN();              \
    pc = code + pc->imm;      \
    run_start = pc;           \
    DISPATCH();               \
  } while (false)
#define AFTER_JUMP_BACK()                                                             \
  do {                                                                                \
    run_start = pc;                                                                   \
    if (++thread_.jump_backs_ >= jump_back_limit_) STOP_HERE(RunStop::kJumpBack);     \
    if (budget <= 0) STOP_HERE(RunStop::kBudget);                                     \
    DISPATCH();                                                                       \
  } while (false)
#define JUMP_BACK()       \
  do {                    \
    COUNT_RUN();          \
    pc = code + pc->imm;  \
    AFTER_JUMP_BACK();    \
  } while (false)
#define LEAVE_UNLESS(worked)       \
  do {                             \
    if (!(worked)) {               \
      COUNT_RUN();                 \
      LEAVE();                     \
    }                              \
    q = thread_.q;                 \
    NEXT();                        \
  } while (false)
#define CALL_MEMBER(expression)                      \
  do {                                               \
    SAVE();                                          \
    COUNT_RUN();                                     \
    if ((expression) == Next::kLeave) LEAVE();       \
    ENTER();                                         \
    if (budget <= 0) STOP_HERE(RunStop::kBudget);    \
    DISPATCH();                                      \
  } while (false)
#define HOST(expression)                                                    \
  do {                                                                      \
    SAVE();                                                                 \
    LEAVE_UNLESS(after(expression) == Next::kContinue);                     \
  } while (false)
#define RB r[pc->b()]
#define RC r[pc->c()]
#define BINARY(Name, expression) \
  OP(Name) : {                   \
    const double left = RB;      \
    const double right = RC;     \
    r[pc->a] = (expression);     \
    NEXT();                      \
  }
#define SPAN std::span<const double>(r, register_count())
#define WATCH()                                                             \
  do {                                                                      \
    if constexpr (kWatched) watch(*pc, static_cast<std::uint32_t>(pc - code)); \
  } while (false)
#define MOTION(Name) OP(Name) : HOST(host_.motion(thread_, *pc, SPAN))
#define ONLINE(Name) OP(Name) : HOST(host_.online(thread_, *thread_.program_.module, *pc, SPAN))

template <bool kWatched>
void InterpreterCore::dispatch() {
  const Instruction* code = nullptr;
  const Instruction* pc = nullptr;
  const Instruction* run_start = nullptr;
  const double* constants = nullptr;
  double* r = nullptr;
  double* const p = thread_.p;
  double* q = thread_.q;
  std::int64_t budget = budget_;
  std::uint32_t label_pc = 0;
  ENTER();
  if (budget <= 0) STOP_HERE(RunStop::kBudget);

#if PMAC_COMPUTED_GOTO
  static const void* const kBodies[] = {
#define OPCODE(Name, text, format, meaning) &&body_##Name,
#include "compiler/bytecode/opcode.def"
#undef OPCODE
#define FUSED2(loads, A, B) &&body_##A##B,
#define FUSED3(loads, A, B, C) &&body_##A##B##C,
#define FUSED4(loads, A, B, C, D) &&body_##A##B##C##D,
#include "runtime/interpreter/fused.def"
#undef FUSED2
#undef FUSED3
#undef FUSED4
  };
#define OP(Name) body_##Name
#define FUSED_OP(Name) body_##Name
#define DISPATCH()                                                \
  do {                                                            \
    WATCH();                                                      \
    goto* kBodies[static_cast<std::size_t>(pc->op)];              \
  } while (false)
#define NEXT()  \
  do {          \
    ++pc;       \
    DISPATCH(); \
  } while (false)
  DISPATCH();
#else
#define OP(Name) case static_cast<unsigned>(Opcode::k##Name)
#define FUSED_OP(Name) case static_cast<unsigned>(FusedOpcode::k##Name)
#define DISPATCH() goto dispatch_next
#define NEXT()  \
  do {          \
    ++pc;       \
    DISPATCH(); \
  } while (false)
dispatch_next:
  WATCH();
  switch (static_cast<unsigned>(pc->op)) {
#endif

  OP(Nop) : NEXT();
  OP(LoadConst) : r[pc->a] = constants[pc->imm]; NEXT();
  OP(LoadInt) : r[pc->a] = pc->imm; NEXT();
  OP(Move) : r[pc->a] = RB; NEXT();
  OP(LoadP) : r[pc->a] = p[pc->imm]; NEXT();
  OP(StoreP) : p[pc->imm] = r[pc->a]; NEXT();
  OP(LoadQ) : r[pc->a] = q[pc->imm]; NEXT();
  OP(StoreQ) : q[pc->imm] = r[pc->a]; NEXT();
  OP(LoadM) : SAVE(); r[pc->a] = host_.read_m(thread_, pc->imm); LEAVE_UNLESS(!host_failed());
  OP(StoreM) : SAVE(); host_.write_m(thread_, pc->imm, r[pc->a]); LEAVE_UNLESS(!host_failed());
  OP(LoadI) : SAVE(); r[pc->a] = host_.read_i(thread_, pc->imm); LEAVE_UNLESS(!host_failed());
  OP(StoreI) : SAVE(); host_.write_i(thread_, pc->imm, r[pc->a]); LEAVE_UNLESS(!host_failed());
  OP(LoadC) : r[pc->a] = thread_.c[static_cast<std::size_t>(pc->imm)]; NEXT();
  OP(StoreC) : thread_.c[static_cast<std::size_t>(pc->imm)] = r[pc->a]; NEXT();
  OP(LoadD) : r[pc->a] = thread_.d[static_cast<std::size_t>(pc->imm)]; NEXT();
  OP(StoreD) : thread_.d[static_cast<std::size_t>(pc->imm)] = r[pc->a]; NEXT();
  OP(LoadIndexed) : SAVE(); LEAVE_UNLESS(load_indexed(*pc, r));
  OP(StoreIndexed) : SAVE(); LEAVE_UNLESS(store_indexed(*pc, r));
  OP(LoadElement) : SAVE(); LEAVE_UNLESS(load_element(*pc, r));
  OP(StoreElement) : SAVE(); LEAVE_UNLESS(store_element(*pc, r) == Next::kContinue);

  BINARY(Add, left + right)
  BINARY(Sub, left - right)
  BINARY(Mul, left * right)
  BINARY(Div, left / right)
  BINARY(Mod, bytecode::modulo(left, right))
  BINARY(BitAnd, bytecode::bit_and(left, right))
  BINARY(BitOr, bytecode::bit_or(left, right))
  BINARY(BitXor, bytecode::bit_xor(left, right))
  BINARY(ShiftLeft, bytecode::shift_left(left, right))
  BINARY(ShiftRight, bytecode::shift_right(left, right))
  BINARY(Equal, left == right ? 1.0 : 0.0)
  BINARY(NotEqual, left != right ? 1.0 : 0.0)
  BINARY(Less, left < right ? 1.0 : 0.0)
  BINARY(LessEqual, left <= right ? 1.0 : 0.0)
  BINARY(Near, bytecode::is_near(left, right) ? 1.0 : 0.0)
  OP(Neg) : r[pc->a] = -RB; NEXT();
  OP(BitNot) : r[pc->a] = bytecode::bit_not(RB); NEXT();
  OP(LogicalNot) : r[pc->a] = RB == 0.0 ? 1.0 : 0.0; NEXT();
  OP(Function) : {
    const auto function = static_cast<bytecode::Function>(pc->b());
    const auto count = static_cast<std::size_t>(bytecode::function_info(function).argument_count);
    r[pc->a] = apply_function(function, {&RC, count}, host_);
    NEXT();
  }
  OP(LoadAddress) : SAVE(); LEAVE_UNLESS(load_address(*pc, r));
  OP(LimitAddress) : limit_address(*pc, r); NEXT();
  OP(LoadByteAddress) : SAVE(); LEAVE_UNLESS(load_byte_address(*pc, r));
  OP(LoadText) : load_text(*pc, r); NEXT();
  OP(FormatValue) : SAVE(); LEAVE_UNLESS(add_format_value(r[pc->a]));
  OP(MemoryFunction) : SAVE(); LEAVE_UNLESS(memory_function(*pc, r, budget));

  OP(Jump) : JUMP();
  OP(JumpIfTrue) : if (r[pc->a] != 0.0) JUMP(); NEXT();
  OP(JumpIfFalse) : if (r[pc->a] == 0.0) JUMP(); NEXT();
  OP(Loop) : JUMP_BACK();
  OP(LoopIfTrue) : if (r[pc->a] != 0.0) JUMP_BACK(); NEXT();
  OP(GotoLabel) : {
    SAVE();
    COUNT_RUN();
    if (!find_label(r[pc->a], label_pc)) LEAVE();
    const bool is_back = code + label_pc <= pc;
    pc = code + label_pc;
    run_start = pc;
    if (is_back) AFTER_JUMP_BACK();
    DISPATCH();
  }
  OP(Gosub) : CALL_MEMBER(gosub(static_cast<std::uint32_t>(pc->imm)));
  OP(GosubLabel) : CALL_MEMBER(find_label(r[pc->a], label_pc) ? gosub(label_pc) : Next::kLeave);
  OP(Callsub) : CALL_MEMBER(callsub(static_cast<std::uint32_t>(pc->imm)));
  OP(CallsubLabel) : CALL_MEMBER(find_label(r[pc->a], label_pc) ? callsub(label_pc) : Next::kLeave);
  OP(Call) : CALL_MEMBER(call_constant(*pc));
  OP(CallComputed) : CALL_MEMBER(call_computed(r[pc->a]));
  OP(Return) : CALL_MEMBER(return_from_routine());
  OP(Stop) : CALL_MEMBER(end_program());
  OP(ScanLoop) : {
    if (!thread_.ends_scans) NEXT();
    COUNT_RUN();
    pc = code + pc->imm;
    STOP_HERE(RunStop::kJumpBack);
  }
  OP(LineBegin) : thread_.line_.resize(thread_.line_begin_); NEXT();
  OP(LineWord) : set_line_word(*pc, r[pc->a]); NEXT();
  OP(LineEnd) : thread_.line_.resize(thread_.line_begin_); NEXT();
  OP(JumpIfTaken) : if (is_taken(pc->a)) JUMP(); NEXT();
  OP(RequireTaken) : SAVE(); LEAVE_UNLESS(require_taken(pc->a) == Next::kContinue);
  OP(CallCode) : CALL_MEMBER(call_code(pc->b(), r[pc->a], pc->c()));
  OP(Read) : read_words(constants[pc->imm]); NEXT();
  OP(FlagTest) : SAVE(); LEAVE_UNLESS(test_flag(*pc, r));
  OP(FlagSet) : SAVE(); LEAVE_UNLESS(change_flag(r[pc->a], true) == Next::kContinue);
  OP(FlagClear) : SAVE(); LEAVE_UNLESS(change_flag(r[pc->a], false) == Next::kContinue);
  OP(CycleDefine) : SAVE(); LEAVE_UNLESS(define_cycle(r[pc->a]) == Next::kContinue);
  OP(CycleUndefine) : thread_.cycle_.armed = false; NEXT();
  OP(CycleCall) : CALL_MEMBER(call_cycle());
  OP(SyncStore) : SAVE(); LEAVE_UNLESS(sync_store(*pc, r) == Next::kContinue);

  MOTION(SetMode);
  MOTION(SetAbs);
  MOTION(SetInc);
  MOTION(SetFrax);
  MOTION(ClearFrax);
  MOTION(SetNormal);
  OP(SetMotion) : {
    const bool is_feed = pc->b() == static_cast<unsigned>(bytecode::MotionParameter::kFeed);
    SAVE();
    if (is_feed && dispatches_feed()) CALL_MEMBER(call_code(kLetterF, r[pc->a], bytecode::kMaxLineWords));
    HOST(host_.motion(thread_, *pc, SPAN));
  }
  OP(AxisWord) : {
    if (thread_.cycle_.armed && thread_.code_depth_ == 0) {
      SAVE();
      LEAVE_UNLESS(collect_cycle_word(*pc, r[pc->a]) == Next::kContinue);
    }
    HOST(host_.motion(thread_, *pc, SPAN));
  }
  OP(RowWords) : SAVE(); LEAVE_UNLESS(put_row(*pc, r) == Next::kContinue);
  OP(RowLoop) : {
    if (r[pc->a] == 0.0) NEXT();
    COUNT_RUN();
    pc = code + pc->imm;
    run_start = pc;
    if (budget <= 0) STOP_HERE(RunStop::kBudget);
    DISPATCH();
  }
  OP(BlockEnd) : {
    if (in_cycle_block()) CALL_MEMBER(end_cycle_block());
    HOST(host_.motion(thread_, *pc, SPAN));
  }
  MOTION(Dwell);
  MOTION(Delay);
  MOTION(StepBegin);
  MOTION(StepEnd);
  OP(Control) : HOST(host_.control(thread_, static_cast<bytecode::ControlVerb>(pc->a), {r + pc->b(), pc->c()}));
  OP(Card) : HOST(host_.card(thread_, static_cast<bytecode::CardVerb>(pc->a), {r + pc->b(), pc->c()}));
  OP(RelayTest) : SAVE(); r[pc->a] = host_.relay(thread_, RB); LEAVE_UNLESS(!host_failed());
  OP(Command) : SAVE(); LEAVE_UNLESS(put_out(*pc) == Next::kContinue);
  OP(Send) : SAVE(); LEAVE_UNLESS(put_out(*pc) == Next::kContinue);
  ONLINE(AddressCoord);
  ONLINE(AddressMotor);
  ONLINE(DefineAxis);
  ONLINE(DefinePointer);
  ONLINE(InstallProgram);
  ONLINE(ReportElement);
  ONLINE(SystemCommand);
  ONLINE(ExecuteProgram);
  ONLINE(Report);

#include "runtime/interpreter/core_fused.inc"

#if !PMAC_COMPUTED_GOTO
  }
#endif
}

}  // namespace pmac::runtime
