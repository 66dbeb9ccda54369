// Values as the controller writes them. Expected texts: saved configurations of controllers.
#include <catch2/catch.hpp>

#include "compiler/bytecode/element.h"
#include "runtime/element_store.h"
#include "runtime/value_text.h"

using pmac::bytecode::ElementType;
using namespace pmac::runtime;

TEST_CASE("doubles have 18 digits and a short exponent", "[values]") {
  CHECK(double_text(0.44274211) == "0.442742110000000022");
  CHECK(double_text(1e-4) == "1.00000000000000005e-4");
  CHECK(double_text(5e-4) == "5.0000000000000001e-4");
  CHECK(double_text(0.001) == "0.00100000000000000002");
  CHECK(double_text(1e-8) == "1.00000000000000002e-8");
  CHECK(double_text(0.008) == "0.00800000000000000017");
  CHECK(double_text(0.2) == "0.200000000000000011");
  CHECK(double_text(-10) == "-10");
  CHECK(double_text(0) == "0");
  CHECK(double_text(0.25) == "0.25");
  CHECK(double_text(1e300) == "1.00000000000000005e300");
}

TEST_CASE("floats have 8 digits", "[values]") {
  CHECK(float_text(1e-4) == "9.9999997e-5");
  CHECK(float_text(0.01) == "0.0099999998");
  CHECK(float_text(5e-4) == "5.0000002e-4");
  CHECK(float_text(166.66667) == "166.66667");
  CHECK(float_text(140845824) == "1.4084582e8");
  CHECK(float_text(32) == "32");
}

TEST_CASE("masks are hexadecimal", "[values]") {
  CHECK(mask_text(0x1fd) == "$1fd");
  CHECK(mask_text(0) == "$0");
  CHECK(mask_text(0xfff00000) == "$fff00000");
  CHECK(mask_text(-1) == "$ffffffff");
}

TEST_CASE("addresses are names", "[values]") {
  using pmac::bytecode::ElementId;
  CHECK(value_text(ElementType::kAddress, pmac::bytecode::kPushm) == "Sys.pushm");
  CHECK(value_text(ElementType::kAddress, pmac::bytecode::kPushm + 0x2c) == "Sys.pushm+$2c");
  CHECK(value_text(ElementType::kAddress, encode_address({ElementId::kStructureEncTable, {1, 0, 0}})) == "EncTable[1].a");
  CHECK(value_text(ElementType::kAddress, encode_address({ElementId::kSysSineTable, {0, 0, 0}})) == "Sys.SineTable[0].a");
  CHECK(value_text(ElementType::kAddress, 0) == "0");
}
