// The language of the ACR1000: what is refused with which id, what the words mean, and what programs become. Ids and rules: docs/acr1000_language.md.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "compiler/bytecode/bytecode.h"
#include "compiler/bytecode/card.h"
#include "compiler/bytecode/opcode.h"
#include "compiler/compiler.h"

using namespace pmac;

namespace {

compiler::Session session(const std::vector<std::string>& settings = {}) {
  compiler::Options options;
  options.dialect = compiler::Dialect::kAcr1000;
  options.card_settings = settings;
  return compiler::Session(options);
}

struct Compiled {
  std::optional<bytecode::Module> module;
  std::vector<source::Diagnostic> messages;
};

Compiled compile(const std::string& text, const std::vector<std::string>& settings = {}, const std::string& name = "a.acr") {
  compiler::Session s = session(settings);
  Compiled compiled;
  compiled.module = s.compile({{name, text}});
  compiled.messages = s.diagnostics().take();
  return compiled;
}

std::string codes_of(const Compiled& compiled) {
  std::string codes;
  for (const source::Diagnostic& message : compiled.messages) codes += (codes.empty() ? "" : " ") + message.code;
  return codes;
}

std::string ir_of(const std::string& text, const std::vector<std::string>& settings = {}) {
  compiler::Session s = session(settings);
  std::string ir = compiler::emit_ir(s, {{"a.acr", text}});
  for (const source::Diagnostic& message : s.diagnostics().take()) ir += message.code + ": " + message.message + "\n";
  return ir;
}

struct Refused { const char* line; const char* code; const char* says; };

// One line each; the text behind the code is what the person has to be told.
const Refused kRefused[] = {
    {"10 JUMP 100", "ACR-E01", "no command begins with 'JUMP'"},
    {"10 MVO 5", "ACR-E01", "did you mean MOV"},
    {"JOG 5", "ACR-E01", "JOG is not part of the documented ACR1000 subset"},
    {"CIRCCW 5", "ACR-E01", "CIRCCW is not part of"},
    {"DWL 5", "ACR-E01", "DWL is not part of"},
    {"10 FOR", "ACR-E01", "FOR is not part of"},
    {"X", "ACR-E01", "no command begins with 'X'"},
    {"10 MOV", "ACR-E02", "MOV takes a target"},
    {"10 MOV 1,2", "ACR-E02", "',' cannot stand here"},
    {"10 MOV 1.5", "ACR-E02", "numbers are whole"},
    {"10 VELOCITY 5", "ACR-E02", "'VELOCITY' is no spelling of VEL"},
    {"10 CIRCLE 1,10,10,0", "ACR-E02", "CIRCLE takes direction, radius, I, J and distance"},
    {"10 CIRCLE 1,10,10,0,62,5", "ACR-E02", "',' cannot stand here"},
    {"10 ACC 5::DEC 5", "ACR-E02", "a command is missing before this :"},
    {"10 ACC 5:", "ACR-E02", "a command is missing at the end"},
    {"10 P30", "ACR-E02", "a parameter takes one value"},
    {"10 P30=P31+1", "ACR-E02", "ARITHMETIC=1"},
    {"10 MOV -P30", "ACR-E02", "a sign stands before a number"},
    {"10 IF 96 GOTO 10", "ACR-E02", "IF takes a relay number, THEN"},
    {"10 MOV 5 REM HERE", "ACR-E02", "put a : before it"},
    {"10 RUN 5", "ACR-E02", "RUN stands alone"},
    {"10 /5", "ACR-E02", "a command begins with its name, not with '/'"},
    {"10 MOV #5", "ACR-E02", "'#' means nothing to the card"},
    {"10 MOV &5", "ACR-E02", "&H and digits"},
    {"10 PEEK 401D", "ACR-E02", "PEEK takes an address"},
    {"65536 MOV 5", "ACR-E03", "line numbers are from 0 to 65535"},
    {"10 GOTO 70000", "ACR-E03", "line numbers are from 0 to 65535"},
    {"99999999999999999999 MOV 5", "ACR-E03", "line numbers"},
    {"10 MOV 2147483648", "ACR-E04", "32 bits"},
    {"10 MOV &H123456789", "ACR-E04", "at most 8 digits"},
    {"10 VEL 65536", "ACR-E04", "version 4 has velocities of 24 bits"},
    {"10 VEL -1", "ACR-E04", "VEL is from 0 to 65535, not -1"},
    {"10 STP -5", "ACR-E04", "STP is from 0"},
    {"10 SET 70000", "ACR-E04", "the number of a relay"},
    {"POKE 401D=100", "ACR-E04", "a byte is hexadecimal from 0 to FF"},
    {"PEEK 401DE,4", "ACR-E04", "an address is hexadecimal"},
    {"POKE FFFF=0,0", "ACR-E04", "behind the last address"},
    {"10 p30=5", "ACR-E05", "a capital P: P30"},
    {"10 MOV p30", "ACR-E05", "a capital P"},
    {"10 P50=1", "ACR-E05", "P0 to P49"},
    {"10 MOV P", "ACR-E05", "P and its number"},
    {"10 GOTO &H0A", "ACR-E06", "decimal digits"},
    {"10 GSB P30", "ACR-E06", "decimal digits"},
    {"10 IF 96 THEN &H0A", "ACR-E06", "decimal digits"},
    {"10 GOTO -10", "ACR-E06", "decimal digits"},
    {"10 RENUMBER", "ACR-E09", "command mode only"},
    {"GSB 100", "ACR-E09", "stored line only"},
    {"RET", "ACR-E09", "give the line a number"},
    {"10 CIRCLE 2,10,10,0,62", "ACR-E10", "1 (clockwise) or -1"},
    {"10 CIRCLE 1,0,10,0,62", "ACR-E10", "radius"},
    {"10 CIRCLE 1,10,10,0,-62", "ACR-E10", "distance"},
    {"HEX 04 80 10 27", "ACR-E12", "8 of 12 bytes are missing"},
    {"HEX 05", "ACR-E12", "begins with 04"},
    {"HEX 04 81 0", "ACR-E12", "no row of bytes"},
    {"HEX 04 8F 10 27 A0 86 01 00 A8 61 00 00", "ACR-E12", "reserved"},
    {"HEX 04 90 90 D0 03 A0 86 01 00 A8 61 00 00", "ACR-E12", "version 4"},
    {"10 PRINT \"READY", "ACR-E14", "put a quote behind it"},
    {"SYSTEM VEL_UNITS=2", "ACR-H01", "did you mean VEL_UNIT"},
    {"SYSTEM PARAMS=0", "ACR-H01", "PARAMS is a whole number"},
    {"AXIS", "ACR-H01", "name of the axis"},
    {"AXIS X START=1.5", "ACR-H01", "whole pulses"},
    {"AXIS X BIT 5=2", "ACR-H01", "BIT takes"},
};

}  // namespace

