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

struct Options {
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

  /// Compiles a line of on-line commands (also: open ... close) as one load script. `name` is shown as the file,
  /// for example "-e" or "stdin". coord, motor: what & and # address when the text begins.
  std::optional<bytecode::Module> compile_online(std::string_view text, std::string_view name);

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

/// The load stream as the vendor's loader hands it to its C pre-processor, for -E. Compiles to the same. Empty where there are errors.
std::string emit_preprocessed(Session& session, const std::vector<InputFile>& files);

}  // namespace pmac::compiler
