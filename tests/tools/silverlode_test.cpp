// pmac-silverlode and pmac-run --drive silverlode as a user calls them.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <sstream>

#include "tests/tools/run_shell.h"

using nlohmann::json;
using pmac::test::program;
using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

json parsed(const ToolResult& ran) {
  const json j = json::parse(ran.out, nullptr, false);
  INFO(ran.out << ran.err);
  REQUIRE(j.is_object());
  return j;
}

std::size_t lines_of(const std::string& text) { return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')); }

}  // namespace

TEST_CASE("silverlode circle: the figures of 72 and 360 segments by both builders", "[tools]") {
  const Workspace w;
  const auto min_of = [&w](const std::string& options) { return parsed(w.run("pmac-silverlode", "circle --json --radius 4000 --velocity 1000 " + options))["radial_error_counts"]["min"].get<double>(); };
  CHECK(min_of("--segments 72") == Approx(-3.807).margin(0.001));
  CHECK(min_of("--segments 72 --builder=literal") == Approx(-5.039).margin(0.001));
  CHECK(min_of("--segments 360 --builder closed") == Approx(-0.152).margin(0.001));
  CHECK(min_of("--segments 360 --builder literal") == Approx(-7.496).margin(0.001));
}

TEST_CASE("silverlode circle: the JSON object has the entries as sent", "[tools]") {
  const Workspace w;
  const json j = parsed(w.run("pmac-silverlode", "circle --segments 72 --json"));
  REQUIRE(j["entries"].size() == 73);
  CHECK(j["entries"][0]["ticks"] == 2928);
  CHECK(j["entries"][0]["X"] == json({{"pos", -1073741824}, {"acc", 8361}, {"vel", 351144}}));
  CHECK(j["entries"][0]["Y"] == json({{"pos", 1073741824}, {"acc", 191489}, {"vel", 8042520}}));
  CHECK(j["entries"][72]["X"]["vel"] == 0);
  CHECK(j["closing_error_counts"].get<double>() < 0.001);
  CHECK(j["time_s"].get<double>() == Approx(209491 * 0.00012).epsilon(1e-12));
}

TEST_CASE("silverlode circle: the record has a row a tick, the table a row a segment", "[tools]") {
  const Workspace w;
  const ToolResult ran = w.run("pmac-silverlode", "circle --segments 4 --velocity 4000 --record r.csv --table t.csv --frames f.txt -q");
  CHECK(ran.code == 0);
  CHECK(w.read("r.csv").rfind("time_s,X,Y\n0,0,0\n0.00012,", 0) == 0);
  const json j = parsed(w.run("pmac-silverlode", "circle --segments 4 --velocity 4000 --json"));
  CHECK(lines_of(w.read("r.csv")) == j["ticks"].get<std::size_t>() + 2);
  CHECK(lines_of(w.read("t.csv")) == 1 + 6);
  CHECK(contains(w.read("t.csv"), "K:Tvm"));
  CHECK(contains(w.read("f.txt"), "@16 11 11 1\n"));
  const ToolResult decoded = w.run("pmac-silverlode", "decode f.txt");
  CHECK(decoded.code == 0);
  CHECK(lines_of(decoded.out) == lines_of(w.read("f.txt")));
  CHECK(contains(decoded.out, "IMW to 17: "));
}

TEST_CASE("silverlode circle: scale and offset, in user units", "[tools]") {
  const Workspace w;
  const json j = parsed(w.run("pmac-silverlode", "circle --segments 12 --radius 2 --scale 4000,4000 --velocity 0.5 --offset -1,0.5 --start-angle 90 --distance-angle -180 --json"));
  CHECK(j["start_counts"] == json({-4000.0, 2000.0}));
  CHECK(j["end_counts"][0].get<double>() == Approx(-4000));
  CHECK(j["end_counts"][1].get<double>() == Approx(2000 - 16000));
  CHECK(j["closing_error_counts"].get<double>() < 0.01);
}

TEST_CASE("silverlode circle: a third axis for the knife", "[tools]") {
  const Workspace w;
  const json j = parsed(w.run("pmac-silverlode", "circle --knife 10 --max-speed 4000,4000,2000 --max-accel 3000 --json"));
  CHECK(j["axes"] == json({"X", "Y", "theta"}));
  CHECK(j["entries"][10]["theta"]["vel"].get<int>() > 0);
}

