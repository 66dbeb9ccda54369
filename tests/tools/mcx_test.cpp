// Register scripts and --drive mcx514 through pmac-run.
#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "tests/tools/run_shell.h"

using nlohmann::json;
using pmac::test::program;
using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

/// Register and value of every write in a text, as the manual prints them.
std::vector<std::string> writes(const std::string& text) {
  static const std::regex pattern("WR([0-7])\\s*(?:\xe2\x86\x90|<-)\\s*([0-9A-F]{4})h");
  std::vector<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) found.push_back((*it)[1].str() + ":" + (*it)[2].str());
  return found;
}

/// The 21 writes of the listing, MCX514 manual p114.
const std::vector<std::string> kListing = {"6:0043", "0:002A", "6:03E8", "7:0000", "0:0104", "6:03E8", "7:0000", "0:0105", "6:1388", "7:0000", "0:0108",
                                           "6:0000", "7:0000", "0:0208", "6:1388", "7:0000", "0:0106", "6:EC78", "7:FFFF", "0:0206", "0:0064"};

std::vector<std::vector<double>> rows_of(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

}  // namespace

TEST_CASE("the manual's listing runs as printed and tells what it did", "[tools][mcx514]") {
  const Workspace w;
  const ToolResult r = w.run("pmac-run", program("mcx514/circle_cw.mcx") + " --json --record cw.csv");
  REQUIRE(r.code == 0);
  CHECK(r.err.empty());
  const json j = json::parse(r.out);
  CHECK(j["status"] == "idle");
  CHECK(j["positions"] == json({{"X", 5000}, {"Y", -5000}}));
  CHECK(j["pulses"] == json({{"X", 15000}, {"Y", 15000}}));
  CHECK(j["events"] == 21213);
  CHECK(j["octants"] == json({3, 2, 1, 0, 7, 6}));
  CHECK(j["stop"] == "short axis");
  CHECK(j["time_s"].get<double>() == Approx(24.850818).epsilon(1e-12));
  CHECK(j["drives"].size() == 1);
  const std::string csv = w.read("cw.csv");
  CHECK(csv.substr(0, csv.find('\n')) == "time_s,X,Y");
  const auto rows = rows_of(csv);
  REQUIRE(rows.size() == 21213);
  CHECK(rows.front() == std::vector<double>{0, 0, 1});   // from quadrant 3 on the left, clockwise: up
  CHECK(rows.back()[1] == 5000);
  CHECK(rows.back()[2] == -5000);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    REQUIRE(std::abs(std::hypot(rows[i][1] - 5000, rows[i][2]) - 5000) <= 1.0);
    if (i == 0) continue;
    const double period = rows[i][0] - rows[i - 1][0];
    const bool both = rows[i - 1][1] != (i > 1 ? rows[i - 2][1] : 0) && rows[i - 1][2] != (i > 1 ? rows[i - 2][2] : 0);
    REQUIRE(period == Approx(both ? 0.001414 : 0.001).epsilon(1e-6));
  }
}

TEST_CASE("a script without record tells the same, and its error", "[tools][mcx514]") {
  const Workspace w;
  const json with = json::parse(w.run("pmac-run", program("mcx514/circle_ccw.mcx") + " --json --record a.npz").out);
  const ToolResult r = w.run("pmac-run", program("mcx514/circle_ccw.mcx") + " --json");
  const json without = json::parse(r.out);
  CHECK(with == without);
  CHECK(without["positions"] == json({{"X", -700}, {"Y", 299}}));
  CHECK(without["octants"] == json({6, 7, 0, 1, 2, 3, 4}));
  CHECK(without["time_s"].get<double>() == Approx((2287 - 948) * 0.001 + 948 * 0.001414).epsilon(1e-12));
  CHECK(without["error_pulses"]["min"].get<double>() > -0.5);
  CHECK(without["error_pulses"]["max"].get<double>() < 0.5);
  CHECK(r.err.find("warning: the finish point lies 2.23 pulses outside the circle") != std::string::npos);
  CHECK(w.read("a.npz").substr(0, 2) == "PK");
}

