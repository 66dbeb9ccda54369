// The fast path for plain move lines against the grammar: the same program, instruction for instruction and bit for bit; and the runtime
// on rows against the runtime on instructions.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cstdlib>
#include <random>
#include <regex>

#include "compiler/compiler.h"
#include "compiler/frontend/power_pmac/plain_number.h"
#include "runtime/machine.h"
#include "tests/reference/unrolled_module.h"

using namespace pmac;

namespace {

/// Lines as part programs have them, with now and then one that is not plain, or only nearly.
class TextMaker {
 public:
  explicit TextMaker(std::uint32_t seed) : random_(seed) {}

  std::string program(int lines) {
    std::string text = "global Speed = 5\nopen prog 7\nlinear abs ta10 ts0 F50\n";
    for (int i = 0; i < lines; ++i) text += below(150) == 0 ? odd_line() : plain_line();
    return text + "close\n";
  }

  /// Part programs with modes, feeds, code letters and block numbers.
  std::string coded_program(int lines, bool right, bool with_moves) {
    right_ = right;
    std::string text = "global Speed = 5\nopen prog 7\nlinear abs ta10 ts0 F50\n";
    for (int i = 0; i < lines; ++i) text += below(120) == 0 && !right ? odd_line() : with_moves && below(60) == 0 ? moves(150) : coded_line();
    return text + "close\n";
  }

  std::string coded_line() {
    static const char* const kModes[] = {"linear", "rapid", "abs", "inc", "Linear", "circle1", "CIRCLE2", "circle 1", "circle5"};
    std::string text = below(4) == 0 ? fmt::format("N{}{}", below(100000), below(2) ? " " : "") : "";
    if (below(25) == 0) return text + "\n";
    if (below(30) == 0) return "  // X5 only a comment\n";
    if (below(2) == 0) {
      const std::string codes = "GgMTSHd";
      text += std::string(1, codes[below(codes.size())]) + fmt::format("{:02}", below(99));
      for (unsigned i = below(6); i > 0; --i) text += (below(5) ? " " : "") + std::string(1, "XYZABCIJKRFSPQLHDMTGxyfmeN"[below(right_ ? 24 : 26)]) + number();
    } else {
      for (unsigned i = below(3); i > 0; --i) {
        const unsigned kind = below(3);
        text += kind == 0 ? std::string(kModes[below(right_ ? 5 : std::size(kModes))]) + " " : kind == 1 ? fmt::format("F{} ", below(500)) : fmt::format("t{}{} ", "asdm"[below(4)], below(100));
      }
      for (unsigned i = below(5); i > 0; --i) text += std::string(1, "XYZABCUVWxzIJKR"[below(right_ ? 11 : 15)]) + number() + (below(3) ? " " : "");
      if (below(6) == 0) text += fmt::format("F{}", below(1000));
    }
    if (below(12) == 0) text += " // G5";
    return text + (below(10) == 0 ? "\r\n" : "\n");
  }

  std::string moves(int lines) {
    std::string text;
    for (int i = 0; i < lines; ++i) text += plain_line();
    return text;
  }

  std::string plain_line() {
    std::string text = below(8) == 0 ? "  " : "";
    std::string axes = "XYZABCUVW";
    std::shuffle(axes.begin(), axes.end(), random_);
    const unsigned words = 1 + below(4);
    for (unsigned i = 0; i < words; ++i) {
      std::string name(below(9) == 0 ? 2 : 1, axes[i]);
      if (below(6) == 0) name[0] = static_cast<char>(name[0] | 0x20);
      text += name + (below(12) == 0 ? " " : "") + number() + (below(3) == 0 ? "" : below(7) == 0 ? "\t" : " ");
    }
    if (below(20) == 0) text += "I" + number() + " J" + number();
    if (below(12) == 0) text += " // X9 comment";
    return text + (below(10) == 0 ? "\r\n" : "\n");
  }

 private:
  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }

  std::string number() {
    const std::string sign = below(3) == 0 ? "-" : below(12) == 0 ? "+" : "";
    switch (below(9)) {
      case 0: return sign + fmt::format("{}", below(1000));
      case 1: return sign + fmt::format(".{}", below(100000));
      case 2: return sign + fmt::format("{}.", below(1000));
      case 3: return sign + "0";
      case 4: return sign + fmt::format("{}.{:012}{:09}", below(1000), random_(), below(1000000000));
      case 5: return sign + fmt::format("00{}.{}00", below(100), below(100));
      default: return sign + fmt::format("{}.{:0{}}", below(1000), below(100000), 3 + below(6));
    }
  }

