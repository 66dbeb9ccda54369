// Binds names to numbers and elements, assigns local variables, and checks what the grammar cannot: ranges, types, labels,
// assignability, motion. It fills the bindings of the IR and reports; it changes nothing else, except that it addresses
// coordinate system 1 where a load stream uses Q variables before addressing one.
#pragma once

#include <set>
#include <vector>

#include "compiler/ir/ir.h"
#include "compiler/sema/names.h"

namespace pmac::compiler::sema {

/// What later texts of a session must know of earlier ones.
struct Project {
  NameTable names;
  std::set<int> defined_axes;             // axis indices that some motor serves
  bool has_axis_definitions = false;
  bool uses_inverse_kinematics = false;   // ->I: which axes are served is known only at run time
  std::set<int> reported_axes;            // axes that a warning was given for
  std::set<std::string> reported_elements;
  std::int64_t addressed_coord = -1;      // by the load stream, -1: none yet
  std::set<std::string> lexed_names;      // names the front end saw a declaration of, even a wrong one
};

struct Settings { bool online = false; };

/// Notes the numbers of PLC programs that have no name; call for every unit before declare(), so that no name takes one of them.
void reserve_numbers(const ir::Unit& unit, Project& project);

/// Declares the global names and programs of a unit; call for every unit before check().
void declare(ir::Unit& unit, Project& project, source::Diagnostics& diagnostics);

/// Binds and checks a unit.
void check(ir::Unit& unit, Project& project, const Settings& settings, source::Diagnostics& diagnostics);

/// Constants that are assigned to an element and make no sense there (check_values.cpp).
void check_element_values(const ir::Assign& assign, source::Diagnostics& diagnostics);

/// Moves on axes that no motor serves; call when every unit has been checked.
void check_served_axes(const std::vector<ir::Unit>& units, Project& project, source::Diagnostics& diagnostics);

/// Motion checks of one buffer: circles without centre, negative feed rates.
void check_motion(const ir::Body& body, source::Diagnostics& diagnostics);

}  // namespace pmac::compiler::sema
