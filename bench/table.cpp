// The table of bench/README.md: every row is measured against its peer in this one run, in cpu seconds.
//
//     bench_table BIN_FOLDER SCRATCH_FOLDER [RS274_FOLDER]
//
// BIN_FOLDER: pmacc and pmac-run. RS274_FOLDER: what `dpkg -x` made of linuxcnc-uspace; without it the rows of rs274 stay empty.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "bench/process.h"
#include "runtime/gather/table_writer.h"

namespace {

namespace fs = std::filesystem;
using pmac::bench::best_of;
using pmac::bench::Usage;

constexpr int kRuns = 3;
constexpr int kLines = 1'000'000;

struct Folders { fs::path bin, scratch, rs274; };

void print_row(const std::string& what, const std::string& ours, const std::string& peer, const std::string& ratio, const std::string& goal) {
  std::printf("| %s | %s | %s | %s | %s |\n", what.c_str(), ours.c_str(), peer.c_str(), ratio.c_str(), goal.c_str());
  std::fflush(stdout);
}

void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

// --- programs ------------------------------------------------------------------------------------------------------------------

/// A million short lines of about 30 bytes in three axes: the same points for both languages.
void write_part(const Folders& f) {
  std::ofstream ours(f.scratch / "part.pmc"), peer(f.scratch / "part.ngc");
  ours << "open prog 1\nlinear abs ta1 ts0 F100\n";
  peer << "G21 G90 G94 G64\nF6000\n";
  for (int i = 0; i < kLines; ++i) {
    const double t = 0.01 * i;
    const std::string words = fmt::format("X{:.4f} Y{:.4f} Z{:.4f}\n", 150 + 50 * std::cos(0.37 * t), 150 + 50 * std::sin(0.41 * t), 15 + std::sin(0.1 * t));
    ours << words;
    peer << "G1 " << words;
  }
  ours << "close\n";
  peer << "M2\n";
}

std::string set_up(int motors, bool lookahead) {
  static const char* const kAxes[] = {"X", "Y", "Z", "A", "B", "C"};
  std::string text = "&1\nCoord[1].SegMoveTime = 5\n";
  for (int m = 1; m <= motors; ++m) text += fmt::format("#{0}->1000{1}\nMotor[{0}].MaxSpeed = 500 Motor[{0}].InvAmax = 1\n", m, kAxes[m - 1]);
  return lookahead ? text + "Coord[1].LHDistance = 500\ndefine lookahead 3000\n" : text;
}

/// A closed contour of lines and arcs, for ever; the further axes follow in step.
std::string contour(int motors) {
  const std::string more = motors > 2 ? " Z{0} A{0} B{0} C{0}" : "";
  const auto further = [&](int value) { return fmt::format(fmt::runtime(more), value); };
  return "open prog 2\nlinear abs ta10 ts0 F100\nwhile (1)\n{\nX10 Y0" + further(1) + "\nX10 Y10" + further(2) + "\ncircle1\nX0 Y10 I-5 J3" + further(3) + "\nlinear\nX0 Y0" + further(0) +
         "\n}\nclose\n";
}

// --- rows ----------------------------------------------------------------------------------------------------------------------

std::string rs274(const Folders& f, bool silent) {
  const std::string libraries = fmt::format("{0}/usr/lib:{0}/usr/lib/x86_64-linux-gnu", f.rs274.string());
  const std::string preload = silent ? fmt::format("LD_PRELOAD={} ", (f.bin / "../bench/libsilent_print.so").string()) : "";
  return fmt::format("env {}LD_LIBRARY_PATH={} {}/usr/bin/rs274 -g -t {} {}", preload, libraries, f.rs274.string(), (f.scratch / "empty.tbl").string(), (f.scratch / "part.ngc").string());
}

void compile_rows(const Folders& f) {
  const Usage ours = best_of(kRuns, fmt::format("{0}/pmacc {1}/part.pmc -o {1}/part.pmx", f.bin.string(), f.scratch.string()));
  const double file_mib = static_cast<double>(fs::file_size(f.scratch / "part.pmc")) / (1 << 20);
  const double rate = kLines / ours.cpu_s / 1e6;
  const Usage silent = f.rs274.empty() ? Usage{} : best_of(kRuns, rs274(f, true));
  const Usage loud = f.rs274.empty() ? Usage{} : best_of(kRuns, rs274(f, false));
  const auto peer = [&](const Usage& u) { return u.ran ? fmt::format("{:.2f} M lines/s", kLines / u.cpu_s / 1e6) : std::string("not found"); };
  const auto ratio = [&](const Usage& u, double cpu_s) { return u.ran ? fmt::format("{:.1f}", u.cpu_s / cpu_s) : std::string("-"); };
  print_row("pmacc, 1,000,000 plain move lines to an object file; peer rs274, printing stubbed", fmt::format("{:.2f} M lines/s", rate), peer(silent), ratio(silent, ours.cpu_s), ">= 12");
  print_row("its peak memory beyond the file, bytes a line", fmt::format("{:.0f}", (ours.peak_mib - file_mib) * (1 << 20) / kLines), "", "", "<= 64");
  const Usage run = best_of(1, fmt::format("{0}/pmac-run {1}/three.cfg {1}/part.pmc -e '&1 b1r' --max-time 1000000 --json=summary", f.bin.string(), f.scratch.string()));
  print_row("pmac-run, the same file to servo positions; peer rs274 alone", fmt::format("{:.2f} M lines/s, {:.0f} MiB", kLines / run.cpu_s / 1e6, run.peak_mib), peer(loud), ratio(loud, run.cpu_s), ">= 10");
}

double contour_rate(const Folders& f, const std::string& name, double simulated_s, double* peak_mib = nullptr) {
  const Usage used = best_of(kRuns, fmt::format("{0}/pmac-run {1}/{2}.cfg {1}/{2}.pmc -e '&1 b2r' --until {3} -q", f.bin.string(), f.scratch.string(), name, simulated_s));
  if (peak_mib) *peak_mib = used.peak_mib;
  return used.ran ? simulated_s / used.cpu_s : std::nan("");
}

void contour_rows(const Folders& f) {
  print_row("contour with lookahead, two axes, output off, 2.26 kHz", fmt::format("{:.0f} simulated s a cpu s", contour_rate(f, "two", 3600)), "", "", ">= 40000");
  print_row("the same, six axes", fmt::format("{:.0f} simulated s a cpu s", contour_rate(f, "six", 3600)), "", "", ">= 28000");
  double hour_mib = 0, minute_mib = 0;
  contour_rate(f, "two", 3600, &hour_mib);
  contour_rate(f, "two", 60, &minute_mib);
  print_row("peak memory, one simulated hour against one minute", fmt::format("{:.1f} MiB", hour_mib), fmt::format("{:.1f} MiB", minute_mib), fmt::format("{:.3f}", hour_mib / minute_mib), "<= 1.05");
}

double cpu_now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void record_rows(const Folders& f) {
  constexpr int kRows = 500'000, kColumns = 5;
  std::vector<double> rows(kRows * kColumns);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = std::sin(0.001 * static_cast<double>(i)) * 12345.678;
  double ours_s = 1e9, peer_s = 1e9;
  for (int run = 0; run < kRuns; ++run) {
    double start = cpu_now();
    const auto writer = pmac::runtime::make_table_writer(pmac::runtime::TableFormat::kCsv, (f.scratch / "ours.csv").string(), {"a", "b", "c", "d", "e"});
    writer->append(rows);
    writer->finish();
    ours_s = std::min(ours_s, cpu_now() - start);
    start = cpu_now();
    std::FILE* file = std::fopen((f.scratch / "peer.csv").c_str(), "w");
    for (std::size_t i = 0; i < rows.size(); i += kColumns) std::fprintf(file, "%.17g,%.17g,%.17g,%.17g,%.17g\n", rows[i], rows[i + 1], rows[i + 2], rows[i + 3], rows[i + 4]);
    std::fclose(file);
    peer_s = std::min(peer_s, cpu_now() - start);
  }
  print_row("--record as CSV, five columns; peer fprintf(\"%.17g\")", fmt::format("{:.2f} M rows/s", kRows / ours_s / 1e6), fmt::format("{:.2f} M rows/s", kRows / peer_s / 1e6), fmt::format("{:.1f}", peer_s / ours_s), ">= 2");
  const std::string run = fmt::format("{0}/pmac-run {1}/two.cfg {1}/two.pmc -e '&1 b2r' --until 1800 -q", f.bin.string(), f.scratch.string());
  const Usage bare = best_of(kRuns, run), recorded = best_of(kRuns, run + fmt::format(" --record {}/r.npz", f.scratch.string()));
  print_row("--record as .npz, half an hour; peer the same run without", fmt::format("{:.2f} s", recorded.cpu_s), fmt::format("{:.2f} s", bare.cpu_s), fmt::format("{:.2f}", recorded.cpu_s / bare.cpu_s), "<= 1.25");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: bench_table BIN_FOLDER SCRATCH_FOLDER [RS274_FOLDER]\n"), 2;
  const Folders f{argv[1], argv[2], argc > 3 ? argv[3] : ""};
  fs::create_directories(f.scratch);
  write_part(f);
  write(f.scratch / "empty.tbl", "");
  write(f.scratch / "three.cfg", set_up(3, false));
  for (const int motors : {2, 6}) {
    const std::string name = motors == 2 ? "two" : "six";
    write(f.scratch / (name + ".cfg"), set_up(motors, true));
    write(f.scratch / (name + ".pmc"), contour(motors));
  }
  std::printf("| what | ours | peer | ratio | goal |\n|---|---|---|---|---|\n");
  compile_rows(f);
  contour_rows(f);
  record_rows(f);
}
