#include "runtime/tool/silverlode_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "runtime/drives/silverlode/units.h"
#include "runtime/gather/plot.h"
#include "runtime/gather/table_writer.h"
#include "runtime/tool/options.h"

namespace pmac::tool {
namespace {

namespace sl = drives::silverlode;

constexpr const char* kCircleFooter = R"(Units: --radius and --offset in user units, times --scale = counts; --velocity in user units/s; --max-speed in rpm and
--max-accel in rpm/s at 4000 counts a revolution; --min-slice in seconds. One tick is 120 us.

Examples:
  pmac-silverlode circle --segments 72 --radius 4000 --velocity 1000 --max-speed 4000 --max-accel 3000 --json
  pmac-silverlode circle --segments 360 --builder literal --table note.csv --plot error.svg
  pmac-silverlode circle --segments 6 --radius 2 --scale 4000,4000 --velocity 0.5 --record hexagon.csv
  pmac-silverlode circle --knife 11.1111 --max-speed 4000,4000,2000 --max-accel 3000,3000,3000 --table knife.csv
  pmac-silverlode circle --link --id 16,17 --frames - --start-latency 8
  pmac-silverlode circle --link --press '5 stop' --press '6 jog X 500' --press '8 jog X 0' --press '9 centre'

Exit codes: 0 ok, 2 usage, bad value or unwritable file, 3 the simulated servos did not execute the table, 70 internal error.)";

/// What is wrong with the command line, for the user.
struct Refused : std::runtime_error { using std::runtime_error::runtime_error; };

double number_from(const std::string& option, const std::string& text) {
  double value = 0;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.empty() || !std::isfinite(value))
    throw Refused(fmt::format("{}: '{}' is not a number", option, text));
  return value;
}

std::vector<double> numbers_from(const std::string& option, const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    numbers.push_back(number_from(option, text.substr(at, comma - at)));
    at = comma + 1;
  }
  return numbers;
}

long long whole_from(const std::string& option, const std::string& text) {
  const double value = number_from(option, text);
  if (value != std::floor(value) || std::abs(value) > 9e15) throw Refused(fmt::format("{}: '{}' is not a whole number", option, text));
  return static_cast<long long>(value);
}

/// One value for every axis, or one an axis.
std::vector<double> per_axis(const std::string& option, const std::string& text, std::size_t axes) {
  std::vector<double> numbers = numbers_from(option, text);
  if (numbers.size() == 1) numbers.assign(axes, numbers[0]);
  if (numbers.size() == 2 && axes == 3) numbers.push_back(numbers[1]);
  if (numbers.size() != axes) throw Refused(fmt::format("{}: '{}' has {} values, wanted one or {}", option, text, numbers.size(), axes));
  return numbers;
}

/// The texts of the options as they are written.
struct Texts {
  std::string segments = "72", radius = "4000", start_angle = "0", offset = "0,0", distance_angle = "360", velocity = "1000", max_speed = "4000", max_accel = "3000",
              scale = "1,1", min_slice = "0", knife, builder = "closed";
  std::string ids = "16,17,18", servo_ids, depth = "10", baud = "57600", latency = "1", reply_delay = "0.00012", host_delay = "0", timeout = "0.05", jog_accel = "3000";
  std::vector<std::string> presses, lost, commands;
};

