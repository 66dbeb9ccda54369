// What lines mean, told to the parser by tokens. The lexer's tokens go through this pass once:
//   - JOIN is put between the words of one motion line (ta25 F200 X5 Y6), so that a word on the next line begins a statement;
//   - every word behind a code letter or call on its line becomes LINE_WORD (G83 X1 P2, call 500 X1 Y2), so do F, P, Q and L behind axis words;
//   - LINE_END is put behind a line with cexec, cskip or cx, which act on the rest of their line;
//   - C, I and R become AXIS, VECTOR and RADIUS where they are words of a move and not variables, M and D become CODE likewise;
//     what they are shows by the assignment operator behind their number;
//   - the words of normal and pset get types of their own, so does the letter of ->*i.16;
//   - & between operands becomes BIT_AND; elsewhere it addresses a coordinate system or a variable;
//   - an else that an if follows becomes ELSE_IF;
//   - a misspelt if, while or switch in front of ( ... ) { becomes that, and is refused by name later;
//   - an operator that begins a line, outside parentheses and not after another operator, is no binary operator: & addresses a
//     coordinate system, < > % are commands, everything else cannot stand there; nor can a parenthesis, except behind if and its kind.
#include <algorithm>
#include <cctype>

#include "compiler/frontend/power_pmac/syntax_tree.h"
#include "compiler/source/source.h"

namespace pmac::compiler::power_pmac {
namespace {

using T = grammar::PowerPmacParser;
using Tokens = std::vector<std::unique_ptr<antlr4::Token>>;

bool is_motion_keyword(std::size_t type) {
  switch (type) {
    case T::LINEAR: case T::RAPID: case T::CIRCLE: case T::PVT: case T::SPLINE: case T::TSEL: case T::CCR: case T::CCMODE: case T::TA: case T::TD: case T::TS:
    case T::TSD: case T::TM: case T::LETTER_F: case T::ABS: case T::INC: case T::FRAX: case T::FRAX2: case T::NOFRAX: case T::NOFRAX2: case T::NORMAL: return true;
    default: return false;
  }
}

bool is_assignment(std::size_t type) { return type >= T::ASSIGN && type <= T::SYNC_DECREMENT; }
bool is_step(std::size_t type) { return type >= T::INCREMENT && type <= T::SYNC_DECREMENT; }

class TokenPass {
 public:
  explicit TokenPass(antlr4::TokenSource& lexer) : lexer_(lexer) {
    for (std::unique_ptr<antlr4::Token> token = lexer.nextToken();; token = lexer.nextToken()) {
      const bool last = token->getType() == antlr4::Token::EOF;
      in_.push_back(std::move(token));
      if (last) return;
    }
  }

  Tokens run() {
    out_.reserve(in_.size() + in_.size() / 4);
    for (at_ = 0; at_ < in_.size(); ++at_) {
      take();
      operand_wanted_ = wants_operand(in_type_);
      before_ = in_type_;
      before_line_ = in_[at_]->getLine();
      last_stop_ = in_[at_]->getStopIndex();
      out_.push_back(std::move(in_[at_]));
    }
    return std::move(out_);
  }

 private:
  enum class Group { kNone, kMotion, kNormal, kMove, kPset, kCall, kCode };

  void take() {
    const std::size_t type = in_type_ = in_[at_]->getType();
    const bool new_line = in_[at_]->getLine() != before_line_;
    end_line(type, new_line);
    if (is_self_format(new_line)) set_type(T::SELF_FORMAT);
    if (type == T::ELSE && at_ + 1 < in_.size() && in_[at_ + 1]->getType() == T::IF) set_type(T::ELSE_IF);
    if (type == T::NAME && in_buffer_ && depth_ == 0 && !operand_wanted_) mend_control_word();
    if (type == T::OPEN) in_buffer_ = true;
    if (type == T::CLOSE) in_buffer_ = false;
    if (at_once_line_ != 0 && in_[at_]->getLine() != at_once_line_) in_buffer_ = false, at_once_line_ = 0;
    if (type == T::CX && !in_buffer_) in_buffer_ = true, at_once_line_ = in_[at_]->getLine();
    if (type == T::LEFT_BRACE) ++braces_;
    if (type == T::RIGHT_BRACE) --braces_;
    if (type == T::OPEN || type == T::CLOSE) braces_ = 0;
    if (type == T::SEMICOLON || type == T::LEFT_BRACE || type == T::RIGHT_BRACE || type == T::OPEN || type == T::CLOSE) depth_ = 0;
    if (new_line && depth_ == 0) group_ = Group::kNone;
    if ((new_line && !operand_wanted_) || type == T::SEMICOLON) expression_open_ = false;
    if (depth_ == 0) take_outside(type, new_line);
    if (in_[at_]->getType() == T::AMPERSAND && !operand_wanted_ && (in_buffer_ || depth_ > 0 || expression_open_)) set_type(T::BIT_AND);
    if (depth_ == 0 && is_assignment(type) && !is_step(type) && before_ != T::ON_J && before_ != T::JOG) expression_open_ = true;
    const bool is_other = in_[at_]->getType() == T::OTHER;
    if (!is_other && (type == T::LEFT || type == T::LEFT_BRACKET)) ++depth_;
    if ((type == T::RIGHT || type == T::RIGHT_BRACKET) && depth_ > 0) --depth_;
  }

