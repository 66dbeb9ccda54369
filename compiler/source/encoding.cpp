#include "compiler/source/encoding.h"

#include <cstdint>
#include <string_view>

#include "compiler/source/characters.h"

namespace pmac::source {
namespace {

class Utf16Reader {
 public:
  Utf16Reader(std::string_view bytes, bool little_endian) : bytes_(bytes), low_(little_endian ? 0 : 1) {}

  bool at_end() const { return at_ + 1 >= bytes_.size(); }
  std::uint32_t next() {
    constexpr std::uint32_t kReplacement = 0xfffd;
    const std::uint32_t first = unit();
    if (first < 0xd800 || first > 0xdfff) return first;
    if (first >= 0xdc00 || at_end()) return kReplacement;
    const std::size_t before = at_;
    const std::uint32_t second = unit();
    if (second >= 0xdc00 && second <= 0xdfff) return 0x10000 + ((first - 0xd800) << 10) + (second - 0xdc00);
    at_ = before;
    return kReplacement;
  }

 private:
  std::uint32_t unit() {
    const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes_[at_ + i])); };
    const std::uint32_t value = byte(low_) | (byte(1 - low_) << 8);
    at_ += 2;
    return value;
  }

  std::string_view bytes_;
  std::size_t low_;
  std::size_t at_ = 2;  // behind the byte-order mark
};

}  // namespace

std::string decode_text(std::string bytes) {
  const bool little = bytes.starts_with("\xff\xfe");
  const bool big = bytes.starts_with("\xfe\xff");
  if (!little && !big) return bytes;
  std::string text = "\xef\xbb\xbf";
  for (Utf16Reader reader(bytes, little); !reader.at_end();) append_utf8(reader.next(), text);
  return text;
}

}  // namespace pmac::source
