// Path time of a coordinate system: everything on its path happens at times of this clock, which runs at the rate of the time base.
// At 100 % path time is the machine's time, bit for bit. Rates are fractions of real time: 1 is 100 %.
//
//   rate  1 ------\                 /------
//                  \               /          a change of rate is a straight slope
//         0         \_____________/
//             h            held      r
//
// Source: User's Manual p693-695; the unit of the slews (change of the time base in ms each servo cycle) is inferred from their
// defaults. The controller changes its time base by steps, once a servo cycle; here it is the straight line through them.
#pragma once

#include <limits>
#include <vector>

namespace pmac::runtime {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

class TimeBase {
 public:
  /// Values of Coord[].FeedHold.
  enum class Hold { kNone = 0, kHeld = 1, kResuming = 2, kSlowing = 3 };

  // --- the clock -------------------------------------------------------------------------------------------------------
  double path_at(double time_ms) const { return real_time_ ? time_ms : path_on_pieces(time_ms); }
  double rate_at(double time_ms) const { return real_time_ ? 1.0 : rate_on_pieces(time_ms); }
  /// First time at which the clock shows path_ms; infinity if it never does as things stand.
  double time_at(double path_ms) const { return real_time_ ? path_ms : time_on_pieces(path_ms); }
  bool is_real_time() const { return real_time_; }
  /// Until when the rate stays what it is at time_ms; infinity if for ever. time_ms itself or later while it slopes.
  double steady_until_ms(double time_ms) const;
  /// From when on the rate does not change any more; 0 while it never has.
  double settled_from_ms() const { return real_time_ ? 0 : pieces_.back().start_ms; }
  /// Nothing is on the path: the clock shows the machine's time again, and goes on from there.
  void restart(double time_ms);

  // --- what commands do with it; slope: change of rate each ms, above 0 -----------------------------------------------------
  void set_override(double time_ms, double rate, double slope_per_ms);
  void hold(double time_ms, double slope_per_ms);
  void release(double time_ms, double slope_per_ms);
  /// Abort: no hold; nothing is left that would feel a jump of the rate.
  void clear_hold(double time_ms);
  /// Exactly this rate from time_ms on; a caller that shapes the rate itself (quick stop).
  void force_rate(double time_ms, double rate);
  /// The caller shapes the rate until shape_end(); FeedHold shows hold meanwhile.
  void shape(Hold hold) { hold_ = hold; shaped_ = true; }
  void shape_end(bool held) { hold_ = held ? Hold::kSlowing : Hold::kNone; shaped_ = false; }

  double override_rate() const { return override_; }
  Hold hold_state(double time_ms) const;
  /// The clock stands, and goes on only by a command.
  bool stands(double time_ms) const;

 private:
  struct Piece { double start_ms, path_ms, rate, slope; };
  const Piece& piece_at(double time_ms) const;
  double path_on_pieces(double time_ms) const;
  double rate_on_pieces(double time_ms) const;
  double time_on_pieces(double path_ms) const;
  void slew_to(double time_ms, double rate, double slope_per_ms);
  void cut(double time_ms);

  bool real_time_ = true;
  double override_ = 1;
  bool shaped_ = false;
  Hold hold_ = Hold::kNone;        // kSlowing and kResuming until the slope has ended
  std::vector<Piece> pieces_{{0, 0, 1, 0}};   // ascending; those of the past serve times that are asked for later
};

}  // namespace pmac::runtime
