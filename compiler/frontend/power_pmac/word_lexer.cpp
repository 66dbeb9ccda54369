#include "compiler/frontend/power_pmac/frontend.h"
#include "compiler/frontend/power_pmac/plain_lines.h"
#include "compiler/frontend/power_pmac/plain_moves.h"
#include "compiler/frontend/power_pmac/word_lexer.h"

#include <algorithm>
#include <cctype>
#include <unordered_map>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "compiler/source/closing_marks.h"

namespace pmac::compiler::power_pmac {
namespace {

using T = grammar::PowerPmacParser;  // its token numbers
using Table = std::unordered_map<std::string, std::size_t>;

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }

const antlr4::dfa::Vocabulary& token_vocabulary() {
  static T parser(nullptr);
  return parser.getVocabulary();
}

/// The keyword tokens of the grammar stand in one run; their names are the words.
void add_keywords(Table& table, std::size_t first, std::size_t last) {
  const auto& vocabulary = token_vocabulary();
  for (std::size_t type = first; type <= last; ++type) table[lower(vocabulary.getSymbolicName(type))] = type;
}

Table make_buffer_keywords() {
  Table table;
  add_keywords(table, T::OPEN, T::WHILE);
  return table;
}

Table make_online_keywords() {
  Table table;
  add_keywords(table, T::OPEN, T::STEP);
  table.erase("local");
  for (const char* word : {"r", "s", "q", "h", "a", "k", "p", "v", "d", "f", "t", "g", "hm", "hmz", "save", "fsave", "reboot", "vers", "type", "cpu", "cid", "size",
                           "buffer", "date", "time", "free", "dir"})
    table[word] = T::COMMAND;
  for (const char* word : {"undefine", "system", "backup"}) table[word] = T::OTHER_COMMAND;
  table.insert({{"b", T::ON_B}, {"j", T::ON_J}, {"out", T::ON_OUT}, {"clear", T::CLEAR}, {"cx", T::CX}, {"define", T::DEFINE},
                {"delete", T::DELETE}, {"lookahead", T::LOOKAHEAD}, {"echo", T::ECHO}, {"list", T::LIST}});
  return table;
}

const Table& buffer_keywords() { static const Table table = make_buffer_keywords(); return table; }
const Table& online_keywords() { static const Table table = make_online_keywords(); return table; }

std::size_t find(const Table& table, std::string_view word) {
  const auto found = table.find(lower(word));
  return found == table.end() ? 0 : found->second;
}

/// Token of a letter or axis name, or 0.
std::size_t letter_type(std::string_view run) {
  const std::string word = lower(run);
  if (word.size() == 1) {
    switch (word[0]) {
      case 'p': case 'q': case 'l': return T::VAR;
      case 'c': return T::LETTER_C;
      case 'd': return T::LETTER_D;
      case 'f': return T::LETTER_F;
      case 'i': return T::LETTER_I;
      case 'm': return T::LETTER_M;
      case 'n': return T::LETTER_N;
      case 'r': return T::LETTER_R;
      case 'j': case 'k': return T::VECTOR;
      case 'g': case 't': case 's': case 'h': return T::CODE;
      default: break;
    }
  }
  if (word == "ii" || word == "jj" || word == "kk") return T::VECTOR;
  return bytecode::axis_index_from_name(word) >= 0 ? T::AXIS : 0;
}

std::size_t run_length(std::string_view word) {
  return static_cast<std::size_t>(std::find_if_not(word.begin(), word.end(), is_letter) - word.begin());
}

}  // namespace

std::string lexer_input(std::string_view text) {
  constexpr char kNoWord = '\x02';
  std::string input(text);
  source::ClosingMarks marks(text, source::ClosingMarks::LineEnd::kEndsText);
  for (std::size_t at = 0; at < input.size();) {
    const std::size_t end = input[at] == '"' ? marks.end_of(at) : at + 1;
    if (input[at] == '"' && end == at + 1) input[at] = kNoWord;
    for (; at < end; ++at)
      if (static_cast<unsigned char>(input[at]) >= 0x80) input[at] = '?';
  }
  return input;
}

