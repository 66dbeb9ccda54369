// The compiler's lexer for others than the parser: one word after the other, without the parser generator's types. The
// formatter reads with it, so that both cut glued words such as ta500ts0 or X1.5Y4 in the same way.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <string_view>

namespace pmac::compiler::power_pmac {

enum class WordKind : std::uint8_t {
  kKeyword,  // also the letters of on-line commands
  kLetter,   // axis, variable, vector or code letter
  kName,     // declared, or not known to the lexer: functions, structures
  kMember,   // behind a dot
  kNumber,
  kString,
  kPointer,  // u.io:$A0000C.12.1
  kSign      // operators, brackets, and bytes that no word begins with
};

struct Word {
  std::uint32_t begin = 0, end = 0;  // bytes of the text
  std::uint16_t type = 0;            // of the grammar; equal types are equal to the parser
  WordKind kind = WordKind::kSign;
};

class WordReader {
 public:
  using Names = std::set<std::string, std::less<>>;

  /// text: without comments and directives (blanks in their place). names: those that are one word from the first line on.
  /// in_buffer: the text stands inside open ... close.
  WordReader(std::string_view text, const Names& names, bool in_buffer);
  ~WordReader();
  WordReader(WordReader&&) noexcept;

  /// False at the end of the text.
  bool next(Word& word);
  /// Names that the text has declared so far, those of buffers included.
  const Names& declared() const;
  /// Names that are known outside of buffers: those given, and the global ones of the text.
  const Names& shared() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pmac::compiler::power_pmac
