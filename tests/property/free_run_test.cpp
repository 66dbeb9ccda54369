// A run with free runs (runtime/free_run.h) and the same run event by event must not differ in anything that comes out: samples bit by
// bit, extremes, moves, outputs, faults and answers in their order, the end. Programs and what is done to them while they run are random.
#include <catch2/catch.hpp>

#include <cstdlib>
#include <random>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compiler/compiler.h"
#include "runtime/machine.h"

using namespace pmac;

namespace {

/// Random motion programs, and commands at random times.
class ScriptMaker {
 public:
  explicit ScriptMaker(std::uint32_t seed) : random_(seed) {}

  std::string set_up() {
    static const char* const kModes[] = {"Coord[{}].SegMoveTime=0\n", "Coord[{}].SegMoveTime=2\n", "Coord[{}].SegMoveTime=5\n",
                                         "Coord[{0}].SegMoveTime=5\nCoord[{0}].LHDistance=20\ndefine lookahead 20\n",
                                         "Coord[{0}].SegMoveTime=3\nCoord[{0}].LHDistance=30\ndefine lookahead 900\n"};
    std::string text = "&1\n#1->100X\n#2->50Y+50X\n#3->200Z\n&2\n#4->100X\n#5->100Y\n&0\n#6->0\n";
    for (int c = 1; c <= 2; ++c) text += fmt::format("&{}\n", c) + fmt::format(fmt::runtime(kModes[below(5)]), c);
    text += "Motor[6].JogSpeed=20\n";
    return text + "open plc 1\nP40=P40+1\nif (Motor[1].DesPos > 500) P41=P41+1\nclose\nopen plc 7\nP42=P42+Motor[2].ActPos\nclose\n"
                  "open plc 8\nif (P40 > 20) { cmd\"#6j:100\" disable plc 8 }\nclose\n";
  }

  std::string program(int number, int statements) {
    std::string text = fmt::format("open prog {}\nlinear abs ta{} ts{} F{}\nX0 Y0\n", number, below(3) * 5, below(3) * 2, 5 + below(60));
    for (int i = 0; i < statements; ++i) text += statement();
    return text + "close\n";
  }

  /// Time in ms and command.
  std::vector<std::pair<double, std::string>> commands() {
    static const char* const kCommands[] = {"&1 h", "&1 r", "&1 %50", "&1 %100", "&1 a", "&2 h", "&2 r", "&2 a", "&2 b2r", "&1 b1r", "enable plc 1", "disable plc 1", "#6 j:300", "#6 j/",
                                            "&1 \\", "&1 q", "&1 s", "P1", "&1p", "#1p", "#2v", "&1 <", "&1 >", "enable plc 7", "disable plc 7", "P9=1", "#3k", "#3j/", "Gather.Enable=2", "Gather.Enable=0"};
    std::vector<std::pair<double, std::string>> list{{0, "&1 b1r"}};
    if (below(2) == 0) list.emplace_back(below(3) == 0 ? 0.0 : 13.7, "&2 b2r");
    for (int i = below(6); i > 0; --i) list.emplace_back(below(4) == 0 ? 100 : 0.37 * below(6000), kCommands[below(std::size(kCommands))]);
    return list;
  }

 private:
  int below(std::size_t n) { return static_cast<int>(random_() % n); }

  std::string moves(int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += fmt::format("X{:.3f} Y{:.3f}{}\n", 0.1 * below(100), 0.05 * below(200), below(3) == 0 ? fmt::format(" Z{:.2f}", 0.1 * below(20)) : "");
    return text;
  }