TEST_CASE("every wrong line of a script is named in one run", "[tools][mcx514]") {
  const Workspace w;
  w.write("bad.mcx",
          "WR6 <- 0043h\nWR0 <- 002Ah\nWR0 <- 002Ch ; no such command\nWR6 <- 0000h\nWR7 <- 4000h\nWR0 <- 0106h\nWR0 <- 0206h\n"
          "WR0 <- 0308h ; out of range\nWR0 <- 0061h ; no speed\nWR6 <-\n");
  const ToolResult r = w.run("pmac-run", "bad.mcx --json --record bad.csv");
  CHECK(r.code == 1);
  CHECK(r.out.empty());
  CHECK_FALSE(w.has("bad.csv"));
  for (const char* text : {"bad.mcx:3:1: error: there is no command 2Ch", "bad.mcx:8:1: error: 1073741824 is out of range for 08h",
                           "bad.mcx:9:1: error: 61h (2-axis linear interpolation): axis X has no drive speed (05h)", "bad.mcx:6:1: error: 1073741824 is out of range for a finish point",
                           "bad.mcx:11:1: error: the script ends inside a write; the value is missing"}) {
    INFO(text << "\n" << r.err);
    CHECK(r.err.find(text) != std::string::npos);
  }
}

TEST_CASE("exit codes of register scripts", "[tools][mcx514]") {
  const Workspace w;
  const std::string start = "WR6 <- 0003h\nWR0 <- 002Ah\nWR6 <- 03E8h\nWR7 <- 0000h\nWR0 <- 0104h\nWR0 <- 0105h\nWR6 <- 000Ah\nWR0 <- 0106h\nWR0 <- 0206h\nWR0 <- 0061h\n";
  w.write("underrun.mcx", start + "WR0 <- 0106h\nwait 1 s\n");
  const ToolResult underrun = w.run("pmac-run", "underrun.mcx --json");
  CHECK(underrun.code == 3);
  CHECK(underrun.err.find("underrun.mcx:11: fault at 0.010000000 s: continuous interpolation") == 0);
  CHECK(json::parse(underrun.out)["faults"].size() == 1);
  w.write("endless.mcx", start + "wait idle\nWR0 <- 0152h\n");
  const ToolResult endless = w.run("pmac-run", "endless.mcx --json --max-time 2");
  CHECK(endless.code == 4);
  CHECK(json::parse(endless.out)["status"] == "time-limit");
  CHECK(w.run("pmac-run", "missing.mcx").code == 2);
  CHECK(w.run("pmac-run", "underrun.mcx endless.mcx").code == 2);
  CHECK(w.run("pmac-run", "underrun.mcx -e '&1b1r'").code == 2);
  w.write("twice.mcx", start + "WR0 <- 0061h\n");
  const ToolResult twice = w.run("pmac-run", "twice.mcx");
  CHECK(twice.code == 1);
  CHECK(twice.err.find("twice.mcx:11:1: error: drive command while driving") == 0);
}

TEST_CASE("the largest circle runs at once", "[tools][mcx514]") {
  const Workspace w;
  w.write("large.mcx",
          "WR6 <- 0043h\nWR0 <- 002Ah\nWR6 <- 1200h\nWR7 <- 007Ah\nWR0 <- 0104h\nWR0 <- 0105h\nWR6 <- FFFFh\nWR7 <- 3FFFh\nWR0 <- 0108h\nWR6 <- 0000h\nWR7 <- 0000h\nWR0 <- 0208h\n"
          "WR0 <- 0306h\nWR0 <- 0065h\n");
  const ToolResult r = w.run("pmac-run", "large.mcx --json");
  REQUIRE(r.code == 0);
  const json j = json::parse(r.out);
  CHECK(j["positions"] == json({{"X", 0}, {"Y", 0}}));
  CHECK(j["pulses"]["X"] == 4LL * 1073741823);
  CHECK(j["error_pulses"].is_null());
}

