// compare_symbols SYMBOLS DATABASE: compares what `pmacc --emit=symbols` printed with the symbol files that the vendor's IDE left in
// a project's Database folder, row by row: pp_global.sym, pp_local.sym, pp_prog.sym, pp_subprog.sym. Exit code 0: equal, 1: not.
//
//   pp_global.sym   number, class, name (arrays with ()), variable number or macro text, size
//   pp_local.sym    number, label of the last named program, name, L number, size; no locals of kinematic routines
//   pp_prog.sym     label, kind, name, number of every named program
//   pp_subprog.sym  kind, name, number, arguments, and for each its index, 1 (by value) or 2 (by reference), size
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Rows = std::vector<std::string>;

std::string trim(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// Rows of a symbol file, cells without blanks around them; empty ones (tabs in a macro's text) are left out. numbered: the first
/// cell counts the rows and is left out too.
Rows vendor_rows(const std::filesystem::path& file, bool numbered) {
  std::ifstream stream(file);
  Rows rows;
  for (std::string line; std::getline(stream, line);) {
    if (trim(line).empty()) continue;
    std::vector<std::string> cells(1);
    for (const char c : line)
      if (c == '\t') cells.emplace_back();
      else cells.back() += c;
    if (numbered) cells.erase(cells.begin());
    while (!cells.empty() && trim(cells.back()).empty()) cells.pop_back();
    std::string row;
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (const std::string cell = trim(cells[i]); !cell.empty() || i == 0) row += (i == 0 ? "" : "|") + cell;
    rows.push_back(row);
  }
  return rows;
}

/// The rows that the printed symbols stand for.
struct OwnRows {
  Rows global, local, prog, subprog;

  void read(std::istream& in) {
    for (std::string line; std::getline(in, line);) line.starts_with("  ") ? take_inside(words_of(line)) : take(line);
    end_routine();
  }

 private:
  void take(std::string line) {
    end_routine();
    if (line.starts_with("inactive ")) line.erase(0, 9);
    const std::vector<std::string> words = words_of(line);
    if (words[0] == "macro") return take_macro(line, words[1]);
    if (words[0] == "global" || words[0] == "csglobal" || words[0] == "ptr") return take_variable(words);
    kinematic_ = words[0] == "forward" || words[0] == "inverse";
    if (words.size() < 3) return;
    const std::string kind = upper(words[0]);
    label_ = kind + words[1];
    prog.push_back(label_ + "|" + kind + "|" + words[1] + "|" + words[2]);
    routine_ = {kind + "|" + words[1] + "|" + words[2], {}};
  }

  void take_macro(const std::string& line, const std::string& name) {
    const std::size_t at = line.find(name, 6) + name.size();
    std::string text = trim(line.substr(at));
    if (text.empty()) return;  // the vendor does not list them
    std::replace(text.begin(), text.end(), '\t', '|');
    global.push_back("UserDefine|" + name + "|" + text + "|1");
  }

  void take_variable(const std::vector<std::string>& words) {
    const std::string kind = words[0] == "global" ? "Global" : words[0] == "ptr" ? "Ptr" : "CSGlobal";
    const bool array = words.size() == 5;
    global.push_back(kind + "|" + words[1] + (array ? "()" : "") + "|" + words[2].substr(1) + "|" + (array ? words[4] : "1"));
  }

  /// argument [&]a L0, local b L1 [size n], sub s N10000
  void take_inside(const std::vector<std::string>& words) {
    if (words[0] == "sub") {
      end_routine();
      routine_ = {"SUB|" + words[1] + "|" + words[2].substr(1), {}};
      return;
    }
    const bool by_reference = words[1][0] == '&';
    const bool array = words.size() == 5;
    if (words[0] == "argument") routine_.arguments.push_back(words[2].substr(1) + "|" + (by_reference ? "2" : "1") + "|1");
    if (!kinematic_) local.push_back(label_ + "|" + words[1].substr(by_reference ? 1 : 0) + (array ? "()" : "") + "|" + words[2].substr(1) + "|" + (array ? words[4] : "1"));
  }

  void end_routine() {
    if (!routine_.arguments.empty()) {
      std::string row = routine_.head + "|" + std::to_string(routine_.arguments.size());
      for (const std::string& argument : routine_.arguments) row += "|" + argument;
      subprog.push_back(row);
    }
    routine_ = {};
  }

  struct Routine { std::string head; Rows arguments; };
  Routine routine_;
  std::string label_;
  bool kinematic_ = false;
};

/// Prints the rows of either side that the other one does not have in its order; true if there are none.
bool compare(const char* name, const Rows& vendor, const Rows& own) {
  std::vector<std::vector<std::size_t>> common(vendor.size() + 1, std::vector<std::size_t>(own.size() + 1, 0));
  for (std::size_t i = vendor.size(); i-- > 0;)
    for (std::size_t j = own.size(); j-- > 0;)
      common[i][j] = vendor[i] == own[j] ? common[i + 1][j + 1] + 1 : std::max(common[i + 1][j], common[i][j + 1]);
  const std::size_t equal = common[0][0];
  std::printf("%s: %zu rows of %zu equal\n", name, equal, vendor.size());
  std::size_t i = 0, j = 0;
  while (i < vendor.size() || j < own.size()) {
    if (i < vendor.size() && j < own.size() && vendor[i] == own[j]) ++i, ++j;
    else if (j == own.size() || (i < vendor.size() && common[i + 1][j] >= common[i][j + 1])) std::printf("  vendor only: %s\n", vendor[i++].c_str());
    else std::printf("  pmacc only:  %s\n", own[j++].c_str());
  }
  return equal == vendor.size() && equal == own.size();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: compare_symbols SYMBOLS DATABASE"), 2;
  const std::filesystem::path database = argv[2];
  std::ifstream symbols(argv[1]);
  if (!symbols || !std::filesystem::exists(database / "pp_global.sym")) return std::puts("cannot read the symbols, or pp_global.sym"), 2;
  OwnRows own;
  own.read(symbols);
  bool same = compare("pp_global.sym", vendor_rows(database / "pp_global.sym", true), own.global);
  same &= compare("pp_local.sym", vendor_rows(database / "pp_local.sym", true), own.local);
  same &= compare("pp_prog.sym", vendor_rows(database / "pp_prog.sym", false), own.prog);
  same &= compare("pp_subprog.sym", vendor_rows(database / "pp_subprog.sym", false), own.subprog);
  return same ? 0 : 1;
}