TEST_CASE("ACR1000: every wrong line has its id and says what to do", "[acr1000]") {
  for (const Refused& refused : kRefused) {
    const Compiled compiled = compile(refused.line);
    INFO(refused.line);
    CHECK_FALSE(compiled.module);
    REQUIRE(compiled.messages.size() == 1);
    INFO(compiled.messages[0].message);
    CHECK(compiled.messages[0].code == refused.code);
    CHECK(compiled.messages[0].message.find(refused.says) != std::string::npos);
  }
}

TEST_CASE("ACR1000: several errors are found in one run", "[acr1000]") {
  CHECK(codes_of(compile("10 JUMP\n20 MOV\n30 p1=2\n40 MOV 5\nAXIS ?\n")) == "ACR-E01 ACR-E02 ACR-E05 ACR-H01");
}

TEST_CASE("ACR1000: executive versions", "[acr1000]") {
  CHECK(codes_of(compile("10 ACC 5:DEC 5", {"VERSION=2.6.965"})) == "ACR-E15");
  CHECK(codes_of(compile("10 ACC 5:DEC 5", {"VERSION=2.6.966"})).empty());
  CHECK(codes_of(compile("SYSTEM VERSION=2.6\n10 P28=5\n20 CIRCLE 1,10,10,0,62")) == "ACR-E15 ACR-E15");
  CHECK(codes_of(compile("10 VEL 16777215", {"VERSION=4"})).empty());
  CHECK(codes_of(compile("10 VEL 16777216", {"VERSION=4"})) == "ACR-E04");
  CHECK(codes_of(compile("SYSTEM VERSION=2.7\n10 VEL 70000", {"VERSION=4"})).empty());  // the command line has the last word
}

TEST_CASE("ACR1000: a branch to a missing line is a warning, and an instruction that fails when it is taken", "[acr1000]") {
  const Compiled compiled = compile("10 IF 1 THEN GOTO 1000\n20 GSB 2000");
  CHECK(codes_of(compiled) == "ACR-W01 ACR-W01");
  REQUIRE(compiled.module);
  const std::string text = bytecode::disassemble(*compiled.module);
  CHECK(text.find("missing.line") != std::string::npos);
}

