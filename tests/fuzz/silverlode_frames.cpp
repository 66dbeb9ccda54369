// Fuzz target: the decoders of the SilverLode line, and a servo that is sent whatever can be decoded. Any bytes may come; a decoded frame
// must encode to one that decodes to the same, and every frame for a servo must have a reply that decodes.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "runtime/drives/silverlode/device.h"
#include "runtime/drives/silverlode/protocol.h"

using namespace pmac::drives::silverlode;

namespace {

std::string without_cr(std::string bytes) {
  bytes.pop_back();
  return bytes;
}

void check(bool holds) {
  if (!holds) std::abort();
}

void try_command(const std::string& bytes, Device& servo) {
  const auto decoded = decode_command(bytes);
  if (decoded.index() != 0) return check(!std::get<std::string>(decoded).empty());
  const CommandFrame& frame = std::get<CommandFrame>(decoded);
  const auto again = decode_command(without_cr(encode(frame)));
  check(again.index() == 0 && std::get<CommandFrame>(again).parameters == frame.parameters);
  check(decode_reply(without_cr(encode(servo.handle(frame)))).index() == 0);
  for (int cycle = 0; cycle < 3; ++cycle) servo.step(cycle % 2 == 0);
}

void try_reply(const std::string& bytes, const CommandSet& commands) {
  const auto decoded = decode_reply(bytes);
  if (decoded.index() == 0) check(!describe(std::get<ReplyFrame>(decoded), commands).empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const CommandSet commands;
  Device servo({"X", 16}, commands, [](bool, const std::string&) {});
  FrameCutter cutter;
  for (const auto& frame : cutter.take({reinterpret_cast<const char*>(data), size})) {
    if (!frame) continue;
    try_command(*frame, servo);
    try_reply(*frame, commands);
  }
  for (int cycle = 0; cycle < 500; ++cycle) servo.step(cycle % 50 == 0);
  return 0;
}
