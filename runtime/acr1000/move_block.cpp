#include "runtime/acr1000/move_block.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

namespace pmac::acr1000 {
namespace {

constexpr std::uint8_t kBinary = 0x80, kCircle = 0x40, kIncremental = 0x20, kWideVelocity = 0x10, kReserved = 0x0f;
constexpr std::size_t kLongWords = 4;  // radius, I, J, end point

bool is_binary_type(std::uint8_t type) { return (type & kBinary) != 0; }

std::size_t binary_length(std::uint8_t type) {
  const std::size_t line = 2 + ((type & kWideVelocity) != 0 ? 3 : 2) + 4 + 4;
  return line + ((type & kCircle) != 0 ? 4 * kLongWords : 0);
}

/// Little-endian numbers from the front of a span, one after the other.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  std::uint32_t take(std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < size; ++k) value |= std::uint32_t{bytes_[at_ + k]} << (8 * k);
    at_ += size;
    return value;
  }
  std::int32_t take_signed() { return static_cast<std::int32_t>(take(4)); }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

void append(std::vector<std::uint8_t>& bytes, std::uint32_t value, std::size_t size) {
  for (std::size_t k = 0; k < size; ++k) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
}

std::uint8_t type_of(const MoveBlock& block) {
  return static_cast<std::uint8_t>(kBinary | (block.is_circle ? kCircle : 0) | (block.incremental ? kIncremental : 0) |
                                   (block.wide_velocity ? kWideVelocity : 0));
}

MoveBlock read_binary(std::uint8_t type, std::span<const std::uint8_t> fields) {
  Reader reader(fields);
  MoveBlock block;
  block.is_circle = (type & kCircle) != 0;
  block.incremental = (type & kIncremental) != 0;
  block.wide_velocity = (type & kWideVelocity) != 0;
  if (const std::uint32_t velocity = reader.take(block.wide_velocity ? 3 : 2); velocity != 0) block.velocity = velocity;
  block.master_distance = reader.take(4);
  block.distance = reader.take_signed();
  if (!block.is_circle) return block;
  block.radius = reader.take(4);
  block.i = reader.take_signed();
  block.j = reader.take_signed();
  block.end_point = reader.take_signed();
  return block;
}

std::variant<DecodedBlock, BlockError> decode_binary(std::span<const std::uint8_t> bytes) {
  const std::uint8_t type = bytes[1];
  if ((type & kReserved) != 0) return BlockError{1, 0, fmt::format("the reserved bits of the move type {:02X} are not 0", type)};
  const std::size_t length = binary_length(type);
  if (bytes.size() < length)
    return BlockError{bytes.size(), length - bytes.size(),
                      fmt::format("the block ends after {} of {} bytes", bytes.size(), length)};
  return DecodedBlock{read_binary(type, bytes.subspan(2)), length};
}

/// One field of a text block: its digits without blanks, and where it begins.
struct Field { std::string text; std::size_t offset = 0; };
struct TextBlock { std::vector<Field> fields; std::size_t length = 0; };

/// The fields that are complete. A line feed right behind a carriage return is passed over, elsewhere it ends a field as well.
TextBlock split_text(std::span<const std::uint8_t> bytes) {
  TextBlock block;
  Field field{"", 1};
  for (std::size_t at = 1; at < bytes.size() && block.fields.size() < 3; ++at) {
    const char c = static_cast<char>(bytes[at]);
    const bool paired = c == '\n' && at > 1 && bytes[at - 1] == '\r';
    if (c == ' ' || paired) continue;
    if (c != '\r' && c != '\n') {
      if (field.text.empty()) field.offset = at;
      field.text += c;
      continue;
    }
    block.fields.push_back(std::move(field));
    field = {"", at + 1};
    block.length = at + 1;
  }
  return block;
}

int digit_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : 99;
}

