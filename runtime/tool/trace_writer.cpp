#include "runtime/tool/trace_writer.h"

#include <cstdio>

#include <fmt/format.h>

namespace pmac::tool {
namespace {

using What = runtime::TraceRecord::What;

constexpr std::size_t kMostSourceText = 120;  // characters of a line that are shown

std::string trimmed(std::string text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return {};
  text = text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
  if (text.size() <= kMostSourceText) return text;
  std::size_t end = kMostSourceText;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;  // not inside a UTF-8 character
  return text.substr(0, end) + "...";
}

}  // namespace

TraceWriter::TraceWriter(const RunOptions& options, SourceText source_text) : options_(options), source_text_(std::move(source_text)) {
  if (!options.trace.empty() && options.trace != "-") file_ = std::make_unique<runtime::OutputFile>(options.trace);
}

void TraceWriter::attach(runtime::MachineOptions& machine) {
  if (options_.trace.empty()) return;
  machine.trace = options_.trace_instructions ? runtime::TraceDetail::kInstructions : runtime::TraceDetail::kLines;
  machine.trace_limit = options_.trace_limit;
}

/// The line itself; an instruction; nothing where a line goes on.
std::string TraceWriter::line_text(const runtime::TraceRecord& record, const std::string& file) const {
  if (record.what == What::kInstruction) return fmt::format("{:>6}  {}", record.pc, record.text);
  if (record.what == What::kGoesOn) return "...";
  return trimmed(source_text_(file, record.source.line).value_or(""));
}

void TraceWriter::write(const runtime::TraceRecord& record, const std::string& file, const std::string& place) {
  ++written_;
  std::string line = fmt::format("{:>14.6f}  {:<8} {:<14} {}: {}", record.time_ms / 1000.0, record.thread, record.program, place, line_text(record, file));
  if (record.what != What::kInstruction && !record.text.empty()) {
    if (line.size() < 80) line.resize(80, ' ');
    line += (record.what == What::kSynchronous ? "  => " : "  -> ") + record.text;
  }
  put(line + "\n");
}

void TraceWriter::put(const std::string& line) {
  if (failed_) return;
  try {
    if (file_) file_->write(line);
    else std::fputs(line.c_str(), stdout);
  } catch (const std::exception& e) {
    fail(e);
  }
}

void TraceWriter::fail(const std::exception& error) {
  std::fprintf(stderr, "pmac-run: %s\n", error.what());
  failed_ = true;
}

bool TraceWriter::finish() {
  if (options_.trace.empty()) return true;
  if (written_ >= options_.trace_limit) {
    put(fmt::format("# {} records; the rest of the trace is left out (--trace-limit)\n", written_));
    std::fprintf(stderr, "pmac-run: the trace ends after %llu records (--trace-limit)\n", static_cast<unsigned long long>(written_));
  }
  try {
    if (file_ && !failed_) file_->commit();
  } catch (const std::exception& e) {
    fail(e);
  }
  return !failed_;
}

}  // namespace pmac::tool
