// The chip as its scripts see it: the listing of the MCX514 manual p114, times, ramps, continuous interpolation, refusals.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "runtime/drives/mcx514/chip.h"

using namespace pmac::drives::mcx514;

namespace {

/// The writes of the manual's listing, p114.
const char* const kListing =
    "WR6 <- 0043h Write ; X and Y, constant vector speed\nWR0 <- 002Ah Write\n"
    "WR6 <- 03E8h Write ; 1000 PPS\nWR7 <- 0000h Write\nWR0 <- 0104h Write\n"
    "WR6 <- 03E8h Write\nWR7 <- 0000h Write\nWR0 <- 0105h Write\n"
    "WR6 <- 1388h Write\nWR7 <- 0000h Write\nWR0 <- 0108h Write\n"
    "WR6 <- 0000h Write\nWR7 <- 0000h Write\nWR0 <- 0208h Write\n"
    "WR6 <- 1388h Write\nWR7 <- 0000h Write\nWR0 <- 0106h Write\n"
    "WR6 <- EC78h Write\nWR7 <- FFFFh Write\nWR0 <- 0206h Write\n"
    "WR0 <- 0064h Write\n";

/// WR6, WR7 and WR0 for a command with data.
std::string data(std::int64_t value, const char* command) {
  const auto bits = static_cast<std::uint32_t>(value);
  return write_text(6, static_cast<std::uint16_t>(bits & 0xffff)) + "\n" + write_text(7, static_cast<std::uint16_t>(bits >> 16)) + "\nWR0 <- " + command + "h\n";
}

std::string mode(const char* bits) { return std::string("WR6 <- ") + bits + "h\nWR0 <- 002Ah\n"; }
std::string speeds(std::int64_t sv, std::int64_t dv) { return data(sv, "0104") + data(dv, "0105"); }
std::string line_to(std::int64_t x, std::int64_t y) { return data(x, "0106") + data(y, "0206"); }

void run(Chip& chip, const std::string& text) {
  const Script script = read_script(text);
  for (const Problem& problem : script.problems) FAIL_CHECK(problem.line << ": " << problem.text);
  REQUIRE(run_items(script, chip));
  REQUIRE(chip.run_until_idle());
}

std::vector<std::string> errors(const Chip& chip) {
  std::vector<std::string> found;
  for (const Problem& problem : chip.problems())
    if (problem.is_error) found.push_back(std::to_string(problem.line) + ": " + problem.text);
  return found;
}

struct Pulses : PulseSink {
  std::vector<double> time_s;
  std::vector<AxisCounts> position;
  void pulses(Time time, const Event&, const AxisCounts& at, const Interpolator&) override {
    time_s.push_back(seconds(time));
    position.push_back(at);
  }
};

}  // namespace

TEST_CASE("the listing of the manual runs to (5000,-5000)", "[mcx514]") {
  Chip chip;
  Pulses pulses;
  chip.observe(&pulses);
  run(chip, kListing);
  CHECK(chip.problems().empty());
  CHECK(chip.position() == AxisCounts{5000, -5000, 0, 0});
  REQUIRE(chip.drives().size() == 1);
  const DriveRecord& drive = chip.drives()[0];
  CHECK(drive.events == 21213);
  CHECK(drive.pulses == AxisCounts{15000, 15000, 0, 0});
  // 30000 pulses in 21213 events are 8787 events of two: (21213 - 8787) * 1 ms + 8787 * 1.414 ms
  CHECK(seconds(chip.now()) == Approx(24.850818).epsilon(1e-12));
  CHECK(chip.now() == time_from_clocks(397'613'088));
  CHECK(pulses.time_s.size() == 21213);
  CHECK(pulses.time_s[0] == 0.0);
  CHECK(pulses.time_s[1] == 0.001);
  CHECK(pulses.position.back() == AxisCounts{5000, -5000, 0, 0});
  REQUIRE(drive.error);
  CHECK(drive.error->low > -0.5);
  CHECK(drive.error->high < 0.5);
}