  std::string odd_line() {
    static const char* const kLines[] = {"X1 X2\n", "X(Speed)\n", "\n", "// only a comment\n", "X1e3\n", "Y5 F100\n", "linear\n", "if (P1 > 2) X5 Y6\n", "if (P1 > 2)\nX5 Y6\nelse\nX7\n", "P1=P1+1\n",
                                         "dwell 10\n", "X$10\n", "N100X5\n", "Z2.5 /* block */ Y1\n", "while (P1 < 0)\n{\nX1\n}\n", "X1;\n", "switch (P1) { case 1:\n", "Y1 Z2:5\n", "X1P2\n", "Speed=3\n"};
    const std::string line = kLines[below(std::size(kLines))];
    if (line.starts_with("N100")) return fmt::format("N{} X5\n", 100 + labels_++);
    if (line.starts_with("switch")) return line + plain_line() + "break\n}\n";
    return line;
  }

  std::mt19937 random_;
  int labels_ = 0;
  bool right_ = true;   // without lines that are wrong
};

struct Compiled {
  std::string listing;
  std::vector<std::string> messages;
  std::optional<bytecode::Module> module;
};

Compiled compile(const std::string& text, bool fast) {
  compiler::Options options;
  options.plain_move_fast_path = fast;
  compiler::Session session(options);
  Compiled result;
  result.module = session.compile({{"part.pmc", text}});
  for (const source::Diagnostic& d : session.diagnostics().take()) result.messages.push_back(fmt::format("{}: {} {}", session.sources().place(d.span).line, d.code, d.message));
  if (!result.module) return result;
  const bytecode::Module plain = reference::unrolled(*result.module);
  CHECK(bytecode::verify(plain) == "");
  result.listing = std::regex_replace(bytecode::disassemble(plain), std::regex("load\\.(int|const) "), "load ");
  result.listing = std::regex_replace(result.listing, std::regex(" +;"), " ;");
  result.listing = std::regex_replace(result.listing, std::regex("load +"), "load ");
  return result;
}

/// Positions of all servo cycles, as they are in memory.
struct Trace : runtime::SampleSink {
  std::vector<double> mu;
  void take(const runtime::SampleBlock& block) override { mu.insert(mu.end(), block.position_mu.begin(), block.position_mu.end()); }
};

struct Ran {
  std::vector<double> mu;
  std::vector<std::string> moves, faults;
};

Ran run(const std::string& text, bool fast, const std::vector<std::string>& commands) {
  const std::string set_up = "&1\n#1->100X\n#2->100Y\n#3->100Z\n#4->100A\nCoord[1].SegMoveTime=2\n";
  compiler::Options options;
  options.plain_move_fast_path = fast;
  compiler::Session session(options);
  auto module = session.compile({{"setup.cfg", set_up}, {"part.pmc", text}});
  REQUIRE(module);
  CHECK(module->move_runs.empty() != fast);
  Ran ran;
  runtime::Machine* place = nullptr;
  runtime::MachineOptions machine_options;
  machine_options.compile_online = [&](std::string_view line, std::string_view name) -> std::variant<bytecode::Module, std::string> {
    auto online = session.compile_online(line, name);
    if (!online) return std::string("refused");
    return std::move(*online);
  };
  machine_options.observers.move = [&](const runtime::MoveRecord& move) {
    ran.moves.push_back(fmt::format("{} {}:{} {} {} {}", move.mode, move.source.line, move.source.column, move.start_ms, move.end_ms, move.length));
  };
  machine_options.observers.fault = [&](const runtime::FaultRecord& record) { ran.faults.push_back(fmt::format("{} {}", place->place(record.fault.source), record.fault.detail)); };
  runtime::Machine machine(machine_options);
  place = &machine;
  Trace trace;
  machine.add_sink(&trace);
  machine.load(std::move(*module));
  for (const std::string& command : commands) {
    machine.command(command);
    runtime::RunLimits limits;
    limits.more_follows = true;
    machine.run(limits);
  }
  machine.run({});
  ran.mu = std::move(trace.mu);
  return ran;
}

/// Both ways; the moves, the samples and the faults must agree. Returns how many moves there were.
std::size_t check_same_run(const std::string& text, const std::vector<std::string>& commands) {
  const Ran fast = run(text, true, commands), slow = run(text, false, commands);
  CHECK(fast.moves == slow.moves);
  CHECK(fast.faults == slow.faults);
  CHECK(fast.mu.size() == slow.mu.size());
  CHECK(fast.mu == slow.mu);
  return fast.moves.size();
}

