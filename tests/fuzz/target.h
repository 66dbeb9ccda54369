// What fuzz targets share. A target is one file with LLVMFuzzerTestOneInput: it gives any bytes to an entry of the tools, and aborts where what
// comes out breaks a promise. With clang it is a libFuzzer target; with any compiler replay_main.cpp runs the corpus and seeded changes of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace pmac::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) { return {reinterpret_cast<const char*>(data), size}; }

/// A promise that every input has to keep.
inline void check(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", promise);
  std::abort();
}

}  // namespace pmac::fuzz