TEST_CASE("without constant vector speed every event lasts alike", "[mcx514]") {
  Chip chip;
  std::string text = kListing;
  text.replace(text.find("0043h"), 5, "0003h");
  run(chip, text);
  CHECK(seconds(chip.now()) == Approx(21.213).epsilon(1e-12));
}

TEST_CASE("axis toggle exchanges the axes of a circle", "[mcx514]") {
  Chip chip;
  std::string text = kListing;
  text.replace(text.find("0043h"), 5, "0053h");  // D4: ax1 is Y, ax2 is X; the centre (5000,0) of X and Y is straight up, the finish point (-5000,5000)
  run(chip, text);
  CHECK(chip.position() == AxisCounts{5000, -5000, 0, 0});
  CHECK(chip.drives()[0].quadrants == std::vector<int>{5, 4});  // a quarter, clockwise in (Y, X): from below the centre to its left
}

TEST_CASE("times do not depend on whether events are made or passed over", "[mcx514]") {
  const std::string text = mode("0043") + speeds(300, 300) + data(70'000, "0108") + data(-12'345, "0208") + line_to(0, 0) + "WR0 <- 0065h\n" +
                           "wait idle\n" + speeds(7'654'321, 7'654'321) + line_to(123'456, -98'765) + "WR0 <- 0061h\n";
  Chip watched, unwatched;
  Pulses pulses;
  watched.observe(&pulses);
  run(watched, text);
  run(unwatched, text);
  CHECK(watched.now() == unwatched.now());
  CHECK(watched.position() == unwatched.position());
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(watched.drives()[i].events == unwatched.drives()[i].events);
    CHECK(watched.drives()[i].pulses == unwatched.drives()[i].pulses);
    CHECK(watched.drives()[i].quadrants == unwatched.drives()[i].quadrants);
  }
  CHECK_FALSE(unwatched.drives()[0].error);
}

TEST_CASE("a line at constant vector speed stretches its double pulses", "[mcx514]") {
  Chip chip;
  run(chip, mode("0043") + speeds(1000, 1000) + line_to(1000, 400) + "WR0 <- 0061h\n");
  CHECK(seconds(chip.now()) == Approx(0.6 + 0.4 * 1.414).epsilon(1e-12));
  Chip three;
  run(three, mode("0087") + speeds(1000, 1000) + line_to(1000, 1000) + data(-1000, "0406") + "WR0 <- 0062h\n");
  CHECK(three.position() == AxisCounts{1000, 1000, -1000, 0});
  CHECK(seconds(three.now()) == Approx(1.732).epsilon(1e-12));
  Chip accurate;
  run(accurate, mode("00C3") + speeds(1000, 1000) + line_to(1000, 1000) + "WR0 <- 0061h\n");
  CHECK(seconds(accurate.now()) == Approx(std::sqrt(2.0)).epsilon(1e-8));
}

TEST_CASE("acceleration and deceleration take the time of straight ramps", "[mcx514]") {
  const std::string ramps = speeds(100, 1000) + data(1000, "0102");
  Chip up;
  run(up, mode("0003") + ramps + line_to(2000, 0) + "WR0 <- 0061h\n");
  // 0.9 s from 100 to 1000 pulses/s over 495 pulses, then 1505 pulses at 1000
  CHECK(seconds(up.now()) == Approx(0.9 + 1.505).epsilon(1e-9));
  Chip both;
  run(both, mode("0003") + ramps + data(2000, "0103") + "WR0 <- 006Dh\n" + line_to(2000, 0) + "WR0 <- 0061h\n");
  // down in 0.45 s over 247.5 pulses
  CHECK(seconds(both.now()) == Approx(0.9 + 0.45 + (2000 - 495 - 247.5) / 1000).epsilon(1e-9));
  Chip triangle;
  run(triangle, mode("0003") + ramps + "WR0 <- 006Dh\n" + line_to(200, 0) + "WR0 <- 0061h\n");
  // never at drive speed: up to sqrt(100^2 + 1000 * 200) and down again
  CHECK(seconds(triangle.now()) == Approx(2 * (std::sqrt(100.0 * 100 + 1000.0 * 200) - 100) / 1000).epsilon(1e-9));
  Chip single;  // a single axis decelerates by itself
  run(single, ramps + data(2000, "0106") + "WR0 <- 0150h\n");
  CHECK(seconds(single.now()) == Approx(0.9 + 0.9 + (2000 - 990) / 1000.0).epsilon(1e-9));
}

