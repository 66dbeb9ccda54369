#include "runtime/gather/plot.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>

#include "runtime/gather/gnuplot.h"
#include "tests/unit/gather/scratch_folder.h"

using namespace pmac::test;
using namespace pmac::runtime;

namespace {

PlotData circle() {
  PlotData data;
  data.title = "A circle's path & <more>";
  data.length_unit = "mm";
  data.curves = {{"X", {}}, {"Y", {}}};
  for (int k = 0; k <= 20000; ++k) {
    const double t = k * 1e-4;
    data.time_s.push_back(t);
    data.curves[0].position.push_back(10 * std::cos(3.14159 * t));
    data.curves[1].position.push_back(10 * std::sin(3.14159 * t));
  }
  data.path = {0, 1};
  return data;
}

/// PATH without programs while it lives.
class EmptyPath {
 public:
  EmptyPath() : before_(std::getenv("PATH")) { ::setenv("PATH", "/nonexistent", 1); }
  ~EmptyPath() { ::setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

bool has_gnuplot() { return std::system("gnuplot --version > /dev/null 2>&1") == 0; }

}  // namespace

TEST_CASE("plots: the format is chosen by the ending", "[gather]") {
  CHECK(plot_format_of("a.svg") == PlotFormat::kSvg);
  CHECK(plot_format_of("a.PNG") == PlotFormat::kPng);
  CHECK(plot_format_of("a.html") == PlotFormat::kHtml);
  CHECK_FALSE(plot_format_of("a.pdf").has_value());
}

TEST_CASE("plots: the script has both panels, units and thinned data", "[gather]") {
  const std::string script = plot_script(circle(), PlotFormat::kSvg);
  CHECK(script.find("'X (mm)'") != std::string::npos);
  CHECK(script.find("'velocity (mm/s)'") != std::string::npos);
  CHECK(script.find("'A circle''s path & <more>'") != std::string::npos);
  CHECK(std::count(script.begin(), script.end(), '\n') < 7 * 4100);
}

TEST_CASE("plots: the path panel has one scale for both axes", "[gather]") {
  const std::string script = plot_script(circle(), PlotFormat::kSvg);
  const auto setting = [&](const std::string& name) {
    const std::size_t at = script.find(name) + name.size();
    return std::strtod(script.c_str() + at, nullptr);
  };
  const double width_px = 1440 * (setting("set rmargin at screen ") - setting("set lmargin at screen "));
  const double height_px = 720 * (setting("set tmargin at screen ") - setting("set bmargin at screen "));
  const double low_x = setting("set xrange [");
  const double low_y = setting("set yrange [");
  CHECK(low_x == Approx(-11.2).epsilon(0.001));  // 12 % wider than the circle
  CHECK(low_y == Approx(-11.2).epsilon(0.001));
  CHECK(width_px == Approx(height_px).epsilon(0.001));
}

TEST_CASE("plots: what cannot be drawn is refused", "[gather]") {
  CHECK_THROWS_AS(plot_script(PlotData{}, PlotFormat::kSvg), std::invalid_argument);
  PlotData data = circle();
  data.path = {0, 2};
  CHECK_THROWS_AS(plot_script(data, PlotFormat::kSvg), std::invalid_argument);
  data = circle();
  data.curves[1].position.pop_back();
  CHECK_THROWS_WITH(plot_script(data, PlotFormat::kSvg), "curve Y has another length");
  data = circle();
  for (double& value : data.curves[1].position) value = std::nan("");
  CHECK_THROWS_WITH(plot_script(data, PlotFormat::kSvg), "curve Y has no finite position");
}

TEST_CASE("plots: a missing gnuplot is named, with the package", "[gather]") {
  const ScratchFolder folder;
  const EmptyPath empty;
  CHECK_THROWS_WITH(draw(circle(), PlotFormat::kSvg, folder.file("a.svg")), Catch::Contains("install the package gnuplot-nox"));
  CHECK(folder.file_count() == 0);
}

TEST_CASE("plots: gnuplot draws svg, png and html", "[gather]") {
  if (!has_gnuplot()) return;
  const ScratchFolder folder;
  draw(circle(), PlotFormat::kSvg, folder.file("a.svg"));
  draw(circle(), PlotFormat::kPng, folder.file("a.png"));
  draw(circle(), PlotFormat::kHtml, folder.file("a.html"));
  CHECK(contents_of(folder.file("a.svg")).find("</svg>") != std::string::npos);
  CHECK(contents_of(folder.file("a.png")).substr(1, 3) == "PNG");
  const std::string page = contents_of(folder.file("a.html"));
  CHECK(page.substr(0, 15) == "<!DOCTYPE html>");
  CHECK(page.find("<title>A circle's path &amp; &lt;more></title>") != std::string::npos);
  CHECK(page.find("<?xml") == std::string::npos);
  CHECK(folder.file_count() == 3);
}

TEST_CASE("plots: a single sample, a motion along one axis and gaps are drawn", "[gather]") {
  if (!has_gnuplot()) return;
  const ScratchFolder folder;
  PlotData data;
  data.time_s = {0};
  data.curves = {{"X", {1}}, {"Y", {1}}};
  data.path = {0, 1};
  CHECK_NOTHROW(draw(data, PlotFormat::kSvg, folder.file("one.svg")));
  data.time_s = {0, 1, 2};
  data.curves = {{"X", {1, std::nan(""), 3}}, {"Y", {5, 5, 5}}};
  CHECK_NOTHROW(draw(data, PlotFormat::kSvg, folder.file("gap.svg")));
  data.curves[1].position[1] = std::nan("");  // no velocity of Y at all
  data.path.reset();
  CHECK_NOTHROW(draw(data, PlotFormat::kSvg, folder.file("panels.svg")));
}

TEST_CASE("plots: what gnuplot refuses is told in its words", "[gather]") {
  if (!has_gnuplot()) return;
  CHECK_THROWS_WITH(run_gnuplot("plot nonsense[\n"), Catch::Contains("gnuplot failed"));
}
