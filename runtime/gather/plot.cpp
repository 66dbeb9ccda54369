// Layout of a picture: with path and panels, the path takes the left half; alone, either takes all of it.
#include "runtime/gather/plot.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "runtime/gather/plot_text.h"
#include "runtime/gather/series.h"

namespace pmac::runtime {
namespace {

constexpr std::size_t kMaxPoints = 4000;   // of one drawn curve
// Colours that people with colour-blindness can tell apart (Okabe and Ito).
constexpr std::array<const char*, 8> kColors = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                "#E69F00", "#56B4E9", "#000000", "#8C6D00"};

struct Box { double left, bottom, right, top; };  // fractions of the picture

std::string margins(const Box& box) {
  return "set lmargin at screen " + number(box.left) + "\nset rmargin at screen " + number(box.right) +
         "\nset bmargin at screen " + number(box.bottom) + "\nset tmargin at screen " + number(box.top) + "\n";
}

/// The legend at the right above a panel.
std::string legend_above(const Box& box) {
  return "set key at screen " + number(box.right) + ", screen " + number(box.top + 0.012) + "\n";
}

/// A named block of rows of x and y.
void add_block(std::string& script, const std::string& name, std::span<const double> x, std::span<const double> y,
               const std::vector<std::size_t>& rows) {
  script += "$" + name + " << EOD\n";
  for (const std::size_t row : rows) script += number(x[row]) + " " + number(y[row]) + "\n";
  script += "EOD\n";
}

std::string with_unit(const std::string& quantity, const PlotData& data, const char* per_time) {
  return quantity + " (" + (data.length_unit.empty() ? "axis units" : data.length_unit) + per_time + ")";
}

struct Range { double low, high; };

Range finite_range(std::span<const double> values) {
  Range range{1, -1};
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (range.low > range.high) range = {value, value};
    range = {std::min(range.low, value), std::max(range.high, value)};
  }
  return range;
}

/// The range around its middle with this length.
Range with_length(const Range& range, double length) {
  const double middle = (range.low + range.high) / 2;
  return {middle - length / 2, middle + length / 2};
}

std::string text_of(const Range& range) { return "[" + number(range.low) + ":" + number(range.high) + "]"; }

/// Sets ranges and margins so that both axes have one scale and the panel lies in the middle of the box. A path that is
/// nearly a line keeps a panel that is not too flat.
std::string equal_aspect(Range x, Range y, const Box& box, double picture_width_per_height) {
  const double flattest = 0.35;
  const double x_length = std::max({x.high - x.low, flattest * (y.high - y.low), 1e-9}) * 1.12;
  const double y_length = std::max({y.high - y.low, flattest * (x.high - x.low), 1e-9}) * 1.12;
  const double width = (box.right - box.left) * picture_width_per_height;  // in picture heights, as the height
  const double height = box.top - box.bottom;
  const double scale = std::min(width / x_length, height / y_length);
  const double half_width = x_length * scale / 2 / picture_width_per_height;
  const double half_height = y_length * scale / 2;
  const double center_x = (box.left + box.right) / 2;
  const double center_y = (box.bottom + box.top) / 2;
  const Box panel{center_x - half_width, center_y - half_height, center_x + half_width, center_y + half_height};
  return margins(panel) + legend_above(panel) + "set xrange " + text_of(with_length(x, x_length)) + "\nset yrange " + text_of(with_length(y, y_length)) + "\n";
}

void add_path_panel(std::string& script, const PlotData& data, const Box& box) {
  const PlotCurve& x = data.curves[data.path->first];
  const PlotCurve& y = data.curves[data.path->second];
  const std::array<std::span<const double>, 2> both = {x.position, y.position};
  add_block(script, "path", x.position, y.position, thinned(both, kMaxPoints));
  add_block(script, "first", x.position, y.position, {0});
  add_block(script, "last", x.position, y.position, {x.position.size() - 1});
  script += equal_aspect(finite_range(x.position), finite_range(y.position), box, data.time_panels ? 2.0 : 1.25);
  script += "set format x '%g'\nset xlabel " + quoted(with_unit(x.name, data, "")) + "\nset ylabel " + quoted(with_unit(y.name, data, "")) + "\n";
  script += "plot $path using 1:2 with lines linewidth 1.6 linecolor rgb '" + std::string(kColors[0]) + "' title 'path', "
            "$first using 1:2 with points pointtype 7 pointsize 0.9 linecolor rgb '#009E73' title 'start', "
            "$last using 1:2 with points pointtype 6 pointsize 1.4 linewidth 1.6 linecolor rgb '#D55E00' title 'end'\n";
}

struct PanelCurve { std::string name; std::vector<double> values; const char* color; };

