// Circles of the application note at the set-up that its figures were worked out for: radius 4000 counts, 1000 counts/s, 4000 rpm.
#pragma once

#include <catch2/catch.hpp>

#include "runtime/drives/silverlode/figures.h"

namespace pmac::test {

inline drives::silverlode::CircleSetup circle(std::int64_t segments, double accel_rpm_s = 3000) {
  drives::silverlode::CircleSetup setup;
  setup.segments = segments;
  setup.limits.assign(2, {4000, accel_rpm_s});
  return setup;
}

inline drives::silverlode::Sheet sheet_of(const drives::silverlode::CircleSetup& setup, bool literal) {
  if (literal) return drives::silverlode::build_literal(setup);
  auto built = drives::silverlode::build_closed(setup);
  REQUIRE(built.index() == 0);
  return std::get<0>(built);
}

inline drives::silverlode::Table table_of(const drives::silverlode::CircleSetup& setup, bool literal) {
  auto made = drives::silverlode::table_from(sheet_of(setup, literal));
  REQUIRE(made.index() == 0);
  return std::get<0>(made);
}

}  // namespace pmac::test
