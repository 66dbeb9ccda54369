// Runs a program text or file as pmac-run does, in process, and keeps everything that comes out.
#pragma once

#include <array>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "compiler/compiler.h"
#include "runtime/machine.h"

namespace pmac::test {

inline std::string read_program(const std::string& name) {
  std::ifstream in(std::string(PMAC_SOURCE_DIR) + "/programs/" + name);
  std::stringstream text;
  text << in.rdbuf();
  REQUIRE(in.good());
  return text.str();
}

class ProgramBench : public runtime::SampleSink {
 public:
  explicit ProgramBench(const std::string& name, std::string text = {}, motion::FineInterpolation fine = motion::FineInterpolation::kThrough,
                        bool limit_jerk = false, std::function<void(int, const motion::MotionCommand&)> command_observer = {}) {
    if (text.empty()) text = read_program(name);
    auto module = session_.compile({{name, text}});
    for (const auto& d : session_.diagnostics().take()) diagnostics.push_back(d.message);
    INFO((diagnostics.empty() ? std::string() : diagnostics[0]));
    REQUIRE(module);
    REQUIRE(verify(*module).empty());
    runtime::MachineOptions options;
    options.fine = fine;
    options.limit_jerk = limit_jerk;
    options.observers.jerk_join = [this](const runtime::JerkJoin& join) { joins.push_back(join); };
    options.compile_online = [this](std::string_view line, std::string_view where) -> std::variant<bytecode::Module, std::string> {
      auto compiled = session_.compile_online(line, where);
      for (const auto& d : session_.diagnostics().take())
        if (d.severity == source::Severity::kError) return d.message;
      if (!compiled) return std::string("refused");
      return std::move(*compiled);
    };
    options.observers.motion_command = std::move(command_observer);
    options.observers.move = [this](const runtime::MoveRecord& m) { moves.push_back(m); };
    options.observers.output = [this](const runtime::OutputChange& c) { outputs.push_back(c); };
    options.observers.fault = [this](const runtime::FaultRecord& f) { faults.push_back(f); };
    options.observers.answer = [this](const std::string& answer) { answers.push_back(answer); };
    options.observers.refused = [this](const std::string& what, const std::string& why) { refusals.push_back(what + ": " + why); };
    options.observers.warning = [this](bytecode::SourceLine, const std::string& warning) { warnings.push_back(warning); };
    machine = std::make_unique<runtime::Machine>(options);
    machine->add_sink(this);
    machine->add_sink(&statistics);
    machine->load(std::move(*module));
  }

  runtime::RunOutcome run(const std::string& commands, const runtime::RunLimits& limits = {}) {
    machine->command(commands, "-e");
    return machine->run(limits);
  }

  void take(const runtime::SampleBlock& block) override {
    for (int k = 0; k < block.count; ++k) {
      time_ms.push_back(block.time_ms(k));
      std::array<double, bytecode::kMaxMotors> row{};
      for (std::size_t m = 0; m < block.motors.size(); ++m) row[static_cast<std::size_t>(block.motors[m])] = block.at(static_cast<int>(m), k);
      motor_mu.push_back(row);
    }
  }

  const runtime::MotionStatistics::Row& motor(int number) {
    rows_ = statistics.rows();
    for (const auto& row : rows_)
      if (row.motor == number) return row;
    FAIL("motor " << number << " is not in use");
    return rows_[0];
  }

  std::vector<std::string> diagnostics, refusals, answers, warnings;
  std::vector<runtime::MoveRecord> moves;
  std::vector<runtime::OutputChange> outputs;
  std::vector<runtime::FaultRecord> faults;
  std::vector<runtime::JerkJoin> joins;
  std::vector<double> time_ms;
  std::vector<std::array<double, bytecode::kMaxMotors>> motor_mu;
  runtime::MotionStatistics statistics;
  std::unique_ptr<runtime::Machine> machine;

 private:
  compiler::Session session_;
  std::vector<runtime::MotionStatistics::Row> rows_;
};

}  // namespace pmac::test