bool has_finite(std::span<const double> values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// Range of the time axis; a second around a single sample.
std::string time_range(const PlotData& data) {
  const double first = data.time_s.front();
  const double last = data.time_s.back();
  const double margin_s = last > first ? 0.0 : 0.5;
  return "[" + number(first - margin_s) + ":" + number(last + margin_s) + "]";
}

/// Panel number `index` from the top of three.
void add_time_panel(std::string& script, const PlotData& data, const std::string& label, int index,
                    const std::vector<PanelCurve>& curves, const Box& all) {
  const double height = (all.top - all.bottom) / 3;
  const double gap = 0.036;
  const Box box{all.left, all.top - (index + 1) * height + gap / 2, all.right, all.top - index * height - gap / 2};
  const bool is_lowest = index == 2;
  script += margins(box) + "set ylabel " + quoted(label) + "\n";
  script += is_lowest ? "set format x '%g'\nset xlabel 'time (s)'\n" : "set format x ''\nunset xlabel\n";
  script += index == 0 ? legend_above(box) : "unset key\n";
  const bool has_points = std::any_of(curves.begin(), curves.end(), [](const PanelCurve& c) { return has_finite(c.values); });
  script += "set xrange " + time_range(data) + "\nset yrange " + (has_points ? "[*:*]" : "[-1:1]") + "\n";
  std::string plot;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::string block = "panel" + std::to_string(index) + "_" + std::to_string(i);
    const std::array<std::span<const double>, 1> curve = {curves[i].values};
    add_block(script, block, data.time_s, curves[i].values, thinned(curve, kMaxPoints));
    plot += std::string(i == 0 ? "plot " : ", ") + "$" + block + " using 1:2 with lines linewidth 1.4 linecolor rgb '" +
            curves[i].color + "' title " + quoted(curves[i].name);
  }
  script += plot + "\n";
}

void add_time_panels(std::string& script, const PlotData& data, const Box& box) {
  std::array<std::vector<PanelCurve>, 3> panels;
  for (std::size_t i = 0; i < data.curves.size(); ++i) {
    const PlotCurve& curve = data.curves[i];
    const char* color = kColors[i % kColors.size()];
    std::vector<double> velocity = rate_of_change(data.time_s, curve.position);
    std::vector<double> acceleration = rate_of_change(data.time_s, velocity);
    panels[0].push_back({curve.name, curve.position, color});
    panels[1].push_back({curve.name, std::move(velocity), color});
    panels[2].push_back({curve.name, std::move(acceleration), color});
  }
  add_time_panel(script, data, with_unit("position", data, ""), 0, panels[0], box);
  add_time_panel(script, data, with_unit("velocity", data, "/s"), 1, panels[1], box);
  add_time_panel(script, data, with_unit("acceleration", data, "/s²"), 2, panels[2], box);
}

void check(const PlotData& data) {
  if (data.time_s.empty() || data.curves.empty()) throw std::invalid_argument("there is nothing to draw");
  for (const PlotCurve& curve : data.curves) {
    if (curve.position.size() != data.time_s.size()) throw std::invalid_argument("curve " + curve.name + " has another length");
    if (!has_finite(curve.position)) throw std::invalid_argument("curve " + curve.name + " has no finite position");
  }
  const bool has_plane = !data.path || std::max(data.path->first, data.path->second) < data.curves.size();
  if (!has_plane) throw std::invalid_argument("the plane of the path names no curve");
  if (!data.path && !data.time_panels) throw std::invalid_argument("there is nothing to draw");
}

}  // namespace

std::optional<PlotFormat> plot_format_of(std::string_view path) {
  std::string lower(path);
  for (char& ch : lower) ch = static_cast<char>(std::tolower(static_cast<unsigned char>(ch)));
  if (lower.ends_with(".svg")) return PlotFormat::kSvg;
  if (lower.ends_with(".png")) return PlotFormat::kPng;
  if (lower.ends_with(".html") || lower.ends_with(".htm")) return PlotFormat::kHtml;
  return std::nullopt;
}

std::string plot_script(const PlotData& data, PlotFormat format) {
  check(data);
  const bool has_both = data.path.has_value() && data.time_panels;
  const double top = data.title.empty() ? 0.945 : 0.905;
  std::string script = "set encoding utf8\n" + terminal(has_both, format) + common_settings();
  script += data.title.empty() ? "set multiplot\n" : "set multiplot title " + quoted(data.title) + " font ',16'\n";
  if (data.path) add_path_panel(script, data, {has_both ? 0.06 : 0.11, 0.09, has_both ? 0.47 : 0.97, top});
  if (data.time_panels) add_time_panels(script, data, {has_both ? 0.565 : 0.11, 0.09, 0.985, top});
  return script + "unset multiplot\n";
}

void draw(const PlotData& data, PlotFormat format, const std::string& path) {
  write_picture(plot_script(data, format), format, path, data.title);
}

}  // namespace pmac::runtime