void add_dialog(CLI::App& app, Texts& t, SilverlodeOptions& o) {
  const auto add = [&app](const char* name, std::string& text, const char* type, const char* meaning) { app.add_option(name, text, meaning)->type_name(type)->capture_default_str(); };
  add("--segments", t.segments, "N", "number of straight segments");
  add("--radius", t.radius, "R", "radius, user units");
  add("--start-angle", t.start_angle, "DEG", "starting angle, counter-clockwise from the X axis");
  add("--offset", t.offset, "X,Y", "first point of the arc, user units");
  add("--distance-angle", t.distance_angle, "DEG", "length of the arc, 360 for a full circle; negative: clockwise");
  add("--velocity", t.velocity, "V", "tangential velocity, user units/s");
  add("--max-speed", t.max_speed, "RPM[,RPM]", "greatest speed of the axes, rpm");
  add("--max-accel", t.max_accel, "A[,A]", "greatest acceleration of the axes, rpm/s");
  add("--scale", t.scale, "X,Y", "counts per user unit");
  add("--min-slice", t.min_slice, "S", "least time of a segment in seconds, so that the link keeps up");
  add("--knife", t.knife, "COUNTS", "third axis: a knife along the cut, counts per degree");
  app.add_option("--builder", t.builder, "closed: corrected, the table closes; literal: the application note's arithmetic as printed")
      ->check(CLI::IsMember({"closed", "literal"}))
      ->capture_default_str();
  app.add_flag("--json", o.json, "print one JSON object");
  app.add_option("--record", o.record, "write the position of every axis in counts at every tick to a .csv, .npz or .txt file")->type_name("FILE");
  app.add_option("--table", o.table, "write the columns of the note's spreadsheet, with their letters, to a .csv, .npz or .txt file")->type_name("FILE");
  app.add_option("--frames", o.frames, "write the frames that the host sends; - for standard output")->type_name("FILE");
  app.add_option("--plot", o.plots, "draw path and radial error to a .svg, .png or .html file")->type_name("FILE")->allow_extra_args(false);
  app.add_flag("-q,--quiet", o.quiet, "no list of the entries");
}

void add_link(CLI::App& app, Texts& t, SilverlodeOptions& o) {
  const auto add = [&app](const char* name, std::string& text, const char* type, const char* meaning) { app.add_option(name, text, meaning)->type_name(type)->capture_default_str()->group("Link"); };
  app.add_flag("--link", o.link, "execute through host, serial line and queues; else the servos are always fed in time")->group("Link");
  add("--id", t.ids, "X,Y", "device ids that the host uses");
  add("--servo-id", t.servo_ids, "X,Y", "device ids that the servos really have");
  add("--queue-depth", t.depth, "N", "entries that a servo's queue holds (assumed)");
  add("--baud", t.baud, "BAUD", "speed of the line, 8 data bits, no parity, 2 stop bits");
  add("--start-latency", t.latency, "TICKS", "ticks from the leader's start to the followers' (assumed)");
  app.add_flag("--compensate-start", o.network.compensate_start, "the leader waits for the followers, by an entry at rest")->group("Link");
  app.add_flag_callback("--no-wire", [&o] { o.network.wired = false; }, "I/O 1 of the leader does not reach the followers")->group("Link");
  add("--reply-delay", t.reply_delay, "S", "time a servo takes to answer (assumed)");
  add("--host-delay", t.host_delay, "S", "time the host takes before each frame (assumed)");
  add("--reply-timeout", t.timeout, "S", "time the host waits for an answer (assumed)");
  app.add_option("--retries", o.network.retries, "how often the host repeats what nobody answers (assumed)")->check(CLI::Range(0, 1000))->capture_default_str()->group("Link");
  app.add_option("--lose", t.lost, "the line swallows this frame, counted from 1")->type_name("N")->allow_extra_args(false)->group("Link");
  app.add_option("--press", t.presses, "press a button at a time: '5 stop', '5 restart', '5 jog X 500' (counts/s), '5 centre'")->type_name("'TIME ACTION'")->allow_extra_args(false)->group("Link");
  add("--jog-accel", t.jog_accel, "A", "acceleration of jogs and centre, rpm/s");
  app.add_option("--command", t.commands, "number of a command that is not documented: WRI RUN IMS IMW IMQ")->type_name("NAME=NUMBER")->allow_extra_args(false)->group("Link");
}

