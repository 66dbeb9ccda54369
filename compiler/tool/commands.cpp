#include "compiler/tool/commands.h"

#include <fmt/format.h>

#include <iostream>

#include "compiler/bytecode/object_file.h"
#include "compiler/source/message.h"
#include "compiler/tool/fix_command.h"
#include "compiler/tool/inputs.h"
#include "compiler/tool/report.h"

namespace pmac::pmacc {
namespace {

void print(std::string_view text) {
  std::cout << text << std::flush;
  if (!std::cout) throw UsageError("cannot write the output");
}

int explain(const std::string& code) {
  const std::string text = code == "all" ? source::messages_page() : source::explain(code);
  const std::string_view near = source::nearest_code(code);
  if (text.empty()) throw UsageError(fmt::format("no message has the code {}{}", code, near.empty() ? "; pmacc --explain all lists them" : fmt::format("; did you mean {}?", near)));
  print(text);
  return kOk;
}

std::string stage_text(compiler::Session& session, const std::string& stage, const std::vector<compiler::InputFile>& files) {
  std::string text;
  if (stage == "files") {
    for (const compiler::InputFile& file : files) text += file.name + "\n";
    return text;
  }
  if (stage == "ir") return compiler::emit_ir(session, files);
  if (stage == "symbols") return compiler::emit_symbols(session, files);
  if (stage == "pmc") return compiler::emit_pmc(session, files);
  if (stage == "tokens" || stage == "tree") {
    for (const compiler::InputFile& file : files) text += stage == "tokens" ? compiler::emit_tokens(session, file) : compiler::emit_tree(session, file);
  } else if (const auto module = session.compile(files)) {
    text = bytecode::disassemble(*module);
  }
  return text;
}

int emit(compiler::Session& session, const Arguments& arguments, const std::vector<compiler::InputFile>& files) {
  print(stage_text(session, arguments.emit, files));
  return report(session, arguments) ? kUserError : kOk;
}

int preprocess(compiler::Session& session, const Arguments& arguments, const std::vector<compiler::InputFile>& files) {
  const std::string text = compiler::emit_preprocessed(session, files);
  if (report(session, arguments)) return kUserError;
  if (arguments.output.empty()) print(text);
  else write_file(arguments.output, text);
  return kOk;
}

int compile(compiler::Session& session, const Arguments& arguments, std::vector<compiler::InputFile> files) {
  const auto module = session.compile(std::move(files));
  if (report(session, arguments) || !module) return kUserError;
  if (arguments.output.empty() || arguments.check) return kOk;
  refuse_to_overwrite(arguments.files, arguments.output);
  write_file(arguments.output, [&](const ByteWriter& write) {
    bytecode::save(*module, [&](std::span<const std::uint8_t> piece) { write({reinterpret_cast<const char*>(piece.data()), piece.size()}); });
  });
  return kOk;
}

/// What exists for one language only.
void refuse_other_dialect(const Arguments& arguments, compiler::Dialect dialect) {
  const bool cards = dialect == compiler::Dialect::kAcr1000;
  if (cards && (arguments.fix || arguments.fix_dry_run)) throw UsageError("--fix repairs Power PMAC files only");
  if (cards && arguments.preprocess) throw UsageError("-E: the ACR1000 has no preprocessor");
  if (!cards && arguments.emit == "pmc") throw UsageError("--emit=pmc translates ACR1000 files (.acr, or --dialect=acr1000)");
  if (!cards && !arguments.card_settings.empty()) throw UsageError("--card is for ACR1000 files (.acr, or --dialect=acr1000)");
}

}  // namespace

int run(const Arguments& arguments) {
  if (!arguments.explain.empty()) return explain(arguments.explain);
  if (arguments.help_warnings) return print(source::list_warnings()), kOk;
  if (arguments.emit == "elements") return print(compiler::emit_elements()), kOk;
  if (arguments.files.empty()) throw UsageError("no input files; try pmacc --help");
  const compiler::Options options = compiler_options(arguments);
  refuse_other_dialect(arguments, options.dialect);
  if (arguments.fix || arguments.fix_dry_run) {
    const int done = fix(arguments, options);
    if (arguments.fix_dry_run) return done;
  }
  compiler::Session session(options);
  set_error_limit(session, arguments);
  std::vector<compiler::InputFile> files = read_inputs(arguments.files, session);
  if (arguments.preprocess) return preprocess(session, arguments, files);
  return arguments.emit.empty() ? compile(session, arguments, std::move(files)) : emit(session, arguments, files);
}

}  // namespace pmac::pmacc
