// Long work that can be given up: planning, loops of scripts. Whoever drives a run says how its owner wants the end (a signal, a reader that
// has gone); the loops deep inside ask now and then. What was being planned is lost, what has been sampled is whole.
#pragma once

#include <functional>

namespace pmac::runtime {

/// Thrown by poll_interruption(). Ends the run: the machine plans nothing more afterwards.
struct Interrupted {};

/// While it lives, poll_interruption() of this thread asks `wanted`. Empty: nobody does.
class InterruptionScope {
 public:
  explicit InterruptionScope(const std::function<bool()>& wanted);
  ~InterruptionScope();
  InterruptionScope(const InterruptionScope&) = delete;

 private:
  const std::function<bool()>* before_;
};

/// Throws Interrupted where the end is wanted. Costs a few nanoseconds.
void poll_interruption();
/// The same for work that can stop where it is.
bool interruption_wanted();

}  // namespace pmac::runtime
