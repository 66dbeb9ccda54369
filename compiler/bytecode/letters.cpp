#include "compiler/bytecode/letters.h"

#include <cctype>

namespace pmac::bytecode {

int letter_number(std::string_view name) {
  if (name.empty() || name.size() > 2 || (name.size() == 2 && std::tolower(name[0]) != std::tolower(name[1]))) return 0;
  const int first = std::toupper(static_cast<unsigned char>(name[0]));
  if (first < 'A' || first > 'Z') return 0;
  return first - 'A' + (name.size() == 2 ? 27 : 1);
}

std::string letter_name(int number) {
  if (number < 1 || number > kLetterCount) return "?";
  const char letter = static_cast<char>('A' + (number - 1) % 26);
  return std::string(number > 26 ? 2u : 1u, letter);
}

bool is_code_letter(int number) {
  if (number < 1 || number > 26) return false;
  return std::string_view("DFGHMST").find(static_cast<char>('A' + number - 1)) != std::string_view::npos;
}

}  // namespace pmac::bytecode
