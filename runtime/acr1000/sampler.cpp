#include "runtime/acr1000/sampler.h"

namespace pmac::acr1000 {

void Sampler::stretch(double, double to_s) {
  while (clock_.next_s() < to_s) take();
}

void Sampler::finish(double end_s) {
  while (clock_.is_due_until(end_s)) take();
}

void Sampler::take() {
  points_.resize(system_.size());
  for (std::size_t k = 0; k < system_.size(); ++k) points_[k] = system_.card(k).at(clock_.next_s());
  taker_(clock_.next_s(), points_);
  clock_.advance();
}

}  // namespace pmac::acr1000
