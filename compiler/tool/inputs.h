// Files in and out of pmacc.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/compiler.h"

namespace pmac::pmacc {

inline constexpr std::size_t kLongestInput = std::size_t{1} << 30;   // bytes of one file

/// Text of a file, or of standard input for "-". Throws UsageError when it cannot be read or is longer than kLongestInput.
std::string read_file(const std::string& name);

/// The files of the command line in load order, projects by their files. What is wrong inside of a project goes to the session,
/// and its first numbers of variables too. Throws UsageError.
std::vector<compiler::InputFile> read_inputs(const std::vector<std::string>& names, compiler::Session& session);

/// Writes under another name first, so that a file of the wanted name is always whole. Throws UsageError.
void write_file(const std::string& name, std::string_view bytes);
/// The same with bytes that come piece by piece.
using ByteWriter = std::function<void(std::string_view)>;
void write_file(const std::string& name, const std::function<void(const ByteWriter&)>& content);

/// Throws UsageError when the output would replace one of the sources.
void refuse_to_overwrite(const std::vector<std::string>& sources, const std::string& output);

}  // namespace pmac::pmacc
