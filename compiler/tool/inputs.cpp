#include "compiler/tool/inputs.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>

#include "compiler/project/project.h"
#include "compiler/tool/options.h"
#include "compiler/tool/temporary_file.h"

namespace pmac::pmacc {
namespace {

void add_project(const std::string& name, compiler::Session& session, std::vector<compiler::InputFile>& files) {
  try {
    compiler::project::Project project = compiler::project::read_project(name, session.sources(), session.diagnostics());
    if (files.empty()) session.set_variable_starts(project.starts);
    for (compiler::InputFile& file : project.files) files.push_back(std::move(file));
  } catch (const compiler::project::Unreadable& problem) {
    throw UsageError(problem.what());
  }
}

}  // namespace

namespace {

/// What stands in a stream; nothing where that is more than a place in a text can count.
std::optional<std::string> text_of(std::istream& stream, std::string text) {
  char buffer[65536];
  while (stream.read(buffer, sizeof buffer), stream.gcount() > 0) {
    text.append(buffer, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kLongestInput) return std::nullopt;
  }
  return text;
}

}  // namespace

std::string read_file(const std::string& name) {
  const std::string too_long = fmt::format("cannot read {}: it is longer than {} MiB", name == "-" ? "standard input" : name, kLongestInput >> 20);
  if (name == "-") {
    if (auto text = text_of(std::cin, {})) return std::move(*text);
    throw UsageError(too_long);
  }
  std::error_code error;
  if (std::filesystem::is_directory(name, error)) throw UsageError(fmt::format("cannot read {}: it is a directory", name));
  std::ifstream stream(name, std::ios::binary);
  if (!stream) throw UsageError(fmt::format("cannot read {}", name));
  std::string text;
  const auto size = std::filesystem::file_size(name, error);
  if (!error && size > kLongestInput) throw UsageError(too_long);
  if (!error) text.reserve(size);
  auto read = text_of(stream, std::move(text));
  if (!read) throw UsageError(too_long);
  if (stream.bad()) throw UsageError(fmt::format("cannot read {}", name));
  return std::move(*read);
}

std::vector<compiler::InputFile> read_inputs(const std::vector<std::string>& names, compiler::Session& session) {
  std::vector<compiler::InputFile> files;
  for (const std::string& name : names) {
    if (compiler::project::is_project(name)) add_project(name, session, files);
    else files.push_back({name == "-" ? "<stdin>" : name, read_file(name)});
  }
  return files;
}

void write_file(const std::string& name, std::string_view bytes) {
  write_file(name, [&](const ByteWriter& write) { write(bytes); });
}

namespace {

/// A pipe or a device stays what it is: it is written to, and not replaced.
void write_to_device(const std::string& name, const std::function<void(const ByteWriter&)>& content) {
  errno = 0;
  std::ofstream stream(name, std::ios::binary);
  content([&](std::string_view bytes) { if (stream) stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
  if (stream) stream.close();
  if (!stream) throw UsageError(fmt::format("cannot write {}{}{}", name, errno != 0 ? ": " : "", errno != 0 ? std::strerror(errno) : ""));
}

}  // namespace

void write_file(const std::string& name, const std::function<void(const ByteWriter&)>& content) {
  std::error_code error;
  const std::filesystem::path known = std::filesystem::canonical(name, error);  // a link keeps pointing at the file
  const std::string target = error ? name : known.string();
  const bool exists = !error;
  if (exists && !std::filesystem::is_regular_file(target)) return write_to_device(name, content);
  TemporaryFile file(target);
  content([&](std::string_view bytes) { file.write(bytes); });
  if (const std::string reason = file.commit(); !reason.empty()) throw UsageError(fmt::format("cannot write {}: {}", name, reason));
}

void refuse_to_overwrite(const std::vector<std::string>& sources, const std::string& output) {
  for (const std::string& source : sources) {
    std::error_code ignored;
    if (!output.empty() && std::filesystem::equivalent(source, output, ignored)) throw UsageError(output + " is a source file; choose another name for the object file");
  }
}

}  // namespace pmac::pmacc
