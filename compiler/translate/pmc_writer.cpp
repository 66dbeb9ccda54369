#include "compiler/translate/pmc_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace pmac::compiler::translate {
namespace {

constexpr double kSagPulses = 0.2;      // how far a chord may be away from a curve that has no counterpart
constexpr int kMostChords = 20'000;     // of one move
constexpr double kSameSpeed = 1e-9;     // relative

/// What the program has said last, so that it is not said again.
struct Modal { double feed = -1, ta = 0, td = 0, tm = -1; std::string mode, normal; };

class Writer {
 public:
  Writer(const PmcSystem& system, source::Diagnostics& diagnostics) : system_(system), diagnostics_(diagnostics) {}

  std::string set_up() const;
  std::string program();

 private:
  const std::string& name(std::size_t card) const { return system_.cards[card].axis; }
  void line(const PathMove& move);
  void check_end(const AxisPart& axis, const PathMove& move);
  void arc(const PathMove& move);
  void chords(const PathMove& move);
  void stand(const PathMove& move) { put(fmt::format("dwell {}", 1000 * move.times.total_s()), move); }
  void ramps(const PathMove& move);
  void stop_if_it_ends(const PathMove& move);
  void put(const std::string& text, const PathMove& move);
  std::string mode(const std::string& text) { return std::exchange(modal_.mode, text) == text ? std::string() : text + " "; }
  std::string feed(double units_s);
  std::string targets(const PathMove& move, double u) const;

