// Pictures of a motion through gnuplot: the path in the plane of two axes, and position, velocity and acceleration of every
// axis against time in stacked panels. Velocity and acceleration are differences of the samples.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "runtime/gather/output_file.h"

namespace pmac::runtime {

enum class PlotFormat { kSvg, kPng, kHtml };

/// Format by the ending of a file name, in either case; nullopt for others.
std::optional<PlotFormat> plot_format_of(std::string_view path);

struct PlotCurve {
  std::string name;              // "X", "Motor[1].DesPos"
  std::vector<double> position;  // by sample, as many as times
};

struct PlotData {
  std::string title;             // empty: none
  std::string length_unit;       // of the positions, as the labels show it: "mm"; empty: "axis units"
  std::vector<double> time_s;    // ascending
  std::vector<PlotCurve> curves;
  /// Curves that span the plane of the path panel; nullopt: no such panel.
  std::optional<std::pair<std::size_t, std::size_t>> path;
  bool time_panels = true;
};

/// The gnuplot script that draws the picture to standard output.
std::string plot_script(const PlotData& data, PlotFormat format);

/// Draws the picture into a file; an .html file holds the picture itself. Throws OutputError (gnuplot missing, disk full) and
/// std::invalid_argument for data with nothing to draw; then nothing keeps the name.
void draw(const PlotData& data, PlotFormat format, const std::string& path);

}  // namespace pmac::runtime