std::string rows(int count, int every = 1) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format("X{} Y{:.3f}\n", i % 7, 0.125 * (i / every % 5));
  return text;
}

}  // namespace

TEST_CASE("plain moves: the fast path and the grammar give the same program", "[property]") {
  const int count = std::getenv("PMAC_RANDOM_PROGRAMS") ? std::atoi(std::getenv("PMAC_RANDOM_PROGRAMS")) : 6;
  std::size_t rows = 0;
  for (int seed = 1; seed <= count; ++seed) {
    const std::string text = TextMaker(static_cast<std::uint32_t>(seed)).program(700);
    const Compiled fast = compile(text, true);
    const Compiled slow = compile(text, false);
    INFO("seed " << seed);
    REQUIRE(slow.module);
    REQUIRE(fast.module);
    CHECK(slow.module->move_runs.empty());
    for (const bytecode::MoveRun& run : fast.module->move_runs) rows += run.row_count();
    CHECK(fast.listing == slow.listing);
  }
  CHECK(rows > static_cast<std::size_t>(count) * 200);
}

TEST_CASE("plain lines: the second fast path and the grammar give the same program and the same messages", "[property]") {
  const int count = std::getenv("PMAC_RANDOM_PROGRAMS") ? std::atoi(std::getenv("PMAC_RANDOM_PROGRAMS")) : 6;
  int whole = 0;
  for (int seed = 1; seed <= count; ++seed) {
    const bool with_moves = seed % 3 == 0;  // of plain moves one message stands for many
    const std::string text = TextMaker(static_cast<std::uint32_t>(seed)).coded_program(600, seed % 2 == 0, with_moves);
    const Compiled fast = compile(text, true), slow = compile(text, false);
    INFO("seed " << seed);
    if (!with_moves) CHECK(fast.messages == slow.messages);
    REQUIRE(fast.module.has_value() == slow.module.has_value());
    CHECK(fast.listing == slow.listing);
    whole += slow.module.has_value();
  }
  CHECK(2 * whole >= count);
}

TEST_CASE("plain lines: a line that goes on, and names that the lines could use, are left to the grammar", "[property]") {
  std::string codes;
  for (int i = 0; i < 100; ++i) codes += fmt::format("N{} G1 X{} F{}\n", i, i % 9, 10 + i);
  for (const std::string& text : {"open prog 1\n" + codes + "M5\n= 3\nclose\n", "open prog 1\n" + codes + "abs (X)\nclose\n", "#define G1 linear\nopen prog 1\n" + codes + "close\n",
                                  "#define linear rapid\nopen prog 1\n" + codes + "linear X5\nclose\n", "global N5;\nopen prog 1\n" + codes + "close\n",
                                  "open prog 1\n" + codes + "if (P1 > 2)\n" + codes + "else\nX5\nclose\n", "open prog 1\nif (P1 > 2)\n\n" + codes + "close\n", "open plc 1\n" + codes + "close\n",
                                  "open prog 1\nswitch (P1)\n{\ncase 1:\n" + codes + "break\n}\nclose\n", "open prog 1\n" + codes + "local G2 = 5;\nG2 = 6\nclose\n"}) {
    const Compiled fast = compile(text, true), slow = compile(text, false);
    INFO(text.substr(0, 60));
    CHECK(fast.messages == slow.messages);
    REQUIRE(fast.module.has_value() == slow.module.has_value());
    CHECK(fast.listing == slow.listing);
  }
}

TEST_CASE("plain moves: rows run as the same lines one by one", "[property]") {
  CHECK(check_same_run("open prog 1\nlinear abs ta5 ts0 F20\n" + rows(300) + "close\n", {"&1 b1r"}) == 300);
  // a label in front of the rows, gone to again; a subprogram with rows of its own
  CHECK(check_same_run("open prog 1\nlinear abs ta5 ts0 F20\nP1=0\nN10:\n" + rows(90) + "P1=P1+1\nif (P1 < 3) goto 10\ncall 50\nclose\nopen subprog 50\n" + rows(70) + "return\nclose\n", {"&1 b1r"}) == 340);
}

TEST_CASE("plain moves: a canned cycle reads the words of rows", "[property]") {
  const std::string cycle = "open subprog 60\nread(X)\ninc\nY(D24/10)\nabs\nreturn\nclose\n";
  CHECK(check_same_run(cycle + "open prog 1\nlinear abs ta5 ts0 F20\ncdef 60\n" + rows(80) + "cundef\n" + rows(70) + "close\n", {"&1 b1r"}) > 150);
}