void read_dialog(const Texts& t, sl::CircleSetup& c, bool& literal) {
  c.segments = whole_from("--segments", t.segments);
  c.radius = number_from("--radius", t.radius);
  c.start_angle_deg = number_from("--start-angle", t.start_angle);
  c.distance_angle_deg = number_from("--distance-angle", t.distance_angle);
  c.velocity = number_from("--velocity", t.velocity);
  const std::vector<double> offset = numbers_from("--offset", t.offset);
  if (offset.size() != 2) throw Refused(fmt::format("--offset: '{}' is not two numbers X,Y", t.offset));
  c.offset_x = offset[0], c.offset_y = offset[1];
  const std::vector<double> scale = per_axis("--scale", t.scale, 2);
  c.scale_x = scale[0], c.scale_y = scale[1];
  c.min_slice_s = number_from("--min-slice", t.min_slice);
  if (!t.knife.empty()) c.knife_counts_deg = number_from("--knife", t.knife);
  const std::vector<double> speeds = per_axis("--max-speed", t.max_speed, c.axis_count()), accels = per_axis("--max-accel", t.max_accel, c.axis_count());
  for (std::size_t a = 0; a < c.axis_count(); ++a) c.limits.push_back({speeds[a], accels[a]});
  literal = t.builder == "literal";
  if (const auto why = sl::problem_of(c)) throw Refused(*why);
}

std::size_t axis_from(const std::string& name, std::size_t axes) {
  const std::vector<std::string> names{"X", "Y", "theta"};
  for (std::size_t a = 0; a < axes; ++a)
    if (names[a] == name) return a;
  throw Refused(fmt::format("--press: there is no axis '{}'", name));
}

/// "5 stop", "5 jog X 500".
sl::PanelAction action_from(const std::string& text, const sl::CircleSetup& circle) {
  using Kind = sl::PanelAction::Kind;
  std::vector<std::string> words;
  std::istringstream in(text);
  for (std::string word; in >> word;) words.push_back(word);
  if (words.size() < 2) throw Refused(fmt::format("--press: '{}' is no time and action", text));
  sl::PanelAction action;
  action.time_s = number_from("--press", words[0]);
  if (action.time_s < 0 || action.time_s > 1e6) throw Refused(fmt::format("--press: '{}' is not a time from 0 to 1000000 s", words[0]));
  const bool jogs = words[1] == "jog";
  if (words.size() != (jogs ? 4u : 2u)) throw Refused(fmt::format("--press: '{}' has {} words; write 'TIME stop', 'TIME jog X SPEED'", text, words.size()));
  if (words[1] == "stop") action.kind = Kind::kStop;
  else if (words[1] == "restart") action.kind = Kind::kRestart;
  else if (words[1] == "centre" || words[1] == "center") action.kind = Kind::kCenter;
  else if (jogs) action.kind = Kind::kJog;
  else throw Refused(fmt::format("--press: there is no action '{}'; stop, restart, jog, centre", words[1]));
  if (jogs) action.axis = axis_from(words[2], circle.axis_count());
  action.speed_counts_s = jogs ? number_from("--press", words[3]) : sl::counts_s_from_rpm(circle.limits[0].max_speed_rpm);
  if (std::abs(action.speed_counts_s) > sl::counts_s_from_rpm(4000)) throw Refused(fmt::format("--press: {} counts/s is beyond 4000 rpm", words[3]));
  return action;
}

std::vector<int> ids_from(const std::string& option, const std::string& text) {
  std::vector<int> ids;
  for (const double id : numbers_from(option, text)) {
    if (id != std::floor(id) || id < 1 || id > sl::kMostAddress) throw Refused(fmt::format("{}: {} is not an id from 1 to {}", option, id, sl::kMostAddress));
    ids.push_back(static_cast<int>(id));
  }
  return ids;
}

