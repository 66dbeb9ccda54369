#include "runtime/tool/acr_cards.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>

namespace pmac::tool {
namespace {

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

}  // namespace

std::optional<std::string> CardStation::send(const std::string& line) {
  auto compiled = compiler_(line);
  if (auto* reason = std::get_if<std::string>(&compiled)) return std::move(*reason);
  runtime::ProgramHandle commands = std::move(std::get<runtime::ProgramHandle>(compiled));
  if (!card_.waits()) {
    lines_.push_back(std::move(commands));
    return std::nullopt;
  }
  const auto fault = processor_.execute_now(std::move(commands));
  return fault ? std::optional(fault->id + ": " + fault->detail) : std::nullopt;
}

void CardStation::read_stream(acr1000::ByteSource source, acr1000::Place place) {
  acr1000::StreamActions actions;
  actions.answer = print_;
  actions.execute = [this](const std::string& line) { return execute_streamed(line); };
  stream_ = std::make_unique<acr1000::BlockStreamDriver>(card_, std::move(source), std::move(actions), place);
}

/// The line is executed when the stream has been left for it, which is at once.
std::optional<acr1000::DriverFault> CardStation::execute_streamed(const std::string& line) {
  if (const auto reason = send(line)) return acr1000::DriverFault{"ACR-E02", *reason, stream_->place()};
  return std::nullopt;
}

acr1000::DriverStep CardStation::step(std::uint64_t command_budget) {
  acr1000::DriverStep step;
  while (step.commands < command_budget) {
    if (!processor_.executes_line() && !lines_.empty()) {
      processor_.start(std::move(lines_.front()));
      lines_.pop_front();
    }
    streams_ = false;
    acr1000::DriverStep part = processor_.step(command_budget - step.commands);
    part.commands += step.commands;
    step = std::move(part);
    if (step.stop != acr1000::DriverStop::kIdle) return step;
    if (!lines_.empty()) continue;
    if (!stream_) return step;
    streams_ = true;
    part = stream_->step(1);   // a line among the blocks goes to the processor
    part.commands += step.commands;
    step = std::move(part);
    if (step.stop != acr1000::DriverStop::kBudget && (step.stop != acr1000::DriverStop::kIdle || lines_.empty())) return step;
  }
  step.stop = acr1000::DriverStop::kBudget;
  return step;
}

void CardStation::abandon() {
  processor_.abandon();
  lines_.clear();
  if (stream_) stream_->abandon();
}

std::string axis_of_file(const std::string& name) {
  const std::filesystem::path stem = std::filesystem::path(name).stem();
  const std::string extension = stem.extension().string();
  return extension.size() > 1 ? upper(extension.substr(1)) : "";
}

acr1000::ByteSource open_stream(const std::string& name) {
  std::error_code ignored;
  if (std::filesystem::is_directory(name, ignored)) return {};
  const std::shared_ptr<std::FILE> file(std::fopen(name.c_str(), "rb"), [](std::FILE* f) { if (f) std::fclose(f); });
  if (!file) return {};
  return [file](std::span<std::uint8_t> into) { return std::fread(into.data(), 1, into.size(), file.get()); };
}

AddressedLine split_address(const std::string& text) {
  const std::size_t sign = text.find('>');
  const std::string axis = sign == std::string::npos ? "" : upper(trimmed(text.substr(0, sign)));
  const bool is_name = !axis.empty() && std::all_of(axis.begin(), axis.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
  return is_name ? AddressedLine{axis, trimmed(text.substr(sign + 1))} : AddressedLine{"", trimmed(text)};
}

bool is_halt(const std::string& line) {
  const std::string word = upper(trimmed(line));
  return word == "HALT" || word == "HAL";
}

}  // namespace pmac::tool
