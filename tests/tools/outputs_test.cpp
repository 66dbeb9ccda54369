// What the tools write: JSON, records, gathered data, pictures, stages.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/tools/run_shell.h"

using nlohmann::json;
using pmac::test::program;
using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

std::vector<std::vector<std::string>> csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

}  // namespace

TEST_CASE("option json holds status, time, moves, motors, outputs and faults", "[tools]") {
  const Workspace w;
  const ToolResult r = w.run("pmac-run", program("02_basic_moves.pmc") + " -e '&1b1r' --json");
  REQUIRE(r.code == 0);
  const json j = json::parse(r.out);
  CHECK(j["status"] == "idle");
  CHECK(j["time_s"].get<double>() == Approx(6.010).margin(1e-9));
  REQUIRE(j["moves"].size() == 4);
  CHECK(j["moves"][0]["mode"] == "linear");
  CHECK(j["moves"][0]["coord"] == 1);
  CHECK(j["moves"][0]["start_s"].get<double>() == 0.0);
  CHECK(j["moves"][0]["end_s"].get<double>() == Approx(2.5).margin(1e-12));
  CHECK(j["moves"][0]["length"].get<double>() == Approx(10.0));
  CHECK(j["moves"][1]["mode"] == "dwell");
  CHECK(j["moves"][1]["length"].get<double>() == 0.0);
  CHECK(j["motors"]["1"]["final"].get<double>() == Approx(0.0).margin(1e-9));
  CHECK(j["motors"]["1"]["max_speed"].get<double>() == Approx(5.0).epsilon(1e-9));
  CHECK(j["motors"]["1"]["max_accel"].get<double>() == Approx(0.01).epsilon(1e-6));
  CHECK(j["outputs"].empty());
  CHECK(j["faults"].empty());
  const json summary = json::parse(w.run("pmac-run", program("02_basic_moves.pmc") + " -e '&1b1r' --json=summary").out);
  CHECK_FALSE(summary.contains("moves"));
  CHECK_FALSE(summary.contains("outputs"));
}

TEST_CASE("option record-act shows where a motor with a plant is", "[tools]") {
  const Workspace w;
  w.write("lag.pmc", "&1 #1->1000X #2->1000Y\nSim.Motor[1].Plant=1 Motor[1].FatalFeLimit=0\nopen prog 1\nlinear abs ta100 ts0 F100\nX10 Y10\nclose\n");
  REQUIRE(w.run("pmac-run", "lag.pmc -e '&1b1r' --until 2 --record r.csv --record-act").code == 0);
  const auto rows = csv(w.read("r.csv"));
  CHECK(rows[0] == std::vector<std::string>{"time_s", "Motor[1].DesPos", "Motor[1].ActPos", "Motor[2].DesPos", "Motor[2].ActPos", "X", "Y"});
  bool lags = false;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    lags = lags || std::stod(rows[i][1]) > std::stod(rows[i][2]) + 1;
    CHECK(rows[i][3] == rows[i][4]);                                  // without a plant: where it is commanded to be
    CHECK(std::stod(rows[i][5]) == Approx(std::stod(rows[i][1]) / 1000).margin(1e-9));
  }
  CHECK(lags);
  CHECK(std::stod(rows.back()[2]) == Approx(10000).margin(1));        // it has settled
}

TEST_CASE("option record has a row at 0, one a servo cycle, and the axes as forward map of the motors", "[tools]") {
  const Workspace w;
  REQUIRE(w.run("pmac-run", program("02_basic_moves.pmc") + " -e '&1b1r' --record r.csv").code == 0);
  const auto rows = csv(w.read("r.csv"));
  REQUIRE(rows.size() == 2 + 13575);  // names, t = 0, and ceil(6010 ms / 0.44274211 ms) ticks
  CHECK(rows[0] == std::vector<std::string>{"time_s", "Motor[1].DesPos", "X"});
  CHECK(rows[1] == std::vector<std::string>{"0", "0", "0"});
  CHECK(std::stod(rows[2][0]) == Approx(0.00044274211).epsilon(1e-12));
  CHECK(std::stod(rows.back()[0]) >= 6.010);
  for (std::size_t k = 1; k < rows.size(); k += 97) REQUIRE(std::stod(rows[k][1]) == Approx(1000 * std::stod(rows[k][2])).margin(1e-9));
}

