// pmacc fmt: files in the style of docs/fmt.md.
#pragma once

namespace pmac::pmacc {

/// argv[0] is the word fmt. Returns the exit code: 0 nothing to do or done, 1 files that would change (--check) or that cannot be
/// formatted, 2 usage or unreadable file.
int run_fmt(int argc, char** argv);

}  // namespace pmac::pmacc
