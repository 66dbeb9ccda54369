// pp_proj.ini, which the IDE writes for the controller: section [PMAC_PROGRAMS] holds PVARSTART, QVARSTART, MVARSTART, the lines
// file1=/var/ftp/usrflash/Project/... in load order, and last_file_number. The other sections that the IDE writes set up the controller's
// buffers, tasks and C programs and mean nothing here.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>

#include "compiler/project/listing.h"
#include "compiler/source/encoding.h"

namespace pmac::compiler::project {
namespace {

namespace fs = std::filesystem;

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::optional<std::int64_t> number_of(std::string_view text) {
  std::int64_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || read.ptr != text.data() + text.size() || read.ec != std::errc() || value < 0) return std::nullopt;
  return value;
}

/// What stands behind the project's folder on the controller, or the path itself.
std::string relative_path(std::string_view path) {
  std::string result(path);
  std::replace(result.begin(), result.end(), '\\', '/');
  constexpr std::string_view kProject = "/Project/";
  const std::size_t at = result.find(kProject);
  return at == std::string::npos ? result : result.substr(at + kProject.size());
}

/// The sections of the files that the IDE writes.
const std::vector<std::string_view>& sections() {
  static const std::vector<std::string_view> kSections = {"PMAC_PROGRAMS", "PMAC_BUFFERS", "PMAC_SIG",        "PMAC_HARDWARE",  "PMAC_CONFIG",      "PMAC_PROJECT", "PMACMODE",   "CPU_AFFINITY",      "THREAD_PRIORITY",
                                                          "ETHERCAT",      "IEC61131",     "CUSTOM_CONFIG_FILE", "MACRO_STATIONS", "PROJECT_SETTINGS", "CPLCC",        "CPLCS",      "LINUX_PROGRAMS",    "RTUSRCCODE"};
  return kSections;
}

class IniReader {
 public:
  IniReader(std::int32_t file, const source::SourceManager& sources, source::Diagnostics& diagnostics) : file_(file), text_(sources.file(file).text), diagnostics_(diagnostics) {}

  void read(Listing& listing) {
    bool programs = false;
    std::size_t begin = text_.starts_with("\xef\xbb\xbf") ? 3 : 0;
    for (std::size_t end; begin < text_.size(); begin = end + 1) {
      end = std::min(text_.find('\n', begin), text_.size());
      const std::string_view line = trim(std::string_view(text_).substr(begin, end - begin));
      if (line.starts_with("[")) programs = line == "[PMAC_PROGRAMS]", check_section(line);
      else if (programs && !line.empty() && line.front() != '#' && line.front() != ';') take_line(line, listing);
    }
    listing.entries = entries();
  }

 private:
  source::Span span_of(std::string_view part) const {
    const auto begin = static_cast<std::uint32_t>(part.data() - text_.data());
    return {file_, begin, begin + static_cast<std::uint32_t>(part.size()), -1};
  }

  void check_section(std::string_view line) {
    const std::size_t end = line.find(']');
    if (end == std::string_view::npos) return void(diagnostics_.warning("PM6105", span_of(line), "a section is a name in square brackets: [PMAC_PROGRAMS]"));
    const std::string_view name = line.substr(1, end - 1);
    if (std::find(sections().begin(), sections().end(), name) != sections().end()) return;
    const source::Guess near = source::guess_word(name, sections());
    const std::string hint = near.word.empty() ? std::string() : fmt::format("; did you mean [{}]?", near.word);
    diagnostics_.warning("PM6105", span_of(line.substr(0, end + 1)), fmt::format("[{}] is no section that the IDE writes, and is not read{}", name, hint));
  }

  void take_line(std::string_view line, Listing& listing) {
    const std::size_t equals = line.find('=');
    const std::string_view key = trim(line.substr(0, equals));
    const std::string_view value = equals == std::string_view::npos ? std::string_view() : trim(line.substr(equals + 1));
    const auto number = key.starts_with("file") ? number_of(key.substr(4)) : std::nullopt;
    if (number) return take_file(*number, value);
    if (key == "PVARSTART") return take_number(key, value, listing.starts.p);
    if (key == "QVARSTART") return take_number(key, value, listing.starts.q);
    if (key == "MVARSTART") return take_number(key, value, listing.starts.m);
    if (key == "last_file_number") return take_number(key, value, last_);
    diagnostics_.warning("PM6105", span_of(key), fmt::format("'{}' is no setting of [PMAC_PROGRAMS]", key));
  }

  void take_number(std::string_view key, std::string_view value, std::int64_t& target) {
    const auto number = number_of(value);
    if (number) target = *number;
    else diagnostics_.warning("PM6105", span_of(key), fmt::format("{} is no number", key));
  }

  void take_file(std::int64_t number, std::string_view path) {
    if (files_.size() >= kMaxFiles) {
      diagnostics_.error("PM6106", span_of(path), fmt::format("a project has at most {} files", kMaxFiles));
    } else if (!files_.emplace(number, Entry{relative_path(path), span_of(path)}).second) {
      diagnostics_.warning("PM6103", span_of(path), fmt::format("file{} is given twice; the first counts", number));
    }
  }

  std::vector<Entry> entries() {
    std::vector<Entry> entries;
    for (auto& [number, entry] : files_) {
      if (last_ < 0 || number <= last_) entries.push_back(std::move(entry));
      else diagnostics_.warning("PM6105", entry.span, fmt::format("file{} comes after last_file_number={} and is not loaded", number, last_));
    }
    return entries;
  }

  std::int32_t file_;
  const std::string& text_;
  source::Diagnostics& diagnostics_;
  std::map<std::int64_t, Entry> files_;
  std::int64_t last_ = -1;
};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

Listing read_project_ini(const fs::path& file, source::SourceManager& sources, source::Diagnostics& diagnostics) {
  auto text = read_bytes(file, kMaxProjectBytes);
  if (!text) throw Unreadable(fmt::format("cannot read {}, or it is larger than {} bytes", file.string(), kMaxProjectBytes));
  Listing listing;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const bool in_configuration = lower(fs::absolute(folder).lexically_normal().filename().string()) == "configuration";
  listing.root = in_configuration ? folder / ".." : folder;
  IniReader(sources.add_file(file.string(), source::decode_text(std::move(*text))), sources, diagnostics).read(listing);
  return listing;
}

}  // namespace pmac::compiler::project
