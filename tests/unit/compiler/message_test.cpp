// The table of messages against the sources that report them, and the page made from it.
#include "compiler/source/message.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>

#include "compiler/compiler.h"

using namespace pmac::source;

namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Code -> the calls it is reported by ("error", "warning"), over all sources of the compiler.
std::map<std::string, std::set<std::string>> reported_codes() {
  std::map<std::string, std::set<std::string>> codes;
  const std::regex any("\"(PM[0-9]{4}|ACR-[EHW][0-9]{2})\""), call("(error|warning)\\(\"(PM[0-9]{4}|ACR-[EHW][0-9]{2})\"");
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(PMAC_SOURCE_DIR) / "compiler")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".cpp" && extension != ".h" && extension != ".def") continue;
    const std::string text = read(entry.path());
    for (std::sregex_iterator it(text.begin(), text.end(), any), end; it != end; ++it) codes[(*it)[1]];
    for (std::sregex_iterator it(text.begin(), text.end(), call), end; it != end; ++it) codes[(*it)[2]].insert((*it)[1]);
  }
  return codes;
}

/// What an example stands in: files, or buffers.
struct Context { const char* before; const char* after; };
constexpr Context kContexts[] = {{"", ""},
                                 {"open prog 1\n", "\nclose"},
                                 {"open plc 1\n", "\nclose"},
                                 {"global Table(10), Speed\nopen prog 1\nlocal i, m\nlinear\n", "\nclose"},
                                 {"global Table(10), Speed\nopen plc 1\nlocal i, m\n", "\nclose"}};

bool gives(const Context& context, std::string_view example, std::string_view code) {
  pmac::compiler::Options options;
  CHECK(options.warnings.apply("extra").empty());
  const bool card = code.starts_with("ACR-");
  if (card) options.dialect = pmac::compiler::Dialect::kAcr1000;
  pmac::compiler::Session session(options);
  session.compile({{card ? "example.acr" : "example.pmc", context.before + std::string(example) + context.after + "\n"}});
  const auto found = session.diagnostics().take();
  return std::any_of(found.begin(), found.end(), [&](const Diagnostic& diagnostic) { return diagnostic.code == code; });
}

}  // namespace

TEST_CASE("every code in the sources has a row in compiler/source/message.def", "[messages]") {
  const auto codes = reported_codes();
  CHECK(codes.size() > 70);
  for (const auto& [code, calls] : codes) {
    INFO("add a row for " << code << " to compiler/source/message.def");
    CHECK(find_message(code) != nullptr);
  }
}

TEST_CASE("a row says error where the sources report nothing else, and names a group where they warn", "[messages]") {
  for (const auto& [code, calls] : reported_codes()) {
    const MessageInfo* row = find_message(code);
    if (row == nullptr || calls.empty()) continue;
    INFO(code);
    CHECK(calls.contains("warning") == (row->level != MessageLevel::kError));
  }
}

TEST_CASE("rows are in order, complete, and spoken of by the sources", "[messages]") {
  const auto codes = reported_codes();
  std::string_view before;
  for (const MessageInfo& row : message_table()) {
    INFO(row.code);
    CHECK(before < row.code);
    CHECK_FALSE(row.title.empty());
    CHECK(row.explanation.size() > 20);
    CHECK(row.group.empty() == (row.level == MessageLevel::kError));
    const bool found_when_run = row.code.starts_with("ACR-") && row.wrong.empty();  // by the card
    CHECK((found_when_run || codes.contains(std::string(row.code))));
    before = row.code;
  }
}

TEST_CASE("an explanation has title, text and both examples; case does not count", "[messages]") {
  CHECK(explain("pm2011") ==
        "PM2011: single = in a condition (error)\n\n"
        "A condition compares with ==. A single = assigns, and the controller refuses it in a condition.\n\n"
        "wrong:\n\n    if (P1 = 5) P2 = 1\n\nright:\n\n    if (P1 == 5) P2 = 1\n");
  CHECK(explain("PM6003").find("-Wunserved-axis") != std::string::npos);
  CHECK(explain("PM9998").empty());
  CHECK(explain("").empty());
  CHECK(explain("no-coord") == explain("PM6001") + "\n" + explain("PM6002"));
  CHECK(nearest_code("PM20111") == "PM2011");
}

TEST_CASE("the wrong example of a message gives it, and the right one does not", "[messages]") {
  for (const MessageInfo& row : message_table()) {
    if (row.wrong.empty() || row.code == "PM1005") continue;  // its right example names a file
    const auto context = std::find_if(std::begin(kContexts), std::end(kContexts), [&](const Context& c) { return gives(c, row.wrong, row.code); });
    INFO(row.code << " " << row.wrong);
    CHECK(context != std::end(kContexts));
    if (context == std::end(kContexts) || row.right.empty()) continue;
    INFO(row.right);
    CHECK_FALSE(gives(*context, row.right, row.code));
  }
}

TEST_CASE("docs/messages.md is the table of messages", "[messages]") {
  INFO("write it anew: pmacc --explain all > docs/messages.md");
  CHECK(read(fs::path(PMAC_SOURCE_DIR) / "docs/messages.md") == messages_page());
}