WordLexer::WordLexer(antlr4::ANTLRInputStream* input, std::string_view text, DeclaredNames& names)
    : PowerPmacLexer(input), text_(text), names_(names) {
  removeErrorListeners();
}

std::unique_ptr<antlr4::Token> WordLexer::nextToken() {
  std::unique_ptr<antlr4::Token> next = PowerPmacLexer::nextToken();
  std::size_t kind = next->getType();
  line_of_word_ = next->getLine();
  if (line_is_buffered_ && next->getLine() != buffered_line_) line_is_buffered_ = false;
  if (axis_definition_ && next->getLine() != axis_line_) axis_definition_ = false;
  if (kind == T::WORD) {
    const std::size_t begin = next->getStartIndex();
    const Word word = classify(text_.substr(begin, next->getStopIndex() + 1 - begin), begin, next->getLine());
    auto* writable = dynamic_cast<antlr4::WritableToken*>(next.get());
    writable->setType(word.type);
    kind = word.type;
    if (begin + word.length <= next->getStopIndex()) {
      split_end_ = std::max(split_end_, next->getStopIndex() + 1);
      cut(*next, word.length);
    }
    if (kind == T::NAME) declare(text_.substr(begin, word.length));
    if (kind == T::NAME && last_[0] == T::PROG && last_[1] == T::OPEN) names_.programs.emplace(text_.substr(begin, word.length));
  }
  if (kind == T::NUMBER && begins_range(*next)) cut(*next, next->getStopIndex() - next->getStartIndex());
  if (kind == T::NUMBER) last_number_is_zero_ = text_.substr(next->getStartIndex(), next->getStopIndex() + 1 - next->getStartIndex()) == "0";
  follow(kind, next->getLine());
  last_end_ = next->getStopIndex() + 1;
  last_line_ = next->getLine();
  return next;
}

/// The 1. of 1..3.
bool WordLexer::begins_range(const antlr4::Token& number) const {
  const std::size_t last = number.getStopIndex();
  return last + 1 < text_.size() && last > number.getStartIndex() && text_[last] == '.' && text_[last + 1] == '.';
}

/// The token keeps `length` characters; what is behind them is read again.
void WordLexer::cut(antlr4::Token& word, std::size_t length) {
  static_cast<antlr4::CommonToken&>(word).setStopIndex(word.getStartIndex() + length - 1);
  setCharPositionInLine(word.getCharPositionInLine() + length);
  _input->seek(word.getStartIndex() + length);
  hitEOF = false;  // the token may have reached the end of the text
}

WordLexer::Word WordLexer::classify(std::string_view word, std::size_t begin, std::size_t line) {
  const Word whole_name{T::NAME, word.size()};
  const bool is_rest = begin < split_end_;
  if (last_[0] == T::DOT) return {T::MEMBER, word.size()};  // behind a dot
  const bool after_verb = last_[0] == T::CLOSE || last_[0] == T::CLEAR;
  const bool all_of_them = (after_verb && lower(word) == "all") || (last_[0] == T::ALL && lower(word) == "buffers");
  if (all_of_them && line == last_line_) return {T::ALL, word.size()};  // close all buffers, clear all buffers
  if (program_length_ > 0 && begin == program_begin_) return {T::NAME, program_length_};
  if (axis_definition_) {
    const std::size_t kind = axis_definition_type(word.substr(0, run_length(word)));
    if (kind) return {kind, run_length(word)};
    const bool stands_for_axis = last_[0] != T::AXIS && last_[0] != T::LETTER_C && last_end_ == begin;
    if (stands_for_axis) return {T::AXIS, word.size()};  // refused when it is found to be none
    axis_definition_ = false;
  }
  if (expect_name_ || (!is_rest && (names_.contains(word) || must_be_name(word, begin + word.size())))) return whole_name;
  if (const Word command = split_program_name(word, begin); command.type) return command;
  const bool buffered = in_buffer_ || (line_is_buffered_ && line == buffered_line_);
  const Table& keywords = buffered ? buffer_keywords() : online_keywords();
  const bool command_letter = !buffered && word.size() == 1;  // may be a variable: P(5)
  if (const std::size_t keyword = find(keywords, word); keyword && !command_letter) return {keyword, word.size()};
  const Word run = split(word, begin);
  return run.type ? run : whole_name;
}