TEST_CASE("option record names axes with their coordinate system where several have motors", "[tools]") {
  const Workspace w;
  w.write("two.pmc", "&1\n#1->1000X\n&2\n#2->100X\nopen prog 1\nF10 X1\nclose\n");
  const ToolResult r = w.run("pmac-run", "two.pmc -e '&1b1r &2b1r' --record r.csv --json");
  REQUIRE(r.code == 0);
  CHECK(csv(w.read("r.csv"))[0] == std::vector<std::string>{"time_s", "Motor[1].DesPos", "Motor[2].DesPos", "&1.X", "&2.X"});
  CHECK(json::parse(r.out)["moves"].size() == 2);
}

TEST_CASE("the same run writes the same bytes twice", "[tools]") {
  const Workspace w;
  REQUIRE(w.run("pmac-run", program("05_blended_contour.pmc") + " -e '&1b4r' --record a.csv").code == 0);
  REQUIRE(w.run("pmac-run", program("05_blended_contour.pmc") + " -e '&1b4r' --record b.csv").code == 0);
  CHECK(w.read("a.csv") == w.read("b.csv"));
}

TEST_CASE("a compiled module runs like its source", "[tools]") {
  const Workspace w;
  REQUIRE(w.run("pmacc", program("05_blended_contour.pmc") + " -o c.pmx").code == 0);
  REQUIRE(w.run("pmac-run", "c.pmx -e '&1b4r' --record a.csv").code == 0);
  REQUIRE(w.run("pmac-run", program("05_blended_contour.pmc") + " -e '&1b4r' --record b.csv").code == 0);
  CHECK(w.read("a.csv") == w.read("b.csv"));
}

TEST_CASE("option gather writes what the program gathers", "[tools]") {
  const Workspace w;
  REQUIRE(w.run("pmac-run", program("03_scurve_loop.pmc") + " -e '&1b2r' --gather g.csv").code == 0);
  const auto rows = csv(w.read("g.csv"));
  CHECK(rows[0] == std::vector<std::string>{"time_s", "Sys.ServoCount", "Motor[2].DesPos"});
  // Two rounds of 7 s; the assignment that ends gathering is calculated when the second round's last dwell is over.
  CHECK(std::stod(rows.back()[0]) == Approx(14.0).margin(0.001));
  w.write("items.pmc",
          "&1 #1->1000X\nGather.Addr[0]=Motor[1].DesPos.a\nGather.Addr[1]=Motor[1].DesVel.a\nGather.Items=2\nGather.Period=10\n"
          "Gather.MaxSamples=50\nopen prog 1\nGather.Enable=2\nF10 X1\nclose\n");
  REQUIRE(w.run("pmac-run", "items.pmc -e '&1b1r' --gather i.csv").code == 0);
  const auto items = csv(w.read("i.csv"));
  CHECK(items[0] == std::vector<std::string>{"time_s", "Motor[1].DesPos", "Motor[1].DesVel"});
  CHECK(items.size() == 51);
  CHECK(std::stod(items[2][0]) - std::stod(items[1][0]) == Approx(10 * 0.00044274211).epsilon(1e-9));
}

TEST_CASE("option plot draws pictures", "[tools]") {
  const Workspace w;
  REQUIRE(w.run("pmac-run", program("06_oval.pmc") + " -e '&1b5r' --plot o.svg --plot o.png").code == 0);
  CHECK(w.read("o.svg").find("<svg") != std::string::npos);
  CHECK(w.read("o.png").substr(1, 3) == "PNG");
}

TEST_CASE("option emit prints the records of every hop", "[tools]") {
  const Workspace w;
  for (const char* stage : {"commands", "path", "segments", "lookahead", "servo"}) {
    const ToolResult r = w.run("pmac-run", program("07_oval_lookahead.pmc") + " -e '&1b5r' --emit=" + stage);
    CHECK(r.code == 0);
    CHECK(std::count(r.out.begin(), r.out.end(), '\n') >= 6);
  }
  for (const char* stage : {"tokens", "tree", "ir", "bytecode", "symbols"})
    CHECK(w.run("pmacc", program("07_oval_lookahead.pmc") + " --emit=" + stage).code == 0);
}

