#include "compiler/tool/inputs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "compiler/tool/options.h"

namespace pmac::pmacc {

std::string read_file(const std::string& name) {
  if (name == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  std::error_code error;
  if (std::filesystem::is_directory(name, error)) throw UsageError(fmt::format("cannot read {}: it is a directory", name));
  std::ifstream stream(name, std::ios::binary);
  if (!stream) throw UsageError(fmt::format("cannot read {}", name));
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) throw UsageError(fmt::format("cannot read {}", name));
  return text;
}

std::vector<compiler::InputFile> read_inputs(const std::vector<std::string>& names) {
  std::vector<compiler::InputFile> files;
  for (const std::string& name : names) files.push_back({name == "-" ? "<stdin>" : name, read_file(name)});
  return files;
}

void write_file(const std::string& name, std::string_view bytes) {
  std::error_code error;
  const std::filesystem::path known = std::filesystem::canonical(name, error);  // a link keeps pointing at the file
  const std::string target = error ? name : known.string();
  const bool exists = !error;
  const std::string temporary = fmt::format("{}.{}.tmp", target, ::getpid());
  std::ofstream stream(temporary, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  error.clear();
  if (stream && exists) std::filesystem::permissions(temporary, std::filesystem::status(target).permissions(), error);
  if (stream && !error) std::filesystem::rename(temporary, target, error);
  if (stream && !error) return;
  std::filesystem::remove(temporary, error);
  throw UsageError(fmt::format("cannot write {}", name));
}

void refuse_to_overwrite(const std::vector<std::string>& sources, const std::string& output) {
  for (const std::string& source : sources) {
    std::error_code ignored;
    if (!output.empty() && std::filesystem::equivalent(source, output, ignored)) throw UsageError(output + " is a source file; choose another name for the object file");
  }
}

}  // namespace pmac::pmacc