  /// whiel (P1 < 5) {: nothing but a control statement goes on with a block.
  void mend_control_word() {
    std::size_t next = at_ + 1;
    const auto type = [&](std::size_t i) { return i < in_.size() ? in_[i]->getType() : antlr4::Token::EOF; };
    if (type(next) != T::LEFT) return;
    int depth = 0;
    do {
      depth += type(next) == T::LEFT ? 1 : type(next) == T::RIGHT ? -1 : 0;
      ++next;
    } while (next <= in_.size() && depth > 0 && ends_not(type(next)));
    if (depth != 0 || type(next) != T::LEFT_BRACE) return;
    std::string word = in_[at_]->getText();
    std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const std::string_view near = source::nearest_word(word, {"if", "while", "switch"});
    if (!near.empty()) set_type(near == "if" ? T::IF : near == "while" ? T::WHILE : T::SWITCH);
  }

  /// The i of ->*i.16, glued to the *.
  bool is_self_format(bool new_line) const {
    const bool behind_self = before_ == T::STAR && out_.size() >= 2 && out_[out_.size() - 2]->getType() == T::ARROW;
    if (!behind_self || new_line || last_stop_ + 1 != in_[at_]->getStartIndex()) return false;
    const std::string text = in_[at_]->getText();
    return text.size() == 1 && std::string_view("usifdUSIFD").find(text[0]) != std::string_view::npos;
  }

  /// Puts LINE_END where the line of a cexec, cskip or cx ends: at the line's end, outside of braces that it has opened.
  void end_line(std::size_t type, bool new_line) {
    if (open_lines_ == 0) return;
    const bool line_ends = new_line && depth_ == 0 && !operand_wanted_ && braces_ <= line_braces_;
    const bool block_ends = type == T::RIGHT_BRACE && braces_ <= line_braces_;
    if (!line_ends && !block_ends && type != T::CLOSE && type != T::OPEN && type != antlr4::Token::EOF) return;
    for (; open_lines_ > 0; --open_lines_) {
      auto end = std::make_unique<antlr4::CommonToken>(out_.back().get());
      end->setType(T::LINE_END);
      out_.push_back(std::move(end));
    }
  }

  void take_outside(std::size_t type, bool new_line) {
    const bool behind_operator = operand_wanted_;
    if (new_line && !behind_operator && is_binary_operator(type)) return set_type(type_at_line_start(type));
    const bool condition_follows = before_ == T::IF || before_ == T::WHILE || before_ == T::SWITCH;
    if (new_line && in_buffer_ && type == T::LEFT && !behind_operator && !condition_follows) return set_type(T::OTHER);
    if (!in_buffer_ && type == T::AMPERSAND && addresses_coord()) return set_type(T::COORD);
    const bool is_command = !in_buffer_ && !expression_open_ && before_ != T::LH && (type == percent() || type == less() || type == greater());
    if (is_command) return set_type(type_at_line_start(type));
    if (!in_buffer_ || behind_operator) return;
    if (begins_line_word(type)) return take_line_word();
    if (is_move_word(type)) return take_move_word(type);
    if (is_motion_keyword(type)) return take_motion_keyword(type);
    const bool is_code = type == T::CODE || ((type == T::LETTER_M || type == T::LETTER_D) && !assignment_follows());
    if (is_code) set_type(T::CODE);
    if (type == T::CEXEC || type == T::CSKIP || type == T::CX) begin_marked_line();
    group_ = group_behind(type, is_code);
  }

