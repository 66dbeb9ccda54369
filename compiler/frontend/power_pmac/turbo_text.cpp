#include "compiler/frontend/power_pmac/turbo_text.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include "compiler/frontend/power_pmac/frontend.h"
#include "compiler/frontend/power_pmac/word_lexer.h"

namespace pmac::compiler::power_pmac {
namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_word_part(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string_view trimmed(std::string_view line) {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  return line;
}

std::string lower_word(std::string_view text) {
  std::string word;
  for (const char c : text) {
    if (!is_word_part(c)) break;
    word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return word;
}

bool begins_with_end_word(std::string_view line) {
  const std::string word = lower_word(line);
  return word == "endif" || word == "endi" || word == "endwhile" || word == "endw";
}

/// M100->X:$078000
bool defines_memory_pointer(std::string_view line) {
  if (line.empty() || std::tolower(static_cast<unsigned char>(line[0])) != 'm') return false;
  const std::size_t arrow = line.find("->");
  if (arrow > 20) return false;   // or none
  const std::string_view target = trimmed(line.substr(arrow + 2));
  const std::string memory = lower_word(target);
  return memory.size() <= 3 && target.size() > memory.size() && target[memory.size()] == ':' && memory != "u" && memory != "s";
}

bool is_comment_line(std::string_view line) {
  if (!line.starts_with(';')) return false;
  const std::string_view rest = trimmed(line.substr(std::min(line.find_first_not_of(';'), line.size())));
  const std::string word = lower_word(rest);
  return word.size() > 1 && std::all_of(word.begin(), word.end(), is_letter);
}

bool is_keyword(const std::string& word) {
  const auto& names = keyword_names();
  return std::binary_search(names.begin(), names.end(), std::string_view(word));
}

/// False for most lines of most files: none of the three kinds of lines begins like that.
bool may_tell(std::string_view line) { return !line.empty() && std::string_view("eEmM;").find(line.front()) != std::string_view::npos; }

}  // namespace

bool is_turbo_text(std::string_view text) {
  int comments = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = trimmed(text.substr(at, end - at));
    at = end + 1;
    if (!may_tell(line)) continue;
    if (begins_with_end_word(line) || defines_memory_pointer(line)) return true;
    if (is_comment_line(line) && ++comments >= 2) return true;
  }
  return false;
}

bool reads_as_prose(std::string_view rest_of_line) {
  int strange = 0;
  std::string_view rest = trimmed(rest_of_line);
  while (!rest.empty() && is_letter(rest.front())) {
    const std::string word = lower_word(rest);
    const bool is_plain = word.size() > 1 && std::all_of(word.begin(), word.end(), is_letter);
    rest.remove_prefix(word.size());
    const bool goes_on = rest.empty() || is_blank(rest.front()) || rest.front() == '\r' || rest.front() == ',' || (rest.front() == '.' && (rest.size() == 1 || !is_letter(rest[1])));
    if (!is_plain || !goes_on) return false;
    strange = is_keyword(word) ? 0 : strange + 1;
    if (!rest.empty() && (rest.front() == ',' || rest.front() == '.')) rest.remove_prefix(1);
    rest = trimmed(rest);
    if (rest.starts_with('=') || rest.starts_with('(') || rest.starts_with("->") || rest.starts_with('[')) return false;
    if (strange >= 2) return true;
  }
  return false;
}

}  // namespace pmac::compiler::power_pmac