/// A program name, a structure, or the left side of an assignment that looks like a command.
bool WordLexer::must_be_name(std::string_view word, std::size_t end) const {
  const std::size_t next = text_.find_first_not_of(" \t", end);
  const auto at = [&](std::size_t i) { return i < text_.size() ? text_[i] : '\0'; };
  if (last_[0] == T::CALL || (last_[0] == T::COLON && last_[1] == T::SUB)) return true;
  const bool opens_named = (last_[0] == T::PROG || last_[0] == T::PLC || last_[0] == T::SUBPROG) && (last_[1] == T::OPEN || find(buffer_keywords(), word) == 0);
  if (opens_named) return true;
  const bool has_digit = std::any_of(word.begin(), word.end(), is_digit);
  if (at(end) == '[' || (at(end) == '.' && is_letter(at(end + 1)))) return !(has_digit && split(word, end - word.size()).type);
  const bool assigned = at(next) == '=' && at(next + 1) != '=';
  const bool numbered_variable = has_digit && run_length(word) == 1;  // P1 = 5; Out3 = 1 is a name
  return !in_buffer_ && assigned && !numbered_variable && lower(word) != "j";
}

std::size_t WordLexer::axis_definition_type(std::string_view run) const {
  const std::size_t before = last_[0];
  if (before == T::NUMBER && last_[1] == T::ARROW && last_number_is_zero_) return 0;  // -> 0 is complete
  const bool expected = before == T::ARROW || before == T::NUMBER || before == T::PLUS || before == T::MINUS;
  const std::string word = lower(run);
  if (!expected) return 0;
  if (word == "i" && before == T::ARROW) return T::LETTER_I;
  if (word == "s" && before == T::ARROW) return T::CODE;
  const std::size_t kind = letter_type(run);
  return kind == T::AXIS || kind == T::LETTER_C ? kind : 0;
}

std::size_t WordLexer::online_type(std::string_view run, bool value_follows) const {
  const std::size_t letter = letter_type(run);
  const bool variable = letter == T::VAR || letter == T::LETTER_C || letter == T::LETTER_D || letter == T::LETTER_I || letter == T::LETTER_M || letter == T::LETTER_R;
  if (variable && value_follows) return letter;
  return find(online_keywords(), run);
}

std::size_t WordLexer::type_of_run(std::string_view run, bool digit_follows, std::size_t begin) const {
  const std::size_t end = begin + run.size();
  const std::size_t next = std::min(text_.find_first_not_of(" \t", end), text_.size());
  const bool value_follows = digit_follows || (next < text_.size() && text_[next] == '(');
  if (!in_buffer_ && !line_is_buffered_) return online_type(run, value_follows);
  if (const std::size_t keyword = find(buffer_keywords(), run)) return keyword;
  const bool is_plain_letter = run.size() == 1 && (lower(run) == "e" || lower(run) == "o");
  const bool is_word = is_plain_letter && code_line_ == line_of_word_ && (value_follows || (next < text_.size() && (text_[next] == '-' || text_[next] == '.')));
  if (is_word) return T::LETTER;
  return letter_type(run);
}

/// XP1: refused by the parser, with the remedy X(P1).
bool WordLexer::axis_before_variable(std::string_view run) const {
  if (!in_buffer_ || run.size() < 2) return false;
  const std::size_t axis = letter_type(run.substr(0, run.size() - 1));
  const std::size_t variable = letter_type(run.substr(run.size() - 1));
  return axis == T::AXIS && (variable == T::VAR || variable == T::LETTER_M);
}