TEST_CASE("silverlode circle: bad values are named", "[tools]") {
  const Workspace w;
  const auto refused = [&w](const std::string& options, const std::string& why) {
    const ToolResult ran = w.run("pmac-silverlode", "circle " + options);
    INFO(options << ": " << ran.out << ran.err);
    CHECK(ran.code == 2);
    CHECK(contains(ran.err, why));
    CHECK(ran.out.empty());
  };
  refused("--segments 0", "number of segments");
  refused("--segments 1e99", "not a whole number");
  refused("--segments 2.5", "not a whole number");
  refused("--radius -4", "radius");
  refused("--radius x", "'x' is not a number");
  refused("--velocity inf", "not a number");
  refused("--distance-angle 0", "distance angle");
  refused("--offset 5", "two numbers");
  refused("--max-accel 0", "acceleration of X");
  refused("--max-speed 1,2,3", "wanted one or 2");
  refused("--scale 0", "scale");
  refused("--min-slice -1", "minimum slice");
  refused("--builder wrong", "builder");
  refused("--max-speed 9000 --velocity 1e7 --max-accel 1e8", "beyond 2147483647");
  refused("--segments 3 --velocity 1e-6", "more ticks than a queue entry can count");
  refused("--segments 3 --velocity 1e-6 --builder literal", "time in ticks");
  refused("--velocity 0.01", "are not simulated");
  refused("--record r.xyz", "unknown ending");
  refused("--record r.csv --table r.csv", "two outputs");
  refused("--press 'soon stop'", "'soon' is not a number");
  refused("--press '5 dance'", "no action 'dance'");
  refused("--command POL=7", "documented");
  refused("--id 16,300", "300 is not an id");
  refused("--link --queue-depth 1", "make it deeper");
}

TEST_CASE("silverlode circle: the link with its faults", "[tools]") {
  const Workspace w;
  const ToolResult slow = w.run("pmac-silverlode", "circle --link --segments 360 --velocity 8000 --json");
  CHECK(slow.code == 3);
  CHECK(parsed(slow)["link"]["axes"]["X"]["underrun"] == true);
  const ToolResult wrong = w.run("pmac-silverlode", "circle --servo-id 16,19 -q");
  CHECK(wrong.code == 3);
  CHECK(contains(wrong.err, "no answer"));
  const ToolResult late = w.run("pmac-silverlode", "circle --link --start-latency 8 --json");
  CHECK(late.code == 0);
  CHECK(parsed(late)["radial_error_counts"]["max"].get<double>() == Approx(0.458).margin(0.001));
  CHECK(parsed(late)["link"]["axes"]["Y"]["start_ticks"] == 8);
  CHECK(contains(w.run("pmac-silverlode", "circle --segments 360 --velocity 8000 -q").err, "--min-slice"));
}

TEST_CASE("silverlode decode: what is no frame is named with its line", "[tools]") {
  const Workspace w;
  w.write("f.txt", "@16 163\r@16 999\r\n* 10\n@17 253 1 2\nhello\n");
  const ToolResult ran = w.run("pmac-silverlode", "decode f.txt");
  CHECK(ran.code == 1);
  CHECK(contains(ran.err, "f.txt:2: error: '999' is no command number"));
  CHECK(contains(ran.err, "f.txt:5: error: a reply begins with"));
  CHECK(contains(ran.out, "CIS to 16"));
  CHECK(contains(ran.out, "acknowledged by 16"));
  CHECK(contains(ran.out, "wants 4 parameters"));
  CHECK(w.run("pmac-silverlode", "decode nowhere.txt").code == 2);
  w.write("count.txt", "@17 253 1 2\n");
  CHECK(w.run("pmac-silverlode", "decode count.txt").code == 1);
  w.write("good.txt", "@16 163\n* 10\n");
  CHECK(w.run("pmac-silverlode", "decode good.txt").code == 0);
}

TEST_CASE("drive silverlode: the contour stays within three counts and ends where it began", "[tools]") {
  const Workspace w;
  const ToolResult ran = w.run("pmac-run", program("05_blended_contour.pmc") + " -e '&1 b4r' -q --drive silverlode --json=summary --drive-record d.csv");
  CHECK(ran.code == 0);
  const json drive = parsed(ran)["drive"];
  CHECK(drive["axes"] == json({"Motor[1]", "Motor[2]"}));
  CHECK(drive["error_max_counts"].get<double>() < 3);
  CHECK(drive["end_error_counts"].get<double>() < 0.01);
  CHECK(w.read("d.csv").rfind("time_s,Motor[1].counts,Motor[2].counts,Motor[1].commanded,Motor[2].commanded,error_counts\n", 0) == 0);
}