  Group group_behind(std::size_t type, bool is_code) const {
    if (is_code) return Group::kCode;
    if (type == T::PSET) return Group::kPset;
    if (type == T::CALL || type == T::GOSUB || type == T::CALLSUB || type == T::CCALL || type == T::CDEF) return Group::kCall;
    const bool names_call = group_ == Group::kCall && (type == T::NAME || type == T::DOT || type == T::MEMBER);
    return names_call || is_part_of_word(type) ? group_ : Group::kNone;
  }

  void begin_marked_line() {
    if (open_lines_ == 0) line_braces_ = braces_;
    ++open_lines_;
  }

  static bool is_letter(std::size_t type) {
    switch (type) {
      case T::AXIS: case T::VECTOR: case T::VAR: case T::CODE: case T::LETTER: case T::LETTER_C: case T::LETTER_D: case T::LETTER_F: case T::LETTER_I:
      case T::LETTER_M: case T::LETTER_R: return true;
      default: return false;
    }
  }

  /// A letter with its number behind a code letter or a call, or one that is no axis behind axis words.
  bool begins_line_word(std::size_t type) const {
    if (!is_letter(type) || is_letter(before_)) return false;
    const bool in_line = group_ == Group::kCode || group_ == Group::kCall;
    const bool for_cycle = group_ == Group::kMove && (type == T::VAR || type == T::LETTER || type == T::LETTER_F);
    if ((!in_line && !for_cycle) || at_ + 1 >= in_.size()) return false;
    const std::size_t next = in_[at_ + 1]->getType();
    const bool value_follows = next == T::NUMBER || next == T::LEFT || next == T::PLUS || next == T::MINUS;
    return value_follows && !assignment_follows();
  }

  void take_line_word() {
    set_type(T::LINE_WORD);
    put_join();
    group_ = Group::kCode;
  }

  /// On line, `P1=5 &2` addresses a coordinate system; `P1=5&2` and `P1=5 & 2` are a bitwise and.
  bool addresses_coord() const {
    if (at_ == 0 || at_ + 1 >= in_.size()) return false;
    const bool blank_before = last_stop_ + 1 < in_[at_]->getStartIndex();
    const bool glued_behind = in_[at_]->getStopIndex() + 1 == in_[at_ + 1]->getStartIndex();
    const std::size_t next = in_[at_ + 1]->getType();
    return blank_before && glued_behind && (next == T::NUMBER || next == T::STAR);
  }

  void take_move_word(std::size_t type) {
    std::size_t kind = type;
    if (type == T::LETTER_C) kind = T::AXIS;
    if (type == T::LETTER_I) kind = T::VECTOR;
    if (type == T::LETTER_R) kind = T::RADIUS;
    if (group_ == Group::kNormal && kind == T::VECTOR) return set_type(T::NORMAL_VECTOR);
    if (group_ == Group::kPset && kind == T::AXIS) return set_type(T::PSET_AXIS);
    set_type(kind);
    if (group_ == Group::kMotion || group_ == Group::kNormal || group_ == Group::kMove) put_join();
    group_ = Group::kMove;
  }

  void take_motion_keyword(std::size_t type) {
    if (group_ == Group::kMotion || group_ == Group::kNormal) put_join();
    group_ = type == T::NORMAL ? Group::kNormal : Group::kMotion;
  }

  bool is_move_word(std::size_t type) const {
    if (type == T::AXIS || type == T::VECTOR) return true;
    return (type == T::LETTER_C || type == T::LETTER_I || type == T::LETTER_R) && !assignment_follows();
  }

  /// What stands inside a word: its number, sign, parentheses, and the : and ^ of a second number.
  bool is_part_of_word(std::size_t type) const {
    if (type == T::COLON) return group_ == Group::kMove || group_ == Group::kCode;
    return type == T::NUMBER || type == T::PLUS || type == T::MINUS || type == T::LEFT || type == T::RIGHT || type == caret();
  }

  /// The token behind `C 90` or `C(...)` assigns.
  bool assignment_follows() const {
    std::size_t next = at_ + 1;
    const auto type = [&](std::size_t i) { return i < in_.size() ? in_[i]->getType() : antlr4::Token::EOF; };
    if (type(next) == T::NUMBER) {
      ++next;
    } else if (type(next) == T::LEFT) {
      int depth = 0;
      do {
        depth += type(next) == T::LEFT ? 1 : type(next) == T::RIGHT ? -1 : 0;
        ++next;
      } while (next <= in_.size() && depth > 0 && ends_not(type(next)));
    } else {
      return false;
    }
    return is_assignment(type(next));
  }
  static bool ends_not(std::size_t type) { return type != T::SEMICOLON && type != T::LEFT_BRACE && type != T::RIGHT_BRACE && type != T::CLOSE && type != T::OPEN && type != antlr4::Token::EOF; }