  std::string statement() {
    static const char* const kOthers[] = {"dwell 3\n", "delay 7.5\n", "dwell 0\n", "P1=Motor[1].DesPos\n", "P2=P2+Coord[1].Ta\n", "P3==P3+1\n", "F40\n", "F8\n", "ta4\n", "enable plc 1\n", "disable plc 1\n",
                                          "enable plc 8\n", "cmd\"P5=P5+1\"\n", "rapid X3 Y4\nlinear\n", "inc\nX1 Y-1\nabs\n", "circle1 X2 Y2 R5\nlinear\n", "P4=P4+1\n", "M1==P1\n",
                                          "if (P9 > 0) X1 Y1\n", "Coord[1].NoBlend=1\n", "Coord[1].NoBlend=0\n", "send 0 \"here %f\",P4\n", "cmd\"&2b2r\"\n", "P6=Sys.Time\n", "cmd\"#6j+\"\n", "cmd\"#6j/\"\n",
                                          "pause\n", "Q5=Q5+1\n", "while (P7 < 20)\n{\nX(P7*0.01) Y(P7 % 3)\nP7=P7+1\n}\nP7=0\n", "P8=0\nwhile (P8 < 3)\n{\nP8=P8+1\n}\n", "X(1/P20)\n"};
    if (below(3) != 0) return moves(1 + below(40));
    for (;;) {
      const std::string line = kOthers[below(std::size(kOthers))];
      const bool rare = line == "X(1/P20)\n" || line == "pause\n";
      if (!rare || below(12) == 0) return line;
    }
  }

  std::mt19937 random_;
};

struct Ran {
  std::vector<double> samples;            // of all motors of a tick, after its number
  std::vector<std::string> log;
};

/// Every tick by itself, so that the sizes of blocks make no difference.
struct Trace : runtime::SampleSink {
  std::vector<double>& samples;
  explicit Trace(std::vector<double>& to) : samples(to) {}
  void take(const runtime::SampleBlock& block) override {
    for (int k = 0; k < block.count; ++k) {
      samples.push_back(static_cast<double>(block.first_tick + k));
      for (std::size_t m = 0; m < block.motors.size(); ++m) samples.insert(samples.end(), {block.at(static_cast<int>(m), k), block.actual_at(static_cast<int>(m), k)});
    }
  }
};

Ran run(const std::string& text, const std::vector<std::pair<double, std::string>>& commands, bool free_runs, bool seen) {
  compiler::Session session;
  auto module = session.compile({{"random.pmc", text}});
  std::string problems;
  for (const auto& d : session.diagnostics().take())
    if (d.severity == source::Severity::kError) problems += fmt::format("{}: {}\n", session.sources().place(d.span).line, d.message);
  INFO(problems << text);
  REQUIRE(module);
  Ran ran;
  runtime::MachineOptions options;
  options.free_runs = free_runs;
  options.max_instructions = 3'000'000;
  options.compile_online = [&](std::string_view line, std::string_view name) -> std::variant<bytecode::Module, std::string> {
    auto online = session.compile_online(line, name);
    for (const auto& d : session.diagnostics().take())
      if (d.severity == source::Severity::kError) return d.message;
    if (!online) return std::string("refused");
    return std::move(*online);
  };
  const auto note = [&ran](std::string line) { ran.log.push_back(std::move(line)); };
  options.observers.move = [&](const runtime::MoveRecord& m) { note(fmt::format("move {} &{} #{} {} {} {} {}", m.mode, m.coord, m.motor, m.source.line, m.start_ms, m.end_ms, m.length)); };
  options.observers.fault = [&](const runtime::FaultRecord& f) { note(fmt::format("fault {} {} {}", f.time_ms, f.coord, f.fault.detail)); };
  options.observers.output = [&](const runtime::OutputChange& o) { note(fmt::format("output {} {} {}", o.time_ms, o.name, o.value)); };
  options.observers.answer = [&](const std::string& answer) { note("answer " + answer); };
  options.observers.warning = [&](bytecode::SourceLine, const std::string& warning) { note("warning " + warning); };
  options.observers.refused = [&](const std::string& what, const std::string& why) { note("refused " + what + " " + why); };
  runtime::Machine machine(options);
  Trace trace(ran.samples);
  runtime::MotionStatistics statistics;
  if (seen) machine.add_sink(&trace), machine.add_sink(&statistics);
  machine.set_gather_sink({[&](const std::vector<std::string>&) {}, [&](std::span<const double> row) { note(fmt::format("gather {}", fmt::join(row, " "))); }});
  machine.load(std::move(*module));
  for (const auto& [time_ms, command] : commands) machine.at(time_ms, command);
  runtime::RunLimits limits;
  limits.max_ms = 4000;
  const runtime::RunOutcome outcome = machine.run(limits);
  for (const char* query : {"P1..9", "P40..43", "Q5", "#1..6p", "#1..6v", "&1p", "&2p"}) machine.command(query);
  note(fmt::format("end {} {} {} {} {}", static_cast<int>(outcome.end), outcome.time_ms, outcome.ticks, outcome.instructions, fmt::join(outcome.running, ", ")));
  for (const auto& row : statistics.rows())
    note(fmt::format("motor {} {} {} {} {} {} {} {}", row.motor, row.final_mu, row.min_mu, row.max_mu, row.max_speed_mu_ms, row.max_accel_mu_ms2, row.max_speed_at_ms, row.max_accel_at_ms));
  return ran;
}

}  // namespace

