// What the scripts of all pictures share: numbers and texts as gnuplot reads them, the look, and the way into a file.
#pragma once

#include <string>

#include "runtime/gather/plot.h"

namespace pmac::runtime {

/// The shortest digits that read back as the same double; NaN for what is not finite.
std::string number(double value);

/// A text in gnuplot's single quotes.
std::string quoted(const std::string& text);

/// Kind and size of the picture; is_wide: two panels side by side.
std::string terminal(bool is_wide, PlotFormat format);

std::string common_settings();

/// Runs the script and writes what it draws; an .html file holds the picture itself. Throws OutputError.
void write_picture(const std::string& script, PlotFormat format, const std::string& path, const std::string& title);

}  // namespace pmac::runtime
