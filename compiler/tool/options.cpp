#include "compiler/tool/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace pmac::pmacc {
namespace {

constexpr const char* kExamples = R"(Examples:
  pmacc --check setup.cfg oval.pmc        report what is wrong, write nothing
  pmacc setup.cfg oval.pmc -o oval.pmx    compile the files in this order to an object file
  pmacc --emit=ir oval.pmc                show the program as the compiler understood it
  pmacc --check MyMachine.ppproj          a project of the vendor's IDE: also its folder, or its pp_proj.ini
  pmacc --emit=files MyMachine            list the files of a project in load order
  pmacc --emit=elements                   list the data-structure elements that are known
  pmacc --explain PM4001                  say more about a message
  pmacc fmt --help                        the formatter)";

void declare_input_options(CLI::App& app, Arguments& arguments) {
  app.add_option("files", arguments.files, "source files in load order; - reads standard input");
  app.add_option("-I", arguments.include_dirs, "look for #include files in this folder too")->type_name("DIR")->allow_extra_args(false);
  app.add_option("-D", arguments.defines, "define a macro before the first file")->type_name("NAME[=TEXT]")->allow_extra_args(false);
}

void declare_output_options(CLI::App& app, Arguments& arguments) {
  app.add_option("-o", arguments.output, "write the object file FILE.pmx")->type_name("FILE");
  app.add_flag("--check", arguments.check, "only report what is wrong");
  app.add_flag("-E", arguments.preprocess, "print the program as the controller's loader sees it: declarations as #define lines")->excludes("--check");
  app.add_option("--emit", arguments.emit, "print one stage instead of compiling")->check(CLI::IsMember({"files", "tokens", "tree", "ir", "bytecode", "symbols", "elements"}))->type_name("STAGE");
}

void declare_message_options(CLI::App& app, Arguments& arguments) {
  app.add_option("-W", arguments.warnings, "extra: more warnings; error: warnings are errors")->type_name("NAME")->allow_extra_args(false)->check(CLI::IsMember({"extra", "error", "all"}));
  app.add_option("--diagnostics-format", arguments.format, "text or json, on standard error")->check(CLI::IsMember({"text", "json"}))->type_name("FORMAT");
  app.add_option("--color", arguments.color, "auto, always or never")->check(CLI::IsMember({"auto", "always", "never"}))->type_name("WHEN");
  app.add_option("--error-limit", arguments.error_limit, "stop reporting after this many errors")->type_name("COUNT");
  app.add_option("--explain", arguments.explain, "say more about the message of this code")->type_name("CODE");
}

}  // namespace

Arguments parse_command_line(int argc, char** argv, std::optional<int>& exit_code) {
  Arguments arguments;
  CLI::App app{"Compiles Power PMAC motion programs, PLC programs and set-up files to bytecode.", "pmacc"};
  declare_input_options(app, arguments);
  declare_output_options(app, arguments);
  declare_message_options(app, arguments);
  app.set_version_flag("--version", "pmacc 0.1.0");
  app.footer(kExamples);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? kOk : kUsage;
  }
  return arguments;
}

compiler::Options compiler_options(const Arguments& arguments) {
  compiler::Options options;
  options.include_dirs = arguments.include_dirs;
  for (const std::string& define : arguments.defines) {
    const std::size_t equals = define.find('=');
    options.defines.emplace_back(define.substr(0, equals), equals == std::string::npos ? "" : define.substr(equals + 1));
  }
  options.extra_warnings = std::find(arguments.warnings.begin(), arguments.warnings.end(), "extra") != arguments.warnings.end();
  return options;
}

}  // namespace pmac::pmacc
