#include "compiler/source/message.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "compiler/source/source.h"

namespace pmac::source {
namespace {

constexpr MessageInfo kTable[] = {
#define MESSAGE(code, level, group, title, explanation, wrong, right) {#code, MessageLevel::level, group, title, explanation, wrong, right},
#include "compiler/source/message.def"
#undef MESSAGE
};

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::string_view level_text(MessageLevel level) {
  switch (level) {
    case MessageLevel::kError: return "error";
    case MessageLevel::kDefault: return "warning";
    case MessageLevel::kAll: return "warning with -Wall";
    case MessageLevel::kExtra: return "warning with -Wextra";
  }
  return "";
}

std::string indented(std::string_view text) {
  std::string result = "    ";
  for (const char c : text) result += c == '\n' ? std::string("\n    ") : std::string(1, c);
  return result + "\n";
}

std::string examples(const MessageInfo& row) {
  std::string text;
  if (!row.wrong.empty()) text += "\nwrong:\n\n" + indented(row.wrong);
  if (!row.right.empty()) text += "\nright:\n\n" + indented(row.right);
  return text;
}

std::string option_of(const MessageInfo& row) { return row.group.empty() ? std::string() : fmt::format(", -W{}", row.group); }

std::string explanation(const MessageInfo& row) {
  return fmt::format("{}: {} ({}{})\n\n{}\n{}", row.code, row.title, level_text(row.level), option_of(row), row.explanation, examples(row));
}

}  // namespace

std::span<const MessageInfo> message_table() { return kTable; }

const MessageInfo* find_message(std::string_view code) {
  const auto* row = std::lower_bound(std::begin(kTable), std::end(kTable), code, [](const MessageInfo& a, std::string_view b) { return a.code < b; });
  return row != std::end(kTable) && row->code == code ? row : nullptr;
}

const std::vector<std::string_view>& warning_groups() {
  static const std::vector<std::string_view> groups = [] {
    std::vector<std::string_view> names;
    for (const MessageInfo& row : kTable)
      if (!row.group.empty() && std::find(names.begin(), names.end(), row.group) == names.end()) names.push_back(row.group);
    return names;
  }();
  return groups;
}

bool is_warning_group(std::string_view name) { return std::find(warning_groups().begin(), warning_groups().end(), name) != warning_groups().end(); }

std::string explain(std::string_view code_or_group) {
  if (const MessageInfo* row = find_message(upper(code_or_group))) return explanation(*row);
  std::string text;
  for (const MessageInfo& row : kTable)
    if (!code_or_group.empty() && row.group == code_or_group) text += (text.empty() ? "" : "\n") + explanation(row);
  return text;
}

std::string_view nearest_code(std::string_view code) {
  std::vector<std::string_view> codes;
  for (const MessageInfo& row : kTable) codes.push_back(row.code);
  return nearest_word(code, codes);
}

std::string list_warnings() {
  std::string text;
  for (const MessageInfo& row : kTable)
    if (!row.group.empty()) text += fmt::format("{:<22} {} {:<20} {}\n", row.group, row.code, level_text(row.level), row.title);
  return text;
}

std::string messages_page() {
  std::string page =
      "# Messages\n\n"
      "Every message of `pmacc` has a code that never changes its meaning; `pmacc --explain CODE` prints the same text as this page, which\n"
      "`pmacc --explain all` writes. Warnings are switched by their names: `-Wname`, `-Wno-name`, `-Werror=name`.\n";
  for (const MessageInfo& row : kTable) page += fmt::format("\n## {}: {}\n\n*{}{}*\n\n{}\n{}", row.code, row.title, level_text(row.level), option_of(row), row.explanation, examples(row));
  return page;
}

}  // namespace pmac::source
