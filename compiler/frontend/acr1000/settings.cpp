#include "compiler/frontend/acr1000/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "compiler/source/source.h"

namespace pmac::compiler::acr1000 {
namespace {

enum class Kind { kText, kNumber, kWhole, kSwitch };
struct Row { std::string_view key; Kind kind; std::string_view fallback; double least, most; std::string_view meaning; };
constexpr Row kRows[] = {
#define SETTING(key, kind, fallback, least, most, meaning) {#key, Kind::kind, fallback, least, most, meaning},
#include "compiler/frontend/acr1000/setting.def"
#undef SETTING
};

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

const Row* find(std::string_view key) {
  const auto* row = std::find_if(std::begin(kRows), std::end(kRows), [&](const Row& r) { return r.key == key; });
  return row == std::end(kRows) ? nullptr : row;
}

std::string refuse_key(const std::string& key) {
  std::vector<std::string_view> keys;
  for (const Row& row : kRows) keys.push_back(row.key);
  const std::string_view near = source::nearest_word(key, keys);
  return fmt::format("there is no setting '{}'{}", key, near.empty() ? std::string("; there are ") + fmt::format("{}", fmt::join(keys, ", ")) : fmt::format("; did you mean {}?", near));
}

/// 2.6.966 as 2006966; -1: no version.
int version_number(std::string_view text) {
  int parts[3] = {0, 0, 0};
  int count = 0;
  const char* at = text.data();
  const char* end = text.data() + text.size();
  while (at < end && count < 3) {
    const auto [next, error] = std::from_chars(at, end, parts[count]);
    if (error != std::errc() || parts[count] < 0 || parts[count] > 999) return -1;
    ++count;
    at = next;
    if (at == end) break;
    if (*at != '.' || at + 1 == end) return -1;
    ++at;
  }
  return count == 0 || at != end ? -1 : parts[0] * 1000000 + parts[1] * 1000 + parts[2];
}

std::string check(const Row& row, const std::string& value) {
  if (row.kind == Kind::kText) return version_number(value) < 0 ? fmt::format("{} is not a version; write VERSION=2.7", value) : std::string();
  double number = 0;
  const bool fits = read_number(value, number) && number >= row.least && number <= row.most && (row.kind == Kind::kNumber || number == std::floor(number));
  return fits ? std::string() : fmt::format("{} is a {}number from {} to {}, not '{}'", row.key, row.kind == Kind::kNumber ? "" : "whole ", row.least, row.most, value);
}

}  // namespace

bool read_number(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

Settings::Settings() {
  for (const Row& row : kRows) values_[std::string(row.key)] = row.fallback;
  version_ = version_number(values_["VERSION"]);
}

std::string Settings::set(std::string_view text, bool fixed) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) return fmt::format("'{}' is no setting; write KEY=VALUE", text);
  const std::string key = upper(text.substr(0, equals));
  const Row* row = find(key);
  if (!row) return refuse_key(key);
  std::string value = upper(text.substr(equals + 1));
  if (row->kind == Kind::kSwitch) value = value == "ON" ? "1" : value == "OFF" ? "0" : value;
  if (std::string why = check(*row, value); !why.empty()) return why;
  if (fixed_[key] && !fixed) return {};
  fixed_[key] = fixed;
  values_[key] = value;
  version_ = version_number(values_["VERSION"]);
  return {};
}

double Settings::number(const char* key) const {
  double value = 0;
  read_number(values_.at(key), value);
  return value;
}

std::vector<bytecode::Symbol> Settings::symbols() const {
  std::vector<bytecode::Symbol> symbols;
  for (const Row& row : kRows)
    if (const std::string& value = values_.at(std::string(row.key)); !value.empty()) symbols.push_back({bytecode::SymbolKind::kMacro, "system." + std::string(row.key), 0, 0, value});
  return symbols;
}

std::string set_card(CardSettings& card, std::string_view key, std::string_view value) {
  const std::string name = upper(key);
  double number = 0;
  if (name == "START" && !(read_number(value, number) && std::abs(number) <= 2147483648.0 && number == std::floor(number))) return "START is the position at power-up in whole pulses: START=0";
  if (name == "SCALE" && !(read_number(value, number) && number > 0)) return "SCALE is a number of pulses a unit above 0: SCALE=10000";
  if (name == "UNIT" && (value.empty() || value.size() > 16)) return "UNIT is the name of a unit: UNIT=in";
  const bool is_limit = name == "MAXSPEED" || name == "MAXACCEL";
  if (is_limit && !(read_number(value, number) && number > 0)) return fmt::format("{} is a limit of the axis above 0, in pulses/s or pulses/s^2: {}=20000", name, name);
  if (name != "START" && name != "SCALE" && name != "UNIT" && !is_limit) return fmt::format("an axis has no '{}'; there are START, SCALE, UNIT, MAXSPEED, MAXACCEL and BIT n=0 or n=1", key);
  card.values.emplace_back(name, std::string(value));
  return {};
}

std::vector<bytecode::Symbol> CardSettings::symbols(std::uint32_t card) const {
  std::vector<bytecode::Symbol> symbols;
  for (const auto& [key, value] : values) symbols.push_back({bytecode::SymbolKind::kMacro, fmt::format("card.{}.{}", axis, key), card, 0, value});
  return symbols;
}

}  // namespace pmac::compiler::acr1000
