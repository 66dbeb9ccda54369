// What is said about the cards outside of their own language: SYSTEM and AXIS lines, and --card on the command line.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/bytecode/bytecode.h"

namespace pmac::compiler::acr1000 {

/// Settings of the system by key, checked.
class Settings {
 public:
  Settings();
  /// Takes "KEY=VALUE". Returns what is wrong with it, or empty. fixed: later texts do not change it (the command line).
  std::string set(std::string_view text, bool fixed = false);

  bool arithmetic() const { return number("ARITHMETIC") != 0; }
  int parameter_count() const { return static_cast<int>(number("PARAMS")); }
  /// 2.6.966 as 2006966.
  int version() const { return version_; }
  const std::string& version_text() const { return values_.at("VERSION"); }
  bool interpolates() const { return version_ / 1000 == 2007 || version_ / 1000000 == 4; }
  bool joins_commands() const { return version_ >= 2006966; }
  double max_velocity() const { return version_ / 1000000 >= 4 ? 16777215 : 65535; }

  /// One entry for each setting that has a value: "system.VERSION" = "2.7".
  std::vector<bytecode::Symbol> symbols() const;

 private:
  double number(const char* key) const;

  std::map<std::string, std::string, std::less<>> values_;
  std::map<std::string, bool, std::less<>> fixed_;
  int version_ = 0;
};

/// What an AXIS line says about one card.
struct CardSettings {
  std::string axis;
  std::vector<std::pair<std::string, std::string>> values;  // START, SCALE, UNIT, BIT (n=0|1)
  /// "card.X.START" = "0".
  std::vector<bytecode::Symbol> symbols(std::uint32_t card) const;
};

/// Takes "START=100" or the n=1 of "BIT n=1" into the card. Returns what is wrong, or empty.
std::string set_card(CardSettings& card, std::string_view key, std::string_view value);

/// A decimal number that is the whole text and finite; false else.
bool read_number(std::string_view text, double& value);

}  // namespace pmac::compiler::acr1000
