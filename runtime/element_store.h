// The values of data-structure elements, by element and indices. What an element does is the machine's business; here it only has
// a value, its default, and whether a program or set-up file has assigned it.
//
// Elements that act have a slot each, found by one addition. The others are a thousand names with up to millions of places each,
// of which a project assigns few: they are kept in a map of what was assigned.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "runtime/interpreter/interpreter.h"

namespace pmac::runtime {

class ElementStore {
 public:
  /// Every element at its default.
  ElementStore();

  double get(bytecode::ElementId id, unsigned i0 = 0, unsigned i1 = 0, unsigned i2 = 0) const {
    const Row& row = rows_[static_cast<std::size_t>(id)];
    return row.dense ? values_[row.base + row.place(i0, i1, i2)] : sparse_value(id, row.place(i0, i1, i2));
  }
  void set(bytecode::ElementId id, double value, unsigned i0 = 0, unsigned i1 = 0, unsigned i2 = 0) {
    const Row& row = rows_[static_cast<std::size_t>(id)];
    if (row.dense) values_[row.base + row.place(i0, i1, i2)] = value;
    else sparse_[key(id, row.place(i0, i1, i2))] = value;
  }
  double get(const ElementAddress& a) const { return get(a.id, a.index[0], a.index[1], a.index[2]); }
  /// Stores and remembers that the element was assigned.
  void assign(const ElementAddress& a, double value);
  bool assigned(bytecode::ElementId id, unsigned i0 = 0, unsigned i1 = 0, unsigned i2 = 0) const;

  /// Saved elements that were assigned or are not at their default, ascending by element and place.
  std::vector<std::pair<ElementAddress, double>> saved() const;

 private:
  /// Where the values of an element begin, and how many its second and third index count.
  struct Row {
    std::size_t base = 0, count1 = 1, count2 = 1;
    bool dense = true;
    std::size_t place(unsigned i0, unsigned i1, unsigned i2) const { return (i0 * count1 + i1) * count2 + i2; }
  };
  static std::uint64_t key(bytecode::ElementId id, std::size_t place) { return static_cast<std::uint64_t>(id) << 40 | place; }
  double sparse_value(bytecode::ElementId id, std::size_t place) const;

  std::vector<Row> rows_;           // by element
  std::vector<double> values_;
  std::vector<bool> assigned_;      // by slot of values_
  std::unordered_map<std::uint64_t, double> sparse_;
};

/// An address that a number stands for: an element or structure, and bytes behind it (Sys.pushm+$2c).
struct DecodedAddress { ElementAddress element; std::uint64_t offset = 0; };

/// A number that stands for the address of an element (Element.a), and back; never 0.
double encode_address(const ElementAddress& address);
/// False where the number is not the address of an element, or lies behind one.
bool decode_address(double number, ElementAddress& address);
bool decode_address(double number, DecodedAddress& address);
/// "Motor[3].DesPos".
std::string element_text(const ElementAddress& address);

}  // namespace pmac::runtime
