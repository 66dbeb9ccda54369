// Which values of a set-up element make sense: the rows of element_range.def.
#pragma once

#include "compiler/bytecode/element.h"

namespace pmac::bytecode {

/// Both bounds included; infinite where there is none.
struct ElementRange { double least, most; };

/// The range of an element; without bounds where any value makes sense.
ElementRange element_range(ElementId id);

}  // namespace pmac::bytecode
