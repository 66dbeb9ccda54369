#include "compiler/codegen/tables.h"

#include <algorithm>
#include <bit>

namespace pmac::compiler::codegen {
namespace {

template <class Entry>
std::int32_t index_in(std::vector<Entry>& table, const Entry& entry) {
  const auto found = std::find(table.begin(), table.end(), entry);
  const auto index = static_cast<std::int32_t>(found - table.begin());
  if (found == table.end()) table.push_back(entry);
  return index;
}

}  // namespace

std::int32_t Tables::constant(double value) {
  const auto [at, fresh] = constants_.emplace(std::bit_cast<std::uint64_t>(value), static_cast<std::int32_t>(module_.constants.size()));
  if (fresh) module_.constants.push_back(value);
  return at->second;
}

std::int32_t Tables::string(const std::string& text) {
  const auto [at, fresh] = strings_.emplace(text, static_cast<std::int32_t>(module_.strings.size()));
  if (fresh) module_.strings.push_back(text);
  return at->second;
}

std::int32_t Tables::element(const bytecode::ElementRef& ref) {
  std::string key = std::to_string(static_cast<int>(ref.id)) + (ref.address ? "a" : "");
  for (const auto& index : ref.index) key += (index.is_register ? "r" : "i") + std::to_string(index.value);
  const auto [at, fresh] = elements_.emplace(std::move(key), static_cast<std::int32_t>(module_.element_refs.size()));
  if (fresh) module_.element_refs.push_back(ref);
  return at->second;
}

std::int32_t Tables::sync_target(const bytecode::SyncTarget& target) { return index_in(module_.sync_targets, target); }
std::int32_t Tables::call_target(const bytecode::CallTarget& target) { return index_in(module_.call_targets, target); }

bytecode::SourceLine Tables::line(const source::Span& span) {
  if (!span.valid()) return {};
  const source::Place place = sources_.place(span);
  auto at = files_.find(place.file);
  if (at == files_.end()) {
    at = files_.emplace(place.file, static_cast<std::int32_t>(module_.files.size())).first;
    module_.files.emplace_back(place.file);
  }
  return {at->second, place.line, place.column};
}

}  // namespace pmac::compiler::codegen
