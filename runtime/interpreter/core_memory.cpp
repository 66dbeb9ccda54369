// Addresses, and reading and writing what they point at. Everything is checked where it is used: an array that a function would
// leave is a fault, and nothing of it is written.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "compiler/bytecode/module_text.h"
#include "compiler/bytecode/opcode.h"
#include "runtime/interpreter/core.h"
#include "runtime/interpreter/memory_address.h"
#include "runtime/interpreter/print_format.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;
using Kind = MemoryAddress::Kind;

constexpr double kOfKind = 0x1p44, kOfEnd = 0x1p22;
constexpr std::uint32_t kLowBits = (1u << 22) - 1;
constexpr std::size_t kMostText = 65536;          // characters of one text
constexpr std::size_t kMostFormatValues = 64;
constexpr std::size_t kBytesOfVariable = sizeof(double);

std::uint32_t size_of_buffer() { return static_cast<std::uint32_t>(bytecode::element_info(ElementId::kSysCdata).index_counts[0]); }

/// Bytes of one element of the user buffer; 0: not an element of it.
std::uint32_t bytes_of_element(ElementId id) {
  switch (id) {
    case ElementId::kSysCdata: return 1;
    case ElementId::kSysIdata:
    case ElementId::kSysUdata:
    case ElementId::kSysFdata: return 4;
    case ElementId::kSysDdata: return 8;
    default: return 0;
  }
}

std::string place_text(const MemoryAddress& address, std::int64_t number) {
  if (address.kind == Kind::kBytes) return fmt::format("Sys.Cdata[{}]", number);
  return fmt::format("{}{}", bytecode::variable_class_name(address.variable_class()), number);
}

}  // namespace

double number_of(const MemoryAddress& address) {
  return (static_cast<double>(address.kind) + 1) * kOfKind + address.end * kOfEnd + address.first;
}

std::optional<MemoryAddress> address_from(double number) {
  const double most = (static_cast<double>(Kind::kCount) + 1) * kOfKind;
  if (!(number >= kOfKind && number < most) || number != std::floor(number)) return std::nullopt;
  const auto bits = static_cast<std::uint64_t>(number);
  MemoryAddress address;
  address.kind = static_cast<Kind>((bits >> 44) - 1);
  address.end = static_cast<std::uint32_t>(bits >> 22) & kLowBits;
  address.first = static_cast<std::uint32_t>(bits) & kLowBits;
  return address;
}

// --- making addresses ---------------------------------------------------------------------------------------------------

bool InterpreterCore::load_address(const Instruction& in, double* r) {
  const auto variable_class = static_cast<bytecode::VariableClass>(in.c());
  int index = 0;
  if (!variable(variable_class, r[in.b()], index)) return false;
  r[in.a] = number_of({static_cast<Kind>(variable_class), static_cast<std::uint32_t>(index), 0});
  return true;
}

void InterpreterCore::limit_address(const Instruction& in, double* r) {
  auto address = address_from(r[in.a]);
  if (!address || in.imm <= 0) return;
  address->end = static_cast<std::uint32_t>(in.imm) & kLowBits;
  r[in.a] = number_of(*address);
}

bool InterpreterCore::load_byte_address(const Instruction& in, double* r) {
  ElementAddress element;
  if (!resolve(thread_.program_.module->element_refs[static_cast<std::size_t>(in.imm)], r, element)) return false;
  const std::uint32_t bytes = bytes_of_element(element.id);
  if (bytes == 0) {
    fault(std::string(bytecode::element_info(element.id).name) + " has no address that a function can use; the user buffer Sys.Cdata[] has");
    return false;
  }
  r[in.a] = number_of({Kind::kBytes, element.index[0] * bytes, 0});
  return true;
}

void InterpreterCore::load_text(const Instruction& in, double* r) {
  const auto index = static_cast<std::uint32_t>(in.imm);
  r[in.a] = number_of({Kind::kText, index & kLowBits, index >> 22});
}

bool InterpreterCore::add_format_value(double value) {
  if (thread_.format_values_.size() >= kMostFormatValues) {
    fault("a text has more than 64 values");
    return false;
  }
  thread_.format_values_.push_back(value);
  return true;
}

