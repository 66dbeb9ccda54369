// Reads an object file into a module and refuses whatever is not exactly what save() writes for a safe module. Memory
// stays in proportion to the bytes present: every vector and text of a chunk is counted against the size of the chunk,
// since offsets of a hostile file may let many entries share the same bytes.
#include <cstdint>
#include <cstring>

#include "compiler/bytecode/chunk.h"
#include "compiler/bytecode/object_file.h"
#include "object_file_generated.h"

namespace pmac::bytecode {
namespace {

/// Thrown inside this file for contents that are well-formed but wrong.
struct BadContents { const char* why; };

SourceLine unpack(const file::SourceLine& source) { return {source.file(), source.line(), source.column()}; }
Instruction unpack(const file::Instruction& in) { return {static_cast<Opcode>(in.op()), in.a(), in.imm()}; }
LineEntry unpack(const file::LineEntry& entry) { return {entry.pc(), unpack(entry.source())}; }
LabelEntry unpack(const file::LabelEntry& entry) { return {entry.number(), entry.pc()}; }
CallTarget unpack(const file::CallTarget& target) { return {target.subprogram(), target.label()}; }
AxisTerm unpack(const file::AxisTerm& term) { return {term.axis(), term.coefficient_mu_per_uu()}; }
ElementRef::Index unpack(const file::ElementIndex& index) { return {index.is_register(), index.value()}; }
ElementRef unpack(const file::ElementRef& ref) {
  ElementRef result;
  result.id = static_cast<ElementId>(ref.id());
  result.index[0] = unpack(ref.index0());
  result.index[1] = unpack(ref.index1());
  result.index[2] = unpack(ref.index2());
  result.address = ref.address();
  return result;
}
SyncTarget unpack(const file::SyncTarget& target) {
  return {static_cast<VariableClass>(target.variable_class()), target.number(), target.number_register(),
          target.element(), static_cast<AssignOp>(target.op())};
}

/// One chunk being read into the module. left_: bytes of text and entries that the chunk can still honestly hold.
class ChunkContents {
 public:
  ChunkContents(Module& module, std::size_t payload_size) : module_(module), left_(payload_size) {}

  /// True when the chunk was the End.
  bool read(const file::Chunk& chunk, std::uint32_t chunks_before);

 private:
  void read_names(const file::Names& names);
  void read_constants(const file::Constants& constants);
  void read_references(const file::References& references);
  void read_definitions(const file::Definitions& definitions);
  void read_symbols(const file::Symbols& symbols);
  void read_program(const file::Program& program);
  void read_move_run(const file::MoveRun& source);
  void read_end(const file::End& end, std::uint32_t chunks_before);
  Program& open_program();

  void spend(std::size_t bytes) {
    if (bytes > left_) throw BadContents{"holds shared contents"};
    left_ -= bytes;
  }
  std::string text(const flatbuffers::String* source) {
    if (source == nullptr) return {};
    spend(source->size());
    return source->str();
  }
  /// FlatBuffers looks whether a vector begins where a number may, not whether its entries do.
  template <class Vector>
  static void require_aligned(const Vector& entries, std::size_t alignment) {
    if (reinterpret_cast<std::uintptr_t>(entries.Data()) % alignment != 0) throw BadContents{"holds a table in a wrong place"};
  }
  template <class Vector>
  std::size_t count(const Vector* entries) {
    if (entries == nullptr) return 0;
    if (entries->size() > kChunkEntries) throw BadContents{"holds an oversized table"};
    spend(entries->size() * sizeof(std::uint32_t));
    return entries->size();
  }
  template <class T>
  std::vector<T> column(const flatbuffers::Vector<T>* source) {
    if (source == nullptr) return {};
    if (source->size() > kMaxRunWords) throw BadContents{"holds an oversized table"};
    spend(source->size() * sizeof(T));
    require_aligned(*source, alignof(T));
    std::vector<T> result(source->size());
    for (flatbuffers::uoffset_t i = 0; i < source->size(); ++i) result[i] = source->Get(i);
    return result;
  }
  template <class Struct, class T>
  void append(const flatbuffers::Vector<const Struct*>* source, std::vector<T>& to) {
    const std::size_t entries = count(source);
    if (entries > 0) require_aligned(*source, alignof(Struct));
    for (std::size_t i = 0; i < entries; ++i) to.push_back(unpack(*source->Get(static_cast<flatbuffers::uoffset_t>(i))));
  }

