#include "compiler/frontend/acr1000/file_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <regex>

namespace pmac::compiler::acr1000 {
namespace {

constexpr std::size_t kLongestAxis = 8;
constexpr std::string_view kAxisOrder = "XYZABCUVWDEFGHIJKLMNOPQRST";
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

bool is_blank(char c) { return c == ' ' || c == '\t'; }

char upper(char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); }

std::string upper(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](char c) { return upper(c); });
  return result;
}

bool is_axis_name(std::string_view name) {
  const auto belongs = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  return !name.empty() && name.size() <= kLongestAxis && std::isalpha(static_cast<unsigned char>(name[0])) != 0 && std::all_of(name.begin(), name.end(), belongs);
}

/// x of contour.x.acr, in capitals; empty where the name has no such part.
std::string axis_of_file(std::string_view name) {
  const std::size_t slash = name.find_last_of("/\\");
  if (slash != std::string_view::npos) name.remove_prefix(slash + 1);
  const std::size_t last = name.rfind('.');
  const std::size_t before = last == std::string_view::npos || last == 0 ? std::string_view::npos : name.rfind('.', last - 1);
  if (before == std::string_view::npos) return {};
  const std::string_view part = name.substr(before + 1, last - before - 1);
  return is_axis_name(part) ? upper(part) : std::string();
}

source::Span trimmed(const source::SourceManager& sources, source::Span span) {
  const std::string_view text = sources.file(span.file).text;
  while (span.begin < span.end && is_blank(text[span.begin])) ++span.begin;
  while (span.end > span.begin && is_blank(text[span.end - 1])) --span.end;
  return span;
}

/// Parts of a line between characters for which `separates` holds; empty parts only where asked for.
template <class Predicate>
std::vector<source::Span> parts(const source::SourceManager& sources, const source::Span& line, Predicate separates, bool with_empty) {
  const std::string_view text = sources.file(line.file).text;
  std::vector<source::Span> found;
  std::uint32_t begin = line.begin;
  for (std::uint32_t at = line.begin; at <= line.end; ++at) {
    if (at < line.end && !separates(text[at])) continue;
    if (with_empty || at > begin) found.push_back(trimmed(sources, {line.file, begin, at, -1}));
    begin = at + 1;
  }
  return found;
}

std::vector<source::Span> words(const source::SourceManager& sources, const source::Span& line) { return parts(sources, line, is_blank, false); }

/// Whether the line is the keyword, alone or with blanks behind it.
bool begins_with(std::string_view text, std::string_view keyword) {
  return text.size() >= keyword.size() && upper(text.substr(0, keyword.size())) == keyword && (text.size() == keyword.size() || is_blank(text[keyword.size()]));
}

}  // namespace

void for_each_line(const source::SourceManager& sources, std::int32_t file, const std::function<void(const source::Span&)>& act) {
  const std::string_view text = sources.file(file).text;
  std::size_t begin = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
    const source::Span line = trimmed(sources, {file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), -1});
    if (line.end > line.begin) act(line);
    begin = end + 1;
  }
}

void FileReader::read(const File& file) {
  const std::int32_t index = sources_.add_file(file.name, file.text);
  current_ = nullptr;
  columns_.clear();
  guessed_ = false;
  file_axis_ = axis_of_file(file.name);
  for_each_line(sources_, index, [this](const source::Span& one) { line(one); });
}

void FileReader::line(const source::Span& one) {
  const std::string_view text = sources_.text(one);
  if (text.starts_with(';')) return;
  if (begins_with(text, "SYSTEM")) return system_line(one);
  if (begins_with(text, "AXIS")) return axis_line(one);
  if (begins_with(text, "HEX")) return block_line(one);
  if (header_line(one)) return;
  if (!columns_.empty()) return columns(one);
  card_line(one);
}

void FileReader::card_line(const source::Span& one) {
  if (Card* card = current(one)) card->reader.take(one);
}

FileReader::Card* FileReader::current(const source::Span& span) {
  if (current_) return current_;
  guessed_ = file_axis_.empty();
  const bool known = std::any_of(cards_.begin(), cards_.end(), [&](const Card& card) { return card.settings.axis == file_axis_; });
  if (known) refuse(span, fmt::format("another file has the program of axis {} already; its lines would be replaced by these. Put them into one file, or begin this one with an AXIS line", file_axis_));
  return current_ = card_of(guessed_ ? free_axis() : file_axis_, span);
}