/// Digits of a base up to 2^32 - 1.
std::optional<std::int64_t> number_of_digits(std::string_view digits, int base) {
  if (digits.empty()) return std::nullopt;
  std::int64_t value = 0;
  for (const char c : digits) {
    if (digit_value(c) >= base) return std::nullopt;
    value = value * base + digit_value(c);
    if (value > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  }
  return value;
}

/// Decimal, or &H hexadecimal of 32 bits in two's complement, with a sign or without.
std::optional<std::int64_t> number_of_text(std::string_view text, bool is_signed) {
  const bool negative = !text.empty() && text.front() == '-';
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  const bool hex = text.size() > 2 && text[0] == '&' && (text[1] == 'H' || text[1] == 'h');
  std::optional<std::int64_t> value = number_of_digits(hex ? text.substr(2) : text, hex ? 16 : 10);
  if (!value) return std::nullopt;
  if (hex && is_signed) value = static_cast<std::int32_t>(static_cast<std::uint32_t>(*value));
  if (negative) value = -*value;
  const std::int64_t low = is_signed ? std::numeric_limits<std::int32_t>::min() : 0;
  const std::int64_t high = is_signed ? std::numeric_limits<std::int32_t>::max() : std::numeric_limits<std::uint32_t>::max();
  return *value < low || *value > high ? std::nullopt : value;
}

BlockError bad_field(const Field& field, const char* name) {
  return {field.offset, 0, field.text.empty() ? fmt::format("the {} is missing", name)
                                              : fmt::format("the {} is no number in range", name)};
}

std::variant<DecodedBlock, BlockError> decode_text(std::span<const std::uint8_t> bytes) {
  const TextBlock text = split_text(bytes.first(std::min(bytes.size(), kMaxTextBlock)));
  if (text.fields.size() < 3 && bytes.size() >= kMaxTextBlock) return BlockError{kMaxTextBlock, 0, "the text form is too long"};
  if (text.fields.size() < 3)
    return BlockError{bytes.size(), 3 - text.fields.size(), fmt::format("the block ends after {} of its 3 numbers", text.fields.size())};
  MoveBlock block;
  const auto velocity = number_of_text(text.fields[0].text, false);
  if (!velocity && !text.fields[0].text.empty()) return bad_field(text.fields[0], "velocity");
  if (velocity && *velocity >= 1 << 24) return bad_field(text.fields[0], "velocity");
  const auto master = number_of_text(text.fields[1].text, false);
  if (!master) return bad_field(text.fields[1], "master distance");
  const auto target = number_of_text(text.fields[2].text, true);
  if (!target) return bad_field(text.fields[2], "target");
  if (velocity) block.velocity = static_cast<std::uint32_t>(*velocity);
  block.wide_velocity = velocity && *velocity > 0xffff;
  block.master_distance = static_cast<std::uint32_t>(*master);
  block.distance = static_cast<std::int32_t>(*target);
  return DecodedBlock{block, text.length};
}

}  // namespace

std::string text_of(const BlockError& error) {
  const std::string missing = error.bytes_missing > 0 ? fmt::format("; {} bytes are missing", error.bytes_missing) : "";
  return fmt::format("{}, at byte {}{}", error.detail, error.offset, missing);
}

CircleArguments circle_of(const MoveBlock& block) {
  const std::int64_t length = block.distance;
  return {length < 0 ? -1 : 1, block.radius, block.i, block.j, length < 0 ? -length : length};
}

std::size_t fast_block_length(std::span<const std::uint8_t> so_far) {
  if (so_far.size() < 2) return 0;
  if (is_binary_type(so_far[1])) return binary_length(so_far[1]);
  const TextBlock text = split_text(so_far.first(std::min(so_far.size(), kMaxTextBlock)));
  if (text.fields.size() == 3) return text.length;
  return so_far.size() >= kMaxTextBlock ? kMaxTextBlock : 0;
}

std::variant<DecodedBlock, BlockError> decode_block(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return BlockError{0, 2, "the block is empty"};
  if (bytes[0] != kControlD) return BlockError{0, 0, fmt::format("a block begins with ctrl-D (04), not with {:02X}", bytes[0])};
  if (bytes.size() < 2) return BlockError{1, 1, "the block ends behind its ctrl-D"};
  return is_binary_type(bytes[1]) ? decode_binary(bytes) : decode_text(bytes);
}

std::vector<std::uint8_t> encode_block(const MoveBlock& block) {
  std::vector<std::uint8_t> bytes{kControlD, type_of(block)};
  append(bytes, block.velocity.value_or(0), block.wide_velocity ? 3 : 2);
  append(bytes, block.master_distance, 4);
  append(bytes, static_cast<std::uint32_t>(block.distance), 4);
  if (!block.is_circle) return bytes;
  append(bytes, block.radius, 4);
  for (const std::int32_t word : {block.i, block.j, block.end_point}) append(bytes, static_cast<std::uint32_t>(word), 4);
  return bytes;
}

std::vector<std::uint8_t> encode_text_block(const MoveBlock& block, NumberForm form) {
  const bool hex = form == NumberForm::kHex;
  std::string text(1, static_cast<char>(kControlD));
  if (block.velocity) text += hex ? fmt::format("&H{:X}", *block.velocity) : fmt::format("{}", *block.velocity);
  text += '\r';
  text += hex ? fmt::format("&H{:X}\r", block.master_distance) : fmt::format("{}\r", block.master_distance);
  text += hex ? fmt::format("&H{:X}\r", static_cast<std::uint32_t>(block.distance)) : fmt::format("{}\r", block.distance);
  return {text.begin(), text.end()};
}

std::string hex_text(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{}{:02X}", text.empty() ? "" : " ", byte);
  return text;
}

std::optional<std::vector<std::uint8_t>> bytes_from_hex(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == ' ' || text[at] == '\t') { ++at; continue; }
    const auto value = at + 1 < text.size() ? number_of_digits(text.substr(at, 2), 16) : std::nullopt;
    if (!value) return std::nullopt;
    bytes.push_back(static_cast<std::uint8_t>(*value));
    at += 2;
  }
  return bytes;
}

}  // namespace pmac::acr1000
