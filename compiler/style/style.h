// The formatter of Power PMAC script: a text in, the same program in the style of docs/fmt.md out.
//
//   text -> pieces (words, comments, directives, line ends) -> lines with their level, blanks and spelling -> text
//
// It reads the text before the preprocessor, with the compiler's own lexer for the words, and never moves a word to another
// line: line ends are meaningful. What it made is read again and compared with what it read; a text that would mean anything
// else is not handed out. Files are read and written by compiler/tool.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace pmac::style {

struct Options {
  int indent = 4;               // blanks a level
  bool indent_buffers = false;  // what stands between open and close goes one level in
};

/// Words with a meaning that the text itself need not show, from the other files of its project. Their case is never changed.
struct Names {
  std::set<std::string, std::less<>> declared;
  std::map<std::string, bool, std::less<>> macros;  // name -> takes arguments
  bool contains(std::string_view name) const { return declared.contains(name) || macros.contains(name); }
};

/// Why a text is not formatted.
struct Problem {
  std::size_t offset = 0;
  std::size_t length = 0;
  std::string code;  // of the message, as everywhere in pmacc
  std::string message;
};

struct Formatted {
  std::string text;               // empty when there are problems
  std::vector<Problem> problems;
};

/// file_name: where the text comes from, so that its #include lines are found when the result is compared.
Formatted format(std::string_view text, const std::string& file_name, const Names& names, const Options& options);

/// Adds the names that a text defines and declares.
void collect_names(std::string_view text, Names& names);

/// Files that the text includes, as written.
std::vector<std::string> included_files(std::string_view text);

/// The change as a unified diff, or empty. Both are texts of the same file: after is before with lines changed or blank lines left out.
std::string unified_diff(const std::string& file_name, std::string_view before, std::string_view after);

}  // namespace pmac::style