TEST_CASE("drive silverlode: a motion beyond the limits is slowed down and says so", "[tools]") {
  const Workspace w;
  const ToolResult ran = w.run("pmac-run", program("06_oval.pmc") + " -e '&1 b5r' -q --drive silverlode:max_accel=600,max_speed=2000 --json=summary");
  CHECK(ran.code == 0);
  const json drive = parsed(ran)["drive"];
  CHECK(drive["error_max_counts"].get<double>() < 1);
  CHECK(drive["table_s"].get<double>() > 9);
  CHECK(drive["table_s"].get<double>() < 11);
  CHECK(contains(ran.err, "slowed down along its path"));
}

TEST_CASE("drive silverlode: frames, each a command that can be decoded", "[tools]") {
  const Workspace w;
  const ToolResult ran = w.run("pmac-run", program("07_oval_lookahead.pmc") + " -e '&1 b5r' -q --drive silverlode --emit=frames");
  CHECK(ran.code == 0);
  std::string frames;
  std::istringstream lines(ran.out);
  for (std::string line; std::getline(lines, line);) frames += line.substr(line.find('@')) + "\n";
  w.write("f.txt", frames);
  const ToolResult decoded = w.run("pmac-silverlode", "decode f.txt");
  CHECK(decoded.code == 0);
  CHECK(contains(decoded.out, "IMW to 17"));
  CHECK_FALSE(contains(decoded.out, "no known command"));
}

TEST_CASE("drive silverlode: what cannot be done is refused", "[tools]") {
  const Workspace w;
  w.write("still.pmc", "&1\n#1->X\n");
  const auto ran = [&w](const std::string& drive, const std::string& more = "") { return w.run("pmac-run", "still.pmc --drive '" + drive + "' " + more); };
  CHECK(ran("silverlode").code == 3);
  CHECK(contains(ran("silverlode").err, "no motor moves"));
  CHECK(contains(ran("lodesilver").err, "there is no drive 'lodesilver'"));
  CHECK(contains(ran("silverlode:max_sped=3").err, "no setting 'max_sped'"));
  CHECK(contains(ran("silverlode:max_speed=0").err, "max_speed: 0 is not from"));
  CHECK(contains(ran("silverlode:max_accel=fast").err, "'fast' is not a number"));
  CHECK(contains(ran("silverlode:STP=9").err, "documented"));
  CHECK(ran("silverlode:scale").code == 2);
  CHECK(w.run("pmac-run", "still.pmc --emit=frames").code == 2);
  CHECK(w.run("pmac-run", "still.pmc --drive-record x.csv").code == 2);
  const ToolResult far = ran("silverlode:scale=1e6,max_accel=1000000", "-e '#1j=100000'");
  CHECK(far.code == 3);
  CHECK(contains(far.err, "leaves the range of a servo"));
}

TEST_CASE("drive silverlode: a line that is too slow is an error of the run", "[tools]") {
  const Workspace w;
  const ToolResult ran = w.run("pmac-run", program("05_blended_contour.pmc") + " -e '&1 b4r' -q --drive silverlode:min_slice=0.004,tolerance=0.01 --json=summary");
  CHECK(ran.code == 3);
  CHECK(contains(ran.err, "the queue ran dry"));
}

TEST_CASE("drive silverlode: the programs of the course", "[tools]") {
  const Workspace w;
  const ToolResult circle = w.run("pmac-run", program("silverlode/circle.pmc") + " -e '&1 b1r' -q --drive silverlode:max_accel=3000 --json=summary");
  CHECK(circle.code == 0);
  CHECK(parsed(circle)["drive"]["error_max_counts"].get<double>() < 0.5);
  const ToolResult knife = w.run("pmac-run", program("silverlode/knife.pmc") + " -e '&1 b2r' -q --drive silverlode --json=summary");
  CHECK(knife.code == 0);
  CHECK(parsed(knife)["drive"]["axes"].size() == 3);
}
