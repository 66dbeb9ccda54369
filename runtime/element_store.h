// The values of data-structure elements, by element and indices. What an element does is the machine's business; here it only has
// a value, its default, and whether a program or set-up file has assigned it.
#pragma once

#include <cstddef>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "runtime/interpreter/interpreter.h"

namespace pmac::runtime {

class ElementStore {
 public:
  /// Every element at its default.
  ElementStore();

  double get(bytecode::ElementId id, unsigned i0 = 0, unsigned i1 = 0, unsigned i2 = 0) const {
    return values_[slot(id, i0, i1, i2)];
  }
  void set(bytecode::ElementId id, double value, unsigned i0 = 0, unsigned i1 = 0, unsigned i2 = 0) {
    values_[slot(id, i0, i1, i2)] = value;
  }
  double get(const ElementAddress& a) const { return get(a.id, a.index[0], a.index[1], a.index[2]); }
  /// Stores and remembers that the element was assigned.
  void assign(const ElementAddress& a, double value);
  bool assigned(bytecode::ElementId id, unsigned i0 = 0, unsigned i1 = 0, unsigned i2 = 0) const {
    return assigned_[slot(id, i0, i1, i2)];
  }

 private:
  /// Where the values of an element begin, and how many its second and third index count; 0 for views.
  struct Row { std::size_t base = 0; std::size_t count1 = 1, count2 = 1; bool view = false; };
  std::size_t slot(bytecode::ElementId id, unsigned i0, unsigned i1, unsigned i2) const {
    const Row& row = rows_[static_cast<std::size_t>(id)];
    return row.view ? row.base : row.base + (i0 * row.count1 + i1) * row.count2 + i2;
  }
  std::vector<Row> rows_;           // by element
  std::vector<double> values_;
  std::vector<bool> assigned_;
};

/// A number that stands for the address of an element (Element.a), and back; never 0.
double encode_address(const ElementAddress& address);
/// False where the number is not an address.
bool decode_address(double number, ElementAddress& address);
/// "Motor[3].DesPos".
std::string element_text(const ElementAddress& address);

}  // namespace pmac::runtime
