// Variables by computed number, elements, and synchronous assignments. Numbers are truncated toward zero; a number outside
// the class is a fault (the controller leaves it undefined, Users Manual p553-555).
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/module_text.h"
#include "runtime/interpreter/core.h"

namespace pmac::runtime {

using bytecode::VariableClass;

bool InterpreterCore::variable(VariableClass variable_class, double number, int& index) {
  int count = bytecode::variable_class_count(variable_class);
  if (variable_class == VariableClass::kL) count = static_cast<int>(program().local_count);
  if (variable_class == VariableClass::kR) count = static_cast<int>(program().outgoing_count);
  if (number > -1.0 && number < count) {
    index = static_cast<int>(number);
    return true;
  }
  const std::string name = bytecode::variable_class_name(variable_class);
  const std::string range = count == 0 ? "there are none here" : "the range is " + name + "0 to " + name + std::to_string(count - 1);
  fault("variable " + name + "(" + bytecode::number_text(number) + ") does not exist; " + range);
  return false;
}

double InterpreterCore::read_variable(VariableClass variable_class, int index, const double* r) {
  const auto i = static_cast<std::size_t>(index);
  switch (variable_class) {
    case VariableClass::kP: return thread_.p[i];
    case VariableClass::kQ: return thread_.q[i];
    case VariableClass::kM: return host_.read_m(thread_, index);
    case VariableClass::kI: return host_.read_i(thread_, index);
    case VariableClass::kL: return r[i];
    case VariableClass::kR: return r[program().frame_size + i];
    case VariableClass::kC: return thread_.c[i];
    case VariableClass::kD: return thread_.d[i];
    case VariableClass::kElement: break;
  }
  return 0;
}

void InterpreterCore::write_variable(VariableClass variable_class, int index, double value, double* r) {
  const auto i = static_cast<std::size_t>(index);
  switch (variable_class) {
    case VariableClass::kP: thread_.p[i] = value; break;
    case VariableClass::kQ: thread_.q[i] = value; break;
    case VariableClass::kM: host_.write_m(thread_, index, value); break;
    case VariableClass::kI: host_.write_i(thread_, index, value); break;
    case VariableClass::kL: r[i] = value; break;
    case VariableClass::kR: r[program().frame_size + i] = value; break;
    case VariableClass::kC: thread_.c[i] = value; break;
    case VariableClass::kD: thread_.d[i] = value; break;
    case VariableClass::kElement: break;
  }
}

bool InterpreterCore::load_indexed(const Instruction& in, double* r) {
  const auto variable_class = static_cast<VariableClass>(in.c());
  int index = 0;
  if (!variable(variable_class, r[in.b()], index)) return false;
  r[in.a] = read_variable(variable_class, index, r);
  return !host_failed();
}

bool InterpreterCore::store_indexed(const Instruction& in, double* r) {
  const auto variable_class = static_cast<VariableClass>(in.c());
  int index = 0;
  if (!variable(variable_class, r[in.b()], index)) return false;
  write_variable(variable_class, index, r[in.a], r);
  return !host_failed();
}

bool InterpreterCore::resolve(const bytecode::ElementRef& ref, const double* r, ElementAddress& address) {
  address.id = ref.id;
  const bytecode::ElementInfo& info = bytecode::element_info(ref.id);
  for (std::size_t i = 0; i < bytecode::kMaxElementIndices; ++i) {
    const bytecode::ElementRef::Index& index = ref.index[i];
    address.index[i] = index.value;
    if (!index.is_register) continue;
    const double value = r[index.value];
    if (!(value > -1.0 && value < info.index_counts[i])) {
      fault("index " + bytecode::number_text(value) + " of " + std::string(info.name) + " is out of range; it is 0 to " +
            std::to_string(info.index_counts[i] - 1));
      return false;
    }
    address.index[i] = static_cast<std::uint32_t>(value < 0 ? 0 : value);
  }
  return true;
}

bool InterpreterCore::load_element(const Instruction& in, double* r) {
  const bytecode::ElementRef& ref = thread_.program_.module->element_refs[static_cast<std::size_t>(in.imm)];
  ElementAddress address;
  if (!resolve(ref, r, address)) return false;
  r[in.a] = ref.address ? host_.element_address(thread_, address) : host_.read_element(thread_, address);
  return !host_failed();
}

InterpreterCore::Next InterpreterCore::store_element(const Instruction& in, const double* r) {
  ElementAddress address;
  const auto index = static_cast<std::size_t>(in.imm);
  if (!resolve(thread_.program_.module->element_refs[index], r, address)) return Next::kLeave;
  return after(host_.write_element(thread_, address, r[in.a]));
}

InterpreterCore::Next InterpreterCore::sync_store(const Instruction& in, const double* r) {
  const bytecode::Module& module = *thread_.program_.module;
  bytecode::SyncTarget target = module.sync_targets[static_cast<std::size_t>(in.imm)];
  ElementAddress address;
  if (target.variable_class == VariableClass::kElement) {
    if (!resolve(module.element_refs[target.element], r, address)) return Next::kLeave;
  } else if (target.number_register != 0xffff) {
    if (!variable(target.variable_class, r[target.number_register], target.number)) return Next::kLeave;
    target.number_register = 0xffff;
  }
  return after(host_.queue_assignment(thread_, target, address, r[in.a]));
}

}  // namespace pmac::runtime
