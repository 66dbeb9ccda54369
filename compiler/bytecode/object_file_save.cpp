// Writes a module as chunks. The order of writing is fixed, so that equal modules give equal bytes.
#include <algorithm>

#include "compiler/bytecode/chunk.h"
#include "compiler/bytecode/object_file.h"
#include "object_file_generated.h"

namespace pmac::bytecode {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

class Writer {
 public:
  explicit Writer(const ByteSink& sink) : sink_(sink) {}

  std::uint32_t chunk_count = 0;

  void header() {
    std::vector<std::uint8_t> bytes;
    append_header(bytes);
    sink_(bytes);
  }

  /// make_body fills the builder and returns the offset of a table of the union's type.
  template <class MakeBody>
  void add(file::Body type, MakeBody make_body) {
    builder_.Clear();
    const auto body = make_body(builder_);
    builder_.Finish(file::CreateChunk(builder_, type, body.Union()));
    const std::span<const std::uint8_t> payload(builder_.GetBufferPointer(), builder_.GetSize());
    sink_(chunk_header(payload));
    sink_(payload);
    ++chunk_count;
  }

 private:
  const ByteSink& sink_;
  FlatBufferBuilder builder_;
};

file::SourceLine pack(const SourceLine& source) { return {source.file, source.line, source.column}; }
file::Instruction pack(const Instruction& in) { return {static_cast<std::uint16_t>(in.op), in.a, in.imm}; }
file::LineEntry pack(const LineEntry& entry) { return {entry.pc, pack(entry.source)}; }
file::LabelEntry pack(const LabelEntry& entry) { return {entry.number, entry.pc}; }
file::CallTarget pack(const CallTarget& target) { return {target.label, target.subprogram}; }
file::AxisTerm pack(const AxisTerm& term) { return {term.coefficient_mu_per_uu, term.axis}; }
file::ElementIndex pack(const ElementRef::Index& index) { return {index.value, index.is_register}; }
file::ElementRef pack(const ElementRef& ref) {
  return {pack(ref.index[0]), pack(ref.index[1]), pack(ref.index[2]), static_cast<std::uint16_t>(ref.id), ref.address};
}
file::SyncTarget pack(const SyncTarget& target) {
  return {target.number, target.element, target.number_register, static_cast<std::uint8_t>(target.variable_class),
          static_cast<std::uint8_t>(target.op)};
}

/// The entries of one block as a vector of FlatBuffers structs.
template <class T>
auto pack_all(FlatBufferBuilder& builder, std::span<const T> entries) {
  std::vector<decltype(pack(entries[0]))> packed;
  packed.reserve(entries.size());
  for (const T& entry : entries) packed.push_back(pack(entry));
  return builder.CreateVectorOfStructs(packed);
}

/// Calls use(block) for the entries in blocks of at most kChunkEntries and, where they hold text, about kChunkTextBytes.
template <class T, class TextSize, class Use>
void in_blocks(const std::vector<T>& entries, TextSize text_size, Use use) {
  std::size_t first = 0;
  std::size_t text = 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    text += text_size(entries[i]);
    if (i + 1 - first < kChunkEntries && text < kChunkTextBytes && i + 1 < entries.size()) continue;
    use(std::span<const T>(entries).subspan(first, i + 1 - first));
    first = i + 1;
    text = 0;
  }
}

constexpr auto kNoText = [](const auto&) { return std::size_t{0}; };
constexpr auto kStringSize = [](const std::string& text) { return text.size(); };

Offset<flatbuffers::Vector<Offset<flatbuffers::String>>> pack_texts(FlatBufferBuilder& builder,
                                                                    std::span<const std::string> texts) {
  std::vector<Offset<flatbuffers::String>> offsets;
  for (const std::string& text : texts) offsets.push_back(builder.CreateString(text));
  return builder.CreateVector(offsets);
}

Offset<file::AxisDefinition> pack_table(FlatBufferBuilder& builder, const AxisDefinition& definition) {
  const auto terms = pack_all(builder, std::span<const AxisTerm>(definition.terms));
  return file::CreateAxisDefinition(builder, definition.motor, static_cast<std::uint8_t>(definition.kind),
                                    definition.spindle, definition.offset_mu, terms);
}

Offset<file::PointerDefinition> pack_table(FlatBufferBuilder& builder, const PointerDefinition& definition) {
  const auto name = builder.CreateString(definition.name);
  return file::CreatePointerDefinition(builder, definition.first_m, definition.last_m,
                                       static_cast<std::uint8_t>(definition.kind), definition.is_signed,
                                       definition.address, definition.start_bit, definition.width,
                                       definition.has_field, definition.element, name);
}

Offset<file::Symbol> pack_table(FlatBufferBuilder& builder, const Symbol& symbol) {
  const auto name = builder.CreateString(symbol.name);
  const auto text = builder.CreateString(symbol.text);
  return file::CreateSymbol(builder, static_cast<std::uint8_t>(symbol.kind), name, symbol.number, symbol.size, text);
}

