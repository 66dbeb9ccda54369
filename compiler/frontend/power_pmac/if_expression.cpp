// The integer expressions of #if: precedence climbing over preprocessor tokens.
#include <array>
#include <cstdlib>

#include "compiler/frontend/power_pmac/preprocessor.h"

namespace pmac::compiler::power_pmac {
namespace {

using Value = std::optional<long long>;

constexpr int kMaxDepth = 100;

struct BinaryOperator { std::string_view text; int level; };
constexpr std::array<BinaryOperator, 18> kOperators{{{"||", 1}, {"&&", 2}, {"|", 3},  {"^", 4},  {"&", 5},  {"==", 6}, {"!=", 6}, {"<=", 7}, {">=", 7},
                                                     {"<<", 8}, {">>", 8}, {"<", 7},  {">", 7},  {"+", 9},  {"-", 9},  {"*", 10}, {"/", 10}, {"%", 10}}};

struct Reader {
  std::string text;
  std::size_t at = 0;
  int depth = 0;

  void skip() { while (at < text.size() && text[at] == ' ') ++at; }
  const BinaryOperator* peek_operator() {
    skip();
    for (const BinaryOperator& op : kOperators)
      if (std::string_view(text).substr(at).starts_with(op.text)) return &op;
    return nullptr;
  }
  Value primary();
  Value binary(int lowest_level);
};

Value apply(std::string_view op, long long a, long long b) {
  const auto ua = static_cast<unsigned long long>(a);
  const auto ub = static_cast<unsigned long long>(b);
  if (op == "||") return a || b;
  if (op == "&&") return a && b;
  if (op == "|") return a | b;
  if (op == "^") return a ^ b;
  if (op == "&") return a & b;
  if (op == "==") return a == b;
  if (op == "!=") return a != b;
  if (op == "<=") return a <= b;
  if (op == ">=") return a >= b;
  if (op == "<") return a < b;
  if (op == ">") return a > b;
  if (op == "<<") return static_cast<long long>(ua << (ub & 63));
  if (op == ">>") return a >> (ub & 63);
  if (op == "+") return static_cast<long long>(ua + ub);
  if (op == "-") return static_cast<long long>(ua - ub);
  if (op == "*") return static_cast<long long>(ua * ub);
  if (b == 0 || b == -1) return b == 0 ? Value() : op == "/" ? Value(static_cast<long long>(0 - ua)) : Value(0);
  return op == "/" ? a / b : a % b;
}

Value Reader::primary() {
  skip();
  if (at >= text.size() || depth > kMaxDepth) return std::nullopt;
  const char c = text[at];
  ++depth;
  Value value;
  if (c == '(') {
    ++at;
    value = binary(1);
    skip();
    if (at >= text.size() || text[at++] != ')') value.reset();
  } else if (c == '!' || c == '-' || c == '~' || c == '+') {
    ++at;
    value = primary();
    if (value && c == '!') value = !*value;
    if (value && c == '-') value = static_cast<long long>(0ULL - static_cast<unsigned long long>(*value));
    if (value && c == '~') value = ~*value;
  } else {
    const std::size_t begin = c == '$' ? ++at : at;
    at = std::min(text.find_first_not_of("0123456789abcdefABCDEF", at), text.size());
    if (at > begin) value = std::strtoll(text.substr(begin, at - begin).c_str(), nullptr, c == '$' ? 16 : 10);
  }
  --depth;
  return value;
}

Value Reader::binary(int lowest_level) {
  Value left = primary();
  for (const BinaryOperator* op = peek_operator(); left && op && op->level >= lowest_level; op = peek_operator()) {
    at += op->text.size();
    const Value right = binary(op->level + 1);
    left = right ? apply(op->text, *left, *right) : Value();
  }
  return left;
}

}  // namespace

std::optional<long long> evaluate_if(const std::vector<PreprocessorToken>& tokens) {
  Reader reader;
  for (const PreprocessorToken& token : tokens) {
    const bool is_blank = token.kind == PreprocessorToken::Kind::kBlank || token.kind == PreprocessorToken::Kind::kNewline;
    const bool is_name = token.kind == PreprocessorToken::Kind::kIdentifier;
    if (is_name) reader.text += "0";
    else if (is_blank) reader.text += " ";
    else reader.text += token.text;
  }
  const Value value = reader.binary(1);
  reader.skip();
  return reader.at == reader.text.size() ? value : std::nullopt;
}

}  // namespace pmac::compiler::power_pmac
