// UTF-16 by hand: U+00B0 (degree) is C2 B0 in UTF-8, U+1F600 is D83D DE00 in UTF-16 and F0 9F 98 80 in UTF-8.
#include <catch2/catch.hpp>

#include "compiler/compiler.h"
#include "compiler/source/encoding.h"
#include "tests/unit/project/project_files.h"

using pmac::source::decode_text;
using namespace std::string_literals;

TEST_CASE("UTF-16 of either byte order becomes UTF-8", "[encoding]") {
  CHECK(decode_text("\xff\xfe"s + "X\0\xb0\0\x3d\xd8\x00\xde"s) == "\xef\xbb\xbfX\xc2\xb0\xf0\x9f\x98\x80");
  CHECK(decode_text("\xfe\xff"s + "\0X\0\xb0\xd8\x3d\xde\x00"s) == "\xef\xbb\xbfX\xc2\xb0\xf0\x9f\x98\x80");
  CHECK(decode_text("\xff\xfe\x3d\xd8"s) == "\xef\xbb\xbf\xef\xbf\xbd");   // half a pair
  CHECK(decode_text("\xff\xfeX\0Y"s) == "\xef\xbb\xbfX");                  // half a unit
}

TEST_CASE("UTF-8 and Latin-1 are passed on", "[encoding]") {
  CHECK(decode_text("P1=1 // 5 \xb0 \xc2\xb0") == "P1=1 // 5 \xb0 \xc2\xb0");
}

TEST_CASE("a program compiles the same with CR LF, byte-order mark, Latin-1 comments and without final newline", "[encoding]") {
  const std::string plain = "global Speed\nopen prog 1\nlinear F(Speed)\nX10\nclose\n";
  const std::string rows[] = {"global Speed\r\nopen prog 1\r\nlinear F(Speed)\r\nX10\r\nclose\r\n", "\xef\xbb\xbf" + plain,
                              "global Speed // 5 \xb0\nopen prog 1 /* \xfc */\nlinear F(Speed)\nX10\nclose", "global Speed // 5 \xc2\xb0\nopen prog 1\nlinear F(Speed)\nX10\nclose"};
  const auto compiled = [](const std::string& text) {
    pmac::compiler::Session session;
    auto module = session.compile({{"a.pmc", text}});
    REQUIRE(module);
    return std::move(*module);
  };
  const auto expected = compiled(plain);
  for (const std::string& row : rows) CHECK(compiled(row) == expected);
  std::string wide = "\xff\xfe";
  for (const char c : plain) wide += {c, '\0'};
  CHECK(compiled(wide) == expected);
}
