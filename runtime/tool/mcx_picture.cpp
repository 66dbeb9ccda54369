// The picture of a register script: the path at the left; error and positions against time at the right.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/gather/gnuplot.h"
#include "runtime/gather/plot.h"
#include "runtime/tool/mcx_output.h"

namespace pmac::tool {

using namespace drives::mcx514;

namespace {

constexpr std::size_t kMostPoints = 16384;
constexpr const char* kColors[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7"};

/// Middle and half length of a range of values, a little widened.
struct Span { double middle, half; };

std::string range(const Span& span) { return fmt::format("[{}:{}]", span.middle - span.half, span.middle + span.half); }

std::string single_quoted(const std::string& text) {
  std::string result = "'";
  for (const char ch : text) result += ch == '\'' ? std::string("''") : std::string(1, ch);
  return result + "'";
}

std::string page(const std::string& svg, const std::string& title) {
  const std::size_t start = svg.find("<svg");
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>" + title + "</title>\n</head>\n<body>\n" +
         svg.substr(start == std::string::npos ? 0 : start) + "\n</body>\n</html>\n";
}

}  // namespace

void PulsePicture::add(double time_s, const AxisCounts& position, double error) {
  if (events_in_point_ == 0) last_ = {time_s, error, error, position};
  last_.error_low = std::min(last_.error_low, error);
  last_.error_high = std::max(last_.error_high, error);
  if (++events_in_point_ < events_a_point_) return;
  points_.push_back(last_);
  events_in_point_ = 0;
  if (points_.size() == kMostPoints) halve();
}

/// Every two points become one that covers both.
void PulsePicture::halve() {
  for (std::size_t i = 0; i < points_.size() / 2; ++i) {
    Point both = points_[2 * i];
    both.error_low = std::min(both.error_low, points_[2 * i + 1].error_low);
    both.error_high = std::max(both.error_high, points_[2 * i + 1].error_high);
    points_[i] = both;
  }
  points_.resize(points_.size() / 2);
  events_a_point_ *= 2;
}

void PulsePicture::draw(const std::string& file, const std::string& title) const {
  std::vector<Point> points = points_;
  if (events_in_point_ > 0) points.push_back(last_);
  if (points.empty()) throw runtime::OutputError("there is nothing to draw: no pulse was made");
  const auto format = *runtime::plot_format_of(file);
  const std::size_t x = axes_[0], y = axes_.size() > 1 ? axes_[1] : axes_[0];
  const auto span_of = [&](std::size_t axis) {
    const auto [low, high] = std::minmax_element(points.begin(), points.end(), [axis](const Point& a, const Point& b) { return a.position[axis] < b.position[axis]; });
    const auto l = static_cast<double>(low->position[axis]), h = static_cast<double>(high->position[axis]);
    return Span{(l + h) / 2, (h - l) / 2};
  };
  Span across = span_of(x), up = span_of(y);
  across.half = up.half = std::max({across.half, up.half, 1.0}) * 1.08;  // one scale for both
  std::string script = format == runtime::PlotFormat::kPng ? "set terminal pngcairo noenhanced size 1440,720 font 'DejaVu Sans,11' linewidth 1.2\n"
                                                           : "set terminal svg noenhanced size 1440,720 dynamic font 'DejaVu Sans,Helvetica,Arial,sans-serif,14' background '#ffffff' linewidth 1.2\n";
  script += "set encoding utf8\nset grid linetype 1 linecolor rgb '#e2e2e2' linewidth 0.6\nset border linecolor rgb '#606060' linewidth 0.8\n"
            "set tics textcolor rgb '#303030' nomirror\nset key bottom right samplen 1.6\n$p << EOD\n";
  for (const Point& point : points) {
    script += fmt::format("{} {} {}", point.time_s, point.error_low, point.error_high);
    for (const std::size_t axis : axes_) script += fmt::format(" {}", point.position[axis]);
    script += '\n';
  }
  script += "EOD\n$first << EOD\n" + fmt::format("{} {}\nEOD\n$last << EOD\n{} {}\nEOD\n", points.front().position[x], points.front().position[y], points.back().position[x], points.back().position[y]);
  script += "set multiplot title " + single_quoted(title) + " font ',16'\n";
  script += "set lmargin at screen 0.07\nset rmargin at screen 0.47\nset bmargin at screen 0.09\nset tmargin at screen 0.89\n";
  script += "set xrange " + range(across) + "\nset yrange " + range(up) + fmt::format("\nset xlabel '{} (pulses)'\nset ylabel '{} (pulses)'\n", kAxisNames[x], kAxisNames[y]);
  script += fmt::format("plot $p using 4:{} with steps linewidth 1.4 linecolor rgb '{}' title 'path', $first using 1:2 with points pointtype 7 linecolor rgb '#009E73' title 'first pulse', "
                        "$last using 1:2 with points pointtype 6 pointsize 1.4 linecolor rgb '#D55E00' title 'last pulse'\n", axes_.size() > 1 ? 5 : 4, kColors[0]);
  script += "set xrange [*:*]\nset lmargin at screen 0.56\nset rmargin at screen 0.985\nset bmargin at screen 0.52\nset tmargin at screen 0.89\nunset xlabel\nset format x ''\n";
  script += "set yrange [-1.05:1.05]\nset ylabel 'error (pulses)'\nset key top right\nplot $p using 1:2:3 with filledcurves linecolor rgb '#D55E00' notitle, "
            "$p using 1:2 with lines linewidth 0.5 linecolor rgb '#D55E00' title 'distance from the ideal curve', $p using 1:3 with lines linewidth 0.5 linecolor rgb '#D55E00' notitle\n";
  script += "set format x '%g'\nset bmargin at screen 0.09\nset tmargin at screen 0.47\nset yrange [*:*]\nset xlabel 'time (s)'\nset ylabel 'position (pulses)'\nset key bottom right\nplot ";
  for (std::size_t i = 0; i < axes_.size(); ++i)
    script += fmt::format("{}$p using 1:{} with steps linewidth 1.4 linecolor rgb '{}' title '{}'", i == 0 ? "" : ", ", 4 + i, kColors[i], kAxisNames[axes_[i]]);
  script += "\nunset multiplot\n";
  const std::string picture = runtime::run_gnuplot(script);
  runtime::OutputFile out(file);
  out.write(format == runtime::PlotFormat::kHtml ? page(picture, title) : picture);
  out.commit();
}

}  // namespace pmac::tool
