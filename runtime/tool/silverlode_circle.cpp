#include "runtime/tool/silverlode_circle.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>

#include <fmt/format.h>

#include "runtime/drives/silverlode/figures.h"
#include "runtime/drives/silverlode/units.h"
#include "runtime/gather/error_plot.h"
#include "runtime/gather/table_writer.h"
#include "runtime/tool/options.h"
#include "runtime/tool/silverlode_report.h"

namespace pmac::tool {
namespace {

namespace sl = drives::silverlode;

constexpr std::int64_t kMostRunTicks = 500'000'000;     // of a whole table, more than 16 hours

/// Takes the servos' positions at every tick: figures, record, picture.
class Observer {
 public:
  Observer(const SilverlodeOptions& options, const sl::Table& table) : options_(options), table_(table) {
    if (options.record.empty()) return;
    std::vector<std::string> columns{"time_s"};
    columns.insert(columns.end(), table.axes.begin(), table.axes.end());
    record_ = runtime::make_table_writer(*runtime::table_format_of(options.record), options.record, columns);
  }

  void take(std::int64_t tick, std::span<const sl::Profile> servos) {
    row_.assign(1, static_cast<double>(tick) * sl::kTick_s);
    for (const sl::Profile& servo : servos) row_.push_back(static_cast<double>(servo.position) / sl::kUnitsPerCount);
    if (record_) record_->append(row_);
    const double error = sl::radial_error_counts(options_.circle, row_[1], row_[2]);
    figures_.radial_min_counts = std::min(figures_.radial_min_counts, error);
    figures_.radial_max_counts = std::max(figures_.radial_max_counts, error);
    figures_.closing_counts = std::hypot(row_[1] - table_.end_counts[0], row_[2] - table_.end_counts[1]);
    figures_.ticks = tick;
    figures_.time_s = row_[0];
    if (!options_.plots.empty()) add_to_plot(error);
  }

  const sl::CircleFigures& figures() const { return figures_; }

  void finish() {
    if (record_) record_->finish();
    if (options_.plots.empty()) return;
    plot_.title = fmt::format("{} segments, radius {:g}, {} builder", options_.circle.segments, options_.circle.radius, options_.literal ? "literal" : "closed");
    plot_.error_name = "radial error";
    plot_.x_name = "X";
    plot_.y_name = "Y";
    for (const std::string& file : options_.plots) runtime::draw(plot_, *runtime::plot_format_of(file), file);
  }

 private:
  /// The commanded point is the one of the circle in the same direction from its centre.
  void add_to_plot(double error) {
    const sl::CircleSetup& c = options_.circle;
    const sl::Center center = sl::center_of(c);
    const double dx = row_[1] / c.scale_x - center.x, dy = row_[2] / c.scale_y - center.y, distance = std::hypot(dx, dy);
    const double share = distance > 0 ? c.radius / distance : 0;
    plot_.time_s.push_back(row_[0]);
    plot_.error.push_back(error);
    plot_.x.push_back(row_[1]);
    plot_.y.push_back(row_[2]);
    plot_.commanded_x.push_back((center.x + dx * share) * c.scale_x);
    plot_.commanded_y.push_back((center.y + dy * share) * c.scale_y);
  }

