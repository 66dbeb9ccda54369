// Executes verified bytecode. One Thread is one running program: a motion program, a PLC, a kinematic routine or an on-line
// command line. run() executes a bounded number of instructions and says why it stopped; everything outside the thread's own
// registers and the P, Q and D arrays goes through Host, so that the interpreter knows nothing of motion or cards.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "runtime/fault.h"

namespace pmac::runtime {

/// A program of a loaded module; keeps the module alive.
struct ProgramHandle {
  std::shared_ptr<const bytecode::Module> module;
  const bytecode::Program* program = nullptr;
  explicit operator bool() const { return program != nullptr; }
};

/// An element with its indices evaluated.
struct ElementAddress {
  bytecode::ElementId id{};
  std::array<std::uint32_t, bytecode::kMaxElementIndices> index{};
  bool operator==(const ElementAddress&) const = default;
};

class Thread;

/// What a motion or control instruction tells the interpreter to do next.
enum class Flow {
  kContinue,   // go on with the next instruction
  kSuspend,    // stop here; the next run() continues with the next instruction
  kStop,       // end the program (abort)
  kFault,      // host_fault() of the thread says why
};

/// Looks on while programs execute (--trace). Runs of threads nest: a move line may run a kinematic routine.
class InstructionWatcher {
 public:
  virtual ~InstructionWatcher() = default;
  /// Before an instruction of thread.program() executes. registers: the frame with its outgoing arguments.
  virtual void before(const Thread& thread, std::uint32_t pc, std::span<const double> registers) = 0;
  /// After the last one of a run. registers: empty where the program has ended.
  virtual void after_run(const Thread& thread, std::span<const double> registers) = 0;
};

/// Everything that a program reaches outside its own registers.
class Host {
 public:
  virtual ~Host() = default;
  /// Who looks on, or nullptr; asked once a run. Programs that are watched must not be fused (fuse.h).
  virtual InstructionWatcher* watcher() { return nullptr; }
  virtual double read_m(Thread&, int number) = 0;
  virtual void write_m(Thread&, int number, double value) = 0;
  virtual double read_i(Thread&, int number) = 0;
  virtual void write_i(Thread&, int number, double value) = 0;
  /// Indices are in range when called. Faults are set with Thread::set_host_fault and answered as 0.
  virtual double read_element(Thread&, const ElementAddress&) = 0;
  virtual Flow write_element(Thread&, const ElementAddress&, double value) = 0;
  /// Number that stands for the address of an element (Element.a).
  virtual double element_address(Thread&, const ElementAddress&) = 0;
  /// SetMode .. Delay. registers: the frame, so that r[a] is registers[a].
  virtual Flow motion(Thread&, const bytecode::Instruction&, std::span<const double> registers) = 0;
  /// The words of a row of plain moves, as so many AxisWord statements. words: bytecode::move_word_code(), one for each of the values.
  virtual Flow move_words(Thread&, std::span<const std::uint8_t> words, std::span<const double> values);
  virtual Flow control(Thread&, bytecode::ControlVerb, std::span<const double> arguments) = 0;
  /// A synchronous assignment with its number or element resolved and its right side evaluated.
  virtual Flow queue_assignment(Thread&, const bytecode::SyncTarget& resolved, const ElementAddress& element, double value) = 0;
  virtual ProgramHandle find_subprogram(std::uint32_t number) = 0;
  virtual Flow command(Thread&, std::string_view text) = 0;
  virtual Flow send(Thread&, int port, std::string_view text) = 0;
  /// What a program of an ACR1000 asks of its card. A host that is no card refuses it with a fault.
  virtual Flow card(Thread&, bytecode::CardVerb, std::span<const double> arguments);
  /// 1 where the relay of a card is set, else 0; as above.
  virtual double relay(Thread&, double number);
  virtual double random(double range) = 0;
  virtual void seed_random(double seed) = 0;
  /// AddressCoord .. Report of load scripts. registers as for motion().
  virtual Flow online(Thread&, const bytecode::Module&, const bytecode::Instruction&, std::span<const double> registers) = 0;
};

enum class RunStop {
  kBudget,      // the instruction budget is used up; call again
  kSuspended,   // Flow::kSuspend
  kJumpBack,    // the jump-back limit was reached: the jump has been made, call again for the next pass
  kEnded,       // return at top level, stop, or Flow::kStop
  kFault,
};

struct RunResult {
  RunStop stop = RunStop::kEnded;
  std::uint64_t instructions = 0;
  std::optional<Fault> fault;
};

class Thread {
 public:
  /// p: kPCount doubles shared by all threads; q: kQCount doubles of the thread's coordinate system.
  Thread(double* p, double* q);

