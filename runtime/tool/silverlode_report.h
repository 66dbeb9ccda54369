// What pmac-silverlode circle tells: the list of the dialog and the figures for people, the JSON object for machines.
#pragma once

#include <optional>
#include <string>

#include "runtime/drives/silverlode/figures.h"
#include "runtime/tool/silverlode_options.h"

namespace pmac::tool {

struct CircleReport {
  const SilverlodeOptions& options;
  const drives::silverlode::Sheet& sheet;
  const drives::silverlode::Table& table;
  drives::silverlode::CircleFigures figures;
  const std::optional<drives::silverlode::NetworkResult>& link;
};

std::string circle_json(const CircleReport& report);
std::string circle_text(const CircleReport& report);
/// What happened on the line, a line each.
std::string events_text(const drives::silverlode::NetworkResult& link);

}  // namespace pmac::tool
