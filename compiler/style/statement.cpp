#include "compiler/style/statement.h"

#include <algorithm>
#include <array>
#include <set>

namespace pmac::style {
namespace {

template <std::size_t N>
bool is_one_of(std::string_view text, const std::array<std::string_view, N>& texts) {
  return std::find(texts.begin(), texts.end(), text) != texts.end();
}

bool is_assignment(std::string_view text) {
  static constexpr std::array<std::string_view, 18> kTexts{"=",  "+=",  "-=",  "*=",  "/=",  "%=",  "&=",  "|=",  "^=",
                                                           ">>=", "<<=", "+==", "-==", "*==", "/==", "&==", "|==", "^=="};
  return is_one_of(text, kTexts);
}

bool is_operator(std::string_view text) {
  static constexpr std::array<std::string_view, 24> kTexts{"+",  "-",  "*",  "/",  "%",  "&",  "|",  "^",  "<<", ">>", "==", "!=",
                                                           "<>", "<",  ">",  "<=", ">=", "!>", "!<", "~",  "!~", "&&", "||", "!"};
  return is_one_of(text, kTexts);
}

bool is_step(std::string_view text) { return text == "++" || text == "--" || text == "++=" || text == "--="; }

/// The word in lower case from storage that stays, so that it can be remembered by view.
std::string_view interned(std::string_view keyword) {
  static thread_local std::set<std::string, std::less<>> words;
  return *words.insert(lower_case(keyword)).first;
}

bool is_jog(std::string_view keyword) { return keyword == "jog" || keyword == "j" || keyword == "jogret"; }

bool is_declaration(std::string_view keyword) { return keyword == "global" || keyword == "csglobal" || keyword == "local" || keyword == "ptr"; }

}  // namespace

Role Statement::role_of(const Piece& word, bool blank_before, bool glued_behind) const {
  switch (word.kind) {
    case PieceKind::kKeyword: return Role::kKeyword;
    case PieceKind::kLetter: return Role::kLetter;
    case PieceKind::kSign: return role_of_sign(source_->of(word), blank_before, glued_behind);
    default: return Role::kOperand;
  }
}

Role Statement::role_of_sign(std::string_view text, bool blank_before, bool glued_behind) const {
  if (text == "(") return Role::kOpen;
  if (text == "[") return Role::kOpenBracket;
  if (text == ")" || text == "]") return Role::kClose;
  if (text == "{") return Role::kOpenBrace;
  if (text == "}") return Role::kCloseBrace;
  if (text == ",") return in_buffer_ || is_expression() || form_ == Form::kDeclaration ? Role::kComma : Role::kAsWritten;
  if (text == ";") return Role::kSemicolon;
  if (text == ":") return colon_ends_label() ? Role::kLabelColon : Role::kAsWritten;
  if (text == "->") return Role::kArrow;
  if (is_step(text)) return last_is_operand() ? Role::kStep : Role::kAsWritten;
  const bool is_jog_distance = form_ == Form::kJog && depth_ == 0;
  if (is_jog_distance) return Role::kAsWritten;
  if (is_assignment(text) || (text == "==" && !is_expression())) return last_is_operand() ? Role::kAssign : Role::kAsWritten;
  return is_operator(text) ? role_of_operator(text, blank_before, glued_behind) : Role::kAsWritten;
}

Role Statement::role_of_operator(std::string_view text, bool blank_before, bool glued_behind) const {
  if (is_expression()) {
    if (!last_is_operand()) return Role::kUnary;
    const bool may_be_command = !in_buffer_ && depth_ == 0 && blank_before && glued_behind;  // P1=5 &2 addresses a coordinate system
    return may_be_command ? Role::kAsWritten : Role::kBinary;
  }
  const bool is_sign = text == "+" || text == "-";
  return is_sign && in_buffer_ && last_role_ == Role::kLetter ? Role::kLetterSign : Role::kAsWritten;
}

bool Statement::colon_ends_label() const {
  if (depth_ > 0) return false;
  if (form_ == Form::kCase) return true;
  if (last_keyword_ == "default" || last_keyword_ == "sub") return true;
  const bool behind_number = last_role_ == Role::kOperand && last_.kind == PieceKind::kNumber && before_last_.kind == PieceKind::kLetter;
  return in_buffer_ && behind_number && lower_case(source_->of(before_last_)) == "n";
}

void Statement::take_keyword(std::string_view word) {
  if (word == "open") in_buffer_ = true, depth_ = 0;
  if (word == "close") in_buffer_ = source_->in_buffer, depth_ = 0;
  const bool is_function = word == "abs" && is_expression() && !last_is_operand();
  if (is_function || depth_ > 0) return;
  form_ = is_jog(word) ? Form::kJog : word == "case" ? Form::kCase : is_declaration(word) ? Form::kDeclaration : Form::kOther;
}

void Statement::take(const Piece& word, Role role) {
  std::string_view keyword;
  switch (role) {
    case Role::kKeyword:
      keyword = interned(source_->of(word));
      take_keyword(keyword);
      break;
    case Role::kOperand: case Role::kLetter: {
      const bool begins_statement = depth_ == 0 && (last_is_operand() || (form_ == Form::kJog && word.kind != PieceKind::kNumber));
      if (begins_statement) form_ = Form::kOther;
      break;
    }
    case Role::kOpen: case Role::kOpenBracket: ++depth_; break;
    case Role::kClose: depth_ = std::max(0, depth_ - 1); break;
    case Role::kSemicolon: case Role::kOpenBrace: case Role::kCloseBrace: case Role::kLabelColon:
      form_ = Form::kOther;
      depth_ = 0;
      break;
    case Role::kAssign: if (depth_ == 0) form_ = Form::kExpression; break;
    default: break;
  }
  before_last_ = last_;
  last_ = word;
  last_role_ = role;
  last_keyword_ = keyword;
}

void Statement::end_line() {
  if (!continues()) reset();
}

void Statement::reset() {
  form_ = Form::kOther;
  depth_ = 0;
  last_role_ = Role::kNone;
  last_keyword_ = {};
}

}  // namespace pmac::style
