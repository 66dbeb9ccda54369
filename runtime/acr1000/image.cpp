#include "runtime/acr1000/image.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>

namespace pmac::acr1000 {
namespace {

using Settings = std::map<std::string, std::string, std::less<>>;

constexpr std::string_view kSystem = "system.", kCard = "card.", kBit = "BIT";
constexpr double kMostWhole = 9e15;

Settings settings_of(const bytecode::Module& module) {
  Settings settings;
  for (const bytecode::Symbol& symbol : module.symbols)
    if (symbol.kind == bytecode::SymbolKind::kMacro) settings[symbol.name] = symbol.text;
  return settings;
}

std::optional<double> number(const Settings& settings, const std::string& name) {
  const auto at = settings.find(name);
  if (at == settings.end()) return std::nullopt;
  double value = 0;
  const char* end = at->second.data() + at->second.size();
  const auto [stop, error] = std::from_chars(at->second.data(), end, value);
  return error == std::errc() && stop == end && std::isfinite(value) && std::abs(value) <= kMostWhole ? std::optional(value) : std::nullopt;
}

std::optional<double> positive(const Settings& settings, const std::string& name) {
  const auto value = number(settings, name);
  return value && *value > 0 ? value : std::nullopt;
}

CardConfig common_config(const Settings& settings) {
  const auto system = [&](const char* key) { return number(settings, std::string(kSystem) + key); };
  CardConfig config;
  config.units.vel_unit_pulses_s = positive(settings, "system.VEL_UNIT").value_or(1);
  config.units.ramp_unit_pulses_s2 = positive(settings, "system.RAMP_UNIT").value_or(1);
  config.busy_relay = static_cast<int>(system("BUSY").value_or(config.busy_relay));
  config.run_relay = static_cast<int>(system("RUNFLAG").value_or(-1));
  const double parameters = system("PARAMS").value_or(50);
  if (parameters >= 1 && parameters <= bytecode::kPCount) config.parameter_count = static_cast<std::size_t>(parameters);
  const auto version = settings.find("system.VERSION");
  config.wide_velocity = version != settings.end() && std::strtol(version->second.c_str(), nullptr, 10) >= 4;
  return config;
}

/// BIT116 = 1: relays at power-up.
std::map<int, bool> relays_of(const Settings& settings, const std::string& prefix) {
  std::map<int, bool> relays;
  const std::string first = prefix + std::string(kBit);
  for (auto at = settings.lower_bound(first); at != settings.end() && at->first.starts_with(first); ++at)
    if (at->second == "1") relays[static_cast<int>(std::strtol(at->first.c_str() + first.size(), nullptr, 10))] = true;
  return relays;
}

CardImage card_of(const Settings& settings, const bytecode::Program& script) {
  CardImage card;
  const std::string prefix = std::string(kCard) + script.name + ".";
  card.config = common_config(settings);
  card.config.name = script.name;
  card.config.start_pulses = static_cast<std::int64_t>(number(settings, prefix + "START").value_or(0));
  card.config.relays = relays_of(settings, prefix);
  card.scale_pulses_per_unit = positive(settings, prefix + "SCALE").value_or(1);
  if (const auto unit = settings.find(prefix + "UNIT"); unit != settings.end()) card.unit = unit->second;
  card.max_speed_pulses_s = positive(settings, prefix + "MAXSPEED");
  card.max_accel_pulses_s2 = positive(settings, prefix + "MAXACCEL");
  return card;
}

}  // namespace

bool is_card_module(const bytecode::Module& module) {
  for (const bytecode::Symbol& symbol : module.symbols)
    if (symbol.kind == bytecode::SymbolKind::kMacro && symbol.name == "system.VERSION") return true;
  return false;
}

SystemImage read_image(const std::shared_ptr<const bytecode::Module>& module) {
  const Settings settings = settings_of(*module);
  SystemImage image;
  if (const auto version = settings.find("system.VERSION"); version != settings.end()) image.version = version->second;
  image.max_time_s = positive(settings, "system.MAXTIME");
  if (const auto commands = positive(settings, "system.MAXCMDS")) image.max_commands = static_cast<std::uint64_t>(*commands);
  for (const std::uint32_t index : module->load_order) {
    const bytecode::Program& script = module->programs[index];
    image.cards.push_back(card_of(settings, script));
    image.cards.back().script = {module, &script};
  }
  return image;
}

}  // namespace pmac::acr1000
