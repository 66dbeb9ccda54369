// Frames of the servos' 8-bit ASCII protocol: commands in decimal, replies in hexadecimal, each ended by CR.
//
//     @16 253 2928 -1073741824 8361 351144<CR>    command 253 with four parameters to device 16
//     * 10<CR>                                    acknowledged by device 16 (10h)
//     # 10 000C 0000 0001<CR>                     data of command 12
//     ! 10 00FD 0006<CR>                          refused: buffer full
//
// Source: SilverMax command reference, technical document TD025 (commands); host libraries of the maker (replies, codes). The numbers of the
// commands that no document found gives are in command.def, marked.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace pmac::drives::silverlode {

enum class CommandName : std::uint8_t {
#define COMMAND(id, number, parameters, documented, meaning) k##id,
#include "runtime/drives/silverlode/command.def"
#undef COMMAND
};

struct CommandRow {
  CommandName name;
  std::string_view text;         // "IMW"
  int number = 0;
  int parameters = 0;
  bool documented = false;       // false: the number is this project's choice, to be set
  std::string_view meaning;
};

/// The commands and their numbers; those that are not documented can be given others.
class CommandSet {
 public:
  CommandSet();
  const CommandRow& row(CommandName name) const { return rows_[static_cast<std::size_t>(name)]; }
  int number(CommandName name) const { return row(name).number; }
  /// nullptr for a number that is none of them.
  const CommandRow* find(int number) const;
  const CommandRow* find(std::string_view text) const;
  std::span<const CommandRow> rows() const { return rows_; }
  /// Gives a command another number. Why not, or nothing: unknown, documented otherwise, taken, out of range.
  std::optional<std::string> set_number(std::string_view text, int number);

 private:
  std::vector<CommandRow> rows_;
};

inline constexpr int kMostAddress = 255;
inline constexpr int kMostCommandNumber = 255;
inline constexpr std::size_t kMostFrameBytes = 120;     // with the CR; longer ones are refused
inline constexpr std::size_t kMostParameters = 8;

struct CommandFrame {
  int address = 0;                 // 1 .. 255
  int command = 0;                 // 0 .. 255
  std::vector<std::int64_t> parameters;   // signed or unsigned 32 bits
};

enum class NakCode : int {
  kBadCommand = 1, kBusy = 2, kBadFormat = 5, kBufferFull = 6, kBadAddress = 7, kBadResponse = 8, kLockOut = 9, kChecksum = 10
};
std::string_view text_of(NakCode code);

struct Ack { int address = 0; };
struct Nak { int address = 0; int command = 0; int code = 0; };
struct Data { int address = 0; int command = 0; std::vector<std::uint16_t> words; };
using ReplyFrame = std::variant<Ack, Nak, Data>;

/// With the CR.
std::string encode(const CommandFrame& frame);
std::string encode(const ReplyFrame& frame);

/// A frame without its CR, or what is wrong with it. Any bytes may come.
std::variant<CommandFrame, std::string> decode_command(std::string_view bytes);
std::variant<ReplyFrame, std::string> decode_reply(std::string_view bytes);

/// Cuts a stream of bytes into frames at every CR. Bytes of a frame that is too long are dropped up to its CR, and it comes out as an
/// empty optional.
class FrameCutter {
 public:
  /// Frames that end within these bytes, without CR.
  std::vector<std::optional<std::string>> take(std::string_view bytes);
  /// Bytes of a frame that has not ended.
  std::size_t pending() const { return too_long_ ? kMostFrameBytes : held_.size(); }

 private:
  std::string held_;
  bool too_long_ = false;
};

/// False where a known command stands with more or fewer parameters than it has.
bool has_its_parameters(const CommandFrame& frame, const CommandSet& commands);

/// "IMW to 16: 2928 ticks, pos -1073741824, acc 8361, vel 351144", for people.
std::string describe(const CommandFrame& frame, const CommandSet& commands);
std::string describe(const ReplyFrame& frame, const CommandSet& commands);

}  // namespace pmac::drives::silverlode