/// Letters and digits of the exponent of a number that ends at an offset: the e5 of X1e5, the e of X1e-3.
std::size_t WordLexer::exponent_length(std::size_t at) const {
  const auto c = [&](std::size_t i) { return i < text_.size() ? text_[i] : '\0'; };
  if (c(at) != 'e' && c(at) != 'E') return 0;
  if ((c(at + 1) == '+' || c(at + 1) == '-') && is_digit(c(at + 2))) return 1;
  std::size_t end = at + 1;
  while (is_digit(c(end))) ++end;
  return end > at + 1 ? end - at : 0;
}

/// The first run of a word whose every run of letters is a keyword, a letter or an axis; kind 0 otherwise.
WordLexer::Word WordLexer::split(std::string_view word, std::size_t begin) const {
  Word first{0, 0};
  if (word.size() > kMaxWord) return first;
  for (std::size_t at = 0; at < word.size();) {
    const std::size_t length = run_length(word.substr(at));
    const bool digit_follows = at + length < word.size();
    const std::size_t kind = type_of_run(word.substr(at, length), digit_follows, begin + at);
    if (kind == 0 && digit_follows && axis_before_variable(word.substr(at, length))) {
      if (at == 0) first = {T::AXIS, length - 1};
      at += length;
      while (at < word.size() && is_digit(word[at])) ++at;
      continue;
    }
    if (kind == 0) return at == 0 && length == word.size() ? split_commands(word, begin) : Word{0, 0};
    if (at == 0) first = {kind, length};
    at += length;
    while (at < word.size() && is_digit(word[at])) ++at;
    if (digit_follows) at += exponent_length(begin + at);
  }
  return first;
}

/// &1qa: command letters glued to an address.
WordLexer::Word WordLexer::split_commands(std::string_view word, std::size_t begin) const {
  const bool glued = !in_buffer_ && (last_[0] == T::NUMBER || last_[0] == T::COMMAND || last_[0] == T::STAR) && last_end_ == begin;
  if (!glued || word.size() > 4) return {0, 0};
  const auto is_command = [](std::string_view run) { return find(online_keywords(), run) == T::COMMAND; };
  for (std::size_t at = 0; at < word.size(); ++at)
    if (!is_command(word.substr(at, 1)) && lower(word.substr(at, 1)) != "j") return {0, 0};
  return {find(online_keywords(), word.substr(0, 1)), 1};
}

/// &1bMain and startMain, with r or s behind the name too: the command, when the name of a program is glued to it.
WordLexer::Word WordLexer::split_program_name(std::string_view word, std::size_t begin) {
  if (in_buffer_ || line_is_buffered_ || names_.programs.empty()) return {0, 0};
  struct Row { std::string_view command; std::size_t type; };
  for (const Row& row : {Row{"begin", T::BEGIN}, Row{"start", T::START}, Row{"b", T::ON_B}}) {
    if (lower(word.substr(0, row.command.size())) != row.command) continue;
    const std::string_view rest = word.substr(row.command.size());
    const bool ends_in_run = rest.size() > 1 && find(online_keywords(), rest.substr(rest.size() - 1)) == T::COMMAND;
    if (names_.programs.contains(rest)) program_length_ = rest.size();
    else if (ends_in_run && names_.programs.contains(rest.substr(0, rest.size() - 1))) program_length_ = rest.size() - 1;
    else continue;
    program_begin_ = begin + row.command.size();
    return {row.type, row.command.size()};
  }
  return {0, 0};
}

void DeclaredNames::add_global(std::string_view name) {
  global.emplace(name);
  note(name);
}

void DeclaredNames::add_local(std::string_view name) {
  local.emplace(name);
  note(name);
}

void DeclaredNames::note(std::string_view name) {
  may_change_moves = may_change_moves || reads_as_move_word(name);
  may_change_lines = may_change_lines || reads_as_line_word(name);
}

void WordLexer::declare(std::string_view name) {
  if (!expect_name_) return;
  if (declaring_ == Declaring::kGlobal) names_.add_global(name);
  else names_.add_local(name);
  if (declaring_ != Declaring::kParameters) expect_name_ = false;
}

