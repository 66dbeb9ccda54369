// Part programs come out the same whether their lines go the short way (runtime/motion/line_path.h, only in free runs) or through all stages:
// samples bit by bit, extremes, moves with their times and rules, answers, the end. Shapes, set-ups and what is done meanwhile are random.
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <random>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compiler/compiler.h"
#include "runtime/machine.h"

using namespace pmac;

namespace {

class PartMaker {
 public:
  explicit PartMaker(std::uint32_t seed) : random_(seed) {}

  std::string set_up() {
    static const char* const kMaps[] = {"#1->100X\n#2->200Y\n#3->50Z\n", "#1->100X+20Y\n#2->-30X+200Y+7\n#3->50Z+5\n", "#1->100X\n#2->200Y\n#3->50A\n", "#1->100X\n#2->100X\n#3->10Y\n"};
    static const char* const kSegments[] = {"5", "2", "0.7", "20", "1"};
    const int map = below(4);
    third_ = map < 2 ? "Z" : map == 2 ? "A" : "";
    std::string text = fmt::format("&1\n{}Coord[1].SegMoveTime={}\n", kMaps[map], kSegments[below(5)]);
    if (below(4) == 0) text += fmt::format("Coord[1].MaxFeedRate={}\n", 5 + below(40));
    if (below(4) == 0) text += "Coord[1].AltFeedRate=0\n";
    if (below(6) == 0) text += fmt::format("Coord[1].AltFeedRate={}\n", 1 + below(9));
    if (below(6) == 0) text += "Coord[1].CornerBlendBp=0.5\n";
    if (below(6) == 0) text += "Coord[1].CornerError=0.01\n";
    if (below(6) == 0) text += "Coord[1].PosRollOver[0]=360\n";
    if (below(6) == 0) text += "Coord[1].FeedTime=60000\n";
    if (below(8) == 0) text += "Sys.RtIntPeriod=3\n";
    return text;
  }

  std::string program() {
    std::string text = fmt::format("open prog 1\nlinear abs ta{} td{} ts{} F{}\n", below(4) * 3, below(3) * 3, below(3) * 2, below(5) == 0 ? 6000 : 5 + below(60));
    for (int i = 2 + below(4); i > 0; --i) text += part(20 + below(250)) + between();
    return text + "close\n";
  }

  std::vector<std::pair<double, std::string>> commands() {
    static const char* const kCommands[] = {"&1 h", "&1 r", "&1 %50", "&1 %100", "&1 a", "&1 s", "&1 q", "&1p", "#1p", "#2v", "P1", "list pc", "&1 %0"};
    std::vector<std::pair<double, std::string>> list{{0, "&1 b1r"}};
    for (int i = below(5); i > 0; --i) list.emplace_back(0.73 * below(2500), kCommands[below(std::size(kCommands))]);
    return list;
  }

 private:
  int below(std::size_t n) { return static_cast<int>(random_() % n); }

  /// A curve of short lines, a staircase, random points, or lines on one straight line.
  std::string part(int lines) {
    const int shape = below(5), step = 1 + below(60);
    std::string text;
    for (int i = 0; i < lines; ++i) {
      const double t = 0.003 * step * i;
      switch (shape) {
        case 0: text += fmt::format("X{:.4f} Y{:.4f}", 10 * std::cos(t), 10 * std::sin(1.3 * t)); break;
        case 1: text += i % 2 == 0 ? fmt::format("X{:.3f}", t) : fmt::format("Y{:.3f}", t); break;
        case 2: text += fmt::format("X{:.2f} Y{:.2f}", 0.01 * below(300), 0.01 * below(300)); break;
        case 3: text += fmt::format("X{:.4f} Y{:.4f}", t, 2 * t); break;
        default: text += fmt::format("X{:.3f}", 0.001 * below(4)); break;   // hardly moves, or not at all
      }
      if (!third_.empty() && below(3) != 0) text += fmt::format(" {}{:.3f}", third_, 0.01 * below(100));
      text += "\n";
    }
    return text;
  }

  std::string between() {
    static const char* const kOthers[] = {"", "F20\n", "F7\n", "ta4\n", "dwell 3\n", "delay 5\n", "P1=P1+1\n", "P3==P3+1\n", "inc\n", "abs\n", "rapid X1 Y1\nlinear\n", "circle1 X2 Y2 R5\nlinear\n", "frax(X)\n",
                                          "frax(X,Y,Z)\n", "tm4\n", "Coord[1].NoBlend=1\n", "Coord[1].NoBlend=0\n", "P2=Motor[1].DesPos\n", "ta0 ts0\n", "ta-0.5\n", "X1/3\n"};
    const std::string line = kOthers[below(std::size(kOthers))];
    return line == "X1/3\n" ? "X(1/3)\n" : line;
  }

