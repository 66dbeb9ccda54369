// The reader of register scripts: what it takes, what it says about what it cannot take, and damaged text.
#include <catch2/catch.hpp>
#include <random>

#include "runtime/drives/mcx514/chip.h"

using namespace pmac::drives::mcx514;

namespace {

std::string problems(const std::string& text) {
  std::string all;
  for (const Problem& problem : read_script(text).problems)
    all += std::to_string(problem.line) + ":" + std::to_string(problem.column) + (problem.is_error ? " error: " : " warning: ") + problem.text + "\n";
  return all;
}

std::vector<std::pair<int, int>> writes(const std::string& text) {
  std::vector<std::pair<int, int>> found;
  for (const ScriptItem& item : read_script(text).items) found.emplace_back(item.reg, item.value);
  return found;
}

using Writes = std::vector<std::pair<int, int>>;

}  // namespace

TEST_CASE("a write is read however it is laid out", "[mcx514]") {
  const Writes expected = {{6, 0x0043}, {0, 0x002a}};
  CHECK(writes("WR6 <- 0043h Write ; define\nWR0 <- 002Ah Write\n") == expected);
  CHECK(writes("WR6\n\xe2\x86\x90\n0043h Write\n;\ndefine: ax1:X axis\nWR0\n\xe2\x86\x90\n002Ah Write\n") == expected);
  CHECK(writes("wr6=0043H\r\nwr0 = 002ah\r\n") == expected);
  CHECK(writes("WR6<-0043h WR0<-002Ah") == expected);
  CHECK(writes("\xef\xbb\xbfWR6 <- 0043h\n0.000000 WR0 <- 002Ah Write\n") == expected);
  CHECK(problems("WR6\n\xe2\x86\x90\n0043h Write\n;\ndefine: ax1:X axis\n:\n5000\nWR0\n\xe2\x86\x90\n002Ah Write\n").empty());
}

TEST_CASE("waits and reads are read", "[mcx514]") {
  const Script script = read_script("wait idle\nwait next ; comment\nwait 2.5 ms\nread RR0\nWAIT 3us\n");
  CHECK(script.problems.empty());
  REQUIRE(script.items.size() == 5);
  CHECK(script.items[0].kind == ScriptItem::Kind::kWaitIdle);
  CHECK(script.items[1].kind == ScriptItem::Kind::kWaitNext);
  CHECK(script.items[2].wait_s == Approx(0.0025));
  CHECK(script.items[3].kind == ScriptItem::Kind::kRead);
  CHECK(script.items[4].wait_s == Approx(3e-6));
}

TEST_CASE("a comment goes on over lines that are nothing else", "[mcx514]") {
  CHECK(problems("WR6 <- 0043h ; a comment that\nwent over the line\nWR0 <- 002Ah\n").empty());
  CHECK(problems("; wait for it\n; WR6 is set below\nWR0 <- 002Ah\n").empty());
  CHECK(problems("; Write it\nWrite on\nWR0 <- 002Ah\n").empty());
  CHECK(problems("; WR6 <- 0043h\nWR0 <- 002Ah\n") == "1:1 warning: a write inside a comment is not executed; give it a line of its own\n");
}

TEST_CASE("the text around a listing is passed over, and said so once", "[mcx514]") {
  CHECK(problems("3.2.3 The Example\nThis interpolation starts from\nWR6 <- 0043h\n") == "1:1 warning: the text before the first write is passed over\n");
}

TEST_CASE("what is no write is an error with its place, and reading goes on", "[mcx514]") {
  CHECK(problems("WR6 <- 0043h\nWR8 <- 0000h\nWR0 <- 43h\nWR0 <- 0G43h\nWR0 0043h\nMR6 <- 0043h\nhello\nWRX <- 0000h\nwait forever\nread RR9\nwait 5 min\n") ==
        "2:1 error: 'WR8' is no register; there are WR0 to WR7\n"
        "3:8 error: '43h' is no value; four hexadecimal digits and h are wanted, such as 03E8h\n"
        "4:8 error: '0G43h' is no value; four hexadecimal digits and h are wanted, such as 03E8h\n"
        "5:5 error: WR0 is not followed by <- and a value\n"
        "6:1 error: 'MR6 <- 0043h' is no register write; write WRn <- 0000h, and begin a comment with ;\n"
        "7:1 error: 'hello' is no register write; write WRn <- 0000h, and begin a comment with ;\n"
        "8:1 error: 'WRX' is no register; there are WR0 to WR7\n"
        "9:6 error: wait is followed by idle, next or a time such as 2.5 ms, not by 'forever'\n"
        "10:6 error: 'RR9' is no register; there are RR0 to RR7\n"
        "11:8 error: the unit of a time is us, ms or s, not 'min'\n");
}

TEST_CASE("a script that ends inside a write says so", "[mcx514]") {
  CHECK(problems("WR6 <- 0043h\nWR0") == "2:1 error: the script ends inside a write to WR0\n");
  CHECK(problems("WR6 <- 0043h\nWR0 <-") == "2:7 error: the script ends inside a write; the value is missing\n");
  CHECK(problems("WR6 <- 00") == "1:8 error: '00' is no value; four hexadecimal digits and h are wanted, such as 03E8h\n");
}

TEST_CASE("random and damaged scripts are read and run without harm", "[mcx514]") {
  const std::string whole =
      "WR6 <- 0043h Write ; define\nWR0 <- 002Ah\nWR6 <- 03E8h\nWR7 <- 0000h\nWR0 <- 0104h\nWR0 <- 0105h\nWR6 <- 0032h\nWR0 <- 0108h\nWR6 <- 0000h\nWR0 <- 0208h\n"
      "WR0 <- 0306h\nWR0 <- 0064h Write\nwait idle\nread RR0\nwait 2.5 ms\nWR0 <- 0061h\nwait next\nWR0 <- 0152h\nWR0 <- 0157h\n";
  std::mt19937 random(7);
  for (int round = 0; round < 1500; ++round) {
    std::string text = whole;
    for (int k = 0; k < 1 + round % 12; ++k) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0: text[at] = static_cast<char>(random() % 256); break;
        case 1: text.erase(at, 1 + random() % 5); break;
        case 2: text.insert(at, text.substr(random() % text.size(), random() % 30)); break;
        default: text[at] = "0123456789ABCDEFh"[random() % 17];
      }
      if (text.empty()) text = "W";
    }
    const Script script = read_script(text);
    Chip chip;
    chip.set_latest(time_from_seconds(100));
    if (run_items(script, chip)) chip.run_until_idle();
    REQUIRE(script.problems.size() <= 101);
  }
  std::string garbage;
  for (int round = 0; round < 300; ++round) {
    garbage.clear();
    for (int k = 0; k < 400; ++k) garbage += static_cast<char>(random() % 256);
    read_script(garbage);
  }
}
