// The comments of Turbo PMAC, which begin with ;. In Power PMAC a ; ends a statement, so text decides what is meant.
#pragma once

#include <string_view>

namespace pmac::compiler::power_pmac {

/// The text is a Turbo PMAC file: lines begin with ENDIF and the like or with ; and a word, or define X: and Y: pointers.
bool is_turbo_text(std::string_view text);

/// What stands behind a ; of a Power PMAC file reads as prose: two words in a row that no statement has.
bool reads_as_prose(std::string_view rest_of_line);

}  // namespace pmac::compiler::power_pmac