TEST_CASE("ACR1000: blanks, case and spellings do not count", "[acr1000]") {
  const std::string same = ir_of("10 MOVE 1000:DECEL 10:IF 1 THEN 10");
  for (const char* line : {"10MOV1000:DEC10:IF1THEN10", "1 0 m o v e 1 0 0 0 : d e c 1 0 : i f 1 t h e n 1 0", "10 Move\t&H3E8:DECE10:If 1 Then 10", "10 MOV +1000 : DEC +10 : IF +1 THEN GOTO 10"})
    CHECK(ir_of(line) == same);
  CHECK(ir_of("10 MOVEP32") == ir_of("10 MOV P32"));
  CHECK(ir_of("10 GSB 10") == ir_of("10 GOSUB 10"));
  CHECK(ir_of("10 MOV &HFFFFFFFF") == ir_of("10 MOV -1"));
  CHECK(ir_of("POK E000=1") == ir_of("POKE 0=1"));  // the E goes to the spelling
}

TEST_CASE("ACR1000: quotes keep blanks, : and quotes of a remark open no text", "[acr1000]") {
  CHECK(ir_of("PRINT \"a : b\"").find("send 0 \"a : b\r\n\"") != std::string::npos);
  CHECK(ir_of("10 REM 2\" BORE").find("ACR") == std::string::npos);
  CHECK(ir_of("10 MOV 5: REM THE : END \" ").find("ACR") == std::string::npos);
}

TEST_CASE("ACR1000: lines are replaced, deleted and kept in order", "[acr1000]") {
  CHECK(ir_of("30 MOV 3\n10 MOV 1\n20 MOV 9\n20 MOV 2\n25 MOV 7\n25\n99") == ir_of("10 MOV 1\n20 MOV 2\n30 MOV 3"));
  CHECK(ir_of("10 MOV 1\nNEW\n20 MOV 2\n").find("label 10") == std::string::npos);
}

TEST_CASE("ACR1000: RENUMBER takes the branches along", "[acr1000]") {
  const std::string ir = ir_of("5 MOV 1\n7 IF 96 THEN 7\n8 GSB 100:GOTO 5\n100 RET\nRENUMBER\n");
  for (const char* part : {"label 10", "label 20", "label 30", "label 40", "goto 20", "gosub 40", "goto 10"}) CHECK(ir.find(part) != std::string::npos);
  CHECK(ir.find("label 100") == std::string::npos);
  CHECK(ir_of("5 GOTO 9\nRENUMBER").find("RENUMBER leaves this branch as it is") != std::string::npos);
}

TEST_CASE("ACR1000: a bare sign is the direction of a CIRCLE", "[acr1000]") {
  CHECK(ir_of("CIRCLE +,10,10,0,62") == ir_of("CIRCLE 1,10,10,0,62"));
  CHECK(ir_of("CIRCLE -,10,10,0,62") == ir_of("CIRCLE -1,10,10,0,62"));
  CHECK(ir_of("CIRCLE P30,P31,P32,P33,P34").find("card circle (P30, P31, P32, P33, P34)") != std::string::npos);
}

TEST_CASE("ACR1000: arithmetic is an extension", "[acr1000]") {
  CHECK(codes_of(compile("10 P30=(P31+2)*3/-P32", {"ARITHMETIC=1"})).empty());
  CHECK(codes_of(compile("SYSTEM ARITHMETIC=ON\n10 MOV P30-1")).empty());
  CHECK(codes_of(compile("10 P30=2*3")) == "ACR-E02");
}

TEST_CASE("ACR1000: a program gets its RUN, unless the file has one", "[acr1000]") {
  const auto runs = [](const std::string& text) {
    const std::string ir = ir_of(text);
    std::size_t count = 0;
    for (std::size_t at = ir.find("card run"); at != std::string::npos; at = ir.find("card run", at + 1)) ++count;
    return count;
  };
  CHECK(runs("10 MOV 5") == 1);
  CHECK(runs("10 MOV 5\nRUN\nRUN") == 2);
  CHECK(runs("MOV 5") == 0);
}

