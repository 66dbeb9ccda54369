#include "runtime/drives/mcx514/command.h"

#include <algorithm>
#include <array>

namespace pmac::drives::mcx514 {
namespace {

constexpr Command kCommands[] = {
#define COMMAND(value, name, kind, bytes, least, most, meaning) {value, #name, CommandKind::kind, bytes, least, most, meaning},
#include "runtime/drives/mcx514/command.def"
#undef COMMAND
};

constexpr Command kSynchronousAction = {0x81, "SYNC", CommandKind::kNotSimulated, 0, 0, 0, "synchronous action"};

bool is_synchronous_action(int value) {
  const int group = value >> 4, number = value & 0xf;
  return (group == 0x8 || group == 0x9 || group == 0xa) && number >= 1 && number <= 8;
}

}  // namespace

const Command* find_command(std::uint8_t code) {
  const auto* at = std::find_if(std::begin(kCommands), std::end(kCommands), [code](const Command& c) { return c.code == code; });
  if (at != std::end(kCommands)) return at;
  return is_synchronous_action(code) ? &kSynchronousAction : nullptr;
}

}  // namespace pmac::drives::mcx514
