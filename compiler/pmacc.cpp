// pmacc: the compiler as a tool. Exit codes: 0 ok, 1 errors in the user's program, 2 usage or unreadable file, 70 internal error.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "compiler/bytecode/object_file.h"
#include "compiler/compiler.h"
#include "compiler/explain.h"
#include "compiler/source/format.h"

namespace {

using namespace pmac;

constexpr int kOk = 0, kUserError = 1, kUsage = 2, kInternal = 70;

constexpr const char* kExamples = R"(Examples:
  pmacc --check setup.cfg oval.pmc        report what is wrong, write nothing
  pmacc setup.cfg oval.pmc -o oval.pmx    compile the files in this order to an object file
  pmacc --emit=ir oval.pmc                show the program as the compiler understood it
  pmacc --emit=elements                   list the data-structure elements that are known
  pmacc --explain PM4001                  say more about a message)";

struct Arguments {
  std::vector<std::string> files, include_dirs, defines, warnings;
  std::string output, emit, format = "text", color = "auto", explain;
  std::size_t error_limit = 100;
  bool check = false;
};

struct UsageError { std::string message; };

std::string read_file(const std::string& name) {
  if (name == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  std::error_code error;
  if (std::filesystem::is_directory(name, error)) throw UsageError{fmt::format("cannot read {}: it is a directory", name)};
  std::ifstream stream(name, std::ios::binary);
  if (!stream) throw UsageError{fmt::format("cannot read {}", name)};
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) throw UsageError{fmt::format("cannot read {}", name)};
  return text;
}