void WordLexer::follow_declaration(std::size_t kind, std::size_t line) {
  switch (kind) {
    case T::GLOBAL: case T::CSGLOBAL: case T::PTR: declaring_ = Declaring::kGlobal; expect_name_ = true; depth_ = 0; return;
    case T::LOCAL: declaring_ = Declaring::kLocal; expect_name_ = true; depth_ = 0; return;
    default: break;
  }
  const bool opens_parameters = kind == T::LEFT && ((last_[0] == T::NAME && (last_[1] == T::SUBPROG || (last_[1] == T::COLON && last_[2] == T::SUB))) || (last_[0] == T::NUMBER && last_[1] == T::SUBPROG && last_[2] == T::OPEN));
  if (opens_parameters) { declaring_ = Declaring::kParameters; expect_name_ = true; depth_ = 0; return; }
  if (declaring_ == Declaring::kNothing) return;
  const bool name_wanted = last_[0] == T::COMMA || last_[0] == T::GLOBAL || last_[0] == T::CSGLOBAL || last_[0] == T::PTR || last_[0] == T::LOCAL;
  const bool ended_by_line = line != last_line_ && !name_wanted && depth_ == 0 && declaring_ != Declaring::kParameters;
  depth_ += kind == T::LEFT ? 1 : kind == T::RIGHT ? -1 : 0;
  const bool ended = kind == T::SEMICOLON || ended_by_line || (declaring_ == Declaring::kParameters && depth_ < 0) || kind == T::CLOSE || kind == T::OPEN;
  if (ended) { declaring_ = Declaring::kNothing; expect_name_ = false; return; }
  if (kind == T::COMMA && depth_ == 0) expect_name_ = true;
}

void WordLexer::follow_mode(std::size_t kind, std::size_t line) {
  if (kind == T::OPEN) { in_buffer_ = true; names_.local.clear(); }
  if (kind == T::CLOSE) { in_buffer_ = false; names_.local.clear(); }
  if (kind == T::CX) { line_is_buffered_ = true; buffered_line_ = line; }
  const bool motor_arrow = kind == T::ARROW && !in_buffer_ && (last_[0] == T::HASH || (last_[0] == T::NUMBER && last_[1] == T::HASH));
  if (motor_arrow) { axis_definition_ = true; axis_line_ = line; }
  else if (axis_definition_ && kind != T::NUMBER && kind != T::AXIS && kind != T::LETTER_C && kind != T::PLUS && kind != T::MINUS) axis_definition_ = false;
}

void WordLexer::follow(std::size_t kind, std::size_t line) {
  follow_declaration(kind, line);
  follow_mode(kind, line);
  if (kind == T::CODE || kind == T::LETTER_M || kind == T::LETTER_D || kind == T::CALL || kind == T::READ) code_line_ = line;
  last_[2] = last_[1];
  last_[1] = last_[0];
  last_[0] = kind;
}

const std::vector<std::string_view>& keyword_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> list;
    for (const auto& [word, type] : buffer_keywords()) list.push_back(word);
    std::sort(list.begin(), list.end());
    return list;
  }();
  return names;
}

std::string token_name(std::size_t type) { return token_vocabulary().getSymbolicName(type); }

std::string describe_token(std::size_t type) {
  const auto& vocabulary = token_vocabulary();
  const std::string literal = vocabulary.getLiteralName(type);
  if (!literal.empty()) return literal;
  switch (type) {
    case T::NUMBER: return "a number";
    case T::NAME: return "a name";
    case T::MEMBER: return "an element name";
    case T::AXIS: case T::LETTER_C: return "an axis";
    case T::STRING: return "a text in quotation marks";
    case T::VAR: case T::LETTER_M: return "a variable";
    case T::ELSE_IF: return "'else'";
    case T::LINE_END: return "the end of the line";
    case T::NORMAL_VECTOR: return "a vector such as K-1";
    case T::PSET_AXIS: return "an axis with its position";
    case T::CODE: return "a code letter";
    case antlr4::Token::EOF: return "the end of the file";
    default: return "'" + lower(vocabulary.getSymbolicName(type)) + "'";
  }
}

}  // namespace pmac::compiler::power_pmac
