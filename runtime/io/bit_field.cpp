#include "runtime/io/bit_field.h"

#include "compiler/bytecode/operators.h"

namespace pmac::runtime {
namespace {

/// `width` low bits set; width is 1 to 32.
std::uint32_t low_bits(unsigned width) { return width >= 32 ? 0xffffffffu : (1u << width) - 1u; }

std::uint32_t integer_bits(double value) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(bytecode::integer_from(value)) & 0xffffffffu);
}

}  // namespace

double read_bits(std::uint32_t word, const bytecode::PointerDefinition& definition) {
  const std::uint32_t mask = low_bits(definition.width);
  const std::uint32_t field = (word >> definition.start_bit) & mask;
  const bool is_negative = definition.is_signed && (field >> (definition.width - 1)) != 0;
  return is_negative ? static_cast<double>(field) - static_cast<double>(mask) - 1.0 : static_cast<double>(field);
}

std::uint32_t write_bits(std::uint32_t word, const bytecode::PointerDefinition& definition, double value) {
  const std::uint32_t mask = low_bits(definition.width) << definition.start_bit;
  return (word & ~mask) | ((integer_bits(value) << definition.start_bit) & mask);
}

double read_bit_field(double element_value, const bytecode::PointerDefinition& definition) {
  return read_bits(integer_bits(element_value), definition);
}

double write_bit_field(double element_value, const bytecode::PointerDefinition& definition, double value) {
  const std::int64_t high_bits = bytecode::integer_from(element_value) & ~std::int64_t{0xffffffff};
  return static_cast<double>(high_bits | std::int64_t{write_bits(integer_bits(element_value), definition, value)});
}

}  // namespace pmac::runtime
