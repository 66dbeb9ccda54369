// The lines of a span with its characters marked, for people to read.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "compiler/source/source.h"

namespace pmac::source {

/// The source line with ^~~~ below the span, each indented by four blanks. Tabs are blanks up to columns of 4; long lines are cut
/// around the mark; of a span over several lines the first and the last ones are shown. paint: colours the mark.
std::string snippet(const SourceManager& sources, const Span& span, const std::function<std::string(std::string_view)>& paint);

}  // namespace pmac::source