std::string FileReader::free_axis() const {
  for (const char letter : kAxisOrder)
    if (std::none_of(cards_.begin(), cards_.end(), [&](const Card& card) { return card.settings.axis == std::string(1, letter); })) return {letter};
  return "X";
}

FileReader::Card* FileReader::card_of(const std::string& axis, const source::Span& span) {
  for (Card& card : cards_)
    if (card.settings.axis == axis) return &card;
  if (cards_.size() == kMaxCards) return refuse(span, fmt::format("the cable joins up to {} cards", kMaxCards)), nullptr;
  const auto number = static_cast<std::int64_t>(cards_.size());
  cards_.push_back({CardReader(sources_, diagnostics_, settings_, number, axis, false), {axis, {}}});
  return &cards_.back();
}

// --- lines for the host --------------------------------------------------------------------------------------------------------

void FileReader::system_line(const source::Span& one) {
  const std::vector<source::Span> all = words(sources_, one);
  for (std::size_t i = 1; i < all.size(); ++i)
    if (std::string why = settings_.set(sources_.text(all[i])); !why.empty()) refuse(all[i], std::move(why));
}

/// AXIS X START=0 SCALE=10000 UNIT=in BIT 116=1
void FileReader::axis_line(const source::Span& one) {
  const std::vector<source::Span> all = words(sources_, one);
  columns_.clear();
  if (guessed_ && current_) return refuse(one, "commands stand before the first AXIS line; put an AXIS line before them");
  const std::string axis = all.size() > 1 ? upper(sources_.text(all[1])) : std::string();
  if (!is_axis_name(axis)) return refuse(one, "AXIS takes the name of the axis, letters and digits: AXIS X START=0");
  current_ = card_of(axis, one);
  for (std::size_t i = 2; current_ && i < all.size(); ++i) {
    std::string_view text = sources_.text(all[i]);
    const bool bit = upper(text) == "BIT" && i + 1 < all.size();
    if (bit) text = sources_.text(all[++i]);
    const std::size_t equals = text.find('=');
    const std::string_view value = equals == std::string_view::npos ? std::string_view() : text.substr(equals + 1);
    std::string why;
    if (equals == std::string_view::npos) why = fmt::format("'{}' is no setting; write KEY=VALUE", text);
    else if (!bit) why = set_card(current_->settings, text.substr(0, equals), value);
    else if (double relay = 0; read_number(text.substr(0, equals), relay) && relay >= 0 && relay <= 65535 && relay == static_cast<int>(relay) && (value == "0" || value == "1"))
      current_->settings.values.emplace_back(fmt::format("BIT{}", static_cast<int>(relay)), std::string(value));
    else why = "BIT takes a relay number and 0 or 1: BIT 116=1";
    if (!why.empty()) refuse(all[i], std::move(why));
  }
}

bool FileReader::header_line(const source::Span& one) {
  static const std::regex kCell(R"(([A-Za-z][A-Za-z0-9]{0,7})[ -]*axis([ -]*program)?)", std::regex::icase);
  const std::string_view text = sources_.text(one);
  if (text.find('\t') == std::string_view::npos || text.size() > 1000) return false;
  std::vector<std::string> names;
  for (const source::Span& cell : parts(sources_, one, [](char c) { return c == '\t'; }, true)) {
    std::smatch match;
    const std::string word(sources_.text(cell));
    if (!std::regex_match(word, match, kCell)) return false;
    names.push_back(upper(match[1].str()));
  }
  columns_.clear();
  for (const std::string& name : names) columns_.push_back(card_of(name, one));
  return true;
}

void FileReader::columns(const source::Span& one) {
  // The blanks in front of the line were left out; a tab among them is an empty cell.
  source::Span whole = one;
  const std::string_view text = sources_.file(one.file).text;
  while (whole.begin > 0 && is_blank(text[whole.begin - 1])) --whole.begin;
  const std::vector<source::Span> cells = parts(sources_, whole, [](char c) { return c == '\t'; }, true);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].begin == cells[i].end) continue;
    if (i >= columns_.size()) return refuse(cells[i], fmt::format("there is no column {} in the line of names", i + 1));
    if (columns_[i]) columns_[i]->reader.take(cells[i]);
  }
}