  const SilverlodeOptions& options_;
  const sl::Table& table_;
  sl::CircleFigures figures_{1e300, -1e300};
  std::unique_ptr<runtime::TableWriter> record_;
  runtime::ErrorPlotData plot_;
  std::vector<double> row_;
};

void write_sheet(const sl::Sheet& sheet, const std::string& file) {
  const std::vector<sl::Column> columns = sl::columns_of(sheet);
  std::vector<std::string> names{"i"};
  for (const sl::Column& column : columns) names.push_back(column.letters.empty() ? column.name : column.letters + ":" + column.name);
  const auto writer = runtime::make_table_writer(*runtime::table_format_of(file), file, names);
  std::vector<double> row;
  for (std::size_t i = 0; i < sheet.motor_time.size(); ++i) {
    row.assign(1, static_cast<double>(i));
    for (const sl::Column& column : columns) row.push_back(column.values[i]);
    writer->append(row);
  }
  writer->finish();
}

/// With the CR as the end of the line, as it goes over the wire, would be hard to read: every frame has a line of its own.
std::string frame_lines(const std::vector<std::string>& frames) {
  std::string text;
  for (const std::string& frame : frames) text += frame.substr(0, frame.size() - 1) + "\n";
  return text;
}

void write_frames(const std::vector<std::string>& frames, const std::string& file) {
  const std::string text = frame_lines(frames);
  if (file == "-") {
    std::fputs(text.c_str(), stdout);
    return;
  }
  runtime::OutputFile out(file);
  out.write(text);
  out.commit();
}

std::vector<std::string> frames_of(const SilverlodeOptions& options, const sl::Table& table, const std::optional<sl::NetworkResult>& link) {
  std::vector<std::string> frames;
  if (link)
    for (const sl::SentFrame& frame : link->frames) frames.push_back(frame.bytes);
  else
    for (const sl::CommandFrame& frame : sl::host_frames(table, options.network)) frames.push_back(sl::encode(frame));
  return frames;
}

/// Slices that the line cannot keep up with are worth a word even where the servos are fed without it.
void note_slow_link(const SilverlodeOptions& options, const sl::Table& table) {
  const double needed_s = sl::link_time_per_entry_s(table, options.network);
  const double mean_s = static_cast<double>(table.ticks()) * sl::kTick_s / static_cast<double>(table.entries.size());
  if (options.link || mean_s >= needed_s) return;
  std::fprintf(stderr, "pmac-silverlode: note: an entry takes %.4f s on the line and lasts %.4f s; the queues would run dry. Use --min-slice %.3f, or --link to see it\n", needed_s, mean_s,
               std::ceil(needed_s * 1000) / 1000);
}

std::optional<sl::NetworkResult> execute(const SilverlodeOptions& options, const sl::Table& table, Observer& observer) {
  const auto visit = [&observer](std::int64_t tick, std::span<const sl::Profile> servos) { observer.take(tick, servos); };
  if (options.link) return sl::run_network(table, options.network, visit);
  sl::execute(table, visit);
  return std::nullopt;
}

bool failed(const std::optional<sl::NetworkResult>& link) {
  return link && std::any_of(link->events.begin(), link->events.end(), [](const sl::NetworkEvent& event) { return event.is_error; });
}

std::string read_stream(std::istream& in) { return {std::istreambuf_iterator<char>(in), {}}; }

/// Frames of a text: each ends with CR, LF or both.
int decode_text(const std::string& text, const std::string& name, const sl::CommandSet& commands) {
  int code = kExitOk, line = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    const std::string_view bytes = std::string_view(text).substr(at, end - at);
    at = end + (text.compare(end, 2, "\r\n") == 0 ? 2 : 1);
    ++line;
    if (bytes.empty()) continue;
    const bool is_command = bytes.front() == '@';
    std::string meaning, why;
    if (is_command) {
      const auto frame = sl::decode_command(bytes);
      const auto* good = std::get_if<sl::CommandFrame>(&frame);
      if (good) meaning = sl::describe(*good, commands);
      else why = std::get<std::string>(frame);
      if (good && !sl::has_its_parameters(*good, commands)) code = 1;
    } else {
      const auto frame = sl::decode_reply(bytes);
      if (const auto* good = std::get_if<sl::ReplyFrame>(&frame)) meaning = sl::describe(*good, commands);
      else why = std::get<std::string>(frame);
    }
    if (why.empty()) std::printf("%s\n", meaning.c_str());
    else std::fprintf(stderr, "%s:%d: error: %s\n", name.c_str(), line, why.c_str()), code = 1;
  }
  return code;
}

}  // namespace

int run_circle(const SilverlodeOptions& options) {
  const auto built = options.literal ? std::variant<sl::Sheet, std::string>(sl::build_literal(options.circle)) : sl::build_closed(options.circle);
  const auto made = built.index() == 0 ? sl::table_from(std::get<sl::Sheet>(built)) : std::variant<sl::Table, std::string>(std::get<std::string>(built));
  if (const auto* why = std::get_if<std::string>(&made)) {
    std::fprintf(stderr, "pmac-silverlode: %s\n", why->c_str());
    return kExitUsage;
  }
  const sl::Table& table = std::get<sl::Table>(made);
  if (table.ticks() > kMostRunTicks) {
    std::fprintf(stderr, "pmac-silverlode: the arc would take %.0f s, more than %.0f s are not simulated; raise the velocity or the limits\n", static_cast<double>(table.ticks()) * sl::kTick_s,
                 static_cast<double>(kMostRunTicks) * sl::kTick_s);
    return kExitUsage;
  }
  Observer observer(options, table);
  const std::optional<sl::NetworkResult> link = execute(options, table, observer);
  const CircleReport report{options, std::get<sl::Sheet>(built), table, observer.figures(), link};
  note_slow_link(options, table);
  if (options.json) std::fputs(circle_json(report).c_str(), stdout);
  else if (options.frames != "-") std::fputs(circle_text(report).c_str(), stdout);
  if (link && !options.json) std::fputs(events_text(*link).c_str(), stderr);
  observer.finish();
  if (!options.table.empty()) write_sheet(report.sheet, options.table);
  if (!options.frames.empty()) write_frames(frames_of(options, table, link), options.frames);
  runtime::flush_standard_output();
  return failed(link) ? kExitFault : kExitOk;
}

int run_decode(const SilverlodeOptions& options) {
  int code = kExitOk;
  std::vector<std::string> files = options.decoded_files;
  if (files.empty()) files.push_back("-");
  for (const std::string& name : files) {
    std::ifstream file;
    if (name != "-") file.open(name, std::ios::binary);
    if (name != "-" && !file) {
      std::fprintf(stderr, "pmac-silverlode: cannot read %s\n", name.c_str());
      return kExitUsage;
    }
    code = std::max(code, decode_text(read_stream(name == "-" ? std::cin : file), name == "-" ? "standard input" : name, options.network.commands));
  }
  runtime::flush_standard_output();
  return code;
}

}  // namespace pmac::tool
