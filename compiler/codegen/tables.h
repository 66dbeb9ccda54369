// The shared tables of a module under construction; equal entries are stored once. Private to this folder.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>

#include "compiler/bytecode/bytecode.h"
#include "compiler/source/source.h"

namespace pmac::compiler::codegen {

class Tables {
 public:
  Tables(bytecode::Module& module, const source::SourceManager& sources) : module_(module), sources_(sources) {}

  std::int32_t constant(double value);
  std::int32_t string(const std::string& text);
  std::int32_t element(const bytecode::ElementRef& ref);
  std::int32_t sync_target(const bytecode::SyncTarget& target);
  std::int32_t call_target(const bytecode::CallTarget& target);
  bytecode::SourceLine line(const source::Span& span);
  bytecode::Module& module() { return module_; }

 private:
  bytecode::Module& module_;
  const source::SourceManager& sources_;
  std::unordered_map<std::uint64_t, std::int32_t> constants_;  // by bits: 0.0 and -0.0 differ
  std::map<std::string, std::int32_t> strings_, elements_;
  std::map<std::string, std::int32_t, std::less<>> files_;      // name as messages show it -> index in the module
};

}  // namespace pmac::compiler::codegen
