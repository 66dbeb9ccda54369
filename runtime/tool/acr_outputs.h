// What becomes of the samples of ACR1000 cards: --record, --gather, --plot, --emit=servo, --check-limits and the numbers of --stats.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "runtime/acr1000/acr1000.h"
#include "runtime/acr1000/sampler.h"
#include "runtime/gather/table_writer.h"
#include "runtime/servo/limit_check.h"
#include "runtime/servo/servo.h"
#include "runtime/tool/options.h"

namespace pmac::tool {

class CardOutputs {
 public:
  /// limits: [card], of --check-limits.
  CardOutputs(const RunOptions& options, const acr1000::CardSystem& system, double period_s, std::vector<acr1000::AxisLimits> limits);

  /// acr1000::SampleTaker.
  void take(double time_s, std::span<const acr1000::MotionPoint> cards);
  /// Completes every file; false (and a message) where one could not be written.
  bool finish();

  std::vector<runtime::MotionStatistics::Row> statistics() const { return statistics_.rows(); }
  std::vector<runtime::LimitCheck::Row> limit_rows() { return limit_check_.rows(); }
  /// Nobody wants samples.
  bool is_idle() const;

 private:
  void open();
  void gather_row(double time_s, std::span<const acr1000::MotionPoint> cards);
  void measure(std::span<const acr1000::MotionPoint> cards);
  runtime::MotorActivity activity(int card) const;
  void fail(const std::string& message);
  void draw();

  const RunOptions& options_;
  const acr1000::CardSystem& system_;
  double period_s_;
  std::vector<acr1000::AxisLimits> limits_;
  std::unique_ptr<runtime::TableWriter> record_, gather_;
  std::vector<double> row_;
  std::vector<double> plot_time_;
  std::vector<std::vector<double>> plot_values_;  // [card][sample]
  runtime::MotionStatistics statistics_;
  runtime::LimitCheck limit_check_;
  std::int64_t tick_ = 0;
  std::vector<int> motors_;                       // card index, as the servo stage's sinks number what they measure
  std::vector<double> positions_, homes_;
  bool failed_ = false, opened_ = false;
};

}  // namespace pmac::tool
