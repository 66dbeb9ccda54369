#include "runtime/tool/acr_outputs.h"

#include <cstdio>
#include <exception>

#include <fmt/format.h>

#include "runtime/gather/plot.h"

namespace pmac::tool {
namespace {

/// Samples that a picture keeps; beyond, a run is too long for one.
constexpr std::size_t kMostPlotSamples = 20'000'000;

std::vector<std::string> gather_columns(const acr1000::CardSystem& system, bool with_program) {
  std::vector<std::string> names{"time_s"};
  for (std::size_t k = 0; k < system.size(); ++k) {
    const std::string& axis = system.card(k).name();
    for (const char* what : {"", ".speed", ".accel"}) names.push_back(axis + what);
    if (!with_program) continue;
    for (const char* what : {".master", ".counter", ".busy"}) names.push_back(axis + what);
  }
  return names;
}

}  // namespace

CardOutputs::CardOutputs(const RunOptions& options, const acr1000::CardSystem& system, double period_s, std::vector<acr1000::AxisLimits> limits)
    : options_(options), system_(system), period_s_(period_s), limits_(std::move(limits)), plot_values_(system.size()),
      limit_check_([this](int card, double) { return activity(card); }), positions_(system.size()), homes_(system.size()) {
  for (std::size_t k = 0; k < system.size(); ++k) motors_.push_back(static_cast<int>(k));
}

bool CardOutputs::is_idle() const {
  return options_.record.empty() && options_.gather.empty() && options_.plots.empty() && options_.emit != "servo" && !options_.check_limits &&
         !options_.stats && options_.json == JsonDetail::kNone;
}

void CardOutputs::fail(const std::string& message) {
  if (!failed_) std::fprintf(stderr, "pmac-run: %s\n", message.c_str());
  failed_ = true;
}

void CardOutputs::open() {
  opened_ = true;
  std::vector<std::string> names{"time_s"};
  for (std::size_t k = 0; k < system_.size(); ++k) names.push_back(system_.card(k).name());
  if (!options_.record.empty()) record_ = runtime::make_table_writer(*runtime::table_format_of(options_.record), options_.record, names);
  if (!options_.gather.empty())
    gather_ = runtime::make_table_writer(*runtime::table_format_of(options_.gather), options_.gather, gather_columns(system_, !options_.cards.lookahead));
  if (options_.emit != "servo") return;
  for (std::size_t k = 0; k < names.size(); ++k) std::printf("%s%s", k == 0 ? "" : " ", names[k].c_str());
  std::printf("\n");
}

void CardOutputs::take(double time_s, std::span<const acr1000::MotionPoint> cards) {
  if (failed_) return;
  try {
    if (!opened_) open();
    row_.assign(1, time_s);
    for (const acr1000::MotionPoint& card : cards) row_.push_back(card.position_pulses);
    if (record_) record_->append(row_);
    if (gather_) gather_row(time_s, cards);
  } catch (const std::exception& e) { fail(e.what()); }
  if (options_.emit == "servo") {
    for (std::size_t k = 0; k < row_.size(); ++k) std::fputs(fmt::format("{}{}", k == 0 ? "" : " ", row_[k]).c_str(), stdout);
    std::fputc('\n', stdout);
  }
  if (!options_.plots.empty() && plot_time_.size() < kMostPlotSamples) {
    plot_time_.push_back(time_s);
    for (std::size_t k = 0; k < cards.size(); ++k) plot_values_[k].push_back(cards[k].position_pulses);
  }
  measure(cards);
}

void CardOutputs::gather_row(double time_s, std::span<const acr1000::MotionPoint> cards) {
  row_.assign(1, time_s);
  for (std::size_t k = 0; k < cards.size(); ++k) {
    const acr1000::Card& card = system_.card(k);
    row_.insert(row_.end(), {cards[k].position_pulses, cards[k].speed_pulses_s, cards[k].accel_pulses_s2});
    if (!options_.cards.lookahead)
      row_.insert(row_.end(), {cards[k].master_pulses, static_cast<double>(card.memory().move_counter()), card.moves() ? 1.0 : 0.0});
  }
  gather_->append(row_);
  row_.assign(1, time_s);
  for (const acr1000::MotionPoint& card : cards) row_.push_back(card.position_pulses);
}

void CardOutputs::measure(std::span<const acr1000::MotionPoint> cards) {
  for (std::size_t k = 0; k < cards.size(); ++k) positions_[k] = cards[k].position_pulses;
  const runtime::SampleBlock block{tick_++, period_s_ * 1e3, 1, motors_, positions_, positions_, homes_};
  statistics_.take(block);
  if (options_.check_limits) limit_check_.take(block);
}

runtime::MotorActivity CardOutputs::activity(int index) const {
  const acr1000::Card& card = system_.card(static_cast<std::size_t>(index));
  const acr1000::AxisLimits& limits = limits_[static_cast<std::size_t>(index)];
  runtime::MotorActivity a;
  a.kind = runtime::MotorActivity::Kind::kPath;
  a.coord = 0;
  if (card.moves()) a.source = card.active().request.place.source;
  if (limits.speed_pulses_s > 0) a.max_speed_mu_ms = limits.speed_pulses_s / 1e3;
  if (limits.accel_pulses_s2 > 0) a.max_accel_mu_ms2 = a.max_stop_mu_ms2 = limits.accel_pulses_s2 / 1e6;
  return a;
}

bool CardOutputs::finish() {
  try {
    if (!opened_ && !is_idle()) open();
    if (record_ && !failed_) record_->finish();
    if (gather_ && !failed_) gather_->finish();
    if (!options_.plots.empty() && !failed_) draw();
  } catch (const std::exception& e) { fail(e.what()); }
  return !failed_;
}

void CardOutputs::draw() {
  runtime::PlotData data;
  data.length_unit = "pulses";
  data.time_s = std::move(plot_time_);
  std::size_t x = 0, y = 1;
  for (std::size_t k = 0; k < system_.size(); ++k) {
    data.curves.push_back({system_.card(k).name(), std::move(plot_values_[k])});
    if (system_.card(k).name() == "X") x = k;
    if (system_.card(k).name() == "Y") y = k;
  }
  if (data.curves.size() >= 2 && x != y) data.path = {x, y};
  for (const std::string& file : options_.plots) runtime::draw(data, *runtime::plot_format_of(file), file);
}

}  // namespace pmac::tool
