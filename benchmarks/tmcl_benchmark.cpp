// Instructions of stand-alone programs. "of_limit" is the share of 50 ns, the time of an
// instruction at 20 million instructions/s, in the least of many short batches, so that what else
// the machine does drops out.

#include <algorithm>
#include <chrono>
#include <vector>

#include <benchmark/benchmark.h>

#include "stator/tmcl/command.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"
#include "tmcl/fake_module.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;
using tmcl::Command;
using tmcl::Instruction;

constexpr double kLimit = 50e-9;  // s
constexpr std::size_t kBatch = 10'000;
constexpr int kBatches = 1'000;

Instruction instruction(Command command, int type = 0, int motor = 0, std::int32_t value = 0) {
  return {.command = static_cast<std::uint8_t>(command),
          .type = static_cast<std::uint8_t>(type),
          .motor = static_cast<std::uint8_t>(motor),
          .value = value};
}

/// Counts to a limit and begins again, with a subroutine.
std::vector<Instruction> calculating() {
  return {instruction(Command::calculate, 0, 0, 1),
          instruction(Command::calculate_with_x, 7),
          instruction(Command::calculate_with_x, 7),
          instruction(Command::call_subroutine, 0, 0, 7),
          instruction(Command::compare, 0, 0, 1'000'000),
          instruction(Command::jump_conditionally, 6, 0, 0),
          instruction(Command::jump_always),
          instruction(Command::calculate, 8),
          instruction(Command::calculate, 8),
          instruction(Command::return_from_subroutine)};
}

/// A control loop: position, inputs and a variable in, a parameter, an output and a variable out.
std::vector<Instruction> controlling() {
  return {instruction(Command::get_axis_parameter, 1),
          instruction(Command::calculate, 1, 0, 1000),
          instruction(Command::accumulator_to_global_parameter, 1, 2),
          instruction(Command::get_input, 255),
          instruction(Command::calculate, 5, 0, 0x7),
          instruction(Command::set_output, 255, 2, -1),
          instruction(Command::get_global_parameter, 2, 2),
          instruction(Command::accumulator_to_axis_parameter, 4),
          instruction(Command::move_to_position, 0, 0, 100),
          instruction(Command::jump_always)};
}

/// Sees everything and keeps the last.
class Watcher : public tmcl::ProgramObserver {
 public:
  void executed(const tmcl::ProgramStep& step, const tmcl::Registers& registers) override {
    benchmark::DoNotOptimize(address_ = step.address);
    benchmark::DoNotOptimize(accumulator_ = registers.accumulator);
  }

 private:
  std::uint16_t address_ = 0;
  std::int32_t accumulator_ = 0;
};

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

template <typename Execute>
void measure(benchmark::State& bench, const Execute& execute_batch) {
  double least = 1.0;
  for (auto _ : bench) {
    for (int batch = 0; batch < kBatches; ++batch) {
      const auto begin = std::chrono::steady_clock::now();
      execute_batch();
      least = std::min(least, seconds_since(begin) / kBatch);
    }
  }
  bench.SetItemsProcessed(bench.iterations() * kBatches * static_cast<std::int64_t>(kBatch));
  bench.counters["least_ns"] = least * 1e9;
  bench.counters["million_per_s"] = 1e-6 / least;
  bench.counters["of_limit"] = least / kLimit;
}

struct Rig {
  explicit Rig(const std::vector<Instruction>& program) {
    module.remember = false;
    module.power_on();
    firmware.load_program(program);
    firmware.power_on({});
    firmware.start_program({});
  }

  tests::FakeModule module;
  tmcl::Firmware firmware{tests::FakeModule::description(), module};
};

/// As fast as possible, without time that passes.
void Interpreter_AtOnce(benchmark::State& bench, const std::vector<Instruction>& program) {
  Rig rig(program);
  measure(bench,
          [&] { benchmark::DoNotOptimize(rig.firmware.interpreter().run_at_once(kBatch, {})); });
}
BENCHMARK_CAPTURE(Interpreter_AtOnce, calculating, calculating())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Interpreter_AtOnce, controlling, controlling())->Unit(benchmark::kMillisecond);

/// One instruction in every 100 us of simulated time, as a rack in `free` time asks for it.
void Interpreter_InPasses(benchmark::State& bench, const std::vector<Instruction>& program) {
  Rig rig(program);
  base::SimTime now;
  measure(bench, [&] {
    now += 100_us * static_cast<std::int64_t>(kBatch);
    rig.firmware.advance(now);
  });
}
BENCHMARK_CAPTURE(Interpreter_InPasses, calculating, calculating())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Interpreter_InPasses, controlling, controlling())->Unit(benchmark::kMillisecond);

/// With somebody who looks at every instruction.
void Interpreter_Observed(benchmark::State& bench) {
  Rig rig(calculating());
  Watcher watcher;
  rig.firmware.interpreter().observe(&watcher);
  measure(bench,
          [&] { benchmark::DoNotOptimize(rig.firmware.interpreter().run_at_once(kBatch, {})); });
  rig.firmware.interpreter().observe(nullptr);
}
BENCHMARK(Interpreter_Observed)->Unit(benchmark::kMillisecond);

/// What a device pays in every period of its own loop while no program runs.
void Interpreter_Stopped(benchmark::State& bench) {
  Rig rig(calculating());
  rig.firmware.stop_program();
  base::SimTime now;
  for (auto _ : bench) {
    now += 100_us;
    rig.firmware.advance(now);
    benchmark::DoNotOptimize(rig.firmware.next_deadline());
  }
}
BENCHMARK(Interpreter_Stopped);

}  // namespace