// --- what they point at -----------------------------------------------------------------------------------------------------

bool InterpreterCore::refuse_memory(const std::string& why) {
  fault(calling_.empty() ? why : fmt::format("{}: {}", calling_, why));
  return false;
}

/// Where the array of a variable or byte address ends.
std::int64_t InterpreterCore::end_of(const MemoryAddress& address) const {
  std::int64_t end = address.kind == Kind::kBytes ? size_of_buffer() : bytecode::variable_class_count(address.variable_class());
  if (address.kind == Kind::kL) end = program().local_count;
  if (address.kind == Kind::kR) end = program().outgoing_count;
  return address.end > 0 ? std::min<std::int64_t>(end, address.end) : end;
}

std::optional<MemoryAddress> InterpreterCore::memory(double number, bool text_allowed) {
  const auto address = address_from(number);
  const bool fits = address && (address->kind != Kind::kText || text_allowed);
  if (fits) return address;
  refuse_memory("an argument is no address");
  return std::nullopt;
}

/// Numbers first, first + step, ... of count variables, all inside.
bool InterpreterCore::fits(const MemoryAddress& address, std::int64_t count, std::int64_t step) {
  if (count == 0) return true;
  const std::int64_t last = address.first + (count - 1) * step;
  const std::int64_t lowest = std::min<std::int64_t>(address.first, last), highest = std::max<std::int64_t>(address.first, last);
  if (lowest >= 0 && highest < end_of(address)) return true;
  return refuse_memory(fmt::format("{} is outside; the array ends with {}", place_text(address, lowest < 0 ? lowest : highest), place_text(address, end_of(address) - 1)));
}

bool InterpreterCore::read_values(double number, std::int64_t count, std::int64_t step, std::vector<double>& values) {
  const auto address = memory(number, false);
  if (!address) return false;
  if (!address->is_variable()) return refuse_memory("vectors and matrices are made of variables");
  if (!fits(*address, count, step)) return false;
  values.clear();
  for (std::int64_t i = 0; i < count; ++i)
    values.push_back(read_variable(address->variable_class(), static_cast<int>(address->first + i * step), registers()));
  return !host_failed();
}

bool InterpreterCore::write_values(double number, std::int64_t step, std::span<const double> values) {
  const auto address = memory(number, false);
  if (!address) return false;
  if (!address->is_variable()) return refuse_memory("vectors and matrices are made of variables");
  if (!fits(*address, static_cast<std::int64_t>(values.size()), step)) return false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    write_variable(address->variable_class(), static_cast<int>(address->first + static_cast<std::int64_t>(i) * step), values[i], registers());
    if (host_failed()) return false;
  }
  return true;
}

/// Byte `at` of the memory behind an address, counted from there; the caller has checked that it is inside.
char InterpreterCore::byte_at(const MemoryAddress& address, std::size_t at) {
  if (address.kind == Kind::kBytes) {
    const ElementAddress element{ElementId::kSysCdata, {address.first + static_cast<std::uint32_t>(at), 0, 0}};
    return static_cast<char>(static_cast<int>(host_.read_element(thread_, element)));
  }
  const double value = read_variable(address.variable_class(), static_cast<int>(address.first + at / kBytesOfVariable), registers());
  std::array<char, kBytesOfVariable> bytes{};
  std::memcpy(bytes.data(), &value, bytes.size());
  return bytes[at % kBytesOfVariable];
}

std::size_t InterpreterCore::room(const MemoryAddress& address) const {
  const std::int64_t places = std::max<std::int64_t>(end_of(address) - address.first, 0);
  return static_cast<std::size_t>(places) * (address.is_variable() ? kBytesOfVariable : 1);
}

bool InterpreterCore::read_bytes(double number, std::size_t count, std::string& bytes) {
  const auto address = memory(number, true);
  if (!address) return false;
  bytes.clear();
  if (address->kind == Kind::kText) {
    bytes = text_of(*address);
    bytes.resize(count);
    return true;
  }
  if (count > room(*address)) return refuse_memory(fmt::format("{} bytes reach behind the memory at {}, which has {}", count, place_text(*address, address->first), room(*address)));
  for (std::size_t i = 0; i < count; ++i) bytes += byte_at(*address, i);
  return !host_failed();
}

