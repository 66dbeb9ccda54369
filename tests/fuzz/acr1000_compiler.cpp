// Fuzz target: ACR1000 programs, compiled and run on the cards of one system. A line "--- y.acr" begins the file of the next card.
#include <memory>

#include "compiler/bytecode/object_file.h"
#include "compiler/compiler.h"
#include "runtime/acr1000/acr1000.h"
#include "runtime/acr1000/image.h"
#include "runtime/acr1000/processor.h"
#include "tests/fuzz/target.h"

using namespace pmac;

namespace {

std::vector<compiler::InputFile> files_of(std::string_view text) {
  std::vector<compiler::InputFile> files{{"fuzz.x.acr", ""}};
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    const std::string_view line = text.substr(at, end - at);
    if (line.starts_with("--- ") && files.size() < 4) files.push_back({std::string(line.substr(4, line.find_last_not_of("\r\n") - 3)), ""});
    else files.back().text += line;
    at = end;
  }
  return files;
}

void run(const acr1000::SystemImage& image) {
  acr1000::CardSystem system({});
  for (const acr1000::CardImage& one : image.cards) {
    acr1000::Card& card = system.add(one.config);
    auto processor = std::make_unique<acr1000::CardProcessor>(card, [](std::string_view) {});
    if (one.script) processor->start(one.script);
    card.driver = std::move(processor);
  }
  acr1000::SystemLimits limits;
  limits.max_s = 20;
  limits.max_commands = 20'000;
  limits.interrupted = [polls = 0]() mutable { return ++polls > 20'000; };
  system.run(limits);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  compiler::Options options;
  options.dialect = compiler::Dialect::kAcr1000;
  compiler::Session session(options);
  auto module = session.compile(files_of(fuzz::text_of(data, size)));
  fuzz::check(module.has_value() != session.diagnostics().has_errors(), "a module, or an error that says why there is none");
  if (!module) return 0;
  fuzz::check(bytecode::verify(*module).empty(), "what the compiler makes is verified");
  if (acr1000::is_card_module(*module)) run(acr1000::read_image(std::make_shared<const bytecode::Module>(std::move(*module))));
  return 0;
}