  const PmcSystem& system_;
  source::Diagnostics& diagnostics_;
  Modal modal_;
  std::string out_;
  std::string told_place_;
};

std::string Writer::set_up() const {
  std::string text = fmt::format("&{}\n", system_.coord);
  for (std::size_t k = 0; k < system_.cards.size(); ++k) {
    // A card that begins elsewhere than at 0: the motor is at 0 there.
    const std::string offset = system_.cards[k].start == 0 ? std::string() : fmt::format("{:+}", -system_.cards[k].start);
    text += fmt::format("#{}->{}{}\n", system_.first_motor + static_cast<int>(k), name(k), offset);
  }
  const bool curves = std::any_of(system_.moves.begin(), system_.moves.end(), [](const PathMove& move) { return move.kind == PathKind::kArc; });
  text += fmt::format("Coord[{}].FeedTime=1000      // F is pulses a second\n", system_.coord);
  text += fmt::format("Coord[{}].SegMoveTime={}\n", system_.coord, curves ? 1 : 0);
  return text;
}

void Writer::put(const std::string& text, const PathMove& move) {
  const bool new_place = move.place != told_place_ && !move.place.empty();
  told_place_ = move.place;
  out_ += "  " + text + (new_place ? fmt::format("   // {} of {}", move.place, name(0)) : std::string()) + "\n";
}

std::string Writer::feed(double units_s) {
  if (std::abs(units_s - std::exchange(modal_.feed, units_s)) <= kSameSpeed * units_s) return {};
  modal_.tm = -1;
  return fmt::format(" F{}", units_s);
}

std::string Writer::targets(const PathMove& move, double u) const {
  std::string text;
  for (std::size_t k = 0; k < move.axes.size(); ++k) text += fmt::format(" {}{}", name(k), u >= 1 ? move.axes[k].to : std::round(move.axes[k].at(u) * 1e4) / 1e4);
  return text.substr(1);
}

/// ta and td of a move. A change of speed where two moves join has no counterpart that stays on the path: there it is a step.
void Writer::ramps(const PathMove& move) {
  const bool from_rest = move.times.entry_speed == 0;
  const double ta = from_rest ? 1000 * move.times.start_s : 0;
  const double td = 1000 * move.times.end_s;
  if (!from_rest && move.times.start_s > 0)
    diagnostics_.warning("ACR-W10", move.span, "the ramp between two joined moves is not carried over: the speed changes at once, the path stays the same");
  if (move.times.forced_stop) diagnostics_.warning("ACR-W10", move.span, "the stop of this move from its entry speed is not carried over exactly: the path stays the same");
  if (ta == modal_.ta && td == modal_.td) return;
  out_ += fmt::format("  ta {} td {}\n", ta, td);
  modal_.ta = ta, modal_.td = td;
}

/// Behind a ramp to rest the path stops; else the next move joins.
void Writer::stop_if_it_ends(const PathMove& move) {
  if (move.times.exit_speed == 0) out_ += "  dwell 0\n";
}

void Writer::line(const PathMove& move) {
  double sum = 0;
  for (const AxisPart& axis : move.axes) sum += (axis.to - axis.from) * (axis.to - axis.from);
  ramps(move);
  const double speed = std::sqrt(sum) / move.times.length * move.times.speed;
  put(mode("linear") + targets(move, 1) + feed(speed), move);
  stop_if_it_ends(move);
}

/// P29 ends a CIRCLE wherever the law has come to; a circle of a motion program is bent to end there.
void Writer::check_end(const AxisPart& axis, const PathMove& move) {
  constexpr double kRounded = 2;   // pulses: P29 and the arguments are whole
  const double angle = axis.direction * axis.distance / axis.radius;
  const double law = axis.from + axis.i * (std::cos(angle) - 1) + axis.j * std::sin(angle);
  if (std::abs(axis.to - law) > kRounded)
    diagnostics_.warning("ACR-W10", move.span, fmt::format("P29 is {:.0f} pulses from where the CIRCLE comes to; the card steps there, the arc of the motion program is bent to end there", std::abs(axis.to - law)));
}

void Writer::arc(const PathMove& move) {
  static constexpr struct { const char *right, *normal, *first, *second; } kPlanes[] = {{"X", "normal K-1", "I", "J"}, {"Y", "normal I-1", "J", "K"}, {"Z", "normal J-1", "K", "I"}};
  const AxisPart &right = move.axes[move.plane[0]], &up = move.axes[move.plane[1]];
  const auto* plane = std::find_if(std::begin(kPlanes), std::end(kPlanes), [&](const auto& p) { return name(move.plane[0]) == p.right; });
  ramps(move);
  if (std::exchange(modal_.normal, plane->normal) != plane->normal) out_ += fmt::format("  {}\n", plane->normal);
  // I of each card leads from the centre to the start, I J K of the program from the start to the centre.
  const double to_centre_right = 0 - right.i, to_centre_up = 0 - up.i;
  const double sweep = right.distance / right.radius, radius = std::hypot(right.i, right.j);
  const double speed = radius * sweep / move.times.length * move.times.speed;
  for (const AxisPart* axis : {&right, &up}) check_end(*axis, move);
  const std::string turn = move.clockwise ? "circle1" : "circle2";
  const auto whole_turns = static_cast<int>(std::floor(sweep / (2 * std::numbers::pi) + 1e-6));
  const bool closed = right.from == right.to && up.from == up.to;
  for (int n = 0; n < whole_turns; ++n)
    put(mode(turn) + fmt::format("{}{} {}{} {}{} {}{}", name(move.plane[0]), right.from, name(move.plane[1]), up.from, plane->first, to_centre_right, plane->second, to_centre_up) + feed(speed), move);
  const bool rest = !closed || whole_turns == 0;
  if (rest && closed) diagnostics_.warning("ACR-W10", move.span, "an arc that ends where it begins is a full circle in a motion program");
  if (rest) put(mode(turn) + targets(move, 1) + fmt::format(" {}{} {}{}", plane->first, to_centre_right, plane->second, to_centre_up) + feed(speed), move);
  stop_if_it_ends(move);
}

/// Ellipses, sines and their kind as short lines of equal times.
void Writer::chords(const PathMove& move) {
  double bend = 0;  // of the path, pulses for a radian^2 of the largest sweep
  double sweep = 0;
  for (const AxisPart& axis : move.axes) {
    if (!axis.is_circle || axis.distance == 0) continue;
    bend = std::hypot(bend, std::hypot(axis.i, axis.j));
    sweep = std::max(sweep, axis.distance / axis.radius);
  }
  const double steepest = move.times.total_s() * std::max(move.times.speed, move.times.entry_speed) / move.times.length;
  const double step_rad = std::sqrt(8 * kSagPulses / std::max(bend, 1e-9));
  const int count = std::clamp(static_cast<int>(std::ceil(sweep * steepest / step_rad)), 1, kMostChords);
  diagnostics_.warning("ACR-W10", move.span, fmt::format("this is no line and no arc; it is carried over as {} short lines", count));
  if (modal_.ta != 0 || modal_.td != 0) out_ += "  ta 0 td 0\n";
  modal_.ta = modal_.td = 0;
  const double time_s = move.times.total_s() / count;
  if (std::exchange(modal_.tm, time_s) != time_s) out_ += fmt::format("  tm {}\n", 1000 * time_s);
  modal_.feed = -1;
  for (int n = 1; n <= count; ++n) put(mode("linear") + targets(move, n == count ? 1 : move.times.at(n * time_s) / move.times.length), move);
  stop_if_it_ends(move);
}

std::string Writer::program() {
  std::string names;
  for (std::size_t k = 0; k < system_.cards.size(); ++k) {
    names += (k ? "," : "") + name(k);
  }
  out_ = fmt::format("open prog {}\n  abs({})\n  frax({})\n  ta 0 ts 0 td 0\n", system_.program, names, names);
  for (const PathMove& move : system_.moves) {
    switch (move.kind) {
      case PathKind::kStand: stand(move); break;
      case PathKind::kLine: line(move); break;
      case PathKind::kArc: arc(move); break;
      case PathKind::kOther: chords(move); break;
    }
  }
  return out_ + "close\n";
}

}  // namespace

std::string write_pmc(const std::vector<PmcSystem>& systems, const std::string& origin, source::Diagnostics& diagnostics) {
  std::string text = fmt::format("// The path of {}. Axis units are pulses. Start with:", origin);
  for (const PmcSystem& system : systems) text += fmt::format(" &{} b{}r", system.coord, system.program);
  text += "\n";
  for (const PmcSystem& system : systems) {
    Writer writer(system, diagnostics);
    text += writer.set_up() + writer.program();
  }
  return text;
}

}  // namespace pmac::compiler::translate
