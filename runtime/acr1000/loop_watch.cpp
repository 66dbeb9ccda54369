#include "runtime/acr1000/loop_watch.h"

namespace pmac::acr1000 {

bool LoopWatch::repeats(ProgramState state) {
  if (!kept_) {
    kept_ = std::move(state);
    passes_ = 0;
    keep_for_ = 1;
    return false;
  }
  if (*kept_ == state) return true;
  if (++passes_ < keep_for_) return false;
  kept_ = std::move(state);
  passes_ = 0;
  keep_for_ *= 2;
  return false;
}

}  // namespace pmac::acr1000
