// The host program: writes, waits and reads in order.
#include "runtime/drives/mcx514/chip.h"

namespace pmac::drives::mcx514 {
namespace {

bool execute(const ScriptItem& item, Chip& chip) {
  const Place place{item.line, item.column};
  switch (item.kind) {
    case ScriptItem::Kind::kWrite: chip.write(item.reg, item.value, place); return true;
    case ScriptItem::Kind::kRead: chip.read(item.reg, place); return true;
    case ScriptItem::Kind::kWaitIdle:
      if (chip.drives_endlessly()) chip.refuse(place, "wait idle has no end: a continuous drive (52h, 53h) runs; stop it by 56h or 57h before");
      return chip.drives_endlessly() || chip.run_until_idle();
    case ScriptItem::Kind::kWaitNext: return chip.run_until_next();
    case ScriptItem::Kind::kWaitTime: return chip.run_until(chip.now() + time_from_seconds(item.wait_s));
  }
  return true;
}

}  // namespace

bool run_items(const Script& script, Chip& chip) {
  for (const ScriptItem& item : script.items)
    if (!execute(item, chip)) return false;
  return true;
}

}  // namespace pmac::drives::mcx514