  /// Stands at the top (or at label number `label`, if >= 0) of the program with all locals 0. False: no such label, then at the top.
  bool begin(ProgramHandle program, std::int64_t label = -1);
  /// Stands at the top of top_program() again; locals keep their values (the next scan of a PLC). False: nothing was begun.
  bool restart();
  /// As begin(), but what is modal goes on: the canned cycle of cdef, D variables. For the next lines of a rotary buffer.
  void go_on_with(ProgramHandle program);
  /// The program ended by coming to its end, not by stop or abort.
  bool came_to_end() const { return came_to_end_; }
  /// Runs until something of RunStop happens. jump_back_limit: stop after this many backward jumps since the last call of
  /// reset_jump_backs(); <= 0: never.
  RunResult run(Host& host, std::uint64_t instruction_budget, std::int64_t jump_back_limit);

  /// Executes the rest of a source line: stops where another line begins, or as run() does at a backward jump. What the line calls in
  /// other modules is executed up to its first backward jump.
  RunResult run_line(Host& host, std::uint64_t instruction_budget);

  void reset_jump_backs() { jump_backs_ = 0; }
  /// True from begin() until the program has ended or failed. Locals of the top frame stay readable after the end.
  bool active() const { return static_cast<bool>(program_); }
  void stop() { program_ = {}; frames_.clear(); base_ = 0; forget_lines(); format_values_.clear(); }

  const ProgramHandle& program() const { return program_; }     // the buffer that executes now (a called subprogram too)
  const ProgramHandle& top_program() const { return top_; }      // the buffer that was begun
  bytecode::SourceLine source() const;                           // of the instruction being executed, or about to be

  /// L(i) and R(i) of the frame on top; bounds are the caller's business (i < local_count, i < outgoing_count).
  double& local(int i);
  double& outgoing(int i);
  std::array<double, bytecode::kCCount> c{};
  std::array<double, bytecode::kDCount> d{};

  double* p = nullptr;
  double* q = nullptr;
  int coord = 0;          // Ldata.Coord
  int motor = 0;          // Ldata.Motor
  int go_back = 10;       // Ldata.GoBack
  int command_status = 0; // Ldata.CmdStatus
  int own_coord = -1;     // coordinate system that executes this motion program; -1: none, coord is meant instead
  bool ends_scans = false;// a PLC program: ScanLoop ends the scan
  void* context = nullptr;// for the host's use

  /// Routines that have been called and have not returned.
  std::size_t call_depth() const { return frames_.size(); }
  /// The row of a move run that the thread stands before, in the loop over its rows; no canned cycle waits for its words.
  struct RowPlace { const bytecode::MoveRun* run; std::size_t row; };
  std::optional<RowPlace> at_row() const;
  /// Standing there, it goes on with this row of the same run.
  void stand_at_row(std::size_t row);
  /// Number in its buffer of the instruction being executed, or about to be.
  std::uint32_t pc() const { return pc_; }

  int executing_coord() const { return own_coord >= 0 ? own_coord : coord; }

  void set_host_fault(Fault fault) { host_fault_ = std::move(fault); }

 private:
  friend class InterpreterCore;
  bool stand_at_top(std::int64_t label);
  std::optional<bytecode::SourceLine> row_source() const;
  void replace_module(const std::shared_ptr<const bytecode::Module>& from, const std::shared_ptr<const bytecode::Module>& by);

  ProgramHandle program_, top_;
  std::vector<double> stack_;
  std::size_t base_ = 0;
  std::uint32_t pc_ = 0;
  bool came_to_end_ = false;
  std::int64_t jump_backs_ = 0;
  bool one_line_ = false;               // run_line() is at work
  std::optional<Fault> host_fault_;
  std::vector<double> format_values_;   // of the next text with a format

  /// A letter-number word of the line that a frame executes.
  struct LineWord { double value = 0; std::uint8_t letter = 0; bool taken = false; };
  /// What a frame is called by: letter is that of a code, kCycle for a canned cycle, 0 else. Words first_word .. end_word of line_
  /// are what the called routine can read.
  struct SavedFrame {
    ProgramHandle program;
    std::uint32_t return_pc;
    std::size_t base;
    std::size_t line_begin, first_word, end_word;
    std::uint8_t letter;
  };
  /// The modal call of cdef. words: given with cdef. block: words of the move block that is being collected for it.
  struct Cycle {
    struct BlockWord { std::uint16_t index; std::uint16_t kind; double value; };
    bool armed = false, called = false;
    double target = 0;
    std::vector<LineWord> words;
    std::vector<BlockWord> block;
    std::size_t first_word = 0, first_block = 0;  // in line_: words that the called cycle can read, and those of them that are not from cdef
  };
  static constexpr std::uint8_t kCycle = 255;

  void forget_lines();

  std::vector<SavedFrame> frames_;
  std::vector<LineWord> line_;    // lines of all frames, the running frame's last
  std::size_t line_begin_ = 0;    // where the running frame's line begins
  int code_depth_ = 0;            // frames that a code letter or a canned cycle has called
  Cycle cycle_;
};

/// Evaluates a scalar function. Domain errors give nan.
double apply_function(bytecode::Function function, std::span<const double> arguments, Host& host);

}  // namespace pmac::runtime
