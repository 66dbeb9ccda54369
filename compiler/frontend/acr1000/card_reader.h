// The lines for one card, in the order in which they are sent: stored ones build the program, the others are executed. Private to this
// folder.
#pragma once

#include <vector>

#include "compiler/frontend/acr1000/lowering.h"
#include "compiler/frontend/acr1000/renumber.h"

namespace pmac::compiler::acr1000 {

class CardReader : public ProgramStore {
 public:
  /// at_once: the lines are typed at a card that keeps its program itself; RUN, LIST and their kind are left to it.
  CardReader(source::SourceManager& sources, source::Diagnostics& diagnostics, const Settings& settings, std::int64_t card, std::string axis, bool at_once);

  /// One line, without its end and the blanks around it.
  void take(const source::Span& line);
  /// A fast move block: the bytes as hexadecimal digits.
  void take_block(const source::Span& line, const std::string& digits);
  /// Everything that was read. Adds the RUN that a program without one gets.
  ir::Unit finish();

  const std::string& axis() const { return unit_.axis; }
  std::int64_t card() const { return unit_.card; }
  const StoredLines& lines() const { return lines_; }

 private:
  void run(const source::Span& span, ir::Body& out, ir::ExprPtr first_line) override;
  void list(const source::Span& span, ir::Body& out) override;
  void erase(const source::Span& span, ir::Body& out) override;
  void renumber(const source::Span& span, ir::Body& out) override;

  void store(const source::Span& line, const ParsedLine& parsed);
  ir::Buffer snapshot();
  void lower_stored(std::int64_t number, const source::Span& line, ir::Body& body);

  source::SourceManager& sources_;
  source::Diagnostics& diagnostics_;
  const Settings& settings_;
  ir::Unit unit_;
  StoredLines lines_;
  bool at_once_ = false;
  bool changed_ = false;     // since the last snapshot
  bool was_run_ = false;     // by a command of its own
  std::size_t lowered_ = 0;  // stored lines, over all snapshots
};

}  // namespace pmac::compiler::acr1000
