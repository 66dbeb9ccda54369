// A short array of plain values, one for each motor, that is made and dropped for every node and segment of a path. Its memory comes
// from lists of blocks that have been dropped before, so that a path costs no call of the allocator once it runs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <new>
#include <type_traits>
#include <utility>

namespace pmac::motion {

/// Blocks of memory by size, for one thread. What is given back is kept until the thread ends.
class RowMemory {
 public:
  static constexpr std::size_t kUnit = 64, kClasses = 24;   // larger blocks are the allocator's

  ~RowMemory() {
    for (Block*& first : free_)
      while (first) ::operator delete(std::exchange(first, first->next));
  }
  void* take(std::size_t units) {
    if (units > kClasses) return ::operator new(units * kUnit);
    Block*& first = free_[units - 1];
    if (!first) return ::operator new(units * kUnit);
    return std::exchange(first, first->next);
  }
  void give_back(void* memory, std::size_t units) {
    if (units > kClasses) return ::operator delete(memory);
    Block*& first = free_[units - 1];
    first = new (memory) Block{first};
  }
  static RowMemory& here() {
    thread_local RowMemory memory;
    return memory;
  }

 private:
  struct Block { Block* next; };
  Block* free_[kClasses] = {};
};

/// As far as it goes a std::vector.
template <class T>
class Row {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  using value_type = T;
  Row() = default;
  explicit Row(std::size_t size, const T& value = T{}) { assign(size, value); }
  Row(std::initializer_list<T> values) { copy(values.begin(), values.size()); }
  Row(const Row& other) { copy(other.data_, other.size_); }
  Row(Row&& other) noexcept : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)), units_(std::exchange(other.units_, 0)) {}
  Row& operator=(const Row& other) {
    if (this != &other) copy(other.data_, other.size_);
    return *this;
  }
  Row& operator=(Row&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(units_, other.units_);
    return *this;
  }
  ~Row() { drop(); }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T* begin() { return data_; }
  const T* begin() const { return data_; }
  T* end() { return data_ + size_; }
  const T* end() const { return data_ + size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T& back() { return data_[size_ - 1]; }
  const T& back() const { return data_[size_ - 1]; }

  void clear() { size_ = 0; }
  void reserve(std::size_t size) {
    if (size > capacity()) grow(size);
  }
  void resize(std::size_t size) {
    reserve(size);
    for (std::size_t i = size_; i < size; ++i) data_[i] = T{};
    size_ = static_cast<std::uint32_t>(size);
  }
  void assign(std::size_t size, const T& value) {
    reserve(size);
    std::fill_n(data_, size, value);
    size_ = static_cast<std::uint32_t>(size);
  }
  void push_back(const T& value) {
    const T kept = value;
    reserve(size_ + std::size_t{1});
    data_[size_++] = kept;
  }

 private:
  std::size_t capacity() const { return units_ * RowMemory::kUnit / sizeof(T); }
  void grow(std::size_t size) {
    const std::size_t units = (std::max(size, 2 * capacity() * (size_ > 0)) * sizeof(T) + RowMemory::kUnit - 1) / RowMemory::kUnit;
    T* bigger = static_cast<T*>(RowMemory::here().take(units));
    if (size_ > 0) std::memcpy(static_cast<void*>(bigger), data_, size_ * sizeof(T));
    const std::uint32_t kept = size_;
    drop();
    data_ = bigger;
    size_ = kept;
    units_ = static_cast<std::uint32_t>(units);
  }
  void copy(const T* from, std::size_t size) {
    if (size > capacity()) {
      size_ = 0;
      grow(size);
    }
    if (size > 0) std::memcpy(static_cast<void*>(data_), from, size * sizeof(T));
    size_ = static_cast<std::uint32_t>(size);
  }
  void drop() {
    if (data_) RowMemory::here().give_back(data_, units_);
    data_ = nullptr;
    size_ = units_ = 0;
  }

  T* data_ = nullptr;
  std::uint32_t size_ = 0, units_ = 0;
};

}  // namespace pmac::motion