  Module& module_;
  std::size_t left_;
};

void ChunkContents::read_names(const file::Names& names) {
  count(names.files());
  if (names.files()) for (const auto* name : *names.files()) module_.files.push_back(text(name));
  count(names.strings());
  if (names.strings()) for (const auto* string : *names.strings()) module_.strings.push_back(text(string));
}

void ChunkContents::read_constants(const file::Constants& constants) {
  if (count(constants.values()) == 0) return;
  require_aligned(*constants.values(), alignof(double));
  for (const double value : *constants.values()) module_.constants.push_back(value);
}

void ChunkContents::read_references(const file::References& references) {
  append(references.elements(), module_.element_refs);
  append(references.syncs(), module_.sync_targets);
  append(references.calls(), module_.call_targets);
}

void ChunkContents::read_definitions(const file::Definitions& definitions) {
  count(definitions.axes());
  if (definitions.axes()) for (const file::AxisDefinition* source : *definitions.axes()) {
    AxisDefinition& axis = module_.axis_definitions.emplace_back();
    axis.motor = source->motor();
    axis.kind = static_cast<AxisDefinitionKind>(source->kind());
    axis.spindle = source->spindle();
    axis.offset_mu = source->offset_mu();
    append(source->terms(), axis.terms);
  }
  count(definitions.pointers());
  if (definitions.pointers()) for (const file::PointerDefinition* source : *definitions.pointers()) {
    module_.pointer_definitions.push_back({source->first_m(), source->last_m(), static_cast<PointerKind>(source->kind()),
                                           source->is_signed(), source->address(), source->start_bit(), source->width(),
                                           source->has_field(), source->element(), text(source->name())});
  }
}

void ChunkContents::read_symbols(const file::Symbols& symbols) {
  count(symbols.symbols());
  if (symbols.symbols()) for (const file::Symbol* source : *symbols.symbols()) {
    module_.symbols.push_back({static_cast<SymbolKind>(source->kind()), text(source->name()), source->number(),
                               source->size(), text(source->text())});
  }
}

void ChunkContents::read_program(const file::Program& source) {
  Program& program = module_.programs.emplace_back();
  program.kind = static_cast<ProgramKind>(source.kind());
  program.number = source.number();
  program.name = text(source.name());
  program.local_count = source.local_count();
  program.frame_size = source.frame_size();
  program.outgoing_count = source.outgoing_count();
  if (source.source() != nullptr) program.source = unpack(*source.source());
}

void ChunkContents::read_move_run(const file::MoveRun& source) {
  MoveRun& run = module_.move_runs.emplace_back();
  run.file = source.file();
  run.first_word = column(source.first_word());
  run.words = column(source.words());
  run.values = column(source.values());
  run.line = column(source.line());
  run.column = column(source.column());
}

Program& ChunkContents::open_program() {
  if (module_.programs.empty()) throw BadContents{"holds code outside a program"};
  return module_.programs.back();
}

void ChunkContents::read_end(const file::End& end, std::uint32_t chunks_before) {
  if (end.chunks() != chunks_before) throw BadContents{"lacks a chunk"};
  if (end.load_order()) module_.load_order.assign(end.load_order()->begin(), end.load_order()->end());
}

bool ChunkContents::read(const file::Chunk& chunk, std::uint32_t chunks_before) {
  switch (chunk.body_type()) {
    case file::Body::Names: read_names(*chunk.body_as_Names()); return false;
    case file::Body::Constants: read_constants(*chunk.body_as_Constants()); return false;
    case file::Body::References: read_references(*chunk.body_as_References()); return false;
    case file::Body::Definitions: read_definitions(*chunk.body_as_Definitions()); return false;
    case file::Body::Symbols: read_symbols(*chunk.body_as_Symbols()); return false;
    case file::Body::Program: read_program(*chunk.body_as_Program()); return false;
    case file::Body::Code: append(chunk.body_as_Code()->instructions(), open_program().code); return false;
    case file::Body::Lines: append(chunk.body_as_Lines()->lines(), open_program().lines); return false;
    case file::Body::Labels: append(chunk.body_as_Labels()->labels(), open_program().labels); return false;
    case file::Body::End: read_end(*chunk.body_as_End(), chunks_before); return true;
    case file::Body::MoveRun: read_move_run(*chunk.body_as_MoveRun()); return false;
    case file::Body::NONE: break;
  }
  throw BadContents{"holds an unknown chunk"};
}

/// The chunk in aligned memory if FlatBuffers finds it well-formed, or nullptr.
const file::Chunk* verified_chunk(std::span<const std::uint8_t> payload, std::vector<std::uint64_t>& aligned) {
  if (payload.empty()) return nullptr;
  aligned.assign(payload.size() / 8 + 1, 0);
  std::memcpy(aligned.data(), payload.data(), payload.size());
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(aligned.data());
  flatbuffers::Verifier verifier(bytes, payload.size());
  if (!file::VerifyChunkBuffer(verifier)) return nullptr;
  const file::Chunk* chunk = file::GetChunk(bytes);
  return chunk->body() == nullptr ? nullptr : chunk;
}

/// Reads chunks up to and with the End. Returns why not, or empty.
std::string read_chunks(ChunkReader& reader, Module& module) {
  std::vector<std::uint64_t> aligned;
  bool ended = false;
  for (std::uint32_t chunks = 0; !ended; ++chunks) {
    const auto payload = reader.next();
    if (!payload) return reader.error();
    const file::Chunk* chunk = verified_chunk(*payload, aligned);
    if (chunk == nullptr) return "object file is damaged (chunk " + std::to_string(chunks) + ")";
    ended = ChunkContents(module, payload->size()).read(*chunk, chunks);
  }
  return reader.at_end() ? std::string() : std::string("object file has extra bytes after its end");
}

}  // namespace

bool looks_like_object_file(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 4 && std::equal(kMagic, kMagic + std::min(bytes.size(), sizeof kMagic), bytes.begin());
}

std::variant<Module, ObjectFileError> load(std::span<const std::uint8_t> bytes) {
  ChunkReader reader(bytes);
  if (std::string why = reader.read_header(); !why.empty()) return ObjectFileError{std::move(why)};
  Module module;
  try {
    if (std::string why = read_chunks(reader, module); !why.empty()) return ObjectFileError{std::move(why)};
  } catch (const BadContents& bad) {
    return ObjectFileError{std::string("object file ") + bad.why};
  }
  if (std::string why = verify(module); !why.empty()) return ObjectFileError{"object file is not safe to run: " + why};
  return module;
}

}  // namespace pmac::bytecode
