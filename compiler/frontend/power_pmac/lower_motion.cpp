// Mode and parameter words, and move blocks.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/frontend/power_pmac/lowering.h"

namespace pmac::compiler::power_pmac {
namespace {

using ir::MotionParameter;

constexpr std::uint32_t kAllAxes = 0xffffffffu;

/// 0-2 for I J K, 3-5 for II JJ KK, or -1.
int vector_index(std::string_view word) {
  const std::string name = lower_case(word);
  constexpr std::string_view kNames[] = {"i", "j", "k", "ii", "jj", "kk"};
  const auto* found = std::find(std::begin(kNames), std::end(kNames), name);
  return found == std::end(kNames) ? -1 : static_cast<int>(found - std::begin(kNames));
}

std::optional<MotionParameter> parameter_of(std::size_t token) {
  using P = grammar::PowerPmacParser;
  switch (token) {
    case P::TA: return MotionParameter::kTa;
    case P::TD: return MotionParameter::kTd;
    case P::TS: return MotionParameter::kTs;
    case P::TSD: return MotionParameter::kTsd;
    case P::TM: return MotionParameter::kTm;
    case P::LETTER_F: return MotionParameter::kFeed;
    case P::TSEL: return MotionParameter::kTsel;
    case P::CCR: return MotionParameter::kCcRadius;
    case P::CCMODE: return MotionParameter::kCcMode;
    default: return std::nullopt;
  }
}

bool is_repeated(const std::vector<ir::Word>& words, std::size_t first, const ir::Word& word) {
  return std::any_of(words.begin() + static_cast<std::ptrdiff_t>(first), words.end(), [&](const ir::Word& other) { return other.kind == word.kind && other.index == word.index; });
}

}  // namespace

void Lowering::lower_motion_line(P::MotionLineContext* line, ir::Body& out) {
  const auto words = line->motionWord();
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool is_spline = words[i]->kind && words[i]->kind->getType() == P::SPLINE;
    if (is_spline) lower_spline_times(words, i, out);
    else lower_motion_word(words[i], out);
  }
  if (line->move()) lower_move(line->move(), out);
}

/// Lines that the fast paths have read (plain_moves.h, plain_lines.h).
void Lowering::lower_plain_moves(P::StatementContext* statement, ir::Body& out) {
  const std::size_t at = statement->start->getStartIndex();
  if (ir::Body* lines = tree_.expanded.plain_lines_at(at)) {
    std::move(lines->begin(), lines->end(), std::back_inserter(out));
    lines->clear();
    return;
  }
  const ir::MoveRows* rows = tree_.expanded.plain_moves_at(at);
  if (rows) return out.push_back(ir::make_stmt(span_of(statement), *rows));
  diagnostics_.error("PM2001", span_of(statement), "this control character cannot stand in a program");
}

/// spline a spline b spline c: one mode with three times; what is not given repeats the last one.
void Lowering::lower_spline_times(const std::vector<P::MotionWordContext*>& words, std::size_t& at, ir::Body& out) {
  const source::Span span = span_of(words[at]);
  out.push_back(ir::make_stmt(span, ir::SetMode{ir::MoveMode::kSpline}));
  constexpr MotionParameter kTimes[] = {MotionParameter::kSplineTime0, MotionParameter::kSplineTime1, MotionParameter::kSplineTime2};
  const std::size_t first = at;
  std::size_t last = at;
  while (last + 1 < words.size() && last - first < 2 && words[last + 1]->kind && words[last + 1]->kind->getType() == P::SPLINE) ++last;
  for (std::size_t i = 0; i < 3; ++i) {
    P::MotionWordContext* word = words[std::min(first + i, last)];
    out.push_back(ir::make_stmt(span_of(word), ir::SetParameter{kTimes[i], lower_data(word->data(0))}));
  }
  at = last;
}

void Lowering::lower_motion_word(P::MotionWordContext* word, ir::Body& out) {
  if (!word->kind) return;
  const source::Span span = span_of(word);
  const std::size_t kind = word->kind->getType();
  if (const auto parameter = parameter_of(kind)) return out.push_back(ir::make_stmt(span, ir::SetParameter{*parameter, lower_data(word->data(0))}));
  switch (kind) {
    case P::LINEAR: return out.push_back(ir::make_stmt(span, ir::SetMode{ir::MoveMode::kLinear}));
    case P::RAPID: return out.push_back(ir::make_stmt(span, ir::SetMode{ir::MoveMode::kRapid}));
    case P::CIRCLE: {
      const auto number = whole_number(token_of(word->NUMBER()), 1000000).value_or(1);
      if (number < 1 || number > 4) diagnostics_.error("PM4005", span, "the circle modes are circle1 to circle4");
      return out.push_back(ir::make_stmt(span, ir::SetMode{static_cast<ir::MoveMode>(static_cast<int>(ir::MoveMode::kCircle1) + std::clamp<std::int64_t>(number, 1, 4) - 1)}));
    }
    case P::PVT:
      out.push_back(ir::make_stmt(span, ir::SetMode{ir::MoveMode::kPvt}));
      return out.push_back(ir::make_stmt(span, ir::SetParameter{MotionParameter::kPvtTime, lower_data(word->data(0))}));
    case P::NORMAL: return lower_normal(word, out);
    default: return lower_axis_mode(word, out);
  }
}