  std::mt19937 random_;
  std::string third_;
};

struct Ran {
  std::vector<double> samples;
  std::vector<std::string> log;
};

struct Trace : runtime::SampleSink {
  std::vector<double>& samples;
  explicit Trace(std::vector<double>& to) : samples(to) {}
  void take(const runtime::SampleBlock& block) override {
    for (int k = 0; k < block.count; ++k) {
      samples.push_back(static_cast<double>(block.first_tick + k));
      for (std::size_t m = 0; m < block.motors.size(); ++m) samples.push_back(block.at(static_cast<int>(m), k));
    }
  }
};

Ran run(const std::string& text, const std::vector<std::pair<double, std::string>>& commands, bool short_way) {
  compiler::Session session;
  auto module = session.compile({{"part.pmc", text}});
  INFO(text);
  REQUIRE(module);
  Ran ran;
  runtime::MachineOptions options;
  options.free_runs = short_way;
  options.compile_online = [&](std::string_view line, std::string_view name) -> std::variant<bytecode::Module, std::string> {
    auto online = session.compile_online(line, name);
    for (const auto& d : session.diagnostics().take())
      if (d.severity == source::Severity::kError) return d.message;
    if (!online) return std::string("refused");
    return std::move(*online);
  };
  const auto note = [&ran](std::string line) { ran.log.push_back(std::move(line)); };
  options.observers.move = [&](const runtime::MoveRecord& m) { note(fmt::format("move {} {} {} {} {} {}", m.mode, m.source.line, m.start_ms, m.end_ms, m.length, m.time_rule)); };
  options.observers.fault = [&](const runtime::FaultRecord& f) { note(fmt::format("fault {} {} {}", f.time_ms, f.coord, f.fault.detail)); };
  options.observers.answer = [&](const std::string& answer) { note("answer " + answer); };
  options.observers.refused = [&](const std::string& what, const std::string& why) { note("refused " + what + " " + why); };
  runtime::Machine machine(options);
  Trace trace(ran.samples);
  runtime::MotionStatistics statistics;
  machine.add_sink(&trace), machine.add_sink(&statistics);
  machine.load(std::move(*module));
  for (const auto& [time_ms, command] : commands) machine.at(time_ms, command);
  runtime::RunLimits limits;
  limits.max_ms = 2500;
  const runtime::RunOutcome outcome = machine.run(limits);
  for (const char* query : {"P1..3", "#1..3p", "#1..3v", "&1p", "&1d"}) machine.command(query);
  note(fmt::format("end {} {} {} {} {}", static_cast<int>(outcome.end), outcome.time_ms, outcome.ticks, outcome.instructions, fmt::join(outcome.running, ", ")));
  for (const auto& row : statistics.rows())
    note(fmt::format("motor {} {} {} {} {} {} {} {}", row.motor, row.final_mu, row.min_mu, row.max_mu, row.max_speed_mu_ms, row.max_accel_mu_ms2, row.max_speed_at_ms, row.max_accel_at_ms));
  return ran;
}

}  // namespace

TEST_CASE("line runs: a part program moves as through all stages, to the last bit", "[property][motion]") {
  const int count = std::getenv("PMAC_RANDOM_PROGRAMS") ? std::atoi(std::getenv("PMAC_RANDOM_PROGRAMS")) : 60;
  const int first = std::getenv("PMAC_FIRST_SEED") ? std::atoi(std::getenv("PMAC_FIRST_SEED")) : 1;
  std::size_t moves = 0;
  for (int seed = first; seed < first + count; ++seed) {
    PartMaker maker(static_cast<std::uint32_t>(seed));
    const std::string text = maker.set_up() + maker.program();
    const auto commands = maker.commands();
    const Ran quick = run(text, commands, true), plain = run(text, commands, false);
    moves += plain.log.size();
    std::string done;
    for (const auto& [time_ms, command] : commands) done += fmt::format("{} {}\n", time_ms, command);
    INFO("seed " << seed << "\n" << done << text);
    CHECK(quick.log == plain.log);
    CHECK(quick.samples.size() == plain.samples.size());
    CHECK((quick.samples == plain.samples));
  }
  CHECK(moves > static_cast<std::size_t>(count) * 50);
}

TEST_CASE("line runs: lines without distance and delays in between", "[property][motion]") {
  std::string text = "&1\n#1->100X\n#2->200Y\nCoord[1].SegMoveTime=2\nopen prog 1\nlinear abs ta3 td12 ts1 F47\n";
  for (int i = 0; i < 200; ++i) text += fmt::format("{}X{:.3f} Y{:.3f}\n", i % 40 == 39 ? "delay 20\n" : "", 0.37 * (i / 2), 0.11 * (i / 3 % 7));
  const Ran quick = run(text + "close\n", {{0, "&1 b1r"}}, true), plain = run(text + "close\n", {{0, "&1 b1r"}}, false);
  CHECK(quick.log == plain.log);
  CHECK((quick.samples == plain.samples));
}
