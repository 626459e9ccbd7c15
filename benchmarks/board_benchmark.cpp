#include <array>
#include <cstddef>
#include <cstdint>

#include <benchmark/benchmark.h>

#include "stator/board/assembly/block_pins.hpp"
#include "stator/board/assembly/board.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"
#include "stator/mfc/block/block.hpp"
#include "stator/mfc/registers/register_numbers.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;
using namespace stator::mfc::register_number;
using board::PeripheralConfiguration;
using mfc::Signal;

// The I/O block of a TMC8461 with everything connected: three step motors, one of them with the
// encoder; a three-phase motor and half an H-bridge on PWM; an SPI ADC behind the converter's
// filter; an I2C sensor.
constexpr std::array<Signal, 24> kCrossbar{
    Signal::sck, Signal::sdo, Signal::sdi, Signal::cs0,  Signal::scl, Signal::sda,
    Signal::a,   Signal::b,   Signal::n,   Signal::s0,   Signal::d0,  Signal::s1,
    Signal::d1,  Signal::s2,  Signal::d2,  Signal::dac0, Signal::hs0, Signal::ls0,
    Signal::hs1, Signal::ls1, Signal::hs2, Signal::ls2,  Signal::hs3, Signal::ls3};

PeripheralConfiguration part(
    const char* name, const board::PeripheralType& type,
    std::initializer_list<std::pair<const char*, unsigned>> pins,
    std::initializer_list<std::pair<const char*, double>> numbers = {},
    std::initializer_list<std::pair<const char*, const char*>> connections = {}) {
  PeripheralConfiguration result(name, type);
  for (const auto& [pin, line] : pins) {
    result.wire(pin, line);
  }
  for (const auto& [parameter, value] : numbers) {
    result.settings.set(parameter, value);
  }
  for (const auto& [connection, other] : connections) {
    result.connect(connection, other);
  }
  return result;
}

board::BoardConfiguration everything() {
  using namespace board;
  return {
      {part("x", kStepDirMotor, {{"step", 9}, {"dir", 10}}),
       part("y", kStepDirMotor, {{"step", 11}, {"dir", 12}}),
       part("z", kStepDirMotor, {{"step", 13}, {"dir", 14}}),
       // 50,000 steps of 1/256 are 0.98 rev/s: 100,000 edges.
       part("encoder", kEncoder, {{"a", 6}, {"b", 7}, {"n", 8}},
            {{"counts_per_revolution", 102'400}}, {{"shaft", "x"}}),
       part("spindle", kThreePhaseMotor,
            {{"u_high", 16},
             {"u_low", 17},
             {"v_high", 18},
             {"v_low", 19},
             {"w_high", 20},
             {"w_low", 21}}),
       part("fan", kBridgeMotor, {{"a_high", 22}, {"a_low", 23}, {"b_high", 20}, {"b_low", 21}}),
       part("filter", kRcFilter, {{"line", 15}}),
       part("adc", kSpiAdc, {{"sck", 0}, {"mosi", 1}, {"miso", 2}, {"cs", 3}}, {},
            {{"channel0", "filter"}}),
       part("sensor", kI2cTemperatureSensor, {{"scl", 4}, {"sda", 5}})}};
}

struct Bench {
  mfc::Block block;
  board::BlockPins pins{block};
  board::Board board;

  Bench() : board((connect(), everything()), pins, base::SimTime()) {}

  void connect() {
    std::array<std::byte, mfc::Configuration::kLength> parameters{};
    for (std::size_t line = 0; line < kCrossbar.size(); ++line) {
      parameters[line] = static_cast<std::byte>(kCrossbar[line]);
    }
    block.load_configuration(parameters);
    block.set_emergency_pin(true);
    block.set_al_state(mfc::Block::kOperational);
  }
  void set(unsigned number, std::uint64_t value) {
    std::array<std::byte, 8> bytes{};
    for (std::size_t k = 0; k < bytes.size(); ++k) {
      bytes[k] = static_cast<std::byte>(value >> (8 * k));
    }
    block.write(static_cast<std::uint16_t>(number << 4U), bytes);
  }
  std::uint64_t get(unsigned number) {
    std::array<std::byte, 4> bytes{};
    block.read(static_cast<std::uint16_t>(number << 4U), bytes);
    return std::to_integer<std::uint64_t>(bytes[0]);
  }

  void start_all() {
    set(kSdSteplength, 24 | 24ULL << 16U | 24ULL << 32U);
    set(kSdCfg, 0x030303);
    for (const unsigned channel : {kSdCh0Steprate, kSdCh1Steprate, kSdCh2Steprate}) {
      set(channel, 8'589'935);  // 50 kHz
    }
    set(kPwmCfg, 999U | 0x77770000U | 20ULL << 48U | 20ULL << 56U);  // 100 kHz
    set(kSpiTime, 0);
    set(kSpiLength, 23);
    set(kSpiConf, 1U << 8U);  // one transfer at each zero of the PWM counter
    set(kSpiTxData, 0x060000);
    set(kI2cTimebase, 1);
  }
  /// What a master does each millisecond: new duties, a new voltage.
  void command(unsigned k) {
    for (unsigned channel = 0; channel < 4; ++channel) {
      set(kPwm1 + channel, 300 + (k * 37 + channel * 250) % 400);
    }
    set(kDacVal, (k * 641) & 0xFFFFU);
  }
  /// Keeps the I2C bus busy: the next command as soon as the last is done.
  void next_i2c(unsigned& state) {
    constexpr std::array<std::uint8_t, 6> kCommands{0x20, 0x08, 0x02, 0x01, 0x10, 0x00};
    if (kCommands[state] == 0x20) {
      set(kI2cAddress, 0x91);
    }
    set(kI2cControl, kCommands[state]);
    state = (state + 1) % 5;
  }
};

/// Everything at once; the counter says how many times faster than real time it runs on one core.
/// Limit: 20.
void BoardWithAllUnitsBusy(benchmark::State& state) {
  Bench bench;
  bench.start_all();
  unsigned millisecond = 0;
  unsigned i2c = 0;
  for (auto _ : state) {
    bench.command(millisecond++);
    // A command of the I2C master takes 9 us at most.
    for (int k = 0; k < 100; ++k) {
      bench.next_i2c(i2c);
      bench.board.advance(bench.board.time() + 10_us);
    }
  }
  state.counters["times_real_time"] = benchmark::Counter(
      1e-3 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  for (const base::Signal& signal : bench.board.signals()) {
    if (signal.name == "encoder.count" || signal.name == "x.steps" ||
        signal.name == "x.lost_steps") {
      state.counters[signal.name] =
          signal.read() / (1e-3 * static_cast<double>(state.iterations()));
    }
  }
}
BENCHMARK(BoardWithAllUnitsBusy)->Unit(benchmark::kMillisecond);

/// The same board in which nothing moves; one second.
void IdleSecond(benchmark::State& state) {
  Bench bench;
  bench.board.advance(base::SimTime(10'000_ms));
  for (auto _ : state) {
    bench.board.advance(bench.board.time() + 1'000_ms);
  }
}
BENCHMARK(IdleSecond);

}  // namespace
