// The text forms of the compiler's hops.
#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "compiler/compiler.h"
#include "compiler/session_state.h"

namespace pmac::compiler {
namespace {

std::string element_indices(const bytecode::ElementInfo& info) {
  std::string text;
  for (int i = 0; i < info.index_count(); ++i) text += fmt::format("{}0..{}", i ? " " : "", info.index_counts[i] - 1);
  return text.empty() ? "-" : text;
}

std::string element_default(const bytecode::ElementInfo& info) {
  if (info.type == bytecode::ElementType::kMask) return fmt::format("${:x}", static_cast<std::uint64_t>(info.default_value));
  return info.default_value == bytecode::kPushm ? "Sys.pushm" : fmt::format("{}", info.default_value);
}

}  // namespace

std::string emit_tokens(Session& session, const InputFile& file) {
  if (session.state().options.dialect == Dialect::kAcr1000) return session.state().cards.tokens({file.name, file.text});
  return session.state().frontend.tokens(file.name, file.text);
}
std::string emit_tree(Session& session, const InputFile& file) {
  if (session.state().options.dialect == Dialect::kAcr1000) return session.state().cards.tree({file.name, file.text});
  return session.state().frontend.tree(file.name, file.text);
}

std::string emit_ir(Session& session, const std::vector<InputFile>& files) {
  std::string out;
  for (const ir::Unit& unit : session.state().analyse(files, false)) out += ir::print(unit);
  return out;
}

std::string emit_elements() {
  std::string out;
  for (std::uint16_t i = 0; i < static_cast<std::uint16_t>(bytecode::ElementId::kCount); ++i) {
    const bytecode::ElementInfo& info = bytecode::element_info(static_cast<bytecode::ElementId>(i));
    out += fmt::format("{} | {} | {} | {} | {} | {} | {} | {}\n", info.name, element_indices(info), element_type_name(info.type), element_default(info),
                       info.unit.empty() ? "-" : info.unit, element_access_name(info.access), element_simulation_name(info.simulation),
                       info.meaning.empty() ? "-" : info.meaning);
  }
  return out;
}

}  // namespace pmac::compiler
