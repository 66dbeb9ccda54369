// pmac-silverlode: interpolation tables of the application note "Make Circles", executed on simulated servos.
#include <csignal>
#include <cstdio>
#include <exception>

#include "runtime/gather/output_file.h"
#include "runtime/tool/options.h"
#include "runtime/tool/silverlode_circle.h"
#include "runtime/tool/silverlode_options.h"

int main(int argc, char** argv) {
  using namespace pmac::tool;
  try {
    std::signal(SIGPIPE, SIG_IGN);
    SilverlodeOptions options;
    if (const auto code = parse_silverlode_options(argc, argv, options)) return *code;
    return options.verb == SilverlodeOptions::Verb::kDecode ? run_decode(options) : run_circle(options);
  } catch (const pmac::runtime::OutputError& e) {
    std::fprintf(stderr, "pmac-silverlode: %s\n", e.what());
    return kExitUsage;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "pmac-silverlode: internal error: %s\n", e.what());
    return kExitInternal;
  }
}
