#include "runtime/io/io_space.h"

#include <cmath>
#include <limits>

#include "runtime/io/bit_field.h"

namespace pmac::runtime {

using bytecode::PointerDefinition;
using bytecode::PointerKind;

namespace {

/// Nearest float; beyond the largest float infinity.
float float_from(double value) {
  if (std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max())) return static_cast<float>(value);
  if (std::isnan(value)) return std::numeric_limits<float>::quiet_NaN();
  return std::copysign(std::numeric_limits<float>::infinity(), value < 0 ? -1.0f : 1.0f);
}

bool is_inside_user_memory(const PointerDefinition& definition) {
  switch (definition.kind) {
    case PointerKind::kUserInteger: return UserMemory::holds<std::uint32_t>(definition.address);
    case PointerKind::kUserFloat: return UserMemory::holds<float>(definition.address);
    case PointerKind::kUserDouble: return UserMemory::holds<double>(definition.address);
    default: return true;
  }
}

}  // namespace

std::uint32_t IoSpace::word(std::uint32_t address) const {
  const auto found = words_.find(address);
  return found == words_.end() ? 0 : found->second;
}

bool IoSpace::set_word(std::uint32_t address, std::uint32_t word) {
  std::uint32_t& stored = words_[address];
  const bool changed = stored != word;
  stored = word;
  return changed;
}

double IoSpace::read(const PointerDefinition& definition) const {
  switch (definition.kind) {
    case PointerKind::kIo: return read_bits(word(definition.address), definition);
    case PointerKind::kUserInteger: return read_bits(user_.read<std::uint32_t>(definition.address), definition);
    case PointerKind::kUserFloat: return user_.read<float>(definition.address);
    case PointerKind::kUserDouble: return user_.read<double>(definition.address);
    default: return 0;
  }
}

bool IoSpace::write(const PointerDefinition& definition, double value) {
  const std::uint32_t at = definition.address;
  switch (definition.kind) {
    case PointerKind::kIo: return set_word(at, write_bits(word(at), definition, value));
    case PointerKind::kUserInteger: return user_.write(at, write_bits(user_.read<std::uint32_t>(at), definition, value));
    case PointerKind::kUserFloat: return user_.write(at, float_from(value));
    case PointerKind::kUserDouble: return user_.write(at, value);
    default: return false;
  }
}

std::string refusal_of(const PointerDefinition& definition) {
  const bool has_bits = definition.width >= 1 && definition.start_bit + definition.width <= 32;
  if (!has_bits) return "the bit field does not fit into 32 bits";
  if (is_inside_user_memory(definition)) return {};
  return "the offset " + std::to_string(definition.address) + " lies outside user memory, which has " +
         std::to_string(UserMemory::kSize) + " bytes here";
}

}  // namespace pmac::runtime