template <class T>
auto pack_tables(FlatBufferBuilder& builder, std::span<const T> entries) {
  std::vector<decltype(pack_table(builder, entries[0]))> offsets;
  for (const T& entry : entries) offsets.push_back(pack_table(builder, entry));
  return builder.CreateVector(offsets);
}

void save_names(Writer& writer, const Module& module) {
  in_blocks(module.files, kStringSize, [&](std::span<const std::string> block) {
    writer.add(file::Body::Names, [&](auto& b) { return file::CreateNames(b, pack_texts(b, block)); });
  });
  in_blocks(module.strings, kStringSize, [&](std::span<const std::string> block) {
    writer.add(file::Body::Names, [&](auto& b) { return file::CreateNames(b, 0, pack_texts(b, block)); });
  });
}

void save_constants(Writer& writer, const Module& module) {
  in_blocks(module.constants, kNoText, [&](std::span<const double> block) {
    writer.add(file::Body::Constants,
               [&](auto& b) { return file::CreateConstants(b, b.CreateVector(block.data(), block.size())); });
  });
}

void save_references(Writer& writer, const Module& module) {
  in_blocks(module.element_refs, kNoText, [&](auto block) {
    writer.add(file::Body::References, [&](auto& b) { return file::CreateReferences(b, pack_all(b, block)); });
  });
  in_blocks(module.sync_targets, kNoText, [&](auto block) {
    writer.add(file::Body::References, [&](auto& b) { return file::CreateReferences(b, 0, pack_all(b, block)); });
  });
  in_blocks(module.call_targets, kNoText, [&](auto block) {
    writer.add(file::Body::References, [&](auto& b) { return file::CreateReferences(b, 0, 0, pack_all(b, block)); });
  });
}

void save_definitions(Writer& writer, const Module& module) {
  in_blocks(module.axis_definitions, kNoText, [&](auto block) {
    writer.add(file::Body::Definitions, [&](auto& b) { return file::CreateDefinitions(b, pack_tables(b, block)); });
  });
  const auto name_size = [](const PointerDefinition& definition) { return definition.name.size(); };
  in_blocks(module.pointer_definitions, name_size, [&](auto block) {
    writer.add(file::Body::Definitions, [&](auto& b) { return file::CreateDefinitions(b, 0, pack_tables(b, block)); });
  });
}

void save_symbols(Writer& writer, const Module& module) {
  const auto text_size = [](const Symbol& symbol) { return symbol.name.size() + symbol.text.size(); };
  in_blocks(module.symbols, text_size, [&](auto block) {
    writer.add(file::Body::Symbols, [&](auto& b) { return file::CreateSymbols(b, pack_tables(b, block)); });
  });
}

void save_program(Writer& writer, const Program& program) {
  writer.add(file::Body::Program, [&](auto& b) {
    const file::SourceLine source = pack(program.source);
    return file::CreateProgram(b, static_cast<std::uint8_t>(program.kind), program.number,
                               b.CreateString(program.name), program.local_count, program.frame_size,
                               program.outgoing_count, &source);
  });
  in_blocks(program.code, kNoText, [&](auto block) {
    writer.add(file::Body::Code, [&](auto& b) { return file::CreateCode(b, pack_all(b, block)); });
  });
  in_blocks(program.lines, kNoText, [&](auto block) {
    writer.add(file::Body::Lines, [&](auto& b) { return file::CreateLines(b, pack_all(b, block)); });
  });
  in_blocks(program.labels, kNoText, [&](auto block) {
    writer.add(file::Body::Labels, [&](auto& b) { return file::CreateLabels(b, pack_all(b, block)); });
  });
}

void save_move_run(Writer& writer, const MoveRun& run) {
  writer.add(file::Body::MoveRun, [&](auto& b) {
    return file::CreateMoveRun(b, run.file, b.CreateVector(run.first_word), b.CreateVector(run.words), b.CreateVector(run.values), b.CreateVector(run.line),
                               b.CreateVector(run.column));
  });
}

void save_end(Writer& writer, const Module& module) {
  const std::uint32_t before = writer.chunk_count;
  writer.add(file::Body::End, [&](auto& b) { return file::CreateEnd(b, before, b.CreateVector(module.load_order)); });
}

}  // namespace

void save(const Module& module, const ByteSink& sink) {
  Writer writer(sink);
  writer.header();
  save_names(writer, module);
  save_constants(writer, module);
  save_references(writer, module);
  save_definitions(writer, module);
  save_symbols(writer, module);
  for (const MoveRun& run : module.move_runs) save_move_run(writer, run);
  for (const Program& program : module.programs) save_program(writer, program);
  save_end(writer, module);
}

std::vector<std::uint8_t> save(const Module& module) {
  std::vector<std::uint8_t> bytes;
  save(module, [&](std::span<const std::uint8_t> piece) { bytes.insert(bytes.end(), piece.begin(), piece.end()); });
  return bytes;
}

}  // namespace pmac::bytecode
