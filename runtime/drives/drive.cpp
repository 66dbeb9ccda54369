#include "runtime/drives/drive.h"
#include "runtime/drives/mcx514/mcx514_drive.h"

namespace pmac::drives {
namespace {

using Made = std::variant<std::unique_ptr<Drive>, std::string>;

struct Row {
  std::string_view name;
  Made (*make)(const Settings&, DriveContext);
  std::string_view meaning;
};

const std::vector<Row>& rows() {
  static const std::vector<Row> table = {
#define DRIVE(name, make, meaning) Row{name, &make, meaning},
#include "runtime/drives/drive.def"
#undef DRIVE
  };
  return table;
}

}  // namespace

Made make_drive(std::string_view name, const Settings& settings, DriveContext context) {
  for (const Row& row : rows())
    if (row.name == name) return row.make(settings, std::move(context));
  std::string known;
  for (const Row& row : rows()) known += (known.empty() ? "" : ", ") + std::string(row.name);
  return "there is no drive '" + std::string(name) + "'; known: " + (known.empty() ? "none" : known);
}

std::string drive_list() {
  std::string text;
  for (const Row& row : rows()) text += std::string(row.name) + "  " + std::string(row.meaning) + "\n";
  return text;
}

}  // namespace pmac::drives