TEST_CASE("the programs of register scripts do what their heads say", "[tools][mcx514]") {
  const Workspace w;
  const json square = json::parse(w.run("pmac-run", program("mcx514/rounded_square.mcx") + " --json").out);
  CHECK(square["positions"] == json({{"X", 0}, {"Y", 0}}));
  REQUIRE(square["drives"].size() == 8);
  for (std::size_t i = 1; i < 8; ++i) CHECK(square["drives"][i]["start_s"] == square["drives"][i - 1]["end_s"]);
  const json helix = json::parse(w.run("pmac-run", program("mcx514/helix.mcx") + " --json").out);
  CHECK(helix["positions"] == json({{"X", 0}, {"Y", 0}, {"Z", 900}}));
  CHECK(helix["pulses"]["X"] == 12000);
  const json ramps = json::parse(w.run("pmac-run", program("mcx514/ramps.mcx") + " --json").out);
  CHECK(ramps["time_s"].get<double>() == Approx(0.45 + 0.45 + 0.705).epsilon(1e-9));
}

TEST_CASE("a clockwise arc becomes the manual's listing", "[tools][mcx514]") {
  const Workspace w;
  const ToolResult r = w.run("pmac-run", program("mcx514/arc.pmc") + " -e '&1 b1r' --drive mcx514 --emit=frames");
  REQUIRE(r.code == 0);
  CHECK(writes(r.out) == kListing);
  w.write("frames.mcx", r.out);
  const ToolResult again = w.run("pmac-run", "frames.mcx --json");
  INFO(again.err);
  REQUIRE(again.code == 0);
  CHECK(json::parse(again.out)["positions"] == json({{"X", 5000}, {"Y", -5000}}));
}

