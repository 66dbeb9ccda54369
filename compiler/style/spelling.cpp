#include "compiler/style/spelling.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "compiler/bytecode/element.h"
#include "compiler/bytecode/function.h"

namespace pmac::style {
namespace {

constexpr std::size_t kMaxElementPieces = 40;

std::string upper_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

bool is_function(const std::string& lower) {
  static const std::set<std::string, std::less<>> names = [] {
    std::set<std::string, std::less<>> all;
    for (std::uint16_t i = 0; i < static_cast<std::uint16_t>(bytecode::Function::kCount); ++i)
      all.emplace(bytecode::function_info(static_cast<bytecode::Function>(i)).name);
    return all;
  }();
  return names.contains(lower);
}

/// The words of an element name such as Coord[].FeedTime.
std::vector<std::string> words_of(std::string_view element) {
  std::vector<std::string> words(1);
  for (const char c : element) {
    if (c == '.') words.emplace_back();
    else if (c != '[' && c != ']') words.back() += c;
  }
  return words;
}

}  // namespace

void Spelling::append(std::size_t index, std::string& out) {
  const Piece& piece = source_.pieces[index];
  const std::string_view text = source_.of(piece);
  const bool may_change = piece.kind == PieceKind::kKeyword || piece.kind == PieceKind::kLetter || piece.kind == PieceKind::kName || piece.kind == PieceKind::kMember;
  if (!may_change || touches_raw(index)) {
    out += text;
    return;
  }
  const std::string spelling = spelt(index);
  if (spelling == text || !is_free(piece, spelling)) out += text;
  else out += spelling;
}

std::string Spelling::spelt(std::size_t index) {
  const Piece& piece = source_.pieces[index];
  const std::string_view text = source_.of(piece);
  if (piece.kind == PieceKind::kKeyword) return lower_case(text);
  if (piece.kind == PieceKind::kLetter) return upper_case(text);
  if (piece.kind == PieceKind::kName) {
    element_words_.clear();
    if (source_.names.contains(text)) return std::string(text);
    if (is_function_call(index)) return lower_case(text);
    read_element(index);
  }
  const auto found = element_words_.find(index);
  return found == element_words_.end() ? std::string(text) : found->second;
}

bool Spelling::is_function_call(std::size_t index) const {
  const bool called = index + 1 < source_.pieces.size() && source_.of(source_.pieces[index + 1]) == "(";
  return called && is_function(lower_case(source_.of(source_.pieces[index])));
}

/// Reads name, indices and members as far as they go; where they are a known element, notes the spelling of its words.
void Spelling::read_element(std::size_t index) {
  std::string pattern = lower_case(source_.of(source_.pieces[index]));
  std::vector<std::size_t> words{index};
  int depth = 0;
  const std::size_t end = std::min(source_.pieces.size(), index + kMaxElementPieces);
  for (std::size_t i = index + 1; i < end; ++i) {
    const Piece& piece = source_.pieces[i];
    const std::string_view text = source_.of(piece);
    if (!piece.is_word()) break;
    if (text == "[") {
      if (depth++ == 0) pattern += "[]";
    } else if (text == "]") {
      if (--depth < 0) break;
    } else if (depth == 0 && piece.kind == PieceKind::kMember) {
      pattern += "." + lower_case(text);
      words.push_back(i);
    } else if (depth == 0 && text != ".") {
      break;
    }
  }
  const bytecode::ElementId id = bytecode::find_element(pattern);
  if (id == bytecode::kNoElement) return;
  const std::vector<std::string> spelling = words_of(bytecode::element_info(id).name);
  if (spelling.size() != words.size()) return;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool is_board = lower_case(spelling[i]) != lower_case(source_.of(source_.pieces[words[i]]));  // PowerBrick[] for Gate3[]
    if (!is_board) element_words_[words[i]] = spelling[i];
  }
}

/// The new spelling is no name that somebody declared, alone or with what touches the word.
bool Spelling::is_free(const Piece& piece, const std::string& spelling) const {
  if (piece.kind == PieceKind::kMember) return !source_.names.macros.contains(spelling) && !source_.names.macros.contains(source_.of(piece));
  const std::string_view text = source_.text;
  std::size_t begin = piece.begin, end = piece.end;
  constexpr std::size_t kLongestName = 255;
  while (begin > 0 && piece.begin - begin < kLongestName && is_name_part(text[begin - 1])) --begin;
  while (end < text.size() && end - piece.end < kLongestName && is_name_part(text[end])) ++end;
  const std::string before(text.substr(begin, piece.begin - begin));
  const std::string behind(text.substr(piece.end, end - piece.end));
  const auto& names = source_.names;
  return !names.contains(spelling) && !names.contains(source_.of(piece)) && !names.contains(before + spelling) && !names.contains(spelling + behind) &&
         !names.contains(before + spelling + behind);
}

bool Spelling::touches_raw(std::size_t index) const {
  const auto& pieces = source_.pieces;
  const bool before = index > 0 && pieces[index - 1].kind == PieceKind::kRaw && pieces[index - 1].end == pieces[index].begin;
  const bool behind = index + 1 < pieces.size() && pieces[index + 1].kind == PieceKind::kRaw && pieces[index].end == pieces[index + 1].begin;
  return before || behind;
}

}  // namespace pmac::style
