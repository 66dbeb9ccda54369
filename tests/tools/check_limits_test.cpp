// --check-limits and what --stats says of moves: closed forms of short programs, found again in what the tool prints.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/tools/run_shell.h"

using nlohmann::json;
using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Two axes, 1000 motor units each, in segments of 5 ms.
std::string segmented(const std::string& set_up, const std::string& moves) {
  return "&1\n#1->1000X\n#2->1000Y\nCoord[1].SegMoveTime=5\n" + set_up + "\nopen prog 1\nabs;\n" + moves + "close\n";
}

json limits_of(const Workspace& w, const std::string& text, int expected_code, const std::string& options = "") {
  w.write("p.pmc", text);
  const ToolResult r = w.run("pmac-run", "p.pmc -e '&1b1r' --check-limits --json " + options);
  INFO(r.err);
  CHECK(r.code == expected_code);
  return json::parse(r.out);
}

}  // namespace

TEST_CASE("check-limits: speed and acceleration of a ramp, their limits, time and line", "[tools]") {
  const Workspace w;
  // 50 mm/s reached in 100 ms: 50 mu/ms and 0.5 mu/ms^2, against 40 and 0.4: both 1.25 times.
  const std::string moves = "F50 ta100 ts0\nlinear X20\nlinear X20 Y20\n";
  const json j = limits_of(w, segmented("Motor[1].MaxSpeed=40 Motor[1].InvAmax=2.5 Motor[2].MaxSpeed=100 Motor[2].InvAmax=1", moves), 3);
  const json& one = j["limits"]["1"];
  CHECK(one["ok"] == false);
  CHECK(one["speed"]["value"].get<double>() == Approx(50.0));
  CHECK(one["speed"]["limit"] == 40.0);
  CHECK(one["speed"]["share"].get<double>() == Approx(1.25));
  CHECK(one["speed"]["line"] == 9);
  CHECK(one["accel"]["value"].get<double>() == Approx(0.5));
  CHECK(one["accel"]["share"].get<double>() == Approx(1.25));
  CHECK(one["jerk"]["limit"].is_null());
  CHECK_FALSE(one.contains("position"));
  CHECK(j["limits"]["2"]["ok"] == true);
  const ToolResult text = w.run("pmac-run", "p.pmc -e '&1b1r' --check-limits");
  CHECK(text.code == 3);
  CHECK(contains(text.out, "limits are exceeded"));
  CHECK(contains(text.out, "p.pmc:9  EXCEEDED"));
}

TEST_CASE("check-limits: a limit of 0 is off, and a program within its limits ends with 0", "[tools]") {
  const Workspace w;
  const json j = limits_of(w, segmented("Motor[1].MaxSpeed=0 Motor[1].InvAmax=0 Motor[2].MaxSpeed=0 Motor[2].InvAmax=0", "F500 ta10 ts0\nlinear X20 Y20\n"), 0);
  for (const char* motor : {"1", "2"}) {
    CHECK(j["limits"][motor]["ok"] == true);
    CHECK(j["limits"][motor]["speed"]["limit"].is_null());
  }
}

TEST_CASE("check-limits: jerk counts with --limit-jerk", "[tools]") {
  const Workspace w;
  // 0.5 mu/ms^2 built up in 50 ms: jerk 0.01 mu/ms^3, against 1/200.
  const std::string limits = "Motor[1].MaxSpeed=0 Motor[1].InvAmax=0 Motor[2].MaxSpeed=0 Motor[2].InvAmax=0 ";
  const json j = limits_of(w, segmented(limits + "Motor[1].InvJmax=200", "F50 ta100 ts50\nlinear X20\n"), 3, "--limit-jerk");
  CHECK(j["limits"]["1"]["jerk"]["value"].get<double>() == Approx(0.01).epsilon(1e-3));
  CHECK(j["limits"]["1"]["jerk"]["limit"] == 0.005);
  limits_of(w, segmented(limits + "Motor[1].InvJmax=99.9", "F50 ta100 ts50\nlinear X20\n"), 0, "--limit-jerk");
  limits_of(w, segmented(limits + "Motor[1].InvJmax=200", "F50 ta100 ts50\nlinear X20\n"), 0);
}

