// Whether a program that loops without moving can ever do anything else. Its way depends on where it stands, its parameters, relays and
// rates alone; a state that comes again without anything from outside comes again for ever, as in 70 GOTO 70 or in a loop that polls
// a relay which nobody sets. Method: Brent's search for a cycle, one kept state.
#pragma once

#include <map>
#include <vector>

#include "runtime/acr1000/diagnostic.h"
#include "runtime/acr1000/rates.h"

namespace pmac::acr1000 {

struct ProgramState {
  Place place;
  std::uint64_t position = 0;
  int nesting = 0;
  std::uint64_t outputs = 0;
  RateSettings rates;
  std::vector<double> parameters;
  std::map<int, bool> relays;
  bool busy = false, program_runs = false;
  bool operator==(const ProgramState&) const = default;
};

class LoopWatch {
 public:
  /// Told the state at the end of every pass. True: it was there before, since the last forget().
  bool repeats(ProgramState state);
  /// Something came from outside, or a move began or ended.
  void forget() { kept_.reset(); }

 private:
  std::optional<ProgramState> kept_;
  std::uint64_t passes_ = 0, keep_for_ = 1;
};

}  // namespace pmac::acr1000