TEST_CASE("segments written while driving follow without a pause", "[mcx514]") {
  Chip chip;
  Pulses pulses;
  chip.observe(&pulses);
  std::string text = mode("0003") + speeds(1000, 1000) + line_to(100, 0) + "WR0 <- 0061h\n";
  for (int i = 0; i < 3; ++i) text += line_to(0, 50) + "WR0 <- 0061h\n";
  text += "read RR0\n" + data(0, "0108") + data(100, "0208") + line_to(100, 100) + "WR0 <- 0065h\n";
  run(chip, text);
  CHECK(errors(chip).empty());
  CHECK(chip.events().empty());
  CHECK(chip.drives().size() == 5);
  CHECK(chip.position() == AxisCounts{200, 250, 0, 0});
  REQUIRE(chip.reads().size() == 1);
  CHECK(chip.reads()[0].value == (0x3000 | 0x0800 | 0x0003));  // three wait, another may be written, X and Y drive
  for (std::size_t i = 1; i < pulses.time_s.size(); ++i) REQUIRE(pulses.time_s[i] - pulses.time_s[i - 1] == Approx(0.001).epsilon(1e-9));
}

TEST_CASE("the pre-buffer holds eight segments", "[mcx514]") {
  Chip chip;
  std::string text = mode("0003") + speeds(1000, 1000);
  for (int i = 0; i < 10; ++i) text += line_to(10, 5) + "WR0 <- 0061h\n";
  run(chip, text);
  REQUIRE(errors(chip).size() == 1);
  CHECK(errors(chip)[0].find("pre-buffer is full") != std::string::npos);
  Chip waiting;
  text = mode("0003") + speeds(1000, 1000);
  for (int i = 0; i < 100; ++i) text += line_to(10, 5) + (i > 0 ? "wait next\n" : "") + "WR0 <- 0061h\n";
  run(waiting, text);
  CHECK(errors(waiting).empty());
  CHECK(waiting.position() == AxisCounts{1000, 500, 0, 0});
}

TEST_CASE("a segment that comes too late is an underrun", "[mcx514]") {
  Chip chip;
  run(chip, mode("0003") + speeds(1000, 1000) + line_to(10, 0) + "WR0 <- 0061h\nwait 5 ms\n" + line_to(0, 10) + "wait 20 ms\nread RR0\nread RR2\nWR0 <- 0061h\n");
  REQUIRE(chip.events().size() == 1);
  CHECK(chip.events()[0].is_error);
  CHECK(seconds(chip.events()[0].time) == Approx(0.010));
  CHECK(chip.drives().back().stop == Stop::kUnderrun);
  CHECK(chip.reads()[0].value == 0x0030);  // errors of X and Y
  CHECK(chip.reads()[1].value == 0x0080);
  REQUIRE(errors(chip).size() == 1);
  CHECK(errors(chip)[0].find("error is pending") != std::string::npos);
  CHECK(chip.position() == AxisCounts{10, 0, 0, 0});
}

TEST_CASE("an error is cleared by its command", "[mcx514]") {
  Chip chip;
  run(chip, mode("0003") + speeds(1000, 1000) + line_to(10, 0) + "WR0 <- 0061h\nwait 5 ms\n" + line_to(0, 10) + "wait idle\nWR0 <- 0379h\nWR0 <- 0061h\n");
  CHECK(errors(chip).empty());
  CHECK(chip.position() == AxisCounts{10, 10, 0, 0});
}