void read_link(const Texts& t, const sl::CircleSetup& circle, sl::NetworkSetup& n) {
  n.host_ids = ids_from("--id", t.ids);
  if (!t.servo_ids.empty()) n.servo_ids = ids_from("--servo-id", t.servo_ids);
  const long long depth = whole_from("--queue-depth", t.depth), latency = whole_from("--start-latency", t.latency);
  if (depth < 1 || depth > 1'000'000) throw Refused("--queue-depth must be 1 to 1000000");
  if (latency < 0 || latency > 1'000'000) throw Refused("--start-latency must be 0 to 1000000 ticks");
  n.queue_depth = static_cast<std::size_t>(depth);
  n.start_latency_ticks = static_cast<int>(latency);
  n.baud = number_from("--baud", t.baud);
  n.reply_delay_s = number_from("--reply-delay", t.reply_delay);
  n.host_delay_s = number_from("--host-delay", t.host_delay);
  n.reply_timeout_s = number_from("--reply-timeout", t.timeout);
  n.panel_accel_counts_s2 = sl::counts_s_from_rpm(number_from("--jog-accel", t.jog_accel));
  for (const std::string& lost : t.lost) n.lost_frames.push_back(static_cast<std::size_t>(std::max(0LL, whole_from("--lose", lost))));
  for (const std::string& press : t.presses) n.actions.push_back(action_from(press, circle));
  std::stable_sort(n.actions.begin(), n.actions.end(), [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  for (const std::string& command : t.commands) {
    const std::size_t equals = command.find('=');
    if (equals == std::string::npos) throw Refused(fmt::format("--command: '{}' is no NAME=NUMBER", command));
    const long long number = whole_from("--command", command.substr(equals + 1));
    if (number < 0 || number > sl::kMostCommandNumber) throw Refused(fmt::format("--command: {} must be 0 to {}", command, sl::kMostCommandNumber));
    if (const auto why = n.commands.set_number(command.substr(0, equals), static_cast<int>(number))) throw Refused("--command: " + *why);
  }
  if (const auto why = sl::problem_of(n, circle.axis_count())) throw Refused(*why);
}

void check_files(const SilverlodeOptions& o) {
  for (const std::string& file : {o.record, o.table})
    if (!file.empty() && !runtime::table_format_of(file)) throw Refused(file + ": unknown ending; tables are .csv, .npz or .txt");
  for (const std::string& file : o.plots)
    if (!runtime::plot_format_of(file)) throw Refused(file + ": unknown ending; pictures are .svg, .png or .html");
  std::vector<std::string> outputs{o.record, o.table, o.frames};
  outputs.insert(outputs.end(), o.plots.begin(), o.plots.end());
  for (std::size_t i = 0; i < outputs.size(); ++i)
    for (std::size_t k = i + 1; k < outputs.size(); ++k)
      if (!outputs[i].empty() && outputs[i] == outputs[k]) throw Refused(outputs[i] + " is two outputs at once; choose another name");
  if (o.json && o.frames == "-") throw Refused("--frames - and --json both want standard output; give the frames a file");
}

}  // namespace

std::optional<int> parse_silverlode_options(int argc, char** argv, SilverlodeOptions& o) {
  CLI::App app{"Interpolation tables for SilverLode servos, executed on simulated servos.", "pmac-silverlode"};
  app.set_version_flag("--version", "pmac-silverlode 0.1.0");
  app.require_subcommand(1);
  Texts texts;
  CLI::App* circle = app.add_subcommand("circle", "arcs as straight segments: the dialog of the application note \"Make Circles\"");
  circle->footer(kCircleFooter);
  add_dialog(*circle, texts, o);
  add_link(*circle, texts, o);
  CLI::App* decode = app.add_subcommand("decode", "tell what frames on the line mean, one a line; errors with their line");
  decode->add_option("FILE", o.decoded_files, "frames; - or nothing for standard input");
  decode->add_option("--command", texts.commands, "number of a command that is not documented")->type_name("NAME=NUMBER")->allow_extra_args(false);
  try {
    app.parse(argc, argv);
    o.verb = decode->parsed() ? SilverlodeOptions::Verb::kDecode : SilverlodeOptions::Verb::kCircle;
    read_dialog(texts, o.circle, o.literal);
    read_link(texts, o.circle, o.network);
    check_files(o);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitOk : kExitUsage;
  } catch (const Refused& e) {
    std::fprintf(stderr, "pmac-silverlode: %s\nRun with --help for more information.\n", e.what());
    return kExitUsage;
  }
  const bool asks_for_link = !o.network.actions.empty() || !o.network.lost_frames.empty() || !o.network.servo_ids.empty() || !o.network.wired;
  o.link = o.link || asks_for_link;
  return std::nullopt;
}

}  // namespace pmac::tool
