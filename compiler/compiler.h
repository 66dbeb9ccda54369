// The way into the compiler. A Session compiles the files of a project in order, as the controller's load stream would see them,
// and later on-line texts with the names that the project declared.
//
//   text -> tokens -> parse tree -> IR -> checked IR -> bytecode
//
//     Session session(options);
//     std::optional<bytecode::Module> module = session.compile(files);
//     print(session.diagnostics());
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "compiler/source/source.h"
#include "compiler/source/warning_control.h"

namespace pmac::compiler {

struct InputFile {
  std::string name;   // as messages show it; the folder of a relative #include
  std::string text;
};

/// First numbers that global, csglobal and ptr names get.
struct VariableStarts { std::int64_t p = 8192, q = 1024, m = 8192; };

/// The language of the files.
enum class Dialect : std::uint8_t { kPowerPmac, kAcr1000 };

/// By the endings of the names: .acr, and .sys beside them, is the ACR1000's. nullopt: the names disagree.
std::optional<Dialect> dialect_of(const std::vector<std::string>& file_names);

struct Options {
  Dialect dialect = Dialect::kPowerPmac;
  std::vector<std::string> card_settings;                    // KEY=VALUE of --card, for the ACR1000
  std::vector<std::string> include_dirs;
  std::vector<std::pair<std::string, std::string>> defines;  // -D name[=text]
  source::WarningOptions warnings;                           // -W...
  int max_include_depth = 64;                                // of #include in #include
  bool plain_move_fast_path = true;                          // false: every line goes through the grammar
};

class Session {
 public:
  explicit Session(Options options = {});
  ~Session();
  Session(Session&&) noexcept;

  /// Compiles the files in order into one module. nullopt when there are errors; diagnostics() has all of them.
  /// Names stay known for later calls.
  std::optional<bytecode::Module> compile(std::vector<InputFile> files);

  /// ACR1000: a line that is typed at a card. RUN, LIST and their kind are left to the card, which keeps the program.
  /// Power PMAC: compiles a line of on-line commands (also: open ... close) as one load script. `name` is shown as the file,
  /// for example "-e" or "stdin". coord, motor: what & and # address when the text begins.
  std::optional<bytecode::Module> compile_online(std::string_view text, std::string_view name);

  /// The numbered lines of an ACR1000 program with the numbers 10, 20, ... and their branches; nothing where that is not possible.
  std::vector<std::string> renumbered(const InputFile& program);

  /// For names that are declared from now on.
  void set_variable_starts(const VariableStarts& starts);

  /// Makes the names of a loaded object file known.
  void adopt(const bytecode::Module& module);

  /// Diagnostics of all calls so far; cleared by take.
  source::Diagnostics& diagnostics();
  const source::SourceManager& sources() const;
  source::SourceManager& sources();

  struct State;
  State& state() { return *state_; }  // for the emit functions below

 private:
  std::unique_ptr<State> state_;
};

/// Stable text forms of the hops, for --emit=. Diagnostics go to the session.
std::string emit_tokens(Session& session, const InputFile& file);
std::string emit_tree(Session& session, const InputFile& file);
std::string emit_ir(Session& session, const std::vector<InputFile>& files);
/// Also where there are errors: of what could be declared.
std::string emit_symbols(Session& session, const std::vector<InputFile>& files);
std::string emit_elements();
/// The cards of ACR1000 files as one Power PMAC program with the same path; what cannot be carried over is a warning. Empty where there
/// are errors.
std::string emit_pmc(Session& session, const std::vector<InputFile>& files);

/// The load stream as the vendor's loader hands it to its C pre-processor, for -E. Compiles to the same. Empty where there are errors.
std::string emit_preprocessed(Session& session, const std::vector<InputFile>& files);

}  // namespace pmac::compiler
