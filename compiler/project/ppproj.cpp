// X.ppproj, the IDE's project file: MSBuild XML. Items of any kind with Include="PMAC Script Language\Folder\File" are script files;
// within a folder DisplayOrder counts, and where it is missing (older IDEs) the name, capitals before small letters.
// pugixml expands no entities of the document's own and loads nothing from elsewhere, and it builds its tree without recursion.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>
#include <pugixml.hpp>
#include <set>

#include "compiler/project/listing.h"
#include "compiler/source/encoding.h"

namespace pmac::compiler::project {
namespace {

constexpr int kNoOrder = std::numeric_limits<int>::max();

struct Item { Entry entry; int folder = 0; int order = kNoOrder; };

/// MSBuild writes some characters as %20.
std::string unescape(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned code = 0;
    const bool escaped = text[i] == '%' && i + 2 < text.size() && std::from_chars(text.data() + i + 1, text.data() + i + 3, code, 16).ptr == text.data() + i + 3;
    result += escaped ? static_cast<char>(code) : text[i];
    i += escaped ? 2 : 0;
  }
  return result;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

class PpprojReader {
 public:
  PpprojReader(std::int32_t file, source::SourceManager& sources, source::Diagnostics& diagnostics) : file_(file), text_(sources.file(file).text), diagnostics_(diagnostics) {}

  bool parse() {
    const pugi::xml_parse_result result = document_.load_buffer(text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result) {
      diagnostics_.error("PM6101", span_at(static_cast<std::size_t>(result.offset), 1), fmt::format("this is not a well-formed project file: {}", result.description()));
      return false;
    }
    if (project()) return true;
    diagnostics_.error("PM6101", span_at(0, 1), "this is not a project file of the IDE: its first element is not <Project>");
    return false;
  }

  std::vector<Entry> entries() {
    for (const pugi::xml_node group : project().children("ItemGroup"))
      for (const pugi::xml_node item : group.children()) take_item(item);
    check_groups();
    std::stable_sort(items_.begin(), items_.end(), [](const Item& a, const Item& b) {
      if (a.folder != b.folder) return a.folder < b.folder;
      return a.order != b.order ? a.order < b.order : a.entry.path < b.entry.path;
    });
    std::vector<Entry> entries;
    for (Item& item : items_) entries.push_back(std::move(item.entry));
    return entries;
  }

  VariableStarts starts() {
    VariableStarts starts;
    read_start("PVarStart", starts.p);
    read_start("QVarStart", starts.q);
    read_start("MVarStart", starts.m);
    return starts;
  }

 private:
  pugi::xml_node project() const { return document_.child("Project"); }

  source::Span span_at(std::size_t begin, std::size_t length) const {
    const std::size_t first = std::min(begin, text_.size());
    return {file_, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(std::min(first + length, text_.size())), -1};
  }

  /// The value of Include as it stands in the text, or the name of the element.
  source::Span span_of(const pugi::xml_node& item) const {
    const auto begin = static_cast<std::size_t>(std::max<std::ptrdiff_t>(item.offset_debug(), 0));
    const std::size_t end = std::min(text_.find('>', begin), text_.size());
    const std::size_t attribute = text_.find("Include", begin);
    const std::size_t open = attribute < end ? text_.find_first_of("\"'", attribute) : std::string::npos;
    if (open >= end) return span_at(begin, std::string_view(item.name()).size());
    const std::size_t close = text_.find(text_[open], open + 1);
    return span_at(open + 1, std::min(close, end) - open - 1);
  }

  void take_item(const pugi::xml_node& item) {
    const std::string_view name = item.name();
    const pugi::xml_attribute include = item.attribute("Include");
    if (!include || name == "Folder" || name == "Reference") return;
    const std::string_view value = include.value();
    for (std::size_t at = 0; at <= value.size();) {
      const std::size_t end = std::min(value.find(';', at), value.size());
      take_path(item, unescape(value.substr(at, end - at)));
      at = end + 1;
    }
  }