TEST_CASE("ACR1000: cards come from sections, file names and columns", "[acr1000]") {
  const auto axes = [](const std::vector<compiler::InputFile>& files) {
    compiler::Session s = session();
    const auto module = s.compile(files);
    std::string names;
    if (module)
      for (const std::uint32_t index : module->load_order) names += module->programs[index].name + " ";
    for (const source::Diagnostic& message : s.diagnostics().take()) names += message.code;
    return names;
  };
  CHECK(axes({{"a.acr", "SYSTEM VERSION=2.7\nAXIS X START=0\nMOV 1\nAXIS Y2\nMOV 2\n"}}) == "X Y2 ");
  CHECK(axes({{"dir.x/contour.y.acr", "MOV 1"}, {"contour.x.acr", "MOV 2"}}) == "Y X ");
  CHECK(axes({{"a.acr", "MOV 1"}, {"b.acr", "MOV 2"}}) == "X Y ");
  CHECK(axes({{"a.acr", "X Axis Program\tY Axis Program\n10 ACC 0\t10 ACC 0\n\t20 MOV 5\n"}}) == "X Y ");
  CHECK(axes({{"a.acr", "MOV 1\nAXIS Y\nMOV 2"}}) == "ACR-H01");
  std::string many;
  for (char axis = 'A'; axis <= 'Q'; ++axis) many += std::string("AXIS ") + axis + "\nMOV 1\n";
  CHECK(axes({{"a.acr", many}}).find("ACR-H01") != std::string::npos);
}

TEST_CASE("ACR1000: CR, LF and CR LF end lines", "[acr1000]") {
  CHECK(ir_of("10 MOV 1\r20 MOV 2\r\n30 MOV 3\n") == ir_of("10 MOV 1\n20 MOV 2\n30 MOV 3"));
}

TEST_CASE("ACR1000: typed lines leave the stored program to the card", "[acr1000]") {
  compiler::Session s = session();
  const auto module = s.compile_online("P30=5:RUN:LIST", "port");
  REQUIRE(module);
  const std::string text = bytecode::disassemble(*module);
  CHECK(text.find("card") != std::string::npos);
  CHECK(text.find("list") != std::string::npos);
  CHECK(s.renumbered({"program", "7 GOTO 7\n9 RET\n"}) == std::vector<std::string>{"10 GOTO 10", "20 RET"});
}

TEST_CASE("ACR1000: damaged and random lines compile or are refused with a message", "[acr1000][robustness]") {
  constexpr unsigned kSeed = 20241107;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  const std::string_view kPieces[] = {"10 ", "MOV", "/", "P30", "=", "&H3E8", ":", "REM", "IF 96 THEN ", "GOTO 10", "GSB", "CIRCLE ", "+,", "1,2,3,4", "\"", "POKE 401D=", "0,0", "PEEK", "\r", "\n", "\t", "AXIS X", "SYSTEM PARAMS=9", "HEX 04", " 80", "(", ")", "*", "-", "RENUMBER", "NEW", "LIST", "RUN", "\xff", "\x04", std::string_view("\0", 1), "99999999999"};
  for (int round = 0; round < 3000; ++round) {
    std::string text;
    for (std::size_t i = below(40); i > 0; --i) text += below(6) == 0 ? std::string(1, static_cast<char>(below(256))) : std::string(kPieces[below(std::size(kPieces))]);
    compiler::Session s = session(round % 2 ? std::vector<std::string>{"ARITHMETIC=1"} : std::vector<std::string>{});
    const auto module = s.compile({{"fuzz.acr", text}});
    INFO(text);
    REQUIRE(module.has_value() != s.diagnostics().has_errors());
    compiler::Session online = session();
    online.compile_online(text, "port");
  }
}

TEST_CASE("ACR1000: nesting has a limit", "[acr1000][robustness]") {
  std::string conditions = "10 ", parentheses = "10 P1=";
  for (int i = 0; i < 100000; ++i) conditions += "IF 1 THEN ", parentheses += "(";
  CHECK(codes_of(compile(conditions + "MOV 1")) == "ACR-E02");
  CHECK(codes_of(compile(parentheses, {"ARITHMETIC=1"})) == "ACR-E02");
}

TEST_CASE("card verbs: each has a text of its own", "[acr1000]") {
  std::vector<std::string_view> texts;
  for (int verb = 0; verb < static_cast<int>(bytecode::CardVerb::kCount); ++verb) texts.push_back(bytecode::card_verb_info(static_cast<bytecode::CardVerb>(verb)).text);
  std::sort(texts.begin(), texts.end());
  CHECK(std::adjacent_find(texts.begin(), texts.end()) == texts.end());
}
