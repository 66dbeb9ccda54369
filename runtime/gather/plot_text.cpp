#include "runtime/gather/plot_text.h"

#include <array>
#include <charconv>
#include <cmath>

#include "runtime/gather/gnuplot.h"
#include "runtime/gather/output_file.h"

namespace pmac::runtime {
namespace {

std::string html_text(const std::string& text) {
  std::string result;
  for (const char ch : text) {
    if (ch == '<') result += "&lt;";
    else if (ch == '&') result += "&amp;";
    else result += ch;
  }
  return result;
}

/// A page that holds the picture itself.
std::string html_page(const std::string& plot_title, const std::string& svg) {
  const std::size_t start = svg.find("<svg");
  const std::string title = html_text(plot_title.empty() ? "Motion" : plot_title);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>" + title +
         "</title>\n<style>body{margin:1rem;background:#fff} svg{width:100%;height:auto;max-height:95vh}</style>\n</head>\n<body>\n" +
         svg.substr(start == std::string::npos ? 0 : start) + "\n</body>\n</html>\n";
}

}  // namespace

std::string number(double value) {
  if (!std::isfinite(value)) return "NaN";
  std::array<char, 32> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char ch : text) result += ch == '\'' ? std::string("''") : std::string(1, ch == '\n' ? ' ' : ch);
  return result + "'";
}

std::string terminal(bool is_wide, PlotFormat format) {
  const std::string size = is_wide ? "1440,720" : "900,720";
  if (format == PlotFormat::kPng) return "set terminal pngcairo noenhanced size " + size + " font 'DejaVu Sans,11' linewidth 1.2\n";
  return "set terminal svg noenhanced size " + size + " dynamic font 'DejaVu Sans,Helvetica,Arial,sans-serif,14' "
         "background '#ffffff' linewidth 1.2\n";
}

std::string common_settings() {
  return "set datafile missing 'NaN'\n"
         "set grid linetype 1 linecolor rgb '#e2e2e2' linewidth 0.6\n"
         "set border linecolor rgb '#606060' linewidth 0.8\n"
         "set tics textcolor rgb '#303030' nomirror\n"
         "set key bottom right horizontal samplen 1.6\n";
}

void write_picture(const std::string& script, PlotFormat format, const std::string& path, const std::string& title) {
  const std::string picture = run_gnuplot(script);
  OutputFile file(path);
  file.write(format == PlotFormat::kHtml ? html_page(title, picture) : picture);
  file.commit();
}

}  // namespace pmac::runtime
