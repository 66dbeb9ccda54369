#include "runtime/element_store.h"
#include "compiler/bytecode/element.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace pmac::runtime {
namespace {

using bytecode::ElementId;
using bytecode::ElementInfo;
using bytecode::element_info;

std::size_t at_least_1(int count) { return static_cast<std::size_t>(std::max(count, 1)); }

/// Elements that act and are not views of a variable array or of the user buffer.
bool has_slots(ElementId id) {
  const ElementInfo& info = element_info(id);
  const bool in_user_buffer = id >= ElementId::kSysCdata && id <= ElementId::kSysDdata;
  const bool view = id == ElementId::kSysP || id == ElementId::kCoordQ || in_user_buffer;
  const bool value = info.type != bytecode::ElementType::kSymbol && info.type != bytecode::ElementType::kStructure;
  return info.simulation == bytecode::ElementSimulation::kActs && value && !view;
}

/// Default of an element at a place; motors read their own entry of the encoder table.
double default_value(ElementId id, std::size_t place) {
  switch (id) {
    case ElementId::kMotorPEnc:
    case ElementId::kMotorPEnc2: return bytecode::address_of(ElementId::kStructureEncTable, place);
    case ElementId::kMotorPMasterEnc: return bytecode::address_of(ElementId::kStructureEncTable);
    case ElementId::kMotorCtrl: return bytecode::address_of(ElementId::kSysServoCtrl);
    case ElementId::kMotorPSineTable:
    case ElementId::kMotorPVoltSineTable: return bytecode::address_of(ElementId::kSysSineTable);
    case ElementId::kCoordPDesTimeBase: return bytecode::address_of(ElementId::kCoordDesTimeBase, place);
    default: return element_info(id).default_value;
  }
}

std::size_t place_of(const ElementAddress& a) {
  const auto& counts = element_info(a.id).index_counts;
  return (a.index[0] * at_least_1(counts[1]) + a.index[1]) * at_least_1(counts[2]) + a.index[2];
}

ElementAddress address_at(ElementId id, std::size_t place) {
  const auto& counts = element_info(id).index_counts;
  const std::size_t count1 = at_least_1(counts[1]), count2 = at_least_1(counts[2]);
  return {id, {static_cast<std::uint32_t>(place / count2 / count1), static_cast<std::uint32_t>(place / count2 % count1),
               static_cast<std::uint32_t>(place % count2)}};
}

}  // namespace

ElementStore::ElementStore() {
  for (int e = 0; e < static_cast<int>(ElementId::kCount); ++e) {
    const auto id = static_cast<ElementId>(e);
    const auto& counts = element_info(id).index_counts;
    const bool dense = has_slots(id);
    rows_.push_back({values_.size(), at_least_1(counts[1]), at_least_1(counts[2]), dense});
    if (dense) values_.insert(values_.end(), static_cast<std::size_t>(element_info(id).size()), element_info(id).default_value);
  }
  assigned_.assign(values_.size(), false);
}

void ElementStore::assign(const ElementAddress& a, double value) {
  set(a.id, value, a.index[0], a.index[1], a.index[2]);
  const Row& row = rows_[static_cast<std::size_t>(a.id)];
  if (row.dense) assigned_[row.base + place_of(a)] = true;
}

bool ElementStore::assigned(ElementId id, unsigned i0, unsigned i1, unsigned i2) const {
  const Row& row = rows_[static_cast<std::size_t>(id)];
  const std::size_t place = row.place(i0, i1, i2);
  return row.dense ? assigned_[row.base + place] : sparse_.contains(key(id, place));
}

double ElementStore::sparse_value(ElementId id, std::size_t place) const {
  const auto found = sparse_.find(key(id, place));
  return found == sparse_.end() ? default_value(id, place) : found->second;
}

std::vector<std::pair<ElementAddress, double>> ElementStore::saved() const {
  std::vector<std::pair<std::uint64_t, double>> found;
  const auto note = [&](ElementId id, std::size_t place, double value, bool assigned) {
    const bool changed = assigned || value != default_value(id, place);
    if (changed && element_info(id).access == bytecode::ElementAccess::kSaved) found.emplace_back(key(id, place), value);
  };
  for (std::size_t e = 0; e < rows_.size(); ++e) {
    const auto id = static_cast<ElementId>(e);
    const std::size_t size = rows_[e].dense ? static_cast<std::size_t>(element_info(id).size()) : 0;
    for (std::size_t place = 0; place < size; ++place) note(id, place, values_[rows_[e].base + place], assigned_[rows_[e].base + place]);
  }
  for (const auto& [where, value] : sparse_) note(static_cast<ElementId>(where >> 40), where & 0xff'ffff'ffffu, value, true);
  std::sort(found.begin(), found.end());
  std::vector<std::pair<ElementAddress, double>> result;
  for (const auto& [where, value] : found) result.emplace_back(address_at(static_cast<ElementId>(where >> 40), where & 0xff'ffff'ffffu), value);
  return result;
}

double encode_address(const ElementAddress& a) { return bytecode::address_of(a.id, place_of(a)); }

bool decode_address(double number, DecodedAddress& address) {
  if (!(number >= bytecode::kAddressOfElement && number < 0x1p53) || number != std::floor(number)) return false;
  const auto bits = static_cast<std::uint64_t>(number);
  const std::uint64_t element = (bits >> 40) - 1, place = bits >> 16 & 0xffffffu;
  if (element >= static_cast<std::uint64_t>(ElementId::kCount)) return false;
  const auto id = static_cast<ElementId>(element);
  const bool inside = place < static_cast<std::uint64_t>(element_info(id).size());
  if (!inside && element_info(id).index_count() > 0) return false;
  // a place without indices goes on for as far as offsets reach: Sys.pushm+$8000000
  address = inside ? DecodedAddress{address_at(id, place), bits & 0xffffu} : DecodedAddress{address_at(id, 0), bits & 0xff'ffff'ffffu};
  return true;
}

bool decode_address(double number, ElementAddress& address) {
  DecodedAddress decoded;
  if (!decode_address(number, decoded) || decoded.offset != 0) return false;
  address = decoded.element;
  return true;
}

std::string element_text(const ElementAddress& address) {
  std::string text(element_info(address.id).name);
  int next = 0;
  for (std::size_t at = text.find("[]"); at != std::string::npos; at = text.find("[]", at)) {
    const std::string index = std::to_string(address.index[next++]);
    text.insert(at + 1, index);
    at += index.size() + 2;
  }
  return text;
}

}  // namespace pmac::runtime
