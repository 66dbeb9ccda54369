// The blocks and conditions of Turbo PMAC: IF (a = 1) AND (b = 2) ... ELSE ... ENDIF, WHILE ... ENDWHILE.
// Private to this folder: shows the parser generator's types.
#pragma once

#include <optional>
#include <vector>

#include "compiler/frontend/power_pmac/token_list.h"

namespace pmac::compiler::power_pmac {

class TurboBlocks {
 public:
  TurboBlocks(TokenList& tokens, const DeclaredNames& names) : tokens_(tokens), names_(names) {}

  /// Looks at the next token of the list.
  void take(std::size_t i);

 private:
  /// A condition that waits for its ENDIF or ENDWHILE; begin == kNone: a { of Power PMAC, which nothing reaches over.
  struct Header { bool is_loop = false; std::size_t begin = TokenList::kNone, last = 0; std::vector<std::size_t> elses; };

  void take_buffer_begin(std::size_t i);
  void take_header(std::size_t i);
  std::size_t take_condition(std::size_t left, std::size_t right);
  std::size_t join_conditions(std::size_t left, std::size_t right);
  void take_logic_word(std::size_t i, source::Diagnostic** error);
  void take_else(std::size_t i);
  void close_before_else(const Header& header, std::size_t i);
  void take_end(std::size_t i, std::size_t last, bool is_loop);
  bool is_split_end(std::size_t i) const;
  void leave_braces();
  void end_single_lines(std::size_t i);
  bool is_word(std::size_t i, std::initializer_list<const char*> words) const;

  TokenList& tokens_;
  const DeclaredNames& names_;
  std::vector<Header> open_;
  std::size_t conditions_end_ = 0;  // conditions up to this token have been read
  bool has_ends_ = false;  // the buffer has ENDIF or ENDWHILE, so its conditions may be theirs
};

}  // namespace pmac::compiler::power_pmac
