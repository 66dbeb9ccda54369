#include "runtime/gather/error_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>

#include "runtime/gather/plot_text.h"
#include "runtime/gather/series.h"

namespace pmac::runtime {
namespace {

constexpr std::size_t kMaxPoints = 4000;
constexpr double kShareOfPicture = 0.1;      // the largest error, magnified

void add_block(std::string& script, const char* name, std::span<const double> x, std::span<const double> y) {
  const std::array<std::span<const double>, 2> both = {x, y};
  script += std::string("$") + name + " << EOD\n";
  for (const std::size_t row : thinned(both, kMaxPoints)) script += number(x[row]) + " " + number(y[row]) + "\n";
  script += "EOD\n";
}

double extent(std::span<const double> values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

/// Distance of every position from the point that it is compared with.
double largest_distance(const ErrorPlotData& data) {
  double largest = 0;
  for (std::size_t i = 0; i < data.x.size(); ++i) largest = std::max(largest, std::hypot(data.x[i] - data.commanded_x[i], data.y[i] - data.commanded_y[i]));
  return largest;
}

void add_path(std::string& script, const ErrorPlotData& data) {
  const double factor = magnification(data);
  std::vector<double> far_x(data.x.size()), far_y(data.x.size());
  for (std::size_t i = 0; i < data.x.size(); ++i) {
    far_x[i] = data.commanded_x[i] + factor * (data.x[i] - data.commanded_x[i]);
    far_y[i] = data.commanded_y[i] + factor * (data.y[i] - data.commanded_y[i]);
  }
  add_block(script, "commanded", data.commanded_x, data.commanded_y);
  add_block(script, "actual", data.x, data.y);
  add_block(script, "magnified", far_x, far_y);
  script += "set size ratio -1\nset lmargin at screen 0.07\nset rmargin at screen 0.47\nset bmargin at screen 0.1\nset tmargin at screen 0.86\n"
            "set key at screen 0.47, screen 0.9\n"
            "set xlabel " + quoted(data.x_name + " (" + data.unit + ")") + "\nset ylabel " + quoted(data.y_name + " (" + data.unit + ")") + "\n";
  script += "plot $commanded using 1:2 with lines linewidth 3 linecolor rgb '#c8c8c8' title 'commanded', "
            "$actual using 1:2 with lines linewidth 1.2 linecolor rgb '#0072B2' title 'executed', "
            "$magnified using 1:2 with lines linewidth 1.2 linecolor rgb '#D55E00' title " + quoted("error x " + number(factor)) + "\n";
}

void add_error(std::string& script, const ErrorPlotData& data, bool has_path) {
  add_block(script, "error", data.time_s, data.error);
  script += "set size noratio\nset lmargin at screen " + number(has_path ? 0.565 : 0.11) + "\nset rmargin at screen 0.985\nset bmargin at screen 0.1\nset tmargin at screen 0.86\n"
            "unset key\nset xlabel 'time (s)'\nset ylabel " + quoted(data.error_name + " (" + data.unit + ")") + "\n"
            "plot $error using 1:2 with lines linewidth 1.2 linecolor rgb '#D55E00'\n";
}

void check(const ErrorPlotData& data) {
  const std::size_t rows = data.time_s.size();
  if (rows < 2) throw std::invalid_argument("there is nothing to draw");
  if (data.error.size() != rows) throw std::invalid_argument("the error has another length");
  for (const auto* column : {&data.y, &data.commanded_x, &data.commanded_y})
    if (column->size() != data.x.size()) throw std::invalid_argument("the paths have different lengths");
  if (!data.x.empty() && data.x.size() != rows) throw std::invalid_argument("the path has another length");
}

}  // namespace

double magnification(const ErrorPlotData& data) {
  const double largest = largest_distance(data);
  const double size = data.x.empty() ? 0 : std::max(extent(data.commanded_x), extent(data.commanded_y));
  if (!(largest > 0) || !(size > 0)) return 1;
  const double wanted = std::clamp(kShareOfPicture * size / largest, 1.0, 1e12);
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double step : {5.0, 2.0})
    if (step * decade <= wanted) return step * decade;
  return decade;
}

std::string error_plot_script(const ErrorPlotData& data, PlotFormat format) {
  check(data);
  const bool has_path = !data.x.empty();
  std::string script = "set encoding utf8\n" + terminal(has_path, format) + common_settings();
  script += data.title.empty() ? "set multiplot\n" : "set multiplot title " + quoted(data.title) + " font ',16'\n";
  if (has_path) add_path(script, data);
  add_error(script, data, has_path);
  return script + "unset multiplot\n";
}

void draw(const ErrorPlotData& data, PlotFormat format, const std::string& path) { write_picture(error_plot_script(data, format), format, path, data.title); }

}  // namespace pmac::runtime