std::string InterpreterCore::text_of(const MemoryAddress& address) const {
  const std::uint64_t index = (std::uint64_t{address.end} << 22) | address.first;
  const auto& strings = thread_.program_.module->strings;
  const std::string text = index < strings.size() ? strings[index] : std::string();
  return text.substr(0, std::min(text.find('\0'), text.size()));
}

bool InterpreterCore::read_text(double number, std::string& text) {
  const auto address = memory(number, true);
  if (!address) return false;
  text.clear();
  if (address->kind == Kind::kText) {
    text = text_of(*address);
    return true;
  }
  const std::size_t end = room(*address);
  for (std::size_t i = 0; i < end; ++i) {
    const char c = byte_at(*address, i);
    if (c == '\0') break;
    if (i == kMostText) return refuse_memory(fmt::format("the text at {} has no end within {} characters", place_text(*address, address->first), kMostText));
    text += c;
  }
  return !host_failed();
}

bool InterpreterCore::write_bytes(double number, std::string_view bytes) {
  const auto address = memory(number, false);
  if (!address) return false;
  if (bytes.size() > room(*address)) return refuse_memory(fmt::format("{} bytes do not fit behind {}, where there are {}", bytes.size(), place_text(*address, address->first), room(*address)));
  for (std::size_t i = 0; i < bytes.size();) {
    if (address->kind == Kind::kBytes) {
      const ElementAddress element{ElementId::kSysCdata, {address->first + static_cast<std::uint32_t>(i), 0, 0}};
      if (after(host_.write_element(thread_, element, static_cast<signed char>(bytes[i++]))) != Next::kContinue) return false;
      continue;
    }
    const int variable_number = static_cast<int>(address->first + i / kBytesOfVariable);
    double value = read_variable(address->variable_class(), variable_number, registers());
    std::array<char, kBytesOfVariable> part{};
    std::memcpy(part.data(), &value, part.size());
    for (std::size_t k = i % kBytesOfVariable; k < kBytesOfVariable && i < bytes.size(); ++k) part[k] = bytes[i++];
    std::memcpy(&value, part.data(), part.size());
    write_variable(address->variable_class(), variable_number, value, registers());
    if (host_failed()) return false;
  }
  return true;
}

// --- formats -------------------------------------------------------------------------------------------------------------------

/// The text of a format with the values that FormatValue has collected; they are used up. Without values and where it is no
/// format for sprintf the text stands as it is.
bool InterpreterCore::fill_format(const std::string& format, bool always, std::string& text) {
  const std::vector<double> values = std::exchange(thread_.format_values_, {});
  text = format;
  if (values.empty() && !always) return true;
  const bytecode::FormatText parts = bytecode::parse_format(format);
  if (!parts.problem.empty() || parts.value_count() != values.size()) return refuse_memory("the values do not fit the format");
  text.clear();
  std::size_t copied = 0, next = 0;
  for (const bytecode::Conversion& conversion : parts.conversions) {
    text.append(format, copied, conversion.begin - copied);
    copied = conversion.end;
    std::string inserted;
    switch (conversion.kind) {
      case bytecode::ConversionKind::kPercent: text += '%'; break;
      case bytecode::ConversionKind::kText:
        if (!read_text(values[next++], inserted)) return false;
        text += print_text(conversion, inserted);
        break;
      default: text += print_value(conversion, values[next++]);
    }
    if (text.size() > kMostText) return refuse_memory(fmt::format("the text has more than {} characters", kMostText));
  }
  text.append(format, copied);
  return true;
}

InterpreterCore::Next InterpreterCore::put_out(const Instruction& in) {
  calling_ = {};
  std::string text;
  const std::string& format = thread_.program_.module->strings[static_cast<std::size_t>(in.imm)];
  if (!fill_format(format, false, text)) return Next::kLeave;
  return after(in.op == bytecode::Opcode::kSend ? host_.send(thread_, in.a, text) : host_.command(thread_, text));
}

}  // namespace pmac::runtime
