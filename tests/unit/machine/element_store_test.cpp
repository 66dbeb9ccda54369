// Values and addresses of data-structure elements.
#include <catch2/catch.hpp>

#include "compiler/bytecode/element.h"
#include "runtime/element_store.h"

using pmac::bytecode::ElementId;
using pmac::bytecode::element_info;
using namespace pmac::runtime;

TEST_CASE("elements begin at their defaults, acting or stored", "[elements]") {
  const ElementStore store;
  CHECK(store.get(ElementId::kMotorJogSpeed, 3) == 32);           // idle controllers' saved files
  CHECK(store.get(ElementId::kMotorAdcMask, 3) == 0xfff00000);
  CHECK(store.get(ElementId::kEncTableType, 767) == 1);
  CHECK_FALSE(store.assigned(ElementId::kMotorAdcMask, 3));
}

TEST_CASE("an element keeps what was assigned to it, and its neighbours keep theirs", "[elements]") {
  ElementStore store;
  store.assign({ElementId::kGate3ChanAdcOffset, {15, 3, 1}}, -7);
  store.assign({ElementId::kMotorJogSpeed, {32, 0, 0}}, 5);
  CHECK(store.get(ElementId::kGate3ChanAdcOffset, 15, 3, 1) == -7);
  CHECK(store.get(ElementId::kGate3ChanAdcOffset, 15, 3, 0) == 0);
  CHECK(store.get(ElementId::kMotorJogSpeed, 32) == 5);
  CHECK(store.get(ElementId::kMotorJogSpeed, 31) == 32);
  CHECK(store.assigned(ElementId::kGate3ChanAdcOffset, 15, 3, 1));
  CHECK(store.assigned(ElementId::kMotorJogSpeed, 32));
}

TEST_CASE("a motor reads its own entry of the encoder table until it is told otherwise", "[elements]") {
  const ElementStore store;
  DecodedAddress address;
  REQUIRE(decode_address(store.get(ElementId::kMotorPEnc, 4), address));
  CHECK(element_text(address.element) == "EncTable[4]");
  REQUIRE(decode_address(store.get(ElementId::kCoordPDesTimeBase, 2), address));
  CHECK(element_text(address.element) == "Coord[2].DesTimeBase");
}

TEST_CASE("every element has addresses that lead back to it", "[elements]") {
  for (int e = 0; e < static_cast<int>(ElementId::kCount); ++e) {
    ElementAddress last{static_cast<ElementId>(e), {}};
    const auto& info = element_info(last.id);
    for (int i = 0; i < info.index_count(); ++i) last.index[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(info.index_counts[i] - 1);
    for (const ElementAddress& address : {ElementAddress{last.id, {}}, last}) {
      ElementAddress back;
      INFO(element_text(address));
      REQUIRE(decode_address(encode_address(address), back));
      CHECK(back == address);
    }
    CHECK(info.size() <= 1 << 24);  // what an address number has room for
  }
}

TEST_CASE("bytes behind a place belong to it, and numbers that are no address are none", "[elements]") {
  DecodedAddress address;
  REQUIRE(decode_address(pmac::bytecode::kPushm + 0x2c, address));
  CHECK(address.element.id == ElementId::kSysPushm);
  CHECK(address.offset == 0x2c);
  ElementAddress exact;
  CHECK_FALSE(decode_address(pmac::bytecode::kPushm + 0x2c, exact));
  for (const double number : {0.0, -1.0, 5.0, 0x1p40 + 0.5, 0x1p53, 1e300}) CHECK_FALSE(decode_address(number, address));
}

TEST_CASE("what is saved is what was assigned, in the order of the table", "[elements]") {
  ElementStore store;
  CHECK(store.saved().empty());
  store.assign({ElementId::kMotorAdcMask, {1, 0, 0}}, 1);
  store.assign({ElementId::kMotorJogSpeed, {2, 0, 0}}, 20);
  store.assign({ElementId::kMotorJogSpeed, {3, 0, 0}}, 32);       // its default: a load of it sets it all the same
  store.assign({ElementId::kSysCdTimer, {3, 0, 0}}, 100);         // not a saved element
  const auto saved = store.saved();
  REQUIRE(saved.size() == 3);
  CHECK(element_text(saved[0].first) == "Motor[2].JogSpeed");
  CHECK(element_text(saved[1].first) == "Motor[3].JogSpeed");
  CHECK(element_text(saved[2].first) == "Motor[1].AdcMask");
}
