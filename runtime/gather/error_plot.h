// Pictures of a motion against the one that was commanded: the two paths, the error magnified beside the commanded path, and the error
// against time.
#pragma once

#include <string>
#include <vector>

#include "runtime/gather/plot.h"

namespace pmac::runtime {

struct ErrorPlotData {
  std::string title;                            // empty: none
  std::string unit = "counts";
  std::vector<double> time_s;                   // ascending
  std::vector<double> error;                    // as many as times
  std::string error_name = "error";
  /// Of the first two axes, as many as times; empty: no picture of the path. commanded: the point of the path that each position is
  /// compared with.
  std::vector<double> x, y, commanded_x, commanded_y;
  std::string x_name, y_name;
};

/// By how much the picture magnifies the error: 1, 2, 5, 10, ... so that the largest is about a tenth of the picture.
double magnification(const ErrorPlotData& data);

std::string error_plot_script(const ErrorPlotData& data, PlotFormat format);

/// Throws OutputError, and std::invalid_argument for data with nothing to draw.
void draw(const ErrorPlotData& data, PlotFormat format, const std::string& path);

}  // namespace pmac::runtime