TEST_CASE("the blended contour stays within a pulse of its path on two simulated axes", "[tools][mcx514]") {
  const Workspace w;
  const ToolResult r = w.run("pmac-run", program("05_blended_contour.pmc") + " -e '&1 b4r' --drive mcx514 --json --emit=frames");
  INFO(r.err);
  REQUIRE(r.code == 0);
  const ToolResult j = w.run("pmac-run", program("05_blended_contour.pmc") + " -e '&1 b4r' --drive mcx514 --json --drive-record c.csv");
  const json drive = json::parse(j.out)["drive"];
  CHECK(drive["error_max_pulses"].get<double>() <= 1.0);
  CHECK(drive["end_error_pulses"].get<double>() <= 1.0);
  // Against the corners of the program by hand: 1000 pulses a unit, twelve blocks (programs/05).
  double worst = 0;
  std::vector<std::vector<double>> rows = rows_of(w.read("c.csv"));
  const auto at_start = [](const std::vector<double>& row) { return row[1] == 1000 && row[2] == 4000; };  // and end; rapid moves lead there and away
  rows.erase(std::find_if(rows.rbegin(), rows.rend(), at_start).base(), rows.end());
  rows.erase(rows.begin(), std::find_if(rows.begin(), rows.end(), at_start));
  CHECK(rows.size() > 40'000);
  for (const auto& row : rows) {
    const double x = row[1] / 1000, y = row[2] / 1000;
    const auto line = [&](double x0, double y0, double x1, double y1) {
      const double length = std::hypot(x1 - x0, y1 - y0), share = std::clamp(((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / (length * length), 0.0, 1.0);
      return std::hypot(x - x0 - share * (x1 - x0), y - y0 - share * (y1 - y0));
    };
    const auto quarter = [&](double cx, double cy, double r0, int sx, int sy) {
      return (x - cx) * sx >= -1e-3 && (y - cy) * sy >= -1e-3 ? std::abs(std::hypot(x - cx, y - cy) - r0) : 1e9;
    };
    const double off = std::min({line(1, 4, 1, 13), quarter(2, 13, 1, -1, 1), line(2, 14, 3, 14), quarter(3, 13, 1, 1, 1), line(4, 13, 4, 7), quarter(7, 7, 3, -1, -1),
                                 line(7, 4, 13, 4), quarter(13, 3, 1, 1, 1), line(14, 3, 14, 2), quarter(13, 2, 1, 1, -1), line(13, 1, 4, 1), quarter(4, 4, 3, -1, -1)});
    worst = std::max(worst, off);
  }
  CHECK(worst <= 0.001);
}

TEST_CASE("a drive at the program's durations ends with the program", "[tools][mcx514]") {
  const Workspace w;
  const json drive = json::parse(w.run("pmac-run", program("05_blended_contour.pmc") + " -e '&1 b4r' --drive mcx514:speed=duration --json").out)["drive"];
  CHECK(drive["time_s"].get<double>() == Approx(drive["program_time_s"].get<double>()).epsilon(0.002));
  CHECK(drive["error_max_pulses"].get<double>() <= 1.0);
}

TEST_CASE("real corners, curves, helices and rapid moves stay within a pulse of the path", "[tools][mcx514]") {
  const Workspace w;
  w.write("mixed.pmc",
          "&1 #1->731X #2->731Y #3->731Z Coord[1].SegMoveTime=5\nopen prog 1\nabs; normal K-1; F20; ta50; ts20;\nlinear X3.3 Y1.7; linear X5 Y-2.2; linear X0.3 Y0.9;\n"
          "circle1 X1.3 Y0.9 I0.5 J0.01; circle2 X2.71 Y1.23 Z0.5 R4; linear X0 Y0 Z0;\npvt 200; X1:3 Y0.5:0; X2:0 Y0:0;\nrapid X0 Y1;\nclose\n");
  const ToolResult r = w.run("pmac-run", "mixed.pmc -e '&1b1r' --drive mcx514 --json");
  INFO(r.err);
  REQUIRE(r.code == 0);
  const json drive = json::parse(r.out)["drive"];
  CHECK(drive["error_max_pulses"].get<double>() <= 1.0);
  CHECK(drive["end_error_pulses"].get<double>() <= 1.0);
  CHECK(drive["pulses_Z"].get<double>() > 0);
}

TEST_CASE("what one chip cannot do is refused by name", "[tools][mcx514]") {
  const Workspace w;
  w.write("five.pmc", "&1 #1->X #2->Y #3->Z #4->A #5->B\nopen prog 1\nF1000 X100 Y100 Z100 A100 B100\nclose\n");
  const ToolResult five = w.run("pmac-run", "five.pmc -e '&1b1r' --drive mcx514");
  CHECK(five.code == 3);
  CHECK(five.err.find("is the fifth that moves") != std::string::npos);
  w.write("fast.pmc", "&1 #1->100000000X\nMotor[1].MaxSpeed=0 Motor[1].InvAmax=0\nopen prog 1\nF10 X10\nclose\n");
  const ToolResult fast = w.run("pmac-run", "fast.pmc -e '&1b1r' --drive mcx514");
  CHECK(fast.code == 3);
  CHECK(fast.err.find("the chip's limit is 8000000") != std::string::npos);
  w.write("two.pmc", "&1 #1->1000X\n&2 #2->1000X\nopen prog 1\nF10 X10\nclose\n");
  const ToolResult two = w.run("pmac-run", "two.pmc -e '&1b1r &2b1r' --drive mcx514");
  CHECK(two.code == 3);
  CHECK(two.err.find("move at the same time") != std::string::npos);
  CHECK(w.run("pmac-run", "two.pmc -e '&1b1r' --drive mcx514:speed=fast").code == 2);
}
