#include "runtime/interruption.h"

namespace pmac::runtime {
namespace {

thread_local const std::function<bool()>* t_wanted = nullptr;

}  // namespace

InterruptionScope::InterruptionScope(const std::function<bool()>& wanted) : before_(t_wanted) { t_wanted = wanted ? &wanted : nullptr; }
InterruptionScope::~InterruptionScope() { t_wanted = before_; }

bool interruption_wanted() { return t_wanted && (*t_wanted)(); }

void poll_interruption() {
  if (interruption_wanted()) throw Interrupted{};
}

}  // namespace pmac::runtime
