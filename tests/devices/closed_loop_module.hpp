#pragma once

#include <array>
#include <cstdint>

#include "devices/tmcm_3315_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {

/// One row of the document's closed-loop example settings (Table 2, L115-L136).
struct ExampleSetting {
  std::uint16_t index;
  std::uint8_t subindex;
  std::uint8_t size;
  std::uint32_t value;
};
inline constexpr std::array kClosedLoopExample{
    ExampleSetting{0x2003, 0, 1, 85},      ExampleSetting{0x2004, 0, 1, 10},
    ExampleSetting{0x606A, 0, 2, 0},       ExampleSetting{0x608F, 1, 4, 10'000},
    ExampleSetting{0x2034, 0, 4, 300'000}, ExampleSetting{0x2035, 0, 4, 1'600'000},
    ExampleSetting{0x2036, 0, 1, 255},     ExampleSetting{0x2027, 0, 2, 255},
    ExampleSetting{0x2029, 0, 1, 50},      ExampleSetting{0x202A, 0, 1, 255},
    ExampleSetting{0x2022, 0, 1, 255},     ExampleSetting{0x2030, 0, 4, 1000},
    ExampleSetting{0x2031, 0, 4, 10'000},  ExampleSetting{0x202B, 0, 4, 3000},
    ExampleSetting{0x202C, 0, 4, 20},      ExampleSetting{0x202D, 0, 2, 2000},
    ExampleSetting{0x202E, 0, 2, 0},       ExampleSetting{0x202F, 0, 4, 100'000},
    ExampleSetting{0x2021, 0, 4, 65'536},
};

/// A module whose first axis has the encoder of the example's table: 10000 counts a revolution.
class ClosedLoopModule : public Tmcm3315Module {
 protected:
  static Tmcm3315Configuration with_encoder(std::int64_t counts = 10'000) {
    Tmcm3315Configuration configuration;
    configuration.axes[0].encoder.counts_per_revolution = counts;
    return configuration;
  }
  explicit ClosedLoopModule(const Tmcm3315Configuration& configuration = with_encoder())
      : Tmcm3315Module(configuration) {}

  void write_example() {
    for (const ExampleSetting& setting : kClosedLoopExample) {
      switch (setting.size) {
        case 1:
          write(setting.index, static_cast<std::uint8_t>(setting.value), setting.subindex);
          break;
        case 2:
          write(setting.index, static_cast<std::uint16_t>(setting.value), setting.subindex);
          break;
        default:
          write(setting.index, setting.value, setting.subindex);
      }
    }
  }
  /// The example as the document tells it: settings, Operation enabled in `mode`, 2020h = 1, and
  /// 2120h polled.
  void start_closed_loop(std::int8_t mode = 1) {
    write_example();
    enable(0, mode);
    write<std::uint8_t>(0x2020, 1);
    await_initialisation();
  }
  void await_initialisation() {
    for (int poll = 0; poll < 500 && !initialised(); ++poll) {
      bus_->pass(2_ms);
    }
    ASSERT_TRUE(initialised());
  }
  bool initialised() { return bus_->upload<std::uint8_t>(0x2120) == 1; }
  plant::StepperAxis& plant() { return device_->axis(0).plant(); }
  void load(double torque) { plant().set_external_torque(torque); }
};

}  // namespace stator::devices