TEST_CASE("free runs: whatever a program does, and is done to it, comes out as event by event", "[property][servo]") {
  const int count = std::getenv("PMAC_RANDOM_PROGRAMS") ? std::atoi(std::getenv("PMAC_RANDOM_PROGRAMS")) : 60;
  const int first = std::getenv("PMAC_FIRST_SEED") ? std::atoi(std::getenv("PMAC_FIRST_SEED")) : 1;
  std::size_t moves = 0;
  for (int seed = first; seed < first + count; ++seed) {
    ScriptMaker maker(static_cast<std::uint32_t>(seed));
    const std::string text = maker.set_up() + maker.program(1, 25) + maker.program(2, 10);
    const auto commands = maker.commands();
    for (const bool seen : {true, false}) {
      const Ran free = run(text, commands, true, seen), plain = run(text, commands, false, seen);
      moves += plain.log.size();
      std::string done;
      for (const auto& [time_ms, command] : commands) done += fmt::format("{} {}\n", time_ms, command);
      INFO("seed " << seed << (seen ? "" : ", nobody looks") << "\n" << done << text);
      CHECK(free.log == plain.log);
      CHECK(free.samples.size() == plain.samples.size());
      CHECK((free.samples == plain.samples));
    }
  }
  CHECK(moves > static_cast<std::size_t>(count) * 50);
}

TEST_CASE("free runs: a sample is that of its tick, however many are made together", "[property][servo]") {
  // Motor[].DesVel can only be gathered tick by tick; nothing else changes by it.
  const std::string path = "open prog 1\nlinear abs ta5 ts2 F40\nX10 Y3\nX4 Y8\ncircle1 X2 Y2 R5\nlinear\ndwell 5\nX0 Y0\nclose\n";
  for (const char* mode : {"Coord[1].SegMoveTime=0\n", "Coord[1].SegMoveTime=2\n", "Coord[1].SegMoveTime=5\nCoord[1].LHDistance=40\ndefine lookahead 500\n"}) {
    const std::string set_up = std::string("&1\n#1->100X\n#2->100Y\n") + mode;
    const std::string gathered = "Gather.Items=1\nGather.Addr[0]=Motor[1].DesVel.a\nGather.Enable=2\n";
    for (const char* rate : {"&1 %100", "&1 %37"}) {
      const std::vector<std::pair<double, std::string>> commands{{0, "&1 b1r"}, {30.1, rate}, {200, "&1 h"}, {300, "&1 r"}};
      INFO(mode << rate);
      CHECK((run(set_up + path, commands, true, true).samples == run(set_up + gathered + path, commands, true, true).samples));
    }
  }
}
