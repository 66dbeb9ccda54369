// A queue in one piece of memory: segments come in at its end and leave at its start, and any of them can be looked at. It grows to the
// most that was ever in it, and costs no allocation from then on.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace pmac::motion {

/// As far as it goes a std::deque. What has been taken out stays as a moved-from value until its place is needed again.
template <class T>
class Ring {
 public:
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  T& operator[](std::size_t i) { return slots_[(first_ + i) & (room_ - 1)]; }
  const T& operator[](std::size_t i) const { return slots_[(first_ + i) & (room_ - 1)]; }
  T& front() { return slots_[first_]; }
  const T& front() const { return slots_[first_]; }
  T& back() { return (*this)[count_ - 1]; }
  const T& back() const { return (*this)[count_ - 1]; }

  void push_back(T value) {
    if (count_ == room_) grow();
    ++count_;
    back() = std::move(value);
  }
  /// A new last one, with whatever its place held before.
  T& extend() {
    if (count_ == room_) grow();
    ++count_;
    return back();
  }
  void push_front(T value) {
    if (count_ == room_) grow();
    first_ = (first_ + room_ - 1) & (room_ - 1);
    ++count_;
    front() = std::move(value);
  }
  void pop_front() {
    first_ = (first_ + 1) & (room_ - 1);
    --count_;
  }
  void pop_back() { --count_; }
  /// Leaves the first `count`.
  void shrink(std::size_t count) { count_ = count; }
  void clear() { count_ = 0; }

  /// The first of those for which is_before does not hold; they come after all for which it does.
  template <class Test>
  std::size_t first_not(const Test& is_before) const {
    std::size_t low = 0, high = count_;
    while (low < high) {
      const std::size_t middle = (low + high) / 2;
      if (is_before((*this)[middle])) low = middle + 1;
      else high = middle;
    }
    return low;
  }

 private:
  void grow() {
    std::vector<T> larger(slots_.empty() ? 16 : 2 * slots_.size());
    for (std::size_t i = 0; i < count_; ++i) larger[i] = std::move((*this)[i]);
    slots_ = std::move(larger);
    room_ = slots_.size();
    first_ = 0;
  }

  std::vector<T> slots_;
  std::size_t room_ = 0;   // size of slots_, a power of two, kept to save a division
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace pmac::motion
