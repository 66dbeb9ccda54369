// Compiles programs into object files that the fuzz targets begin with: object_seeds FOLDER PROGRAM...
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "compiler/bytecode/object_file.h"
#include "compiler/compiler.h"

using namespace pmac;

namespace {

bool compile(const std::filesystem::path& program, const std::filesystem::path& object) {
  std::ifstream in(program, std::ios::binary);
  compiler::Session session;
  const auto module = session.compile({{program.string(), {std::istreambuf_iterator<char>(in), {}}}});
  if (!module) return false;
  const auto bytes = bytecode::save(*module);
  std::ofstream(object, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  std::filesystem::create_directories(folder);
  for (int i = 2; i < argc; ++i) {
    const std::filesystem::path program = argv[i];
    if (compile(program, folder / program.stem().concat(".pmx"))) continue;
    std::fprintf(stderr, "%s does not compile\n", program.c_str());
    return 1;
  }
  return 0;
}
