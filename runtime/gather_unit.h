// Data gathering as the controller does it: while Gather.Enable is 2 or 3, a row of items every Gather.Period servo cycles. Without
// Gather.Items the row is the servo count and the desired position of every motor in use. Source: the vendor's technical guide on
// data gathering; Period 0 is single shot there and every servo cycle here, since published programs set only Gather.Enable.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "runtime/interpreter/interpreter.h"
#include "runtime/servo/servo.h"

namespace pmac::runtime {

/// Takes gathered rows: column names once, then rows; the first column is time_s.
struct GatherSink {
  std::function<void(const std::vector<std::string>& names)> begin;
  std::function<void(std::span<const double> row)> row;
};

class GatherUnit {
 public:
  GatherSink sink;

  /// True while samples are wanted.
  bool enabled() const { return enable_ >= 2; }
  void set_enable(int value);
  int enable() const { return enable_; }
  std::int64_t samples() const { return samples_; }

  /// Items to gather, as elements; empty: the default set.
  void set_items(std::vector<ElementAddress> items) { items_ = std::move(items); }
  /// True if an item cannot be read from a block of samples, so that blocks have to be single ticks.
  bool needs_single_ticks() const;

  /// value: reads an element now. max_samples 0: no limit.
  void take(const SampleBlock& block, int period_cycles, std::int64_t max_samples,
            const std::function<double(const ElementAddress&)>& value);

 private:
  void start(const SampleBlock& block);
  void add_row(const SampleBlock& block, int k, const std::function<double(const ElementAddress&)>& value);

  int enable_ = 0;
  bool started_ = false;
  std::int64_t samples_ = 0;
  std::vector<ElementAddress> items_;
  std::vector<ElementAddress> columns_;
  std::vector<double> row_;
};

}  // namespace pmac::runtime
