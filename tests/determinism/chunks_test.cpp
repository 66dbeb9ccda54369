// However a run or a file is cut into pieces, the same bytes come out.
#include <array>
#include <cstdlib>
#include <random>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "runtime/gather/table_writer.h"
#include "tests/reference/random_motion_spec.h"
#include "tests/unit/gather/scratch_folder.h"
#include "tests/unit/programs/bench.h"

using namespace pmac;
using namespace pmac::test;

namespace {

struct Samples {
  std::vector<double> time_ms;
  std::vector<std::array<double, bytecode::kMaxMotors>> motor_mu;
  double end_ms = 0;
  bool operator==(const Samples&) const = default;
};

Samples samples_of(const ProgramBench& bench, double end_ms) { return {bench.time_ms, bench.motor_mu, end_ms}; }

Samples run_whole(const std::string& name, const std::string& text, const std::string& commands) {
  ProgramBench bench(name, text);
  const double end_ms = bench.run(commands).time_ms;
  return samples_of(bench, end_ms);
}

/// The run ends and goes on at random times, from a fraction of a servo cycle to a few hundred of them apart.
Samples run_in_pieces(const std::string& name, const std::string& text, const std::string& commands, double whole_ms, unsigned seed) {
  std::mt19937 random(seed);
  ProgramBench bench(name, text);
  bench.machine->command(commands, "-e");
  const auto step_ms = [&random] { return 1e-3 * static_cast<double>(random() % std::array{2'000u, 20'000u, 300'000u}[random() % 3]); };
  for (double until_ms = step_ms(); until_ms < 0.9 * whole_ms; until_ms += step_ms()) {
    runtime::RunLimits limits;
    limits.until_ms = until_ms;
    limits.more_follows = true;
    bench.machine->run(limits);
  }
  const double end_ms = bench.machine->run({}).time_ms;
  return samples_of(bench, end_ms);
}

void check_pieces(const std::string& name, const std::string& text, const std::string& commands) {
  INFO(name << "\n" << text);
  const Samples whole = run_whole(name, text, commands);
  REQUIRE(whole.motor_mu.size() > 10);
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const Samples pieces = run_in_pieces(name, text, commands, whole.end_ms, seed);
    CHECK(pieces.motor_mu.size() == whole.motor_mu.size());
    CHECK((pieces == whole));
  }
}

/// The file that a table becomes when its rows come in pieces; next() says how many rows a piece has.
template <class Next>
std::string table(runtime::TableFormat format, const std::vector<double>& values, std::size_t columns, Next next) {
  const ScratchFolder folder;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < columns; ++i) names.push_back("c" + std::to_string(i));
  const auto writer = runtime::make_table_writer(format, folder.file("table"), names);
  for (std::size_t at = 0; at < values.size();) {
    const std::size_t size = std::min(values.size() - at, columns * next());
    writer->append(std::span(values).subspan(at, size));
    at += size;
  }
  writer->finish();
  return contents_of(folder.file("table"));
}

}  // namespace

TEST_CASE("chunks: a run in pieces of any length has the samples of the run in one", "[determinism]") {
  check_pieces("05_blended_contour.pmc", "", "&1 b4r");
  check_pieces("07_oval_lookahead.pmc", "", "&1 b5r");
  check_pieces("10_scara.pmc", "", "&1 b10r");
  check_pieces("motion/1_pvt.pmc", "", "&1 b1r");
  check_pieces("motion/2_spline.pmc", "", "&1 b1r");
}

TEST_CASE("chunks: random motion programs in pieces", "[determinism]") {
  const int count = std::getenv("PMAC_RANDOM_PROGRAMS") ? std::atoi(std::getenv("PMAC_RANDOM_PROGRAMS")) : 25;
  for (int seed = 1; seed <= count; ++seed)
    check_pieces(fmt::format("random_{}.pmc", seed), reference::random_motion(reference::random_motion_spec(static_cast<std::uint32_t>(seed))).text, "&1 b1r");
}

TEST_CASE("chunks: tables do not depend on how many rows come at once", "[determinism]") {
  std::mt19937 random(5);
  constexpr std::size_t kColumns = 3, kRows = 70'000;   // more than two blocks of an archive
  std::vector<double> values(kColumns * kRows);
  for (double& value : values) value = static_cast<double>(random()) / 1024.0 - 1e6;
  for (const runtime::TableFormat format : {runtime::TableFormat::kCsv, runtime::TableFormat::kText, runtime::TableFormat::kNpz}) {
    const std::string whole = table(format, values, kColumns, [] { return kRows; });
    CHECK((table(format, values, kColumns, [] { return std::size_t{1}; }) == whole));
    CHECK((table(format, values, kColumns, [&random] { return std::size_t{1 + random() % 5000}; }) == whole));
  }
}

TEST_CASE("chunks: plain move lines in runs of any length move as one run", "[determinism]") {
  std::mt19937 random(9);
  std::string whole = "&1\n#1->100X\n#2->100Y\nCoord[1].SegMoveTime=2\nopen prog 1\nlinear abs ta5 ts0 F20\n", pieces = whole;
  for (int i = 0; i < 900; ++i) {
    const std::string line = fmt::format("X{} Y{:.3f}\n", i % 7, 0.125 * static_cast<double>(random() % 40));
    whole += line;
    pieces += line;
    if (random() % 70 == 0) pieces += "linear abs\n";   // says nothing new, and ends a run
  }
  CHECK((run_whole("whole.pmc", whole + "close\n", "&1 b1r") == run_whole("pieces.pmc", pieces + "close\n", "&1 b1r")));
}
