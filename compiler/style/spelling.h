// Letter case: keywords, functions and on-line letters small, axis, variable and code letters capital, elements as in element.def.
// Words that are declared or defined anywhere keep theirs: such names differ by case.
#pragma once

#include <map>
#include <string>

#include "compiler/style/source_text.h"

namespace pmac::style {

class Spelling {
 public:
  explicit Spelling(const SourceText& source) : source_(source) {}

  /// Appends the word at an index of the pieces. To be called for the words of a text in order.
  void append(std::size_t index, std::string& out);

 private:
  std::string spelt(std::size_t index);
  void read_element(std::size_t index);
  bool is_function_call(std::size_t index) const;
  bool is_free(const Piece& piece, const std::string& spelling) const;
  bool touches_raw(std::size_t index) const;

  const SourceText& source_;
  std::map<std::size_t, std::string> element_words_;  // spelling of the words of the element at hand
};

}  // namespace pmac::style