  void take_path(const pugi::xml_node& item, std::string path) {
    std::replace(path.begin(), path.end(), '\\', '/');
    const auto folder = folder_rank(path);
    const source::Span span = span_of(item);
    if (!folder) {
      if (is_script(path)) diagnostics_.warning("PM6104", span, fmt::format("\"{}\" lies in none of the script folders of a project and is not loaded", path));
      return;
    }
    if (path.find_first_of("*?") != std::string::npos || path.find("$(") != std::string::npos) {
      diagnostics_.error("PM6104", span, "wildcards and properties in Include are not understood; list the files");
    } else if (!is_script(path)) {
      diagnostics_.warning("PM6104", span, fmt::format("\"{}\" is no script file (.pmh .kin .pmc .plc) and is not loaded", path));
    } else if (items_.size() >= kMaxFiles) {
      diagnostics_.error("PM6106", span, fmt::format("a project has at most {} files", kMaxFiles));
    } else if (!seen_.insert(path).second) {
      diagnostics_.warning("PM6103", span, fmt::format("\"{}\" is listed twice; it is loaded once", path));
    } else {
      items_.push_back({{std::move(path), span}, *folder, item.child("DisplayOrder").text().as_int(kNoOrder)});
    }
  }

  /// Names of elements that are read, in any case as MSBuild has it; what is nearly one of them is a slip. The IDE writes hundreds of others.
  void check_groups() {
    for (const pugi::xml_node group : project().children()) {
      if (group.type() != pugi::node_element) continue;
      check_name(group, {"ItemGroup", "PropertyGroup", "Import", "UsingTask", "Target", "ProjectExtensions", "Choose"});
      if (std::string_view(group.name()) != "PropertyGroup") continue;
      for (const pugi::xml_node property : group.children())
        if (property.type() == pugi::node_element) check_name(property, {"PVarStart", "QVarStart", "MVarStart"});
    }
  }

  void check_name(const pugi::xml_node& node, const std::vector<std::string_view>& names) {
    const std::string written = lower_case(node.name());
    if (std::any_of(names.begin(), names.end(), [&](std::string_view name) { return lower_case(name) == written; })) return;
    const std::string_view near = source::nearest_word(written, names);
    if (near.empty()) return;
    const auto begin = static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0));
    diagnostics_.warning("PM6105", span_at(begin, std::string_view(node.name()).size()), fmt::format("<{}> is not read; did you mean <{}>?", node.name(), near));
  }

  void read_start(const char* name, std::int64_t& start) {
    for (const pugi::xml_node group : project().children("PropertyGroup")) {
      const pugi::xml_node node = group.find_child([&](const pugi::xml_node& child) { return lower_case(child.name()) == lower_case(name); });
      if (!node) continue;
      const std::string_view text = node.text().get();
      std::int64_t value = -1;
      const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
      if (read.ec == std::errc() && read.ptr == text.data() + text.size() && value >= 0) start = value;
      else diagnostics_.warning("PM6105", span_of(node), fmt::format("{} is no number; {} is used", name, start));
      return;
    }
  }

  std::int32_t file_;
  const std::string& text_;
  source::Diagnostics& diagnostics_;
  pugi::xml_document document_;
  std::vector<Item> items_;
  std::set<std::string> seen_;
};

}  // namespace

Listing read_ppproj(const std::filesystem::path& file, source::SourceManager& sources, source::Diagnostics& diagnostics) {
  auto text = read_bytes(file, kMaxProjectBytes);
  if (!text) throw Unreadable(fmt::format("cannot read {}, or it is larger than {} bytes", file.string(), kMaxProjectBytes));
  Listing listing;
  listing.root = file.parent_path();
  PpprojReader reader(sources.add_file(file.string(), source::decode_text(std::move(*text))), sources, diagnostics);
  if (!reader.parse()) return listing;
  listing.starts = reader.starts();
  listing.entries = reader.entries();
  return listing;
}

}  // namespace pmac::compiler::project
