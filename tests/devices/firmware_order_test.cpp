// Who is first at one instant: SYNC0, the firmware's period, a step of the world, a frame. The
// order decides bits, so what devices did when these tests were written is kept as sums.

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "devices/sentences.hpp"
#include "devices/test_bus.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "tmcl/serial_line.hpp"

namespace stator::devices {
namespace {

using namespace base::literals;
using ethercat::AlState;

/// FNV-1a over all that can be seen of a device.
class Sum {
 public:
  void add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) {
      sum_ = (sum_ ^ (value >> 8 * byte & 0xFF)) * 0x100000001B3U;
    }
  }
  void add(std::string_view text) {
    for (const char c : text) {
      add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
    }
  }
  [[nodiscard]] std::uint64_t value() const { return sum_; }

 private:
  std::uint64_t sum_ = 0xCBF29CE484222325U;
};

struct Case {
  std::string_view product;
  std::string_view serial;
  std::uint8_t output_length;
  std::uint8_t input_length;
  std::vector<std::uint32_t> cycles;  ///< of SYNC0, ns
  std::uint64_t sum;
};

/// One device that a seeded master synchronises by SYNC0 on, before and behind the grid of its
/// periods, and that people switch off, load with firmware and let alone in between.
class Life {
 public:
  Life(const Case& which, std::uint64_t seed)
      : case_(which),
        random_(seed),
        device_(products().find(which.product)->defaults().make(base::EventReporter(&told_, 0))),
        bus_(ethercat()) {
    EXPECT_TRUE(device_->connect_serial(which.serial, &line_));
    bus_.set_output_length(which.output_length);
    bus_.set_input_length(which.input_length);
    signals_ = device_->signals();
  }

  std::uint64_t live() {
    for (int turn = 0; turn < 3; ++turn) {
      synchronise();
      for (int step = 0; step < 100; ++step) {
        exchange();
        bus_.pass(some_time());
        look();
      }
      leave();
    }
    for (const std::string& sentence : told_.all) {
      sum_.add(sentence);
    }
    return sum_.value();
  }

 private:
  [[nodiscard]] product::EtherCatDevice& ethercat() const {
    return dynamic_cast<product::EtherCatDevice&>(*device_);
  }
  std::uint64_t below(std::uint64_t limit) { return random_() % limit; }
  /// Times that end on, just before and just behind multiples of 50 us, or anywhere.
  base::SimDuration some_time() {
    constexpr std::int64_t kGrid = 50'000;
    if (below(4) == 0) {
      return base::SimDuration(static_cast<std::int64_t>(1 + below(900'000)));
    }
    const std::int64_t now = bus_.now().nanoseconds();
    const std::int64_t end = (now / kGrid + 1 + static_cast<std::int64_t>(below(20))) * kGrid;
    return base::SimDuration(end + static_cast<std::int64_t>(below(3)) - 1 - now);
  }
  static tests::TestBus::Bytes bytes(std::uint64_t value, std::size_t length) {
    tests::TestBus::Bytes result(8);
    base::store_le(result, 0, value);
    result.resize(length);
    return result;
  }

  /// Operational with a SYNC0 that lies on a millisecond, 1 ns before it or 1 ns behind it.
  void synchronise() {
    bus_.bring_to(AlState::pre_operational);
    bus_.write(0x0420, bytes(0, 2));
    const std::int64_t now = bus_.now().nanoseconds();
    const std::int64_t first =
        (now / 1'000'000 + 3) * 1'000'000 + static_cast<std::int64_t>(below(3)) - 1;
    const std::uint64_t system = ethercat().controller().system_time(bus_.now());
    bus_.write(0x0990, bytes(system + static_cast<std::uint64_t>(first - now), 8));
    bus_.write(0x09A0, bytes(case_.cycles[below(case_.cycles.size())], 4));
    const bool synchronous = below(4) != 0;
    bus_.write(0x0980, bytes(synchronous ? 0x0300 : 0, 2));
    bus_.bring_to(AlState::safe_operational);
    bus_.pass(4_ms);
    bus_.exchange();
    sum_.add(bus_.request(AlState::operational));
  }

  void exchange() {
    constexpr std::array<std::uint16_t, 6> kControlwords{6, 7, 15, 15, 31, 128};
    base::store_le(bus_.outputs, 0, kControlwords[below(kControlwords.size())]);
    for (std::size_t at = 2; at + 4 <= case_.output_length; at += 4) {
      base::store_le(bus_.outputs, at, static_cast<std::int32_t>(below(2'000)));
    }
    bus_.exchange();
    for (const std::byte byte : bus_.inputs) {
      sum_.add(std::to_integer<std::uint64_t>(byte));
    }
  }

  void look() {
    sum_.add(static_cast<std::uint64_t>(bus_.now().nanoseconds()));
    for (const product::Signal& signal : signals_) {
      sum_.add(std::bit_cast<std::uint64_t>(signal.read()));
    }
    for (const std::byte byte : bus_.read(0x0130, 6)) {
      sum_.add(std::to_integer<std::uint64_t>(byte));
    }
    for (const std::byte byte : line_.read()) {
      sum_.add(std::to_integer<std::uint64_t>(byte));
    }
  }

  /// Power fails, the boot loader is called and left, or the master goes to Init.
  void leave() {
    switch (below(3)) {
      case 0:
        device_->set_power(false, bus_.now());
        bus_.pass(some_time());
        device_->set_power(true, bus_.now());
        break;
      case 1:
        line_.put(encode(tmcl::Request{.command = 242,
                                       .type = 0x81,
                                       .motor = 0x92,
                                       .value = static_cast<std::int32_t>(0xA3B4C5D6)}));
        bus_.pass(some_time() + 2_ms);
        line_.put(encode(tmcl::Request{.command = 136}));
        bus_.pass(some_time() + 2_ms);
        line_.put(encode(tmcl::Request{.command = 205}));
        bus_.pass(some_time() + 2_ms);
        break;
      default:
        break;
    }
    bus_.write(0x0980, bytes(0, 2));
    sum_.add(bus_.request(AlState::init));
    look();
  }

  const Case& case_;
  std::mt19937_64 random_;
  tests::Sentences told_;
  std::unique_ptr<product::Device> device_;
  tests::TestBus bus_;
  tests::SerialLine line_;
  std::vector<product::Signal> signals_;
  Sum sum_;
};

class FirmwareOrder : public testing::TestWithParam<Case> {};

TEST_P(FirmwareOrder, IsWhatItWas) {
  constexpr std::uint64_t kLives = 60;
  Sum sum;
  for (std::uint64_t seed = 0; seed < kLives; ++seed) {
    sum.add(Life(GetParam(), seed).live());
  }
  EXPECT_EQ(sum.value(), GetParam().sum) << std::hex << "0x" << sum.value();
}

INSTANTIATE_TEST_SUITE_P(OfProducts, FirmwareOrder,
                         testing::Values(Case{"tmcm-3315",
                                              "usb",
                                              30,
                                              30,
                                              {125'000, 250'000, 1'000'000, 2'000'000},
                                              0x8F5E68197DF363E0},
                                         Case{"tmc8670",
                                              "mcu-uart",
                                              13,
                                              15,
                                              {250'000, 500'000, 1'000'000, 2'000'000},
                                              0x097F2C9DFDA4BFF0}),
                         [](const auto& each) {
                           return each.param.product == "tmc8670" ? "Tmc8670" : "Tmcm3315";
                         });

}  // namespace
}  // namespace stator::devices
