#include "runtime/acr1000/block_stream.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

namespace pmac::acr1000 {
namespace {

constexpr std::uint8_t kControlL = 0x0c;
/// Longest command line; what follows is another one.
constexpr std::size_t kMaxLine = 4096;

bool is_line_end(std::uint8_t byte) { return byte == '\r' || byte == '\n'; }

}  // namespace

/// Makes room and reads on. False: the stream is at its end.
bool BlockReader::fill() {
  if (ended_) return false;
  std::memmove(buffer_.data(), buffer_.data() + at_, size_ - at_);
  before_ += at_;
  size_ -= at_;
  at_ = 0;
  const std::size_t count = source_(std::span(buffer_).subspan(size_));
  size_ += count;
  ended_ = count == 0;
  return count > 0;
}

StreamItem BlockReader::next() {
  for (;;) {
    while (at_ < size_ && (is_line_end(buffer_[at_]) || buffer_[at_] == ' ')) skip(1);
    if (at_ < size_) break;
    if (!fill()) return {};
  }
  if (buffer_[at_] == kControlD) return block();
  if (buffer_[at_] != kControlL) return line();
  StreamItem item;
  item.kind = StreamItem::Kind::kCounter;
  item.offset = offset();
  skip(1);
  return item;
}

StreamItem BlockReader::block() {
  std::size_t length = 0;
  while ((length = fast_block_length(rest())) == 0 || length > rest().size())
    if (!fill()) break;
  const auto decoded = decode_block(rest().first(length == 0 ? rest().size() : std::min(length, rest().size())));
  if (const auto* error = std::get_if<BlockError>(&decoded)) return bad_block(*error);
  StreamItem item;
  item.kind = StreamItem::Kind::kBlock;
  item.offset = offset();
  item.block = std::get<DecodedBlock>(decoded).block;
  skip(std::get<DecodedBlock>(decoded).length);
  return item;
}

/// A block that is cut short is the rest of the stream; behind one that is malformed the next ctrl-D is looked for.
StreamItem BlockReader::bad_block(BlockError error) {
  StreamItem item;
  item.kind = StreamItem::Kind::kError;
  item.offset = offset();
  const bool cut_short = error.bytes_missing > 0;
  error.offset += offset();
  item.error = std::move(error);
  skip(1);
  while (cut_short || at_ >= size_ || buffer_[at_] != kControlD) {
    if (at_ < size_) skip(cut_short ? size_ - at_ : 1);
    else if (!fill()) break;
  }
  return item;
}

StreamItem BlockReader::line() {
  StreamItem item;
  item.kind = StreamItem::Kind::kLine;
  item.offset = offset();
  for (;;) {
    if (at_ == size_ && !fill()) return item;
    if (is_line_end(buffer_[at_]) || buffer_[at_] == kControlD || buffer_[at_] == kControlL) return item;
    if (item.line.size() == kMaxLine) return item;
    item.line += static_cast<char>(buffer_[at_]);
    skip(1);
  }
}

DriverFault BlockStreamDriver::fault_of(const StreamItem& item, std::string id, std::string detail) const {
  return {std::move(id), fmt::format("{} (block {} at byte {})", detail, blocks_, item.offset), place_};
}

DriverStep BlockStreamDriver::step(std::uint64_t command_budget) {
  DriverStep step;
  while (!ended_ && step.commands < command_budget) {
    const StreamItem item = reader_.next();
    ended_ = item.kind == StreamItem::Kind::kEnd;
    if (ended_) break;
    ++step.commands;
    if (auto fault = take(item)) {
      step.stop = DriverStop::kFault;
      step.fault = std::move(fault);
      return step;
    }
    if (!card_.waits()) continue;
    step.stop = DriverStop::kWaits;
    return step;
  }
  step.stop = ended_ ? DriverStop::kIdle : DriverStop::kBudget;
  return step;
}

std::optional<DriverFault> BlockStreamDriver::take(const StreamItem& item) {
  switch (item.kind) {
    case StreamItem::Kind::kEnd: return std::nullopt;
    case StreamItem::Kind::kCounter:
      if (actions_.answer) actions_.answer(card_.memory().counter_answer());
      return std::nullopt;
    case StreamItem::Kind::kLine:
      if (actions_.execute) return actions_.execute(item.line);
      return fault_of(item, "ACR-E12", "a stream of blocks holds what is neither a block nor ctrl-L");
    case StreamItem::Kind::kError:
      ++blocks_;
      return fault_of(item, std::string(row_of(DiagnosticId::kBadBlock).id), text_of(item.error));
    case StreamItem::Kind::kBlock: break;
  }
  ++blocks_;
  if (const auto refusal = card_.request(item.block, place_)) return fault_of(item, std::string(row_of(refusal->id).id), refusal->detail);
  return std::nullopt;
}

}  // namespace pmac::acr1000
