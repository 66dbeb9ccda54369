// A card at the end of a host's byte stream: fast move blocks one after the other, ctrl-L for the move counter, and command lines
// between them. The stream is read in pieces as the card takes its moves, so a stream may be as long as it likes.
#pragma once

#include <functional>

#include "runtime/acr1000/card.h"

namespace pmac::acr1000 {

/// Puts the next bytes of a stream into the span; answers how many, 0 at its end.
using ByteSource = std::function<std::size_t(std::span<std::uint8_t>)>;

/// What is next in a stream. offset: of its first byte.
struct StreamItem {
  enum class Kind : std::uint8_t { kEnd, kBlock, kError, kCounter, kLine };
  Kind kind = Kind::kEnd;
  std::uint64_t offset = 0;
  MoveBlock block;
  BlockError error;           // its offset counts from the start of the stream
  std::string line;           // without its CR
};

/// Bytes to items. After a malformed block the next ctrl-D begins again.
class BlockReader {
 public:
  explicit BlockReader(ByteSource source) : source_(std::move(source)) {}
  StreamItem next();

 private:
  bool fill();
  std::span<const std::uint8_t> rest() const { return std::span(buffer_).subspan(at_, size_ - at_); }
  void skip(std::size_t count) { at_ += count; }
  std::uint64_t offset() const { return before_ + at_; }
  StreamItem block();
  StreamItem line();
  StreamItem bad_block(BlockError error);

  ByteSource source_;
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(1 << 16);
  std::size_t at_ = 0, size_ = 0;
  std::uint64_t before_ = 0;  // bytes of the stream in front of the buffer
  bool ended_ = false;
};

/// What a stream's owner does with what is no block.
struct StreamActions {
  std::function<void(const std::string& text)> answer;
  /// Executes a command line; refused: the reason. Absent: lines are refused.
  std::function<std::optional<DriverFault>(const std::string& line)> execute;
};

/// Streams the blocks into its card. A bad block is reported, and the stream goes on.
class BlockStreamDriver : public CardDriver {
 public:
  BlockStreamDriver(Card& card, ByteSource source, StreamActions actions, Place place)
      : card_(card), reader_(std::move(source)), actions_(std::move(actions)), place_(place) {}

  DriverStep step(std::uint64_t command_budget) override;
  Place place() const override { return place_; }
  bool program_runs() const override { return false; }
  void halt() override {}
  void abandon() override { ended_ = true; }
  std::span<const double> parameters() const override { return card_.parameters(); }
  int nesting() const override { return 0; }
  std::uint64_t outputs() const override { return blocks_; }
  std::uint64_t blocks() const { return blocks_; }

 private:
  DriverFault fault_of(const StreamItem& item, std::string id, std::string detail) const;
  std::optional<DriverFault> take(const StreamItem& item);

  Card& card_;
  BlockReader reader_;
  StreamActions actions_;
  Place place_;
  bool ended_ = false;
  std::uint64_t blocks_ = 0;
};

}  // namespace pmac::acr1000
