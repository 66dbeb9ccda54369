// Functions of bytes and texts, with the meaning that their namesakes have in C; places are counted from 0 and -1 means none.
#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

#include "compiler/bytecode/function.h"
#include "compiler/bytecode/operators.h"
#include "runtime/interpreter/core.h"

namespace pmac::runtime {
namespace {

using bytecode::Function;

constexpr double kMostBytes = 1 << 20;

double place_of(std::size_t at) { return at == std::string::npos ? -1.0 : static_cast<double>(at); }

double sign_of_comparison(const std::string& left, const std::string& right) {
  const auto unsigned_less = [](char x, char y) { return static_cast<unsigned char>(x) < static_cast<unsigned char>(y); };
  if (std::lexicographical_compare(left.begin(), left.end(), right.begin(), right.end(), unsigned_less)) return -1;
  return left == right ? 0 : 1;
}

/// As C's strtod for decimal numbers: blanks, a sign, digits, exponent; also inf and nan. 0 where there is no number.
double number_at_beginning(const std::string& text) {
  std::size_t at = 0;
  while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at])) != 0) ++at;
  if (at < text.size() && text[at] == '+') ++at;
  double value = 0;
  std::from_chars(text.data() + at, text.data() + text.size(), value);
  return value;
}

char with_case(char c, bool upper) {
  const auto letter = static_cast<unsigned char>(c);
  return static_cast<char>(upper ? std::toupper(letter) : std::tolower(letter));
}

}  // namespace

/// Writes a text and the 0 behind it; the result is its length.
bool InterpreterCore::write_text(double address, const std::string& text, double& result) {
  result = static_cast<double>(text.size());
  return write_bytes(address, text + '\0');
}

bool InterpreterCore::byte_count_argument(double value, std::size_t& count) {
  if (!(value > -1.0 && value <= kMostBytes)) return refuse_memory(fmt::format("{} is no number of bytes", number_text(value)));
  count = static_cast<std::size_t>(value);
  return true;
}

/// Functions that write bytes; x: their arguments.
bool InterpreterCore::writing_text_function(Function function, const double* x, double& result) {
  std::string text, added;
  std::size_t count = std::string::npos;
  switch (function) {
    case Function::kMemcpy:
      if (!byte_count_argument(x[2], count) || !read_bytes(x[1], count, text)) return false;
      result = static_cast<double>(count);
      return write_bytes(x[0], text);
    case Function::kMemset:
      if (!byte_count_argument(x[2], count)) return false;
      result = static_cast<double>(count);
      return write_bytes(x[0], std::string(count, static_cast<char>(bytecode::integer_from(x[1]) & 0xff)));
    case Function::kStrcpy: return read_text(x[1], text) && write_text(x[0], text, result);
    case Function::kStrncpy:
      if (!byte_count_argument(x[2], count) || !read_text(x[1], text)) return false;
      text.resize(count);
      result = static_cast<double>(count);
      return write_bytes(x[0], text);
    case Function::kStrcat:
    case Function::kStrncat:
      if (function == Function::kStrncat && !byte_count_argument(x[2], count)) return false;
      return read_text(x[0], text) && read_text(x[1], added) && write_text(x[0], text + added.substr(0, count), result);
    default: {  // strtolower, strtoupper
      if (!read_text(x[0], text)) return false;
      const bool upper = function == Function::kStrtoupper;
      std::transform(text.begin(), text.end(), text.begin(), [upper](char c) { return with_case(c, upper); });
      result = static_cast<double>(text.size());
      return write_bytes(x[0], text);
    }
  }
}

/// Functions that only read texts.
bool InterpreterCore::reading_text_function(Function function, const double* x, double& result) {
  std::string left, right;
  std::size_t count = std::string::npos;
  if (!read_text(x[0], left)) return false;
  const bool has_two_texts = bytecode::function_info(function).signature.starts_with("ss");
  if (has_two_texts && !read_text(x[1], right)) return false;
  const auto letter = [x] { return static_cast<char>(bytecode::integer_from(x[1]) & 0xff); };   // of the functions that have one
  switch (function) {
    case Function::kStrcmp: result = sign_of_comparison(left, right); break;
    case Function::kStrncmp:
      if (!byte_count_argument(x[2], count)) return false;
      result = sign_of_comparison(left.substr(0, count), right.substr(0, count));
      break;
    case Function::kStrlen: result = static_cast<double>(left.size()); break;
    case Function::kStrchr: result = place_of((left + '\0').find(letter())); break;
    case Function::kStrrchr: result = place_of((left + '\0').rfind(letter())); break;
    case Function::kStrspn: result = static_cast<double>(std::min(left.find_first_not_of(right), left.size())); break;
    case Function::kStrcspn: result = static_cast<double>(std::min(left.find_first_of(right), left.size())); break;
    case Function::kStrpbrk: result = place_of(left.find_first_of(right)); break;
    case Function::kStrstr: result = place_of(left.find(right)); break;
    default: result = number_at_beginning(left); break;  // strtod
  }
  return true;
}

/// sprintf(&to, format, values).
bool InterpreterCore::print_function(const double* x, double& result) {
  std::string format, text;
  return read_text(x[1], format) && fill_format(format, true, text) && write_text(x[0], text, result);
}

bool InterpreterCore::memory_function(const Instruction& in, double* r, std::int64_t& budget) {
  const auto function = static_cast<Function>(in.b());
  const double* x = r + in.c();
  double result = 0;
  std::int64_t work = 0;
  calling_ = bytecode::function_info(function).name;
  bool worked = false;
  if (function == Function::kCFromScript) worked = refuse_memory("it is a C routine of the user, which is not simulated");
  else if (function <= Function::kVmadd) worked = vector_function(function, x, result, work);
  else if (function <= Function::kMtrans) worked = matrix_function(function, x, result, work);
  else if (function <= Function::kTprop) worked = transform_function(function, x, result);
  else if (function == Function::kSprintf) worked = print_function(x, result);
  else if (function <= Function::kStrtoupper) worked = writing_text_function(function, x, result);
  else worked = reading_text_function(function, x, result);
  calling_ = {};
  if (!worked) return false;
  budget -= work / 16;  // an instruction of the budget does about as much
  r[in.a] = result;
  return true;
}

}  // namespace pmac::runtime
