#include "runtime/tool/load.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

#include <unistd.h>

#include "compiler/bytecode/object_file.h"
#include "compiler/project/project.h"
#include "compiler/source/format.h"

namespace pmac::tool {
namespace {

std::span<const std::uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

bool use_color() { return isatty(STDERR_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr; }

/// The first error of a text, as the answer to a command.
std::string first_error(const compiler::Session& session, const std::vector<source::Diagnostic>& diagnostics, ErrorPlace* place) {
  const auto is_error = [](const source::Diagnostic& d) { return d.severity == source::Severity::kError; };
  const auto error = std::find_if(diagnostics.begin(), diagnostics.end(), is_error);
  if (error == diagnostics.end()) return {};
  if (place && error->span.valid()) {
    const source::LineColumn at = session.sources().line_column(error->span.file, error->span.begin);
    place->line = at.line + place->before;
    place->column = at.column;
  }
  return error->message;
}

/// The lines of a text that began behind other lines of its file.
void shift_lines(bytecode::Module& module, int by) {
  const auto shift = [by](bytecode::SourceLine& source) {
    if (source.line > 0) source.line += by;
  };
  for (bytecode::Program& program : module.programs) {
    shift(program.source);
    for (bytecode::LineEntry& entry : program.lines) shift(entry.source);
  }
}

int compile_pending(std::vector<compiler::InputFile>& pending, compiler::Session& session, runtime::Machine& machine) {
  if (pending.empty()) return kExitOk;
  auto module = session.compile(pending);
  pending.clear();
  const bool errors = print_diagnostics(session);
  if (!module || errors) return kExitProgramError;
  if (const std::string reason = bytecode::verify(*module); !reason.empty()) {
    std::fprintf(stderr, "pmac-run: internal error: the compiler produced an invalid module: %s\n", reason.c_str());
    return kExitInternal;
  }
  machine.load(std::move(*module));
  return kExitOk;
}

/// The files of a project take its place; what is wrong inside of it is reported when they are compiled.
int add_project(const std::string& name, compiler::Session& session, std::vector<compiler::InputFile>& pending) {
  try {
    compiler::project::Project project = compiler::project::read_project(name, session.sources(), session.diagnostics());
    if (pending.empty()) session.set_variable_starts(project.starts);
    for (compiler::InputFile& file : project.files) pending.push_back(std::move(file));
    return kExitOk;
  } catch (const compiler::project::Unreadable& problem) {
    std::fprintf(stderr, "pmac-run: %s\n", problem.what());
    return kExitUsage;
  }
}

int load_object(const std::string& name, const std::string& bytes, compiler::Session& session, runtime::Machine& machine) {
  auto loaded = bytecode::load(as_bytes(bytes));
  if (const auto* error = std::get_if<bytecode::ObjectFileError>(&loaded)) {
    std::fprintf(stderr, "pmac-run: %s: %s\n", name.c_str(), error->message.c_str());
    return kExitUsage;
  }
  auto& module = std::get<bytecode::Module>(loaded);
  session.adopt(module);
  machine.load(std::move(module));
  return kExitOk;
}

}  // namespace

bool print_diagnostics(compiler::Session& session) {
  const bool errors = session.diagnostics().has_errors();
  for (const source::Diagnostic& diagnostic : session.diagnostics().take())
    std::fputs(source::format_text(session.sources(), diagnostic, use_color()).c_str(), stderr);
  return errors;
}

bool read_file(const std::string& name, std::string& bytes) {
  std::error_code error;
  if (std::filesystem::is_directory(name, error)) {
    errno = EISDIR;
    return false;
  }
  const auto size = std::filesystem::file_size(name, error);
  if (!error && size > kLongestInput) {
    errno = EFBIG;
    return false;
  }
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(name.c_str(), "rb"), std::fclose);
  if (!file) return false;
  char buffer[65536];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, file.get())) > 0;) {
    bytes.append(buffer, n);
    if (bytes.size() <= kLongestInput) continue;
    errno = EFBIG;
    return false;
  }
  return std::ferror(file.get()) == 0;
}

int load_files(const RunOptions& options, compiler::Session& session, runtime::Machine& machine) {
  std::vector<compiler::InputFile> pending;
  for (const std::string& name : options.files) {
    if (compiler::project::is_project(name)) {
      if (const int code = add_project(name, session, pending); code != kExitOk) return code;
      continue;
    }
    std::string text;
    if (!read_file(name, text)) {
      std::fprintf(stderr, "pmac-run: cannot read %s: %s\n", name.c_str(), std::strerror(errno));
      return kExitUsage;
    }
    const bool object = bytecode::looks_like_object_file(as_bytes(text)) || name.ends_with(".pmx");
    if (!object) {
      pending.push_back({name, std::move(text)});
      continue;
    }
    if (const int code = compile_pending(pending, session, machine); code != kExitOk) return code;
    if (const int code = load_object(name, text, session, machine); code != kExitOk) return code;
  }
  return compile_pending(pending, session, machine);
}

std::function<std::optional<std::string>(const std::string& file, int line)> source_lines(const compiler::Session& session) {
  return [&sources = session.sources()](const std::string& file, int line) -> std::optional<std::string> {
    for (std::size_t i = sources.file_count(); i-- > 0;) {
      const source::File& candidate = sources.file(static_cast<std::int32_t>(i));
      if (candidate.name != file || line < 1 || static_cast<std::size_t>(line) > candidate.line_starts.size()) continue;
      return std::string(sources.line_text(static_cast<std::int32_t>(i), line));
    }
    return std::nullopt;
  };
}

runtime::OnlineCompiler online_compiler(compiler::Session& session, ErrorPlace* place) {
  return [&session, place](std::string_view text, std::string_view name) -> std::variant<bytecode::Module, std::string> {
    auto module = session.compile_online(text, name);
    const std::string reason = first_error(session, session.diagnostics().take(), place);
    if (!reason.empty()) return reason;
    if (!module) return std::string("error #20: ILLEGAL CMD");
    if (const std::string invalid = bytecode::verify(*module); !invalid.empty()) return "internal error: " + invalid;
    if (place && place->before > 0) shift_lines(*module, place->before);
    return std::move(*module);
  };
}

}  // namespace pmac::tool
