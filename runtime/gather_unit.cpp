#include "runtime/gather_unit.h"

#include <algorithm>

#include "compiler/bytecode/element.h"
#include "runtime/element_store.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

bool from_block(ElementId id) {
  return id == ElementId::kMotorDesPos || id == ElementId::kMotorActPos || id == ElementId::kSysServoCount || id == ElementId::kSysTime;
}

}  // namespace

void GatherUnit::set_enable(int value) {
  if (value >= 2 && enable_ < 2) samples_ = 0;
  enable_ = value;
}

bool GatherUnit::needs_single_ticks() const {
  return std::any_of(items_.begin(), items_.end(), [](const ElementAddress& a) { return !from_block(a.id); });
}

void GatherUnit::start(const SampleBlock& block) {
  started_ = true;
  columns_ = items_;
  if (columns_.empty()) {
    columns_.push_back({ElementId::kSysServoCount, {}});
    for (int motor : block.motors) columns_.push_back({ElementId::kMotorDesPos, {static_cast<std::uint32_t>(motor)}});
  }
  std::vector<std::string> names{"time_s"};
  for (const ElementAddress& column : columns_) names.push_back(element_text(column));
  if (sink.begin) sink.begin(names);
}

void GatherUnit::take(const SampleBlock& block, int period_cycles, std::int64_t max_samples,
                      const std::function<double(const ElementAddress&)>& value) {
  if (!enabled() || !sink.row) return;
  if (!started_) start(block);
  const int period = std::max(period_cycles, 1);
  for (int k = 0; k < block.count && enabled(); ++k) {
    if ((block.first_tick + k) % period != 0) continue;
    add_row(block, k, value);
    ++samples_;
    if (enable_ == 2 && max_samples > 0 && samples_ >= max_samples) enable_ = 0;
  }
}

void GatherUnit::add_row(const SampleBlock& block, int k, const std::function<double(const ElementAddress&)>& value) {
  row_.clear();
  row_.push_back(block.time_ms(k) / 1000.0);
  for (const ElementAddress& column : columns_) {
    const auto motor = std::find(block.motors.begin(), block.motors.end(), static_cast<int>(column.index[0]));
    const bool commanded = column.id == ElementId::kMotorDesPos, actual = column.id == ElementId::kMotorActPos;
    const auto row = motor - block.motors.begin();
    if (column.id == ElementId::kSysServoCount) row_.push_back(static_cast<double>(block.first_tick + k));
    else if (column.id == ElementId::kSysTime) row_.push_back(block.time_ms(k) / 1000.0);
    else if (commanded && motor != block.motors.end()) row_.push_back(block.home_mu[static_cast<std::size_t>(row)] + block.at(static_cast<int>(row), k));
    else if (actual && motor != block.motors.end()) row_.push_back(block.home_mu[static_cast<std::size_t>(row)] + block.actual_at(static_cast<int>(row), k));
    else row_.push_back(value(column));
  }
  sink.row(row_);
}

}  // namespace pmac::runtime
