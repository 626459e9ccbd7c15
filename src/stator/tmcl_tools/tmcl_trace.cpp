#include "stator/tmcl_tools/tmcl_trace.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "stator/base/csv.hpp"
#include "stator/tmcl/command.hpp"

namespace stator::tmcl_tools {

namespace {

constexpr std::array<std::pair<tmcl::ErrorFlag, std::string_view>, tmcl::kErrorFlagCount>
    kErrorFlagNames{{{tmcl::ErrorFlag::timeout, "ETO"},
                     {tmcl::ErrorFlag::external_alarm, "EAL"},
                     {tmcl::ErrorFlag::deviation, "EDV"},
                     {tmcl::ErrorFlag::position, "EPO"},
                     {tmcl::ErrorFlag::shutdown, "ESD"}}};

void append_word(std::string& text, bool holds, std::string_view word) {
  if (holds) {
    text += text.empty() ? "" : " ";
    text += word;
  }
}

}  // namespace

std::string flags_text(const tmcl::Registers& registers) {
  std::string text;
  append_word(text, registers.zero, "ZE");
  append_word(text, registers.equal, "EQ");
  append_word(text, registers.lower, "LT");
  append_word(text, registers.greater, "GT");
  for (const auto& [flag, name] : kErrorFlagNames) {
    append_word(text, registers.raised(flag), name);
  }
  return text;
}

std::string seconds_text(base::SimTime time) {
  const std::int64_t microseconds = time.nanoseconds() / 1'000;
  return fmt::format("{}.{:06}", microseconds / 1'000'000, microseconds % 1'000'000);
}

TmclTrace::TmclTrace(std::FILE* file, const TmclSource& source,
                     std::vector<product::Signal> signals, const TraceOptions& options)
    : file_(file),
      source_(source),
      signals_(std::move(signals)),
      options_(options),
      outcomes_(source.module().program_length) {
  for (std::size_t address = 0; address < source.program().instructions.size(); ++address) {
    command_width_ = std::max(command_width_, source.command_at(address).size());
  }
  if (options_.csv) {
    std::string row = "time [s],address,line,command,accumulator,x,flags,status";
    for (const product::Signal& signal : signals_) {
      fmt::format_to(std::back_inserter(row), ",{} [{}]", signal.name, signal.unit);
    }
    write(row);
    return;
  }
  std::string row =
      fmt::format("{:>12} {:>7} {:>5}  {:{}} {:>11} {:>11}  {:11} {:>6}", "TIME [s]", "ADDRESS",
                  "LINE", "COMMAND", command_width_, "ACCUMULATOR", "X", "FLAGS", "STATUS");
  for (const product::Signal& signal : signals_) {
    fmt::format_to(std::back_inserter(row), "  {} [{}]", signal.name, signal.unit);
  }
  write(row);
}

bool TmclTrace::repeats(const tmcl::ProgramStep& step, const tmcl::Registers& registers) {
  const Outcome outcome{era_, step.instruction, registers, step.status};
  const bool repeated = outcomes_[step.address] == outcome;
  outcomes_[step.address] = outcome;
  if (step.instruction.command == static_cast<std::uint8_t>(tmcl::Command::wait)) {
    ++era_;
  }
  return repeated;
}

void TmclTrace::executed(const tmcl::ProgramStep& step, const tmcl::Registers& registers) {
  if (options_.changes_only && repeats(step, registers)) {
    return;
  }
  const auto line = source_.line_of(step.address);
  const std::string line_text = line ? std::to_string(*line) : std::string();
  const auto status = static_cast<int>(step.status);
  std::string row;
  if (options_.csv) {
    fmt::format_to(std::back_inserter(row), "{},{},{},", seconds_text(step.time), step.address,
                   line_text);
    base::append_csv_field(row, source_.command_at(step.address));
    fmt::format_to(std::back_inserter(row), ",{},{},{},{}", registers.accumulator, registers.x,
                   flags_text(registers), status);
  } else {
    row =
        fmt::format("{:>12} {:>7} {:>5}  {:{}} {:>11} {:>11}  {:11} {:>6}", seconds_text(step.time),
                    step.address, line_text, source_.command_at(step.address), command_width_,
                    registers.accumulator, registers.x, flags_text(registers), status);
  }
  for (const product::Signal& signal : signals_) {
    if (options_.csv) {
      fmt::format_to(std::back_inserter(row), ",{:.10g}", signal.read());
    } else {
      fmt::format_to(std::back_inserter(row), "  {:>{}.10g}", signal.read(),
                     signal.name.size() + signal.unit.size() + 3);
    }
  }
  write(row);
}

void TmclTrace::write(const std::string& row) {
  good_ = std::fwrite(row.data(), 1, row.size(), file_) == row.size() && good_;
  good_ = std::fputc('\n', file_) != EOF && good_;
}

}  // namespace stator::tmcl_tools