// --- fast move blocks ------------------------------------------------------------------------------------------------------------

namespace {

constexpr int kCtrlD = 0x04, kRaw = 0x80, kCircle = 0x40, kWideVelocity = 0x10, kReserved = 0x0f;

std::size_t ascii_length(const std::vector<int>& bytes, std::size_t begin) {
  int returns = 0;
  for (std::size_t i = begin + 1; i < bytes.size(); ++i)
    if (bytes[i] == '\r' && ++returns == 3) return i + 1 - begin;
  return 0;
}

/// What is wrong with the block that begins there, or empty and its length.
std::string block_problem(const std::vector<int>& bytes, std::size_t begin, const Settings& settings, std::size_t& length) {
  const std::size_t rest = bytes.size() - begin;
  if (bytes[begin] != kCtrlD) return fmt::format("byte {}: a fast move block begins with 04, not {:02X}", begin + 1, bytes[begin]);
  if (rest == 1) return fmt::format("byte {}: the block ends behind 04; the type of the move is missing", begin + 2);
  const int type = bytes[begin + 1];
  if ((type & kRaw) == 0) {
    length = ascii_length(bytes, begin);
    return length ? std::string() : fmt::format("byte {}: the block in ASCII is incomplete: velocity, master distance and target each end with 0D", bytes.size() + 1);
  }
  if ((type & kReserved) != 0) return fmt::format("byte {}: bits 3-0 of the type {:02X} are reserved and must be 0", begin + 2, type);
  const bool wide = (type & kWideVelocity) != 0;
  if (wide && settings.max_velocity() < 16777215) return fmt::format("byte {}: velocities of 24 bits (type {:02X}) need executive version 4, and this is {}", begin + 2, type, settings.version_text());
  length = ((type & kCircle) != 0 ? 28 : 12) + (wide ? 1 : 0);
  return rest >= length ? std::string() : fmt::format("byte {}: the block of type {:02X} is incomplete: {} of {} bytes are missing", bytes.size() + 1, type, length - rest, length);
}

int hex_value(char c) { return c <= '9' ? c - '0' : upper(c) - 'A' + 10; }

}  // namespace

/// HEX 04 80 10 27 ...: one block or several.
void FileReader::block_line(const source::Span& one) {
  const std::vector<source::Span> all = words(sources_, one);
  std::vector<int> bytes;
  for (std::size_t i = 1; i < all.size(); ++i) {
    const std::string_view digits = sources_.text(all[i]);
    const bool is_hex = digits.size() % 2 == 0 && std::all_of(digits.begin(), digits.end(), [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; });
    if (!is_hex) return void(diagnostics_.error("ACR-E12", all[i], fmt::format("'{}' is no row of bytes; HEX takes bytes of two hexadecimal digits: HEX 04 80 10 27", digits)));
    for (std::size_t k = 0; k < digits.size(); k += 2) bytes.push_back(16 * hex_value(digits[k]) + hex_value(digits[k + 1]));
  }
  if (bytes.empty()) return void(diagnostics_.error("ACR-E12", one, "HEX takes the bytes of a fast move block: HEX 04 80 10 27"));
  Card* card = current(one);
  for (std::size_t begin = 0, length = 0; card && begin < bytes.size(); begin += length) {
    if (std::string why = block_problem(bytes, begin, settings_, length); !why.empty()) return void(diagnostics_.error("ACR-E12", one, std::move(why)));
    std::string digits;
    for (std::size_t i = begin; i < begin + length; ++i) digits += fmt::format("{:02X}", bytes[i]);
    card->reader.take_block(one, digits);
  }
}

System FileReader::finish() {
  System system;
  system.symbols = settings_.symbols();
  for (Card& card : cards_) {
    for (bytecode::Symbol& symbol : card.settings.symbols(static_cast<std::uint32_t>(card.reader.card()))) system.symbols.push_back(std::move(symbol));
    system.units.push_back(card.reader.finish());
  }
  return system;
}

}  // namespace pmac::compiler::acr1000
