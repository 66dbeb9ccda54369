#include "compiler/tool/fmt.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "compiler/source/format.h"
#include "compiler/style/style.h"
#include "compiler/tool/inputs.h"
#include "compiler/tool/options.h"
#include "compiler/tool/project_names.h"

namespace pmac::pmacc {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExamples = R"(Examples:
  pmacc fmt oval.pmc                  rewrite the file in place
  pmacc fmt --check *.pmc *.plc       name the files that are not formatted, exit code 1 if there are any
  pmacc fmt --check MyMachine         the same of all script files in and below a folder
  pmacc fmt --diff oval.pmc           show what would change, change nothing
  pmacc fmt - < oval.pmc              standard input to standard output

Text between the comments // pmacc: fmt off and // pmacc: fmt on is left alone.
The rules: docs/fmt.md)";

struct FmtArguments {
  std::vector<std::string> files;
  style::Options style;
  bool check = false, diff = false, to_stdout = false;
};

/// What became of a file.
enum class Outcome { kSame, kChanged, kRefused };

void print_problems(const std::string& name, const std::string& text, const std::vector<style::Problem>& problems) {
  source::SourceManager sources;
  const std::int32_t file = sources.add_file(name, text);
  const bool color = std::getenv("NO_COLOR") == nullptr && ::isatty(STDERR_FILENO) != 0;
  for (const style::Problem& problem : problems) {
    source::Diagnostic diagnostic;
    diagnostic.code = problem.code;
    diagnostic.span = {file, static_cast<std::uint32_t>(problem.offset), static_cast<std::uint32_t>(problem.offset + problem.length), -1};
    diagnostic.message = problem.message;
    std::cerr << source::format_text(sources, diagnostic, color);
  }
}

Outcome format_file(const std::string& name, ProjectNames& project, const FmtArguments& arguments) {
  if (name.ends_with(".acr") || name.ends_with(".sys")) throw UsageError(fmt::format("{}: an ACR1000 file; pmacc fmt formats Power PMAC script only (blanks mean nothing to the card, LIST is its own form)", name));
  const std::string text = read_file(name);
  const std::string shown = name == "-" ? "<stdin>" : name;
  const style::Formatted formatted = style::format(text, shown, project.of(name == "-" ? "stdin" : name, text), arguments.style);
  const bool refused = !formatted.problems.empty();
  if (refused) {
    print_problems(shown, text, formatted.problems);
    std::cerr << fmt::format("{}: not formatted\n", shown);
  }
  const std::string& result = refused ? text : formatted.text;
  if (arguments.diff) std::cout << style::unified_diff(shown, text, result);
  else if (!arguments.check && (name == "-" || arguments.to_stdout)) std::cout << result;
  else if (!arguments.check && result != text) write_file(name, result);
  if (refused) return Outcome::kRefused;
  return result == text ? Outcome::kSame : Outcome::kChanged;
}

bool is_script(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".pmc" || extension == ".plc" || extension == ".pmh" || extension == ".kin";
}

/// The script files in and below a folder, without hidden folders, by name.
std::vector<std::string> scripts_below(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error), end; !error && it != end; it.increment(error)) {
    if (it->is_directory() && it->path().filename().string().starts_with('.')) it.disable_recursion_pending();
    else if (it->is_regular_file() && is_script(it->path())) names.push_back(it->path().string());
  }
  if (error) throw UsageError(fmt::format("cannot read the folder {}", folder));
  if (names.empty()) throw UsageError(fmt::format("there are no script files (.pmh .kin .pmc .plc) in {}", folder));
  std::sort(names.begin(), names.end());
  return names;
}

/// The files that are meant: folders stand for the script files in them.
std::vector<std::string> files_of(const FmtArguments& arguments, int& exit_code) {
  std::vector<std::string> files;
  for (const std::string& name : arguments.files) {
    std::error_code ignored;
    if (!fs::is_directory(name, ignored)) {
      files.push_back(name);
      continue;
    }
    try {
      for (std::string& file : scripts_below(name)) files.push_back(std::move(file));
    } catch (const UsageError& error) {
      std::cerr << "pmacc fmt: " << error.what() << "\n";
      exit_code = kUsage;
    }
  }
  return files;
}

int format_files(const FmtArguments& arguments) {
  ProjectNames project;
  int exit_code = kOk;
  for (const std::string& name : files_of(arguments, exit_code)) {
    try {
      const Outcome outcome = format_file(name, project, arguments);
      if (outcome == Outcome::kRefused) exit_code = std::max(exit_code, kUserError);
      if (outcome == Outcome::kChanged && arguments.check) {
        if (!arguments.diff) std::cout << (name == "-" ? "<stdin>" : name) << "\n";
        exit_code = std::max(exit_code, kUserError);
      }
    } catch (const UsageError& error) {
      std::cerr << "pmacc fmt: " << error.what() << "\n";
      exit_code = kUsage;
    }
  }
  std::cout << std::flush;
  if (!std::cout) throw UsageError("cannot write the output");
  return exit_code;
}

void declare_options(CLI::App& app, FmtArguments& arguments) {
  app.add_option("files", arguments.files, "files to rewrite in place, or folders of .pmh .kin .pmc .plc files; - reads standard input and writes standard output")->required();
  app.add_flag("--check", arguments.check, "change nothing; list the files that would change, and exit with 1 if there are any");
  app.add_flag("--diff", arguments.diff, "change nothing; print the changes as a unified diff");
  app.add_flag("--stdout", arguments.to_stdout, "write to standard output instead of the files");
  app.add_option("--indent", arguments.style.indent, "blanks a level")->type_name("N")->check(CLI::Range(1, 16))->capture_default_str();
  app.add_flag("--indent-buffers", arguments.style.indent_buffers, "what stands between open and close goes one level in");
  app.footer(kExamples);
}

}  // namespace

int run_fmt(int argc, char** argv) {
  FmtArguments arguments;
  CLI::App app{"Formats Power PMAC script: indentation, blanks, letter case, comments in columns. The program stays the same.", "pmacc fmt"};
  declare_options(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kUsage;
  }
  return format_files(arguments);
}

}  // namespace pmac::pmacc