/// A normal of the axes X Y Z, of XX YY ZZ, or both: normal K-1, normal II1 JJ1.
void Lowering::lower_normal(P::MotionWordContext* word, ir::Body& out) {
  ir::SetNormal normals[2];
  bool given[2] = {false, false};
  const auto letters = word->NORMAL_VECTOR();
  const auto values = word->data();
  for (std::size_t i = 0; i < std::min(letters.size(), values.size()); ++i) {
    const int index = vector_index(text_of(token_of(letters[i])));
    if (index < 0) continue;
    given[index / 3] = true;
    normals[index / 3].vector[index % 3] = lower_data(values[i]);
  }
  for (int set = 0; set < 2; ++set) {
    if (!given[set]) continue;
    normals[set].second_set = set == 1;
    for (ir::ExprPtr& component : normals[set].vector)
      if (!component) component = ir::make_number(0, span_of(word));
    out.push_back(ir::make_stmt(span_of(word), std::move(normals[set])));
  }
}

void Lowering::lower_axis_mode(P::MotionWordContext* word, ir::Body& out) {
  const source::Span span = span_of(word);
  const std::size_t kind = word->kind->getType();
  if (kind == P::ABS || kind == P::INC) {
    ir::SetAbsInc mode{kind == P::ABS, kAllAxes, false};
    if (word->axisList()) mode.axes = axis_mask(word->axisList(), &mode.centres);
    return out.push_back(ir::make_stmt(span, mode));
  }
  const bool off = kind == P::NOFRAX || kind == P::NOFRAX2;
  const std::uint32_t axes = word->axisList() ? axis_mask(word->axisList(), nullptr) : kAllAxes;
  out.push_back(ir::make_stmt(span, ir::SetFrax{axes, kind == P::FRAX2 || kind == P::NOFRAX2, off}));
}

std::uint32_t Lowering::axis_mask(P::AxisListContext* list, bool* centres) {
  std::uint32_t mask = 0;
  for (P::AxisNameContext* name : list->axisName()) {
    const std::string text = text_of(name->start);
    if (centres && (lower_case(text) == "r" || vector_index(text) >= 0)) {
      *centres = true;
      continue;
    }
    const int axis = axis_index(name->start);
    if (axis >= 0) mask |= 1u << axis;
  }
  return mask;
}

/// Index of an axis name; reports what is none.
int Lowering::axis_index(antlr4::Token* token) {
  const std::string text = text_of(token);
  const int axis = bytecode::axis_index_from_name(text);
  if (axis < 0) diagnostics_.error("PM2009", span_of(token), fmt::format("'{}' is no axis; the axes are A B C U V W X Y Z and AA to HH, LL to ZZ", text));
  return axis;
}

void Lowering::append_words(P::MoveWordContext* word, std::vector<ir::Word>& words) {
  const source::Span span = span_of(word);
  if (auto* axis = word->axisWord()) {
    const int index = axis_index(axis->start);
    if (index < 0) return;
    words.push_back({ir::WordKind::kTarget, index, lower_data(axis->data(0)), span});
    if (axis->velocity) words.push_back({ir::WordKind::kVelocity, index, lower_data(axis->velocity), span});
    if (axis->trigger) words.push_back({ir::WordKind::kTriggerDistance, index, lower_data(axis->trigger), span});
  } else if (auto* vector = word->vectorWord()) {
    words.push_back({ir::WordKind::kCenter, vector_index(text_of(vector->start)), lower_data(vector->data()), span});
  } else if (auto* radius = word->radiusWord()) {
    words.push_back({ir::WordKind::kRadius, 0, lower_data(radius->data()), span});
  }
}

/// A repeated letter begins a new block: X5 Y10 X7 Y13 are two moves.
void Lowering::lower_move(P::MoveContext* move, ir::Body& out) {
  const auto words = move->lineWord();
  if (words.size() == 1 && lower_case(text_of(words[0]->start)) == "f") {  // X10 F5: the feed rate of this move
    out.push_back(ir::make_stmt(span_of(words[0]), ir::SetParameter{MotionParameter::kFeed, lower_data(words[0]->data(0))}));
  } else if (!words.empty()) {
    return out.push_back(lower_move_with_words(move));
  }
  std::vector<ir::Word> block;
  const auto finish = [&] {
    if (block.empty()) return;
    const source::Span span = source::join(block.front().span, block.back().span);
    out.push_back(ir::make_stmt(span, ir::Move{std::move(block)}));
    block.clear();
  };
  for (P::MoveWordContext* word : move->moveWord()) {
    std::vector<ir::Word> next;
    append_words(word, next);
    if (next.empty()) continue;
    if (is_repeated(block, 0, next.front())) finish();
    std::move(next.begin(), next.end(), std::back_inserter(block));
  }
  finish();
}

}  // namespace pmac::compiler::power_pmac
