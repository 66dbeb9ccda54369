#include "compiler/bytecode/module_text.h"
#include "compiler/bytecode/element.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace pmac::bytecode {

std::string number_text(double value) {
  std::array<char, 40> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

std::string variable_class_name(VariableClass variable_class) {
  static constexpr std::array<const char*, 9> kNames = {"P", "Q", "M", "I", "L", "R", "C", "D", "element"};
  const auto index = static_cast<std::size_t>(variable_class);
  return index < kNames.size() ? kNames[index] : "?";
}

int variable_class_count(VariableClass variable_class) {
  switch (variable_class) {
    case VariableClass::kP: return kPCount;
    case VariableClass::kQ: return kQCount;
    case VariableClass::kM: return kMCount;
    case VariableClass::kI: return kICount;
    case VariableClass::kL: return kLCount;
    case VariableClass::kR: return kMaxOutgoing;
    case VariableClass::kC: return kCCount;
    case VariableClass::kD: return kDCount;
    case VariableClass::kElement: break;
  }
  return 0;
}

std::string register_name(const Program& program, unsigned reg) {
  if (reg < program.local_count) return "L" + std::to_string(reg);
  if (reg < program.frame_size) return "t" + std::to_string(reg - program.local_count);
  return "R" + std::to_string(reg - program.frame_size);
}

std::string element_text(const Program& program, const ElementRef& ref) {
  std::string text;
  int index = 0;
  for (const char ch : element_info(ref.id).name) {
    text += ch;
    if (ch != '[' || index >= kMaxElementIndices) continue;
    const ElementRef::Index& value = ref.index[index++];
    text += value.is_register ? register_name(program, value.value) : std::to_string(value.value);
  }
  return ref.address ? text + ".a" : text;
}

std::string program_title(const Program& program) {
  std::string title(program_kind_name(program.kind));
  title += ' ' + std::to_string(program.number);
  if (!program.name.empty()) title += " (" + program.name + ")";
  return title;
}

std::string quoted(const std::string& text) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string result = "\"";
  for (const char ch : text) {
    const auto byte = static_cast<unsigned char>(ch);
    if (ch == '"' || ch == '\\') result += '\\';
    if (byte >= 0x20 && byte != 0x7f) {
      result += ch;
    } else {
      result += std::string("\\x") + kHex[byte >> 4] + kHex[byte & 15];
    }
  }
  return result + '"';
}

SourceLine source_of(const Program& program, std::uint32_t pc) {
  const auto after = std::upper_bound(program.lines.begin(), program.lines.end(), pc,
                                      [](std::uint32_t at, const LineEntry& entry) { return at < entry.pc; });
  return after == program.lines.begin() ? SourceLine{} : std::prev(after)->source;
}

const LabelEntry* find_label(const Program& program, std::int64_t number) {
  const auto found = std::lower_bound(program.labels.begin(), program.labels.end(), number,
                                      [](const LabelEntry& label, std::int64_t wanted) { return label.number < wanted; });
  return found != program.labels.end() && found->number == number ? &*found : nullptr;
}

std::string to_string(const Module& module, SourceLine source) {
  const bool has_file = source.file >= 0 && static_cast<std::size_t>(source.file) < module.files.size();
  if (!has_file) return "<no source>";
  const std::string& file = module.files[static_cast<std::size_t>(source.file)];
  return source.line > 0 ? file + ":" + std::to_string(source.line) : file;
}

}  // namespace pmac::bytecode
