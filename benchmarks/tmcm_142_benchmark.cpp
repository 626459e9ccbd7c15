// Complete TMCM-142 modules. Limits: a hundred of them in real time on one core, that is a
// real-time factor of 1; 50,000 commands of a host per second, of which the module itself should
// take next to nothing.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <benchmark/benchmark.h>

#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/telegram.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;
using devices::Tmcm142;
using devices::Tmcm142Configuration;

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

tmcl::Instruction instruction(tmcl::Command command, std::uint8_t type, std::int32_t value) {
  return {.command = static_cast<std::uint8_t>(command), .type = type, .value = value};
}

enum class Work : std::uint8_t { at_rest, turning, turning_with_program };

/// A hundred modules through 10 ms at a time, in the periods in which a rack brings them there.
void run_hundred_modules(benchmark::State& bench, Work work) {
  constexpr std::size_t kModules = 100;
  const std::vector<tmcl::Instruction> program{instruction(tmcl::Command::get_axis_parameter, 1, 0),
                                               instruction(tmcl::Command::compare, 0, 1'000'000),
                                               instruction(tmcl::Command::jump_always, 0, 0)};
  std::vector<std::unique_ptr<Tmcm142>> modules;
  for (std::size_t i = 0; i < kModules; ++i) {
    modules.push_back(std::make_unique<Tmcm142>(Tmcm142Configuration{}));
    if (work != Work::at_rest) {
      static_cast<void>(modules.back()->tmcl().execute(
          instruction(tmcl::Command::rotate_right, 0, 40'000'000 + static_cast<int>(i) * 100'000),
          tmcl::Origin::serial, {}));
    }
    if (work == Work::turning_with_program) {
      modules.back()->tmcl().load_program(program);
      modules.back()->tmcl().start_program({});
    }
  }
  base::SimTime now;
  const auto advance = [&](base::SimDuration duration) {
    for (const base::SimTime end = now + duration; now < end;) {
      now += 1_ms;
      for (const auto& module : modules) {
        module->advance(now);
      }
    }
  };
  advance(1_s);
  double best = 0.0;
  for (auto _ : bench) {
    const auto begin = std::chrono::steady_clock::now();
    advance(10_ms);
    best = std::max(best, 10e-3 / seconds_since(begin));
  }
  bench.counters["real_time_factor"] = best;
  bench.counters["ns_per_period"] = 1e9 * 100e-6 / best / static_cast<double>(kModules);
}

void Tmcm142_HundredAtRest(benchmark::State& bench) {
  run_hundred_modules(bench, Work::at_rest);
}
BENCHMARK(Tmcm142_HundredAtRest);

void Tmcm142_HundredTurning(benchmark::State& bench) {
  run_hundred_modules(bench, Work::turning);
}
BENCHMARK(Tmcm142_HundredTurning);

void Tmcm142_HundredTurningWithPrograms(benchmark::State& bench) {
  run_hundred_modules(bench, Work::turning_with_program);
}
BENCHMARK(Tmcm142_HundredTurningWithPrograms);

/// One telegram at a time.
class Cable final : public tmcl::SerialPort {
 public:
  std::size_t take(std::span<std::byte> buffer) override {
    const std::size_t count = std::min(buffer.size(), waiting_);
    std::copy_n(request_.begin() + static_cast<std::ptrdiff_t>(request_.size() - waiting_), count,
                buffer.begin());
    waiting_ -= count;
    return count;
  }
  void send(std::span<const std::byte> bytes, base::SimTime /*now*/) override {
    answered_ += bytes.size();
  }
  void write(const tmcl::Telegram& telegram) {
    request_ = telegram;
    waiting_ = telegram.size();
  }
  [[nodiscard]] std::size_t answered() const { return answered_; }

 private:
  tmcl::Telegram request_{};
  std::size_t waiting_ = 0;
  std::size_t answered_ = 0;
};

void Tmcm142_GetParameterTelegram(benchmark::State& bench) {
  Tmcm142 module({});
  Cable cable;
  static_cast<void>(module.connect_serial("usb", &cable));
  const tmcl::Telegram request = tmcl::encode(tmcl::Request{
      .command = static_cast<std::uint8_t>(tmcl::Command::get_axis_parameter), .type = 1});
  for (auto _ : bench) {
    cable.write(request);
    module.handle_serial({});
  }
  if (cable.answered() != static_cast<std::size_t>(bench.iterations()) * request.size()) {
    bench.SkipWithError("not every telegram was answered");
  }
  bench.SetItemsProcessed(bench.iterations());
  bench.counters["of_limit"] = benchmark::Counter(static_cast<double>(bench.iterations()) / 50'000,
                                                  benchmark::Counter::kIsRate);
}
BENCHMARK(Tmcm142_GetParameterTelegram);

}  // namespace