TEST_CASE("what a drive needs and does not have is said with its line", "[mcx514]") {
  const auto first_error = [](const std::string& text) {
    Chip chip;
    run(chip, text);
    return errors(chip).empty() ? std::string("none") : errors(chip)[0];
  };
  const std::string drive = "WR0 <- 0061h\n", arc = "WR0 <- 0064h\n";
  using Catch::Contains;
  CHECK_THAT(first_error(drive), Contains("1: 61h (2-axis linear interpolation): the interpolation mode (2Ah) has not been written"));
  CHECK_THAT(first_error(mode("0003") + line_to(5, 5) + drive), Contains("9: ") && Contains("no drive speed"));
  CHECK_THAT(first_error(mode("0003") + data(100, "0105") + line_to(5, 5) + drive), Contains("no initial speed"));
  CHECK_THAT(first_error(mode("0003") + speeds(100, 200) + line_to(5, 5) + drive), Contains("no acceleration"));
  CHECK_THAT(first_error(mode("0007") + speeds(100, 100) + line_to(5, 5) + drive), Contains("enables X, Y, Z; 2 axes are wanted"));
  CHECK_THAT(first_error(mode("0001") + speeds(100, 100) + line_to(5, 5) + arc), Contains("enables X; 2 axes are wanted"));
  CHECK_THAT(first_error(mode("0003") + speeds(100, 100) + line_to(5, 5) + arc), Contains("no circular centre"));
  CHECK_THAT(first_error(mode("0003") + speeds(100, 100) + data(0, "0308") + line_to(5, 5) + arc), Contains("circular centre is (0,0)"));
  CHECK_THAT(first_error(mode("0003") + speeds(100, 100) + drive), Contains("no finish point"));
  CHECK_THAT(first_error(mode("0003") + speeds(100, 100) + line_to(1'073'741'824, 5) + drive), Contains("11: 1073741824 is out of range for a finish point"));
  CHECK_THAT(first_error(data(1'073'741'824, "0108")), Contains("3: 1073741824 is out of range for 08h"));
  CHECK_THAT(first_error(data(8'000'001, "0105")), Contains("out of range for 05h"));
  CHECK_THAT(first_error(data(0, "0104")), Contains("out of range for 04h"));
  CHECK_THAT(first_error(data(5, "0005")), Contains("names no axis"));
  CHECK_THAT(first_error("WR0 <- 0164h\n"), Contains("takes no axis bits"));
  CHECK_THAT(first_error("WR0 <- 012Ch\n"), Contains("there is no command 2Ch"));
  CHECK_THAT(first_error("WR0 <- 8104h\n"), Contains("D15 to D12"));
  CHECK_THAT(first_error("WR0 <- 0330h\n"), Contains("reads one axis, not X, Y"));
  CHECK_THAT(first_error("WR0 <- 0381h\n"), Contains("synchronous action) is not simulated"));
  CHECK_THAT(first_error(mode("0403")), Contains("several chips"));
  CHECK_THAT(first_error(mode("0043") + speeds(100, 100) + line_to(5, 5) + drive + drive), Contains("drive command while driving"));
  CHECK_THAT(first_error(mode("0043") + speeds(100, 100) + line_to(5, 5) + drive + "WR0 <- 0150h\n"), Contains("drive command while driving: axis X drives since line 15"));
  CHECK_THAT(first_error(mode("0043") + speeds(100, 100) + line_to(5, 5) + drive + mode("0043")), Contains("wait idle before"));
  CHECK_THAT(first_error(mode("0007") + speeds(100, 100) + line_to(5, 5) + data(100, "0308") + data(5, "0406") + "WR0 <- 0069h\n"), Contains("no helical calculation value"));
}

TEST_CASE("a listing that follows itself without waiting is refused at its mode and at its drive command", "[mcx514]") {
  Chip chip;
  run(chip, std::string(kListing) + kListing);
  REQUIRE(errors(chip).size() == 2);
  CHECK(errors(chip)[0].find("23: the interpolation mode is written while") == 0);
  CHECK(errors(chip)[1].find("42: drive command while driving: X, Y interpolate since line 21") == 0);
  Chip waiting;
  run(waiting, std::string(kListing) + "wait idle\n" + kListing);
  CHECK(errors(waiting).empty());
  CHECK(waiting.position() == AxisCounts{10000, -10000, 0, 0});
}

TEST_CASE("waiting for the end of a drive without end is refused", "[mcx514]") {
  Chip chip;
  run(chip, speeds(1000, 1000) + "WR0 <- 0152h\nwait 1 ms\nwait idle\nWR0 <- 0157h\n");
  REQUIRE(errors(chip).size() == 1);
  CHECK(errors(chip)[0].find("9: wait idle has no end") == 0);
}

TEST_CASE("a helix runs with its calculated value and its rotations", "[mcx514]") {
  Chip chip;
  run(chip, mode("0047") + speeds(1000, 1000) + "WR6 <- 0002h\nWR0 <- 001Ah\n" + data(500, "0108") + data(0, "0208") + line_to(0, 0) + data(300, "0406") +
                "WR0 <- 006Bh\nWR0 <- 003Bh\nread RR6\nWR0 <- 0069h\n");
  CHECK(errors(chip).empty());
  CHECK(chip.position() == AxisCounts{0, 0, 300, 0});
  CHECK(chip.drives()[0].events == chip.reads()[0].value);
  CHECK(chip.drives()[0].pulses == AxisCounts{6000, 6000, 300, 0});   // three turns around the square of 4 * 500
}

TEST_CASE("drives of single axes run beside each other and stop on command", "[mcx514]") {
  Chip chip;
  run(chip, speeds(1000, 1000) + data(500, "0204") + data(500, "0205") + data(100, "0106") + data(-100, "0206") +
                "WR0 <- 0350h\nwait 50 ms\nWR0 <- 0130h\nread RR6\nwait idle\nWR0 <- 0251h\nwait idle\nWR0 <- 0152h\nwait 9.5 ms\nWR0 <- 0157h\n");
  CHECK(errors(chip).empty());
  CHECK(chip.reads()[0].value == 51);                   // events at 0, 1, ... 50 ms
  CHECK(chip.position() == AxisCounts{110, 0, 0, 0});   // Y is back; X went on for ten events
  CHECK(chip.drives().back().stop == Stop::kInstant);
}

TEST_CASE("drive speed written while driving counts at once, and a deceleration stop takes its ramp", "[mcx514]") {
  Chip chip;
  run(chip, mode("0003") + speeds(1000, 1000) + line_to(1000, 0) + "WR0 <- 0061h\nwait 500 ms\n" + data(2000, "0105"));
  CHECK(seconds(chip.now()) == Approx(0.501 + 499 * 0.0005).epsilon(1e-9));
  Chip stopping;
  run(stopping, speeds(100, 1000) + data(9000, "0102") + "WR0 <- 0152h\nwait 1 s\nWR0 <- 0156h\n");
  // 0.1 s up over 55 pulses, 900 at drive speed, 55 down
  CHECK(stopping.position()[0] == Approx(55 + 900 + 55).margin(2));
  CHECK(stopping.drives()[0].stop == Stop::kDecelerated);
}

TEST_CASE("positions are written, read back and counted with 32 bits", "[mcx514]") {
  Chip chip;
  run(chip, mode("0003") + speeds(1000, 1000) + data(2147483647, "0109") + data(-5, "0209") + line_to(3, 2) + "WR0 <- 0061h\nwait idle\nWR0 <- 0230h\nread RR6\nread RR7\n");
  CHECK(chip.position() == AxisCounts{-2147483646, -3, 0, 0});
  CHECK(chip.reads()[0].value == 0xfffd);
  CHECK(chip.reads()[1].value == 0xffff);
}