TEST_CASE("plain moves: single steps stop at every row", "[property]") {
  std::vector<std::string> steps(40, "&1 s");
  steps.front() = "&1 b1s";
  CHECK(check_same_run("open prog 1\nlinear abs ta5 ts0 F20\n" + rows(100) + "close\n", steps) >= 30);
}

TEST_CASE("plain moves: the line of a fault inside of rows", "[property]") {
  // a circle without a radius that fits, at the 85th row
  std::string text = "open prog 1\ncircle1 abs ta5 ts0 F20\n";
  for (int i = 0; i < 120; ++i) text += i == 84 ? "X500 Y500 R1\n" : fmt::format("X{} Y{} I0.5 J0\n", i % 2, 0);
  check_same_run(text + "close\n", {"&1 b1r"});
}

TEST_CASE("plain moves: names that the lines could use turn the fast path off", "[property]") {
  const std::string body = "open prog 1\nlinear abs F5\n" + rows(200) + "close\n";
  const auto row_count = [](const std::string& text) {
    compiler::Session session;
    const auto module = session.compile({{"part.pmc", text}});
    return module ? module->move_runs.size() : 99;
  };
  CHECK(row_count(body) == 1);
  CHECK(row_count("#define X3 Y9\n" + body) == 0);
  CHECK(row_count("#define Y Z\n" + body) == 0);
  CHECK(row_count("#define Yaw 5\n" + body) == 1);
  CHECK(row_count("global X3;\nopen prog 1\nlinear abs F5\n" + rows(200) + "close\n") == 99);  // X3 alone is no statement then
  CHECK(row_count("open plc 1\n" + rows(200) + "close\n") == 0);
}

TEST_CASE("plain moves: what there is to say about a row is said at its line", "[property]") {
  const auto messages = [](const std::string& text) {
    compiler::Session session;
    session.compile({{"part.pmc", text}});
    std::vector<std::string> found;
    for (const source::Diagnostic& d : session.diagnostics().take()) found.push_back(fmt::format("{}:{}", session.sources().place(d.span).line, d.code));
    return found;
  };
  const auto has = [](const std::vector<std::string>& all, const std::string& one) { return std::find(all.begin(), all.end(), one) != all.end(); };
  CHECK(has(messages("&1 #1->X #2->Y\nopen prog 1\nlinear abs F5\n" + rows(100) + "X1 Z5\n" + rows(9) + "close\n"), "104:PM6003"));
  CHECK(has(messages("open prog 1\nlinear abs F5\n" + rows(100) + "X1 Y5 I3\n" + rows(9) + "close\n"), "103:PM4003"));
  CHECK(has(messages("open prog 1\ncircle1 abs F5\nX1 R3\n" + [] { std::string t; for (int i = 0; i < 90; ++i) t += "X1 Y2 R5\n"; return t; }() + "X7 Y7\nclose\n"), "94:PM4001"));
}

TEST_CASE("plain numbers: as strtod reads them, wherever the text ends", "[property][compiler]") {
  std::mt19937 random(7);
  const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
  const auto digits = [&](unsigned count) {
    std::string text;
    for (unsigned i = 0; i < count; ++i) text += static_cast<char>('0' + below(10));
    return text;
  };
  for (int i = 0; i < 20000; ++i) {
    const std::string sign = below(3) == 0 ? "-" : below(8) == 0 ? "+" : "";
    const std::string number = sign + digits(below(10)) + (below(4) == 0 ? "" : "." + digits(below(10)));
    const std::string behind = std::vector<std::string>{"", " Y2", "\n", "Y7.25 Z3.1234567 A1\n", ".5", "e5", "_", "\xff\x8a\x8a\x8a", ":", "/", "                    "}[below(11)];
    const std::string text = number + behind;
    double value = -1;
    const char* const end = compiler::power_pmac::read_plain_number(text.data(), text.data() + text.size(), value);
    const bool is_number = number.find_first_of("0123456789") != std::string::npos, goes_on = behind == "e5" || behind == "_" || (behind == ".5" && number.find('.') != std::string::npos);
    const bool is_longer = behind == ".5" && number.find('.') == std::string::npos;   // and with .5 it is a number whatever was before it
    INFO("'" << text << "'");
    if (goes_on || (!is_number && !is_longer)) {
      REQUIRE(end == nullptr);
      continue;
    }
    const std::string whole = is_longer ? number + ".5" : number;
    REQUIRE(end == text.data() + whole.size());
    REQUIRE(value == std::strtod(whole.c_str(), nullptr));
  }
}