TEST_CASE("inputs are set at their time and outputs are logged with theirs", "[tools]") {
  const Workspace w;
  const ToolResult r = w.run("pmac-run", program("04_looping_and_io.pmc") +
                                             " -e 'LoopCtrlInput=1 DirCtrlInput=1 &1b3r' --at 2.5 'LoopCtrlInput=0' --json");
  REQUIRE(r.code == 0);
  const json j = json::parse(r.out);
  REQUIRE(j["outputs"].size() == 2);  // the laser on and off; stimulated inputs are no outputs
  CHECK(j["outputs"][0]["name"] == "LaserOn");
  CHECK(j["outputs"][0]["value"] == 1.0);
  CHECK(j["outputs"][0]["time_s"].get<double>() >= 1.575);
  CHECK(j["outputs"][1]["value"] == 0.0);
}

TEST_CASE("a command that is refused at every scan is reported once, and its count at the end", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "open plc 1\ncmd \"&1b77\"\nclose\n");
  const ToolResult r = w.run("pmac-run", "a.pmc -e 'enable plc 1' --until 0.1 --json=summary");
  CHECK(r.code == 3);
  const std::string refusal = "a.pmc:2: cmd \"&1b77\": begin: error #22: PROGRAM NOT IN BUFFER: there is no motion program 77\n";
  CHECK(r.err == "refused: " + refusal + "refused 100 times in all: " + refusal);   // a background scan every 1 ms
  const auto j = nlohmann::json::parse(r.out);
  REQUIRE(j["refused"].size() == 1);
  CHECK(j["refused"][0]["count"] == 100);
}

TEST_CASE("record: a motor that moves when the columns stand is named", "[tools]") {
  const Workspace w;
  w.write("a.cfg", "&1 #1->1000X\nMotor[5].JogSpeed=1\n");
  const std::string run = "a.cfg -e '#1j=10' --until 160 --record r.csv --at ";
  const ToolResult early = w.run("pmac-run", run + "1 '#5j=100'");
  CHECK(early.err.find("Motor[5]") == std::string::npos);
  CHECK(w.read("r.csv").starts_with("time_s,Motor[1].DesPos,Motor[5].DesPos,X\n0,0,0,0\n"));
  const ToolResult late = w.run("pmac-run", run + "150 '#5j=100'");
  CHECK(late.err.find("motor 5 moved for the first time when the columns of the record stood already") != std::string::npos);
  CHECK(w.read("r.csv").starts_with("time_s,Motor[1].DesPos,X\n"));
}

TEST_CASE("archives: with the number of rows known beforehand or not, the bytes are the same, also where the run ends early", "[tools]") {
  const Workspace w;
  w.write("loop.pmc", "&1\n#1->1000X\n#2->1000Y\nCoord[1].SegMoveTime=5\nopen prog 1\nlinear abs ta10 F100\nwhile (P1 < 50000)\n{\nX(P1 % 7) Y(P1 % 3)\nP1=P1+1\n}\nclose\n");
  const std::string run = "pmac-run loop.pmc -q -e '&1b1r' ";
  REQUIRE(w.shell(run + "--until 20 --record known.npz").code == 0);
  REQUIRE(w.shell(run + "--max-time 20 --record unknown.npz").code == 4);
  CHECK(w.read("known.npz").size() > 5 * 40'000 * 8);
  CHECK((w.read("known.npz") == w.read("unknown.npz")));
  REQUIRE(w.shell(run + "--until 3000 --max-output 3 --record early.npz").code == 4);
  REQUIRE(w.shell(run + "--max-output 3 --record early_unknown.npz").code == 4);
  CHECK((w.read("early.npz") == w.read("early_unknown.npz")));
  CHECK(w.read("early.npz").size() < 3000 * 2258 * 5 * 8 / 2);
}

TEST_CASE("a record beyond the file size limit of the shell is an error, and leaves nothing", "[tools]") {
  const Workspace w;
  for (const char* file : {"a.npz", "a.csv"}) {
    const ToolResult r = w.shell("ulimit -f 100; pmac-run " + program("05_blended_contour.pmc") + " -q -e '&1b1r' --until 20 --record " + file);
    CHECK(r.code == 2);
    CHECK(r.err.find("cannot write") != std::string::npos);
    CHECK(w.shell("ls -A | grep -E 'npz|csv'").out == "");
  }
}
