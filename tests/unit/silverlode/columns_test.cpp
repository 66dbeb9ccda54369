// The columns under the letters of the note's spreadsheet.
#include <catch2/catch.hpp>

#include <algorithm>
#include <set>

#include "runtime/drives/silverlode/units.h"
#include "tests/unit/silverlode/circles.h"

using namespace pmac::drives::silverlode;
using pmac::test::circle;
using pmac::test::sheet_of;

namespace {

const Column& column(const std::vector<Column>& columns, const std::string& letters) {
  const auto at = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.letters == letters; });
  REQUIRE(at != columns.end());
  return *at;
}

}  // namespace

TEST_CASE("columns: every letter that the note names, once", "[silverlode]") {
  const auto columns = columns_of(sheet_of(circle(72), true));
  std::multiset<std::string> letters;
  for (const Column& c : columns) letters.insert(c.letters);
  for (const char* name : {"C32", "C33", "C34", "C35", "M2", "E38", "F38", "B", "C", "E", "F", "H", "I", "K", "L", "M", "O", "P", "R", "S", "T", "U", "V", "W", "X", "AA", "AB", "AC", "AD", "AE",
                           "AH", "AI", "AJ", "AK", "AL", "AM", "AN", "AO", "AP", "AQ", "AR", "AS", "AT", "AU"})
    CHECK(letters.count(name) == 1);
}

TEST_CASE("columns: theta has AV to BB of its own, and the gaps between X and Y, marked as inferred", "[silverlode]") {
  CircleSetup setup = circle(72);
  setup.knife_counts_deg = 10;
  setup.limits.push_back({4000, 3000});
  const auto columns = columns_of(sheet_of(setup, false));
  for (const char* name : {"AV", "AW", "AX", "AY", "AZ", "BA", "BB"}) CHECK_FALSE(column(columns, name).inferred);
  for (const char* name : {"D", "G", "J", "N", "Q", "Y", "Z", "AF", "AG"}) CHECK(column(columns, name).inferred);
}

TEST_CASE("columns: the check columns find the end that the simulated servos find", "[silverlode]") {
  const auto columns = columns_of(sheet_of(circle(72), false));
  CHECK(column(columns, "AN").values.back() == Approx(0).margin(0.001));
  CHECK(column(columns, "AU").values.back() == Approx(0).margin(0.001));
  CHECK(column(columns, "AN").values[36] == Approx(-8000).margin(1));    // half way round, at the start of a ramp
  CHECK(column(columns, "AM").values.back() == 209491);
  CHECK(column(columns, "C32").values[0] == Approx(25132.741228718343));
}
