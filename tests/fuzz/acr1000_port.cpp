// Fuzz target: bytes to the port of an ACR1000 card: lines, control characters, fast move blocks, the stored program.
#include <span>

#include "runtime/tool/acr_console.h"
#include "tests/fuzz/target.h"

using namespace pmac;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tool::CardConsoleOptions options;
  options.max_time_s = 2;
  tool::CardConsole card(options, [](std::string_view) {});
  const std::span<const std::uint8_t> bytes(data, size);
  const std::size_t half = size / 2;   // a host may stop anywhere
  if (card.receive(bytes.first(half)) && card.receive(bytes.subspan(half))) card.pause();
  return 0;
}
