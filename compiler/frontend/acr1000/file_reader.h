// Cuts files into lines and gives each to its card: AXIS sections, one file an axis, or columns side by side. Private to this folder.
#pragma once

#include <deque>
#include <functional>
#include <map>

#include "compiler/frontend/acr1000/card_reader.h"
#include "compiler/frontend/acr1000/frontend.h"

namespace pmac::compiler::acr1000 {

/// The lines of a text, without their ends (CR, LF or both) and the blanks around them, in order; empty ones are left out.
void for_each_line(const source::SourceManager& sources, std::int32_t file, const std::function<void(const source::Span&)>& act);

class FileReader {
 public:
  FileReader(source::SourceManager& sources, source::Diagnostics& diagnostics, Settings& settings) : sources_(sources), diagnostics_(diagnostics), settings_(settings) {}

  void read(const File& file);
  System finish();

 private:
  struct Card { CardReader reader; CardSettings settings; };

  void line(const source::Span& line);
  void card_line(const source::Span& line);
  void system_line(const source::Span& line);
  void axis_line(const source::Span& line);
  void block_line(const source::Span& line);
  bool header_line(const source::Span& line);
  void columns(const source::Span& line);
  Card* card_of(const std::string& axis, const source::Span& span);
  Card* current(const source::Span& span);
  std::string free_axis() const;
  void refuse(const source::Span& span, std::string message) { diagnostics_.error("ACR-H01", span, std::move(message)); }

  source::SourceManager& sources_;
  source::Diagnostics& diagnostics_;
  Settings& settings_;
  std::deque<Card> cards_;
  Card* current_ = nullptr;        // of the file or its section
  std::vector<Card*> columns_;     // of a side by side listing
  std::string file_axis_;          // by the file's name, or empty
  bool guessed_ = false;           // the card of the file so far has no name in it
};

}  // namespace pmac::compiler::acr1000
