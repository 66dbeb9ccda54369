#include "compiler/tool/options.h"

#include <CLI/CLI.hpp>
#include <iostream>

namespace pmac::pmacc {
namespace {

constexpr const char* kExamples = R"(Examples:
  pmacc --check setup.cfg oval.pmc          report what is wrong, write nothing
  pmacc setup.cfg oval.pmc -o oval.pmx      compile the files in this order to an object file
  pmacc -Wall -Werror=array-bounds *.pmc    more warnings, and one of them as an error
  pmacc --fix old.pmc                       repair what has one certain repair, in place
  pmacc --diagnostics-format=sarif x.pmc    messages for code scanning, on standard error
  pmacc --emit=ir oval.pmc                  show the program as the compiler understood it
  pmacc --check MyMachine.ppproj            a project of the vendor's IDE: also its folder, or its pp_proj.ini
  pmacc --emit=files MyMachine              list the files of a project in load order
  pmacc --emit=elements                     list the data-structure elements that are known
  pmacc contour.x.acr contour.y.acr --check  programs of two ACR1000 cards
  pmacc --dialect=acr1000 --emit=ir old.txt  an ACR1000 program in a file of any name
  pmacc --emit=pmc contour.x.acr contour.y.acr   the same path as a Power PMAC program
  pmacc --explain PM4001                    say more about a message
  pmacc fmt --help                          the formatter)";

void declare_input_options(CLI::App& app, Arguments& arguments) {
  app.add_option("files", arguments.files, "source files in load order; - reads standard input");
  app.add_option("-I", arguments.include_dirs, "look for #include files in this folder too")->type_name("DIR")->allow_extra_args(false);
  app.add_option("--dialect", arguments.dialect, "language of the files; without it, .acr files are the ACR1000's")->check(CLI::IsMember({"power-pmac", "acr1000"}))->type_name("NAME");
  app.add_option("--card", arguments.card_settings, "a setting of the ACR1000 system that no file changes, as VERSION=4")->type_name("KEY=VALUE")->allow_extra_args(false);
  app.add_option("--max-include-depth", arguments.max_include_depth, "give up at #include nested so deep")->type_name("N")->check(CLI::Range(1, 200))->capture_default_str();
  app.add_option("-D", arguments.defines, "define a macro before the first file")->type_name("NAME[=TEXT]")->allow_extra_args(false);
}

void declare_output_options(CLI::App& app, Arguments& arguments) {
  app.add_option("-o", arguments.output, "write the object file FILE.pmx")->type_name("FILE");
  app.add_flag("--check", arguments.check, "only report what is wrong");
  app.add_flag("-E", arguments.preprocess, "print the program as the controller's loader sees it: declarations as #define lines")->excludes("--check");
  app.add_option("--emit", arguments.emit, "print one stage instead of compiling")->check(CLI::IsMember({"files", "tokens", "tree", "ir", "bytecode", "symbols", "elements", "pmc"}))->type_name("STAGE");
}

void declare_message_options(CLI::App& app, Arguments& arguments) {
  app.add_option("-W", arguments.warnings, "all, extra, name, no-name, error, error=name, no-error=name; the last one counts")->type_name("NAME")->allow_extra_args(false)->group("Messages");
  app.add_flag("-w", arguments.no_warnings, "no warnings")->group("Messages");
  app.add_flag("--help-warnings", arguments.help_warnings, "list the names for -W")->group("Messages");
  app.add_option("--explain", arguments.explain, "say more about the message of this code; all: about every one")->type_name("CODE")->group("Messages");
  app.add_option("--diagnostics-format", arguments.format, "text, json, sarif or github, on standard error")->check(CLI::IsMember({"text", "json", "sarif", "github"}))->type_name("FORMAT")->group("Messages");
  app.add_option("--color", arguments.color, "auto, always or never")->check(CLI::IsMember({"auto", "always", "never"}))->type_name("WHEN")->group("Messages");
  app.add_option("--error-limit", arguments.error_limit, "stop reporting after this many errors; 0: never")->type_name("COUNT")->group("Messages");
  app.add_option("--repeat-limit", arguments.repeat_limit, "show so many of the same Turbo PMAC spelling in a file, then only their lines; 0: all")->type_name("COUNT")->group("Messages");
  app.add_flag("--fix", arguments.fix, "repair the files in place where a message has a safe repair")->group("Repairs");
  app.add_flag("--fix-dry-run", arguments.fix_dry_run, "print what --fix would change, as a unified diff")->group("Repairs");
}

compiler::Dialect dialect_of(const Arguments& arguments) {
  if (!arguments.dialect.empty()) return arguments.dialect == "acr1000" ? compiler::Dialect::kAcr1000 : compiler::Dialect::kPowerPmac;
  const auto dialect = compiler::dialect_of(arguments.files);
  if (!dialect) throw UsageError("ACR1000 files (.acr) and files of another language cannot be compiled together");
  return *dialect;
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
  options.dialect = dialect_of(arguments);
  options.card_settings = arguments.card_settings;
  options.include_dirs = arguments.include_dirs;
  options.max_include_depth = arguments.max_include_depth;
  for (const std::string& define : arguments.defines) {
    const std::size_t equals = define.find('=');
    options.defines.emplace_back(define.substr(0, equals), equals == std::string::npos ? "" : define.substr(equals + 1));
  }
  for (const std::string& warning : arguments.warnings) {
    const std::string problem = options.warnings.apply(warning);
    if (!problem.empty()) std::cerr << "pmacc: warning: " << problem << "\n";
  }
  if (arguments.no_warnings) options.warnings.silence();
  return options;
}

}  // namespace pmac::pmacc
