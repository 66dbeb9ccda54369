// Register scripts: the writes to a chip as its manual prints them, and a few words of the host program around them.
//
//     WR6 <- 1388h Write ; centre of X          a write; the arrow is <-, = or the printed one; "Write" and the comment may be missing
//     wait idle                                 until no axis drives
//     wait next                                 until RR0 says that the next segment may be written (or nothing drives)
//     wait 2.5 ms                               so much simulated time; units us, ms, s
//     read RR0                                  the value is reported
//
// Blanks and line ends between the parts of a write do not count, as in text taken out of a printed page. A comment goes from ; to the end of
// its line and over the lines below it that neither begin with WR, RR, wait or read nor hold an arrow. Writes take no simulated time; a time in
// front of an item (0.000000, as --emit=frames prints it) is passed over.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pmac::drives::mcx514 {

/// Something about a place of a script, line and column counted from 1.
struct Problem {
  bool is_error = true;
  int line = 0;
  int column = 1;
  std::string text;   // a sentence without full stop
};

struct ScriptItem {
  enum class Kind : std::uint8_t { kWrite, kRead, kWaitIdle, kWaitNext, kWaitTime };
  Kind kind = Kind::kWrite;
  int line = 0;
  int column = 1;
  int reg = 0;               // of kWrite, kRead
  std::uint16_t value = 0;   // of kWrite
  double wait_s = 0;         // of kWaitTime
};

struct Script {
  std::vector<ScriptItem> items;
  std::vector<Problem> problems;   // in order of their place
};

/// Reads a whole script. Never fails: what is wrong is in problems.
Script read_script(std::string_view text);

class Chip;

/// Executes the items in order; false where the chip's time limit or an interruption ended it before. What still drives then is left to
/// Chip::run_until_idle().
bool run_items(const Script& script, Chip& chip);

/// "WR6 <- 1388h Write"
std::string write_text(int reg, std::uint16_t value);

}  // namespace pmac::drives::mcx514
