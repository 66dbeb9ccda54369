// The verbs of the Card instruction, made from the rows of card_verb.def.
#pragma once

#include "compiler/bytecode/bytecode.h"

namespace pmac::bytecode {

enum class CardVerb : std::uint16_t {
#define CARD_VERB(Name, text, arguments, meaning) k##Name,
#include "compiler/bytecode/card_verb.def"
#undef CARD_VERB
  kCount
};

struct CardVerbInfo { std::string_view text; int argument_count; std::string_view meaning; };
const CardVerbInfo& card_verb_info(CardVerb verb);

}  // namespace pmac::bytecode
