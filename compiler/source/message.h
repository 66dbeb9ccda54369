// The table of all messages of the compiler: message.def.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pmac::source {

/// When a message is given: always, or a warning that is on by default, with -Wall, or with -Wextra.
enum class MessageLevel : std::uint8_t { kError, kDefault, kAll, kExtra };

struct MessageInfo {
  std::string_view code;         // PM2011
  MessageLevel level;
  std::string_view group;        // name of the warning for -Wname, empty for errors
  std::string_view title;
  std::string_view explanation;
  std::string_view wrong, right; // examples, may be empty
};

/// All rows, ordered by code.
std::span<const MessageInfo> message_table();

/// The row of a code, or null.
const MessageInfo* find_message(std::string_view code);

/// Names of the warning groups, each once, in order of their first code.
const std::vector<std::string_view>& warning_groups();
bool is_warning_group(std::string_view name);

/// A few sentences with a wrong and a right example, of a code (in either case) or of every message of a warning group; empty where there is none.
std::string explain(std::string_view code_or_group);

/// The known code nearest to a mistyped one, or empty.
std::string_view nearest_code(std::string_view code);

/// One line for each warning: name, when it is on, what it is about.
std::string list_warnings();

/// The whole table as the page docs/messages.md.
std::string messages_page();

}  // namespace pmac::source
