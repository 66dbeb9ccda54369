// The integer expressions of #if: precedence climbing over preprocessor tokens, 64 bits, with the operators of C. What is not
// reached (behind a false &&, in the other branch of ?:) is read and not evaluated.
#include <algorithm>
#include <array>
#include <charconv>

#include "compiler/frontend/power_pmac/macros.h"

namespace pmac::compiler::power_pmac {
namespace {

using Token = PreprocessorToken;
using Kind = PreprocessorToken::Kind;

constexpr int kMaxDepth = 100;

struct BinaryOperator { std::string_view text; int level; };
constexpr std::array<BinaryOperator, 18> kOperators{{{"||", 1}, {"&&", 2}, {"==", 6}, {"!=", 6}, {"<=", 7}, {">=", 7}, {"<<", 8}, {">>", 8}, {"|", 3},
                                                     {"^", 4},  {"&", 5},  {"<", 7},  {">", 7},  {"+", 9},  {"-", 9},  {"*", 10}, {"/", 10}, {"%", 10}}};

class IfReader {
 public:
  explicit IfReader(const PreprocessorTokens& tokens) {
    bool gap = true;
    for (const Token& token : tokens) {
      const bool is_gap = token.kind == Kind::kBlank || token.kind == Kind::kNewline;
      if (!is_gap) {
        tokens_.push_back(token);
        glued_.push_back(!gap);
      }
      gap = is_gap;
    }
  }

  IfValue read() {
    if (tokens_.empty()) return {0, "it is empty"};
    const long long value = choice(true);
    if (problem_.empty() && at_ < tokens_.size()) fail("'" + std::string(tokens_[at_].text) + "' is not expected");
    return {value, problem_};
  }

 private:
  bool is(std::string_view text) const {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const std::size_t at = at_ + i;
      if (at >= tokens_.size() || tokens_[at].text != text.substr(i, 1) || (i > 0 && !glued_[at])) return false;
    }
    return true;
  }
  bool accept(std::string_view text) {
    if (!is(text)) return false;
    at_ += text.size();
    return true;
  }
  long long fail(std::string problem) {
    if (problem_.empty()) problem_ = std::move(problem);
    return 0;
  }
  const BinaryOperator* next_operator() const {
    const auto found = std::find_if(kOperators.begin(), kOperators.end(), [&](const BinaryOperator& op) { return is(op.text); });
    return found == kOperators.end() ? nullptr : &*found;
  }

  long long choice(bool needed) {
    if (++depth_ > kMaxDepth) return fail("it is nested too deep");
    const long long condition = binary(1, needed);
    long long value = condition;
    if (problem_.empty() && accept("?")) {
      const long long first = choice(needed && condition != 0);
      if (!accept(":")) return fail(": is missing behind ?");
      const long long second = choice(needed && condition == 0);
      value = condition != 0 ? first : second;
    }
    --depth_;
    return value;
  }

  long long binary(int lowest_level, bool needed) {
    long long left = unary(needed);
    for (const BinaryOperator* op = next_operator(); problem_.empty() && op && op->level >= lowest_level; op = next_operator()) {
      accept(op->text);
      const bool decided = (op->text == "&&" && left == 0) || (op->text == "||" && left != 0);
      const long long right = binary(op->level + 1, needed && !decided);
      left = decided ? left != 0 : apply(op->text, left, right, needed);
    }
    return left;
  }

  long long unary(bool needed) {
    if (at_ >= tokens_.size()) return fail("an operand is missing");
    if (++depth_ > kMaxDepth) return fail("it is nested too deep");
    long long value = 0;
    if (accept("!")) value = unary(needed) == 0;
    else if (accept("~")) value = ~unary(needed);
    else if (accept("-")) value = static_cast<long long>(0ULL - static_cast<unsigned long long>(unary(needed)));
    else if (accept("+")) value = unary(needed);
    else if (accept("(")) value = parenthesis(needed);
    else value = operand();
    --depth_;
    return value;
  }

  long long parenthesis(bool needed) {
    const long long value = choice(needed);
    return accept(")") ? value : fail(") is missing");
  }

  long long operand() {
    const Token token = tokens_[at_++];
    if (token.kind == Kind::kIdentifier) return 0;
    if (token.text.starts_with("$")) return number(token.text.substr(1), 16);
    if (token.kind != Kind::kNumber) return fail("'" + std::string(token.text) + "' is no operand");
    const bool letters_follow = at_ < tokens_.size() && tokens_[at_].kind == Kind::kIdentifier && glued_[at_];
    if (!letters_follow) return number(token.text, 10);
    const std::string_view letters = tokens_[at_++].text;
    const bool hexadecimal = token.text == "0" && (letters[0] == 'x' || letters[0] == 'X');
    if (hexadecimal) return number(letters.substr(1), 16);
    const bool suffix = letters.find_first_not_of("uUlL") == std::string_view::npos;
    return suffix ? number(token.text, 10) : fail("'" + std::string(token.text) + std::string(letters) + "' is no number");
  }

  long long number(std::string_view digits, int base) {
    unsigned long long value = 0;
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
    const bool whole = !digits.empty() && read.ec == std::errc() && read.ptr == digits.data() + digits.size();
    return whole ? static_cast<long long>(value) : fail("'" + std::string(digits) + "' is no number of 64 bits");
  }

  long long apply(std::string_view op, long long a, long long b, bool needed) {
    const auto ua = static_cast<unsigned long long>(a);
    const auto ub = static_cast<unsigned long long>(b);
    if (op == "||") return a != 0 || b != 0;
    if (op == "&&") return a != 0 && b != 0;
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
    if (b == 0) return needed ? fail("it divides by zero") : 0;
    if (b == -1) return op == "/" ? static_cast<long long>(0 - ua) : 0;
    return op == "/" ? a / b : a % b;
  }

  PreprocessorTokens tokens_;
  std::vector<bool> glued_;  // no blank before the token
  std::size_t at_ = 0;
  int depth_ = 0;
  std::string problem_;
};

}  // namespace

IfValue evaluate_if(const PreprocessorTokens& tokens) { return IfReader(tokens).read(); }

}  // namespace pmac::compiler::power_pmac
