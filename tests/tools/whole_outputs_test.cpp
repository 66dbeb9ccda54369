// A result keeps its name only when it is whole: every kind of output that the tools write, against a full disk (a limit of the size of files,
// and the device that is always full), a reader that goes away, and a signal.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/tools/run_shell.h"

using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

constexpr const char* kMachine = "&1 #1->1000X #2->1000Y\nGather.Addr[0]=Motor[1].DesPos.a\nGather.Items=1 Gather.Period=1 Gather.MaxSamples=1000000\n";

/// Moves of some seconds.
std::string some_moves() { return std::string(kMachine) + "open prog 1\nGather.Enable=2\nlinear abs ta10 ts0 F10\nX10 Y3\nX0 Y0\nX4\nclose\n"; }

std::string endless_moves() { return std::string(kMachine) + "open prog 1\nGather.Enable=2\nlinear abs ta10 ts0 F100\nwhile(1){X1 Y1\nX0 Y0}\nclose\n"; }

/// A program whose text, object file and stages are large.
std::string large_program() {
  std::string text = "open prog 1\nlinear abs F10\n";
  for (int i = 0; i < 3000; ++i) text += "P1=P1*3+" + std::to_string(i) + " X(P1)\n";
  return text + "close\n";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

bool leaves_other_files(const Workspace& w) {
  for (const auto& entry : std::filesystem::directory_iterator(w.path(""))) {
    const std::string name = entry.path().filename().string();
    if (contains(name, "partial") || name.ends_with(".tmp")) return true;
  }
  return false;
}

/// Writes beyond 16 KiB of any file fail, as on a disk that is full there.
ToolResult with_small_files(const Workspace& w, const std::string& command) { return w.shell("trap '' XFSZ; ulimit -f 16; " + command); }

std::size_t lines_of(const std::string& text) { return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')); }

/// The last line is complete and has as many parts as the one before it.
bool ends_with_a_complete_row(const std::string& text, char between) {
  if (text.empty() || text.back() != '\n') return false;
  const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
  const std::size_t before = last < 2 ? 0 : text.rfind('\n', last - 2) + 1;
  const auto parts = [&](const std::string& line) { return std::count(line.begin(), line.end(), between); };
  return parts(text.substr(last)) == parts(text.substr(before, last - before));
}

/// An archive that was closed: its end of central directory is its end.
bool is_whole_archive(const std::string& bytes) { return bytes.size() > 22 && bytes.starts_with("PK") && bytes.substr(bytes.size() - 22, 4) == "PK\5\6"; }

struct Output { const char* option; const char* file; };

constexpr Output kFiles[] = {{"--record", "r.csv"}, {"--record", "r.npz"}, {"--record", "r.txt"}, {"--gather", "g.csv"},
                             {"--gather", "g.npz"}, {"--plot", "p.svg"}, {"--plot", "p.html"}, {"--trace", "t.txt"}};

std::string option_of(const Output& output) { return std::string(output.option) + (std::string(output.option) == "--trace" ? "=" : " ") + output.file; }

}  // namespace

TEST_CASE("whole outputs: on a full disk no file of pmac-run keeps its name, and an older one of that name stays", "[tools]") {
  const Workspace w;
  w.write("moves.pmc", some_moves() + "open prog 2\nwhile(P1<5000){P1++}\nclose\n");
  for (const Output& output : kFiles) {
    INFO(output.file);
    w.write(output.file, "older");
    const std::string run = "moves.pmc -e '&1b1r' " + option_of(output);
    const std::string traced = std::string(output.option) == "--trace" ? "moves.pmc -e '&1b2r' " + option_of(output) : run;
    const ToolResult r = with_small_files(w, "pmac-run " + traced);
    CHECK(r.code == 2);
    CHECK(contains(r.err, std::string(output.option) == "--plot" ? "cannot run gnuplot" : std::string("cannot write ")));
    CHECK(contains(r.err, "File too large"));
    CHECK(w.read(output.file) == "older");
  }
  CHECK_FALSE(leaves_other_files(w));
}

TEST_CASE("whole outputs: on a full disk no file of pmacc keeps its name, and the source stays", "[tools]") {
  const Workspace w;
  const std::string source = large_program();
  w.write("large.pmc", source);
  for (const char* command : {"pmacc large.pmc -o o.pmx", "pmacc -E large.pmc -o o.pmx"}) {
    INFO(command);
    const ToolResult r = with_small_files(w, command);
    CHECK(r.code == 2);
    CHECK(contains(r.err, "cannot write o.pmx: File too large"));
    CHECK_FALSE(w.has("o.pmx"));
  }
  const ToolResult formatted = with_small_files(w, "pmacc fmt large.pmc");
  CHECK(formatted.code == 2);
  CHECK(contains(formatted.err, "large.pmc: File too large"));
  CHECK(w.read("large.pmc") == source);
  CHECK_FALSE(leaves_other_files(w));
}

TEST_CASE("whole outputs: a standard output that is full is an error of every tool and stage", "[tools]") {
  const Workspace w;
  w.write("moves.pmc", some_moves());
  w.write("card.x.acr", "AXIS X\n10 VEL1000 : ACC10000 : DEC10000 : MOV1000\nRUN\n");
  w.write("unformatted.pmc", "P1  =1\n");
  const char* const commands[] = {
      "pmac-run moves.pmc -e '&1b1r' --json", "pmac-run moves.pmc -e '&1b1r' --stats", "pmac-run moves.pmc -e '&1b1r' --trace",
      "pmac-run moves.pmc -e '&1b1r' --emit=commands", "pmac-run moves.pmc -e '&1b1r' --emit=path", "pmac-run moves.pmc -e '&1b1r' --emit=servo",
      "pmac-run moves.pmc -e 'P1'", "echo P1 | pmac-run moves.pmc --console", "pmac-run card.x.acr --json", "pmac-run card.x.acr --stats",
      "pmac-run --kinematics list", "pmac-run --drive list", "pmac-silverlode circle", "pmac-silverlode circle --json",
      "pmacc moves.pmc --emit=tokens", "pmacc moves.pmc --emit=tree", "pmacc moves.pmc --emit=ir", "pmacc moves.pmc --emit=bytecode",
      "pmacc moves.pmc --emit=symbols", "pmacc -E moves.pmc", "pmacc --explain all", "pmacc fmt --diff unformatted.pmc", "pmacc fmt - < unformatted.pmc"};
  for (const char* command : commands) {
    INFO(command);
    const ToolResult r = w.shell(std::string(command) + " > /dev/full");
    CHECK(r.code == 2);
    CHECK(contains(r.err, "cannot write"));
  }
  CHECK(w.read("unformatted.pmc") == "P1  =1\n");
}

TEST_CASE("whole outputs: a reader that goes away ends every stage with a message", "[tools]") {
  const Workspace w;
  w.write("endless.pmc", endless_moves());
  for (const char* output : {"--emit=commands", "--emit=path", "--emit=servo", "--trace --trace-limit 1000000000"}) {
    INFO(output);
    const ToolResult r = w.shell("set -o pipefail; pmac-run endless.pmc -e '&1b1r' --max-time 1e9 " + std::string(output) + " | head -1");
    CHECK(r.code == 2);
    CHECK(contains(r.err, "standard output"));
    CHECK(lines_of(r.out) == 1);
  }
}

TEST_CASE("whole outputs: SIGTERM and Ctrl-C leave every kind of file whole, with a complete last row", "[tools]") {
  for (const char* signal : {"TERM", "INT"}) {
    const Workspace w;
    INFO(signal);
    w.write("endless.pmc", endless_moves());
    std::string options;
    for (const Output& output : kFiles)
      if (std::string(output.file) != "r.npz" && std::string(output.file) != "r.txt" && std::string(output.file) != "g.npz") options += option_of(output) + " ";
    const auto interrupted = [&](const std::string& outputs, const std::string& to) {   // a run without an end fills a disk: it gets 20 s at most
      return w.shell("timeout --foreground -s KILL 20 pmac-run endless.pmc -e '&1b1r' --until 1e8 --max-time 1e9 " + outputs + " > " + to + " & run=$!\n"
                     "for i in $(seq 10); do [ -n \"$(find . -name '[rg].csv.partial-*' -size +0)\" ] && break; sleep 0.1; done\n"
                     "sleep 0.3; pkill -" + signal + " -P $run; wait $run");
    };
    const ToolResult r = interrupted(options + "--trace-limit 1000 --json", "j.json");
    CHECK(r.code == 130);
    CHECK(contains(r.err, "interrupted at"));
    for (const char* table : {"r.csv", "g.csv"}) CHECK(ends_with_a_complete_row(w.read(table), ','));
    CHECK(w.read("t.txt").back() == '\n');
    CHECK(contains(w.read("p.svg"), "</svg>"));
    CHECK(contains(w.read("p.html"), "</html>"));
    CHECK(nlohmann::json::parse(w.read("j.json"))["status"] == "interrupted");
    CHECK(interrupted("--record r.npz --gather g.npz", "out.txt").code == 130);
    for (const char* archive : {"r.npz", "g.npz"}) CHECK(is_whole_archive(w.read(archive)));
    CHECK(interrupted("--record r.txt --emit=servo", "servo.txt").code == 130);
    CHECK(ends_with_a_complete_row(w.read("servo.txt"), ' '));
    CHECK(w.read("r.txt").back() == '\n');
    CHECK_FALSE(leaves_other_files(w));
  }
}

TEST_CASE("whole outputs: a compiler that is ended by a signal leaves neither its file nor another one", "[tools]") {
  const Workspace w;
  w.write("large.pmc", large_program());
  // The name of the output is a fifo's neighbour: the compiler waits in the middle of reading its second file.
  const ToolResult r = w.shell("mkfifo more.pmc; pmacc large.pmc more.pmc -o o.pmx & run=$!; sleep 0.5; kill -TERM $run; wait $run");
  CHECK(r.code == 143);
  CHECK_FALSE(w.has("o.pmx"));
  CHECK_FALSE(leaves_other_files(w));
}

TEST_CASE("whole outputs: a reader that goes away is an error of pmacc", "[tools]") {
  const Workspace w;
  const std::string source = large_program() + std::string(200'000, '\n') + "P1  =1\n";   // more than a pipe holds
  w.write("large.pmc", source);
  for (const char* command : {"pmacc large.pmc --emit=tokens", "pmacc large.pmc --emit=tree", "pmacc large.pmc --emit=ir", "pmacc large.pmc --emit=bytecode", "pmacc -E large.pmc",
                              "pmacc fmt --stdout large.pmc", "pmacc fmt - < large.pmc", "pmacc --explain all"}) {
    INFO(command);
    const ToolResult r = w.shell("set -o pipefail; " + std::string(command) + " | true");
    CHECK(r.code == 2);
    CHECK(contains(r.err, "cannot write"));
  }
  CHECK(w.shell("set -o pipefail; pmacc large.pmc nosuch.pmc 2>&1 | true").code == 2);   // of messages: the exit code stays
  CHECK(w.read("large.pmc") == source);
}

namespace {

/// Sends a signal as soon as the command has made a temporary file. Where the command is faster, it is over and its code is 0.
ToolResult ended_while_writing(const Workspace& w, const std::string& command, const std::string& signal) {
  return w.shell("shopt -s nullglob; rm -f *.tmp; " + command + " & run=$!\n"
                 "while kill -0 $run 2>/dev/null; do made=(*.tmp); [ ${#made[@]} = 0 ] || { kill -" + signal + " $run; break; }; done\n"
                 "wait $run");
}

}  // namespace

TEST_CASE("whole outputs: pmacc and its formatter, ended while they write, leave the old file or the new one and nothing else", "[tools]") {
  const Workspace w;
  const std::string source = "P1  =1\n// " + std::string(10'000'000, '-') + "\n";   // takes long to write, and not to format
  std::string moves = "open prog 1\nlinear abs F10\n";
  for (int i = 0; i < 400'000; ++i) moves += "X1 Y2\n";
  w.write("moves.pmc", moves + "close\n");
  int ended = 0;
  for (int attempt = 0; attempt < 10 && ended == 0; ++attempt) {   // a fast machine may be over before the signal comes
    for (const char* signal : {"TERM", "INT", "HUP"}) {
      INFO(signal);
      w.write("long.pmc", source);
      const ToolResult r = ended_while_writing(w, "pmacc fmt long.pmc", signal);
      ended += r.code > 128;
      CHECK((r.code == 0 || r.code > 128));
      CHECK((w.read("long.pmc") == source) == (r.code != 0));
      CHECK_FALSE(leaves_other_files(w));
    }
    w.write("o.pmx", "older");
    const ToolResult r = ended_while_writing(w, "pmacc moves.pmc -o o.pmx", "TERM");
    ended += r.code > 128;
    CHECK((w.read("o.pmx") == "older") == (r.code != 0));
    CHECK_FALSE(leaves_other_files(w));
  }
  CHECK(ended > 0);
}

TEST_CASE("whole outputs: the formatter, ended between two files, has written the first one whole", "[tools]") {
  const Workspace w;
  w.write("first.pmc", "P1  =1\n");
  const ToolResult r = w.shell("mkfifo second.pmc; pmacc fmt first.pmc second.pmc & run=$!\n"
                               "for i in $(seq 100); do [ \"$(cat first.pmc)\" = 'P1 = 1' ] && break; sleep 0.1; done; kill -TERM $run; wait $run");
  CHECK(r.code == 143);
  CHECK(w.read("first.pmc") == "P1 = 1\n");
  CHECK_FALSE(leaves_other_files(w));
}

TEST_CASE("whole outputs: a limit of the size of files that is a signal leaves nothing of pmacc's", "[tools]") {
  const Workspace w;
  w.write("large.pmc", large_program());
  const ToolResult r = w.shell("ulimit -f 16; pmacc large.pmc -o o.pmx");
  CHECK(r.code == 2);
  CHECK(contains(r.err, "cannot write o.pmx: File too large"));
  CHECK_FALSE(w.has("o.pmx"));
  CHECK_FALSE(leaves_other_files(w));
}

TEST_CASE("whole outputs: an input of more than a gibibyte is refused", "[tools]") {
  const Workspace w;
  REQUIRE(w.shell("truncate -s 3G long.pmc").code == 0);   // takes no room on the disk
  for (const char* tool : {"pmacc", "pmac-run"}) {
    const ToolResult r = w.run(tool, "long.pmc");
    CHECK(r.code == 2);
    CHECK(contains(r.err, "cannot read long.pmc: "));
  }
}

TEST_CASE("long lines: texts, comments and words of a megabyte are answered, at every entry", "[tools]") {
  const Workspace w;
  const std::string many(900'000, 'a');
  w.write("typed.txt", "\"" + many + "\"\nP1\n/*" + many + "*/\nP1\n//" + many + "\nP1\nP2=" + many + "\nP1\n");
  const ToolResult console = w.shell("pmac-run --console < typed.txt");
  CHECK(console.code == 0);
  CHECK(std::count(console.out.begin(), console.out.end(), '\6') == 8);   // a line each
  std::string sum = "10 P1=1";
  for (int i = 0; i < 20'000; ++i) sum += "+1";
  w.write("sum.acr", sum + "\nRUN\n");
  const ToolResult card = w.run("pmac-run", "sum.acr");
  CHECK(card.code == 1);
  CHECK(contains(card.err, "a line has at most 2000 words and signs"));
  std::string writes;
  for (int i = 0; i < 50'000; ++i) writes += "WR0 <- ";
  w.write("writes.mcx", writes + "\n");
  CHECK(w.run("pmac-run", "writes.mcx").code == 1);
}
