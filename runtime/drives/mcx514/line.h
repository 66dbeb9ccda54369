// Linear interpolation of two to four axes, and drives of a single axis. MCX514 manual p111.
//
// The long axis pulses at every event, the others evenly in between: their distance from the line is at most half a pulse.
#pragma once

#include "runtime/drives/mcx514/interpolator.h"

namespace pmac::drives::mcx514 {

class Line : public Interpolator {
 public:
  /// finish: relative, within kLargestDistance. events: 0 for those of the longest axis, or more than that (maximum finish point): then every
  /// axis is spread over them.
  explicit Line(const AxisCounts& finish, std::int64_t events = 0);

  Event next() override;
  /// Where at most two axes move.
  Skip skip(std::uint64_t most) override;
  std::uint64_t remaining() const override { return static_cast<std::uint64_t>(events_ - at_); }
  std::optional<ErrorRange> error() const override;
  double error_now() const override;

 private:
  AxisCounts length_{}, sum_{}, sum_low_{}, sum_high_{};
  std::array<std::int8_t, kAxes> direction_{};
  std::int64_t events_ = 0, at_ = 0;
  int moving_ = 0;
  bool passed_over_ = false;
};

/// One axis in one direction until it is stopped.
class Endless : public Interpolator {
 public:
  Endless(int axis, int direction) { event_.step[static_cast<std::size_t>(axis)] = static_cast<std::int8_t>(direction); }
  Event next() override { return event_; }
  Skip skip(std::uint64_t most) override;
  std::uint64_t remaining() const override { return std::numeric_limits<std::uint64_t>::max(); }

 private:
  Event event_;
};

/// Bit pattern interpolation: an event a bit, lowest first; both bits of an axis set end the pattern.
class BitPattern : public Interpolator {
 public:
  static constexpr int kEvents = 16;
  struct Bits { std::uint16_t plus = 0, minus = 0; };
  explicit BitPattern(const std::array<Bits, kAxes>& bits);
  Event next() override;
  std::uint64_t remaining() const override { return static_cast<std::uint64_t>(events_ - at_); }

 private:
  std::array<Bits, kAxes> bits_;
  int events_ = kEvents, at_ = 0;
};

}  // namespace pmac::drives::mcx514