  /// Numbers of the operators that have no name in the grammar.
  static std::size_t literal(std::string_view text) {
    static const T parser(nullptr);
    const auto& vocabulary = const_cast<T&>(parser).getVocabulary();
    for (std::size_t type = 1; type < T::SEMICOLON; ++type)
      if (vocabulary.getLiteralName(type) == "'" + std::string(text) + "'") return type;
    return antlr4::Token::INVALID_TYPE;
  }
  static std::size_t caret() { static const std::size_t type = literal("^"); return type; }
  static std::size_t percent() { static const std::size_t type = literal("%"); return type; }
  static std::size_t less() { static const std::size_t type = literal("<"); return type; }
  static std::size_t greater() { static const std::size_t type = literal(">"); return type; }
  static bool is_one_of(std::size_t type, const std::vector<std::string_view>& texts) {
    for (const std::string_view text : texts)
      if (literal(text) == type) return true;
    return false;
  }
  static std::vector<bool> make_binary() {
    std::vector<bool> is_binary(T::SEMICOLON, false);
    for (std::size_t type = 1; type < T::SEMICOLON; ++type)
      is_binary[type] = is_one_of(type, {"/", "%", "|", "^", "<<", ">>", "!=", "<>", "<", ">", "<=", ">=", "!>", "!<", "~", "!~", "&&", "||"});
    return is_binary;
  }
  static bool is_binary_operator(std::size_t type) {
    static const std::vector<bool> is_binary = make_binary();
    return type == T::PLUS || type == T::MINUS || type == T::STAR || type == T::AMPERSAND || (type < T::SEMICOLON && is_binary[type]);
  }
  /// Behind this token an operand must follow, so that a letter is a variable and a line end means nothing.
  static bool is_operand_wanted(std::size_t type) {
    static const std::size_t negation = literal("!");
    return is_binary_operator(type) || (is_assignment(type) && !is_step(type)) || type == T::COMMA || type == T::LEFT || type == T::LEFT_BRACKET || type == negation;
  }

  /// Behind the token at hand an operand must follow. The signs of jog+ and lh<, and the * that stands for a position, are none.
  bool wants_operand(std::size_t type) const {
    if (before_ == T::JOG || before_ == T::ON_J) return is_assignment(type) || type == T::LEFT;
    if (before_ == T::LH) return false;
    if (type == T::STAR) return before_ == T::NUMBER || before_ == T::NAME || before_ == T::MEMBER || before_ == T::RIGHT || before_ == T::RIGHT_BRACKET;
    return is_operand_wanted(type);
  }

  std::size_t type_at_line_start(std::size_t type) const {
    if (in_buffer_) return T::OTHER;
    if (type == T::AMPERSAND) return T::COORD;
    if (type == percent()) return T::LINE_PERCENT;
    return type == less() || type == greater() ? T::COMMAND : T::OTHER;
  }

  void set_type(std::size_t type) { static_cast<antlr4::CommonToken*>(in_[at_].get())->setType(type); }

  /// An empty token of type JOIN before the one at hand.
  void put_join() {
    auto join = std::make_unique<antlr4::CommonToken>(in_[at_].get());
    join->setType(T::JOIN);
    out_.push_back(std::move(join));
  }

  antlr4::TokenSource& lexer_;
  Tokens in_, out_;
  std::size_t at_ = 0;
  std::size_t in_type_ = 0;      // type that the lexer gave to the token at hand
  std::size_t before_ = T::SEMICOLON;
  std::size_t before_line_ = 0;
  std::size_t last_stop_ = 0;    // last character of the token before
  int depth_ = 0;
  bool operand_wanted_ = false;
  bool in_buffer_ = false;
  bool expression_open_ = false; // on line: behind the = of an assignment
  std::size_t at_once_line_ = 0; // line of a cx, whose rest is read as in a buffer
  int braces_ = 0;               // open blocks
  int open_lines_ = 0;           // cexec and cskip of the line at hand
  int line_braces_ = 0;          // open blocks where the first of them stands
  Group group_ = Group::kNone;
};

}  // namespace

std::unique_ptr<antlr4::TokenSource> run_token_pass(antlr4::TokenSource& lexer) { return std::make_unique<antlr4::ListTokenSource>(TokenPass(lexer).run()); }

}  // namespace pmac::compiler::power_pmac
