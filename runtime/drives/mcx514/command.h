// The command codes of the chip: one table, command.def.
#pragma once

#include <cstdint>
#include <string_view>

namespace pmac::drives::mcx514 {

enum class CommandKind : std::uint8_t {
  kSetting, kCommonSetting, kStored, kRead, kCommonRead, kAxisDrive, kInterpolation, kAxisAction, kCommonAction, kNotSimulated
};

namespace code {
enum Code : std::uint8_t {
#define COMMAND(value, name, kind, bytes, least, most, meaning) k##name = value,
#include "runtime/drives/mcx514/command.def"
#undef COMMAND
};
}  // namespace code

struct Command {
  std::uint8_t code;
  std::string_view name;
  CommandKind kind;
  int data_bytes;            // 4: WR7 and WR6, 2: WR6, 0: none
  std::int64_t least, most;  // of the data
  std::string_view meaning;
};

/// nullptr: there is no such code. Synchronous actions (81h to 88h, 91h to 98h, A1h to A8h) are known as not simulated.
const Command* find_command(std::uint8_t code);

}  // namespace pmac::drives::mcx514
