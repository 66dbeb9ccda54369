#include "runtime/io/user_memory.h"

#include <algorithm>

namespace pmac::runtime {

void UserMemory::grow(std::size_t size) {
  constexpr std::size_t kFirstSize = 4096;
  if (size > bytes_.size()) bytes_.resize(std::min(kSize, std::max({size, 2 * bytes_.size(), kFirstSize})), 0);
}

}  // namespace pmac::runtime