/// Under another name first, so that a file of the wanted name is always whole.
void write_file(const std::string& name, const std::vector<std::uint8_t>& bytes) {
  const std::string temporary = fmt::format("{}.{}.tmp", name, ::getpid());
  std::ofstream stream(temporary, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(temporary, name, error);
  if (stream && !error) return;
  std::filesystem::remove(temporary, error);
  throw UsageError{fmt::format("cannot write {}", name)};
}

compiler::Options options_of(const Arguments& arguments) {
  compiler::Options options;
  options.include_dirs = arguments.include_dirs;
  for (const std::string& define : arguments.defines) {
    const std::size_t equals = define.find('=');
    options.defines.emplace_back(define.substr(0, equals), equals == std::string::npos ? "" : define.substr(equals + 1));
  }
  const auto has = [&](std::string_view w) { return std::find(arguments.warnings.begin(), arguments.warnings.end(), w) != arguments.warnings.end(); };
  options.extra_warnings = has("extra");
  return options;
}

bool use_color(const Arguments& arguments) {
  if (arguments.color != "auto") return arguments.color == "always";
  return std::getenv("NO_COLOR") == nullptr && ::isatty(STDERR_FILENO) != 0;
}

/// Prints what was found; true if there are errors.
bool report(compiler::Session& session, const Arguments& arguments) {
  const std::size_t dropped = session.diagnostics().dropped_count();
  const std::vector<source::Diagnostic> found = session.diagnostics().take();
  const auto count = [&](source::Severity severity) { return std::count_if(found.begin(), found.end(), [&](const auto& d) { return d.severity == severity; }); };
  if (arguments.format == "json") {
    std::cerr << source::format_json(session.sources(), found);
    return count(source::Severity::kError) > 0;
  }
  for (const source::Diagnostic& diagnostic : found) std::cerr << source::format_text(session.sources(), diagnostic, use_color(arguments));
  if (dropped) std::cerr << fmt::format("{} more error(s) are not shown\n", dropped);
  const auto errors = static_cast<std::size_t>(count(source::Severity::kError)) + dropped;
  const auto warnings = count(source::Severity::kWarning);
  if (errors || warnings) std::cerr << fmt::format("{} error(s), {} warning(s)\n", errors, warnings);
  return errors > 0;
}

int emit(compiler::Session& session, const Arguments& arguments, const std::vector<compiler::InputFile>& files) {
  std::string text;
  if (arguments.emit == "tokens" || arguments.emit == "tree") {
    for (const compiler::InputFile& file : files) text += arguments.emit == "tokens" ? compiler::emit_tokens(session, file) : compiler::emit_tree(session, file);
  } else if (arguments.emit == "ir") {
    text = compiler::emit_ir(session, files);
  } else if (const auto module = session.compile(files)) {
    text = arguments.emit == "bytecode" ? bytecode::disassemble(*module) : compiler::emit_symbols(*module);
  }
  std::cout << text << std::flush;
  if (!std::cout) throw UsageError{"cannot write the output"};
  return report(session, arguments) ? kUserError : kOk;
}

int run(const Arguments& arguments) {
  if (!arguments.explain.empty()) {
    const std::string text = compiler::explain(arguments.explain);
    if (text.empty()) throw UsageError{fmt::format("no message has the code {}", arguments.explain)};
    std::cout << text;
    return kOk;
  }
  if (arguments.emit == "elements") {
    std::cout << compiler::emit_elements();
    return kOk;
  }
  if (arguments.files.empty()) throw UsageError{"no input files; try pmacc --help"};
  std::vector<compiler::InputFile> files;
  for (const std::string& name : arguments.files) files.push_back({name == "-" ? "<stdin>" : name, read_file(name)});
  compiler::Session session(options_of(arguments));
  const bool warnings_are_errors = std::find(arguments.warnings.begin(), arguments.warnings.end(), "error") != arguments.warnings.end();
  session.diagnostics().set_error_limit(arguments.error_limit);
  session.diagnostics().set_warnings_are_errors(warnings_are_errors);
  if (!arguments.emit.empty()) return emit(session, arguments, files);
  const auto module = session.compile(files);
  if (report(session, arguments) || !module) return kUserError;
  for (const std::string& file : arguments.files) {
    std::error_code ignored;
    if (!arguments.output.empty() && std::filesystem::equivalent(file, arguments.output, ignored)) throw UsageError{arguments.output + " is a source file; choose another name for the object file"};
  }
  if (!arguments.output.empty() && !arguments.check) write_file(arguments.output, bytecode::save(*module));
  return kOk;
}

void declare_options(CLI::App& app, Arguments& arguments) {
  app.add_option("files", arguments.files, "source files in load order; - reads standard input");
  app.add_option("-o", arguments.output, "write the object file FILE.pmx")->type_name("FILE");
  app.add_option("-I", arguments.include_dirs, "look for #include files in this folder too")->type_name("DIR")->allow_extra_args(false);
  app.add_option("-D", arguments.defines, "define a macro before the first file")->type_name("NAME[=TEXT]")->allow_extra_args(false);
  app.add_option("-W", arguments.warnings, "extra: more warnings; error: warnings are errors")->type_name("NAME")->allow_extra_args(false)->check(CLI::IsMember({"extra", "error", "all"}));
  app.add_flag("--check", arguments.check, "only report what is wrong");
  app.add_option("--emit", arguments.emit, "print one stage instead of compiling")->check(CLI::IsMember({"tokens", "tree", "ir", "bytecode", "symbols", "elements"}))->type_name("STAGE");
  app.add_option("--diagnostics-format", arguments.format, "text or json, on standard error")->check(CLI::IsMember({"text", "json"}))->type_name("FORMAT");
  app.add_option("--color", arguments.color, "auto, always or never")->check(CLI::IsMember({"auto", "always", "never"}))->type_name("WHEN");
  app.add_option("--error-limit", arguments.error_limit, "stop reporting after this many errors")->type_name("COUNT");
  app.add_option("--explain", arguments.explain, "say more about the message of this code")->type_name("CODE");
  app.set_version_flag("--version", "pmacc 0.1.0");
  app.footer(kExamples);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app{"Compiles Power PMAC motion programs, PLC programs and set-up files to bytecode.", "pmacc"};
  declare_options(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kUsage;
  }
  try {
    return run(arguments);
  } catch (const UsageError& error) {
    std::cerr << "pmacc: " << error.message << "\n";
    return kUsage;
  } catch (const std::exception& error) {
    std::cerr << "pmacc: internal error: " << error.what() << "\n";
    return kInternal;
  }
}
