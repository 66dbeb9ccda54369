// What a run of ACR1000 cards tells: faults and warnings as they come, the JSON object and the statistics at its end.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "runtime/acr1000/acr1000.h"
#include "runtime/servo/limit_check.h"
#include "runtime/servo/servo.h"
#include "runtime/tool/options.h"

namespace pmac::tool {

/// Numbers of a run that is over.
struct CardRunResult {
  std::string status;
  double time_s = 0;
  std::uint64_t commands = 0;
  std::vector<runtime::MotionStatistics::Row> statistics;   // by card
  std::vector<runtime::LimitCheck::Row> limits;             // by card; empty without --check-limits
  /// Times of moves and notices as the motion has them (--lookahead stretches them).
  std::function<double(double)> stretched_s;
};

class CardReport {
 public:
  /// keep_moves: false where nobody will read them, so that memory stays flat. files: names by SourceLine::file.
  CardReport(const acr1000::CardSystem& system, const std::vector<std::string>& files, bool keep_moves)
      : system_(system), files_(files), keep_moves_(keep_moves) {}

  void add(const acr1000::CardMoveRecord& move);
  /// Prints the first one of its kind and place; the others are counted.
  void add(const acr1000::CardNotice& notice);
  void add_refusal(const std::string& command, const std::string& reason);

  /// A line for every notice that came again, with its count.
  std::string repeated() const;
  std::string json(const CardRunResult& result, JsonDetail detail) const;
  std::string text(const CardRunResult& result, double wall_s) const;
  std::string limit_text(const CardRunResult& result) const;
  bool any_refused() const { return !refusals_.empty(); }
  std::size_t move_count() const { return move_count_; }

 private:
  static constexpr std::size_t kMostNotices = 1000;   // kinds and places; the others are counted together
  struct Counted { acr1000::CardNotice notice; std::size_t count = 1; };
  std::string place_of(const acr1000::Place& place) const;

  const acr1000::CardSystem& system_;
  const std::vector<std::string>& files_;
  bool keep_moves_;
  std::size_t move_count_ = 0;
  std::vector<acr1000::CardMoveRecord> moves_;
  std::vector<Counted> notices_;
  std::map<std::tuple<std::size_t, std::string, int, int>, std::size_t> notice_index_;
  std::size_t more_notices_ = 0;
  std::vector<std::pair<std::string, std::string>> refusals_;
};

}  // namespace pmac::tool
