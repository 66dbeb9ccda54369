// Set-up values that make no sense: what the simulation makes of them is said when they are set.
#pragma once

#include <string>

#include "runtime/element_store.h"

namespace pmac::runtime {

/// What is wrong with the value of a set-up element and what happens with it, as a warning; empty where it makes sense.
std::string why_nonsense(const ElementAddress& element, double value);

}  // namespace pmac::runtime
