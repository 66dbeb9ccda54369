// Encodings of the files that come in.
#pragma once

#include <string>

namespace pmac::source {

/// UTF-16 of either byte order (known by its byte-order mark) as UTF-8 with a byte-order mark; anything else unchanged: UTF-8
/// and Latin-1 differ only in comments and texts, which are passed on byte by byte. Halves of surrogate pairs become U+FFFD.
std::string decode_text(std::string bytes);

}  // namespace pmac::source
