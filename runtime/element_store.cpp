#include "runtime/element_store.h"
#include "compiler/bytecode/element.h"

#include <cmath>
#include <string>

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

/// Elements that are views of a variable array or of the user buffer and hold nothing themselves.
bool is_view(ElementId id) { return id == ElementId::kSysP || id == ElementId::kCoordQ || (id >= ElementId::kSysCdata && id <= ElementId::kSysDdata); }

std::size_t slot_count(ElementId id) {
  if (is_view(id)) return 1;
  std::size_t count = 1;
  for (int n : bytecode::element_info(id).index_counts) count *= n > 0 ? static_cast<std::size_t>(n) : 1;
  return count;
}

}  // namespace

ElementStore::ElementStore() {
  for (int e = 0; e < static_cast<int>(ElementId::kCount); ++e) {
    const auto id = static_cast<ElementId>(e);
    const auto& counts = bytecode::element_info(id).index_counts;
    const auto at_least_1 = [](int n) { return static_cast<std::size_t>(n > 0 ? n : 1); };
    rows_.push_back({values_.size(), at_least_1(counts[1]), at_least_1(counts[2]), is_view(id)});
    values_.insert(values_.end(), slot_count(id), bytecode::element_info(id).default_value);
  }
  assigned_.assign(values_.size(), false);
}

void ElementStore::assign(const ElementAddress& a, double value) {
  const std::size_t s = slot(a.id, a.index[0], a.index[1], a.index[2]);
  values_[s] = value;
  assigned_[s] = true;
}

// Layout of an address number: (element + 1) * 2^32 + index0 * 2^16 + index1; exact in a double.
double encode_address(const ElementAddress& a) {
  return (static_cast<double>(a.id) + 1) * 4294967296.0 + a.index[0] * 65536.0 + a.index[1];
}

bool decode_address(double number, ElementAddress& address) {
  if (!(number >= 4294967296.0) || number != std::floor(number)) return false;
  const double element = std::floor(number / 4294967296.0) - 1;
  if (element >= static_cast<double>(ElementId::kCount)) return false;
  const auto rest = static_cast<std::uint32_t>(number - (element + 1) * 4294967296.0);
  address = {};
  address.id = static_cast<ElementId>(static_cast<int>(element));
  address.index[0] = rest >> 16;
  address.index[1] = rest & 0xffffu;
  const auto& counts = bytecode::element_info(address.id).index_counts;
  for (int i = 0; i < 2; ++i)
    if (address.index[i] >= static_cast<std::uint32_t>(counts[i] > 0 ? counts[i] : 1)) return false;
  return true;
}

std::string element_text(const ElementAddress& address) {
  std::string text(bytecode::element_info(address.id).name);
  int next = 0;
  for (std::size_t at = text.find("[]"); at != std::string::npos; at = text.find("[]", at)) {
    const std::string index = std::to_string(address.index[next++]);
    text.insert(at + 1, index);
    at += index.size() + 2;
  }
  return text;
}

}  // namespace pmac::runtime
