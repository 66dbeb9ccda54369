// User memory (Sys.udata): bytes that M variables reach as integers, floats and doubles by byte offset. Starts as zeros and
// grows when written. Source: the u.user, s.user, f.user and d.user definitions of the Software Reference p1254 (offsets in
// bytes: inferred).
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

namespace pmac::runtime {

class UserMemory {
 public:
  static constexpr std::size_t kSize = 1u << 20;  // bytes

  /// True if a T at this byte offset lies inside.
  template <class T>
  static bool holds(std::uint32_t offset) { return offset <= kSize - sizeof(T); }

  /// Value at a byte offset; 0 outside the memory.
  template <class T>
  T read(std::uint32_t offset) const {
    T value{};
    if (offset + sizeof(T) <= bytes_.size()) std::memcpy(&value, bytes_.data() + offset, sizeof(T));
    return value;
  }

  /// Stores at a byte offset; does nothing outside the memory. True if the bytes changed.
  template <class T>
  bool write(std::uint32_t offset, T value) {
    if (!holds<T>(offset)) return false;
    grow(offset + sizeof(T));
    const bool changed = std::memcmp(bytes_.data() + offset, &value, sizeof(T)) != 0;
    std::memcpy(bytes_.data() + offset, &value, sizeof(T));
    return changed;
  }

 private:
  void grow(std::size_t size);

  std::vector<unsigned char> bytes_;
};

}  // namespace pmac::runtime
