#include "compiler/style/spacing.h"

#include <cctype>

namespace pmac::style {
namespace {

bool takes_blank_before_parenthesis(std::string_view keyword) {
  return keyword == "if" || keyword == "while" || keyword == "switch" || keyword == "case" || keyword == "forward" || keyword == "inverse";
}

bool takes_blank_before_number(std::string_view keyword) {
  return keyword == "case" || keyword == "prog" || keyword == "plc" || keyword == "subprog";
}

/// The letters, digits and underscores that stand together around an offset, as far as a name could reach.
std::string_view word_around(std::string_view text, std::size_t at) {
  constexpr std::size_t kLongestName = 255;
  std::size_t begin = at, end = at;
  while (begin > 0 && at - begin < kLongestName && is_name_part(text[begin - 1])) --begin;
  while (end < text.size() && end - at < kLongestName && is_name_part(text[end])) ++end;
  return text.substr(begin, end - begin);
}

/// A letter and the number behind it may touch, unless both together are a name.
bool would_be_name(const SourceText& source, const Piece& letter, const Piece& number) {
  const std::string_view digits = source.of(number);
  std::size_t end = 0;
  while (end < digits.size() && is_name_part(digits[end])) ++end;
  return source.names.contains(std::string(source.of(letter)).append(digits.substr(0, end)));
}

/// A glued word may be cut between two pieces, unless one of the parts is a name on its own.
bool cut_makes_name(const SourceText& source, const Piece& next) {
  const std::string_view whole = word_around(source.text, next.begin);
  const std::size_t cut = static_cast<std::size_t>(source.text.data() + next.begin - whole.data());
  return cut > 0 && cut < whole.size() && (source.names.contains(whole.substr(0, cut)) || source.names.contains(whole.substr(cut)));
}

bool is_word(Role role) { return role == Role::kOperand || role == Role::kKeyword || role == Role::kLetter; }
bool is_operand_end(Role role) { return role == Role::kOperand || role == Role::kClose || role == Role::kStep; }

/// Two words next to each other, in a buffer.
int blanks_between_words(const SourceText& source, const Statement& statement, const Piece& next, bool written) {
  const Piece& last = *statement.last();
  const bool is_number = next.kind == PieceKind::kNumber;
  if (last.kind == PieceKind::kRaw || next.kind == PieceKind::kRaw || source.of(last) == "." || source.of(next) == ".") return written;
  if (last.kind == PieceKind::kLetter && is_number) return written && would_be_name(source, last, next);
  if (statement.last_role() == Role::kKeyword && is_number) return written || takes_blank_before_number(statement.last_keyword());
  if (is_number && (last.kind == PieceKind::kName || statement.last_role() == Role::kClose)) return written;
  return written || !cut_makes_name(source, next);
}

int blanks_before_parenthesis(const Statement& statement, bool written) {
  switch (statement.last_role()) {
    case Role::kKeyword:
      if (takes_blank_before_parenthesis(statement.last_keyword())) return 1;
      return statement.in_buffer() ? 0 : written;
    case Role::kLetter: return statement.in_buffer() ? 0 : written;
    case Role::kOperand: return statement.last()->kind == PieceKind::kName || statement.last()->kind == PieceKind::kMember ? 0 : written;
    default: return written;
  }
}

int blanks_before_unary(const Statement& statement, bool written) {
  return is_operand_end(statement.last_role()) || statement.last_role() == Role::kKeyword ? 1 : written;
}

}  // namespace

int blanks_between(const SourceText& source, const Statement& statement, const Piece& next, Role role, bool written) {
  const Role last = statement.last_role();
  if (last == Role::kNone) return 0;
  if (next.kind == PieceKind::kRaw || statement.last()->kind == PieceKind::kRaw) {
    const bool beside_operator = last == Role::kBinary || last == Role::kAssign || last == Role::kSemicolon || role == Role::kBinary || role == Role::kAssign;
    return beside_operator ? 1 : written;
  }
  if (role == Role::kSemicolon || role == Role::kClose) return 0;
  if (last == Role::kOpen || last == Role::kOpenBracket) return 0;
  if (role == Role::kComma) return 0;
  if (last == Role::kSemicolon) return 1;
  if (role == Role::kCloseBrace && (last == Role::kOpenBrace || last == Role::kCloseBrace)) return written;
  if (role == Role::kOpenBrace || role == Role::kCloseBrace || last == Role::kOpenBrace || last == Role::kCloseBrace) return 1;
  if (role == Role::kArrow || last == Role::kArrow) return 0;
  if (role == Role::kStep || role == Role::kLabelColon) return 0;
  if (last == Role::kComma || last == Role::kLabelColon) return 1;
  if (role == Role::kAssign || role == Role::kBinary || last == Role::kAssign || last == Role::kBinary) return 1;
  if (role == Role::kUnary) return blanks_before_unary(statement, written);
  if (last == Role::kUnary) return is_word(role) || role == Role::kOpen ? 0 : written;
  if (role == Role::kLetterSign) return 0;
  if (last == Role::kLetterSign) return next.kind == PieceKind::kNumber ? 0 : written;
  if (role == Role::kAsWritten || last == Role::kAsWritten) return written;
  if (role == Role::kOpen) return blanks_before_parenthesis(statement, written);
  if (role == Role::kOpenBracket) return 0;
  if (!statement.in_buffer() && !statement.is_expression()) return written;
  return statement.in_buffer() ? blanks_between_words(source, statement, next, written) : written;
}

}  // namespace pmac::style