TEST_CASE("check-limits: a stop has InvDmax where it is assigned, a blend has not", "[tools]") {
  const Workspace w;
  // Ramps of 0.5 mu/ms^2. The limit is 1, that of stops 0.4.
  const std::string limits = "Motor[1].MaxSpeed=0 Motor[2].MaxSpeed=0 Motor[1].InvAmax=1 Motor[2].InvAmax=1 ";
  const json j = limits_of(w, segmented(limits + "Motor[1].InvDmax=2.5 Motor[2].InvDmax=2.5", "F50 ta100 ts0\nlinear X20\nlinear X20 Y20\n"), 3);
  CHECK(j["limits"]["1"]["ok"] == true);    // X slows down while Y speeds up
  CHECK(j["limits"]["2"]["ok"] == false);   // Y stops
  CHECK(j["limits"]["2"]["accel"]["limit"] == 0.4);
  CHECK(j["limits"]["2"]["accel"]["line"] == 10);
}

TEST_CASE("check-limits: positions, where a motor comes nearest to their limits", "[tools]") {
  const Workspace w;
  const std::string limits = "Motor[1].MaxSpeed=0 Motor[2].MaxSpeed=0 Motor[1].InvAmax=0 Motor[2].InvAmax=0 Motor[1].MinPos=-5000 Motor[1].MaxPos=19000";
  w.write("p.pmc", segmented(limits, "F50 ta100 ts0\nlinear X18.9\nlinear X0\n"));
  const ToolResult kept = w.run("pmac-run", "p.pmc -e '&1b1r' --check-limits --json");
  CHECK(kept.code == 0);
  const json position = json::parse(kept.out)["limits"]["1"]["position"];
  CHECK(position["value"].get<double>() == Approx(18900 - 100 * 100 / 8.0).margin(1));  // the blend cuts the corner by dv T / 8
  CHECK(position["limit"] == 19000.0);
}

TEST_CASE("check-limits: jogs are held to JogSpeed, MaxSpeed and their rates", "[tools]") {
  const Workspace w;
  w.write("p.pmc", "Motor[1].JogSpeed=30 Motor[1].JogTa=-10 Motor[1].JogTs=-50 Motor[1].MaxSpeed=25\n");
  const ToolResult r = w.run("pmac-run", "p.pmc -e '#1j:20000' --check-limits --json");
  CHECK(r.code == 3);
  const json one = json::parse(r.out)["limits"]["1"];
  CHECK(one["speed"]["limit"] == 25.0);
  CHECK(one["speed"]["value"].get<double>() == Approx(30));
  CHECK(one["accel"]["limit"].get<double>() == Approx(0.1));
  CHECK(one["accel"]["share"].get<double>() == Approx(1).epsilon(1e-3));
  CHECK(one["jerk"]["limit"].get<double>() == Approx(0.02));
  CHECK(one["jerk"]["share"].get<double>() == Approx(1).epsilon(1e-3));
  w.write("p.pmc", "Motor[1].JogSpeed=30 Motor[1].JogTa=-10 Motor[1].JogTs=-50\n");
  CHECK(w.run("pmac-run", "p.pmc -e '#1j:20000' --check-limits").code == 0);
}

TEST_CASE("stats: what governed each move", "[tools]") {
  const Workspace w;
  const std::string limits = "Motor[1].MaxSpeed=30 Motor[2].MaxSpeed=500 Motor[1].InvAmax=1 Motor[2].InvAmax=100\n&1 define lookahead 1000\nCoord[1].LHDistance=100";
  w.write("p.pmc", segmented(limits, "F50 ta0 ts0\nlinear X20\ndwell 0\nF5\nlinear X30\ndwell 0\ntm 1000\nlinear X20\ndwell 0\nF1\nlinear X20 Y2\n"
                                     "dwell 0\nta400\nF100\nlinear Y3\ndwell0\nrapid Y20\n"));
  const ToolResult r = w.run("pmac-run", "p.pmc -e '&1b1r' --stats --json");
  CHECK(r.code == 0);
  const json moves = json::parse(r.out)["moves"];
  const auto governs = [&](std::size_t move) { return moves[move]["governed"][0]["by"].get<std::string>(); };
  CHECK(governs(0) == "MaxSpeed of motor 1");  // 50 mm/s asked, 30 allowed
  CHECK(governs(2) == "F");
  CHECK(governs(4) == "tm");
  CHECK(governs(6) == "F");
  CHECK(governs(8) == "ta and ts");            // 10 ms at F100, but the ramp takes 400; 2.5 mm/s in 400 ms
  CHECK(governs(10) == "JogTa of motor 2");    // 19000 mu at 500 mu/ms: never reached
  CHECK(contains(r.err, "MaxSpeed of motor 1 9"));
}
