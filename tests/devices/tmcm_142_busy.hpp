// A TMCM-142 on USB and RS232 whose memory is ready when the test says so.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "stator/can/frame.hpp"
#include "stator/devices/tmcm_142/eeprom.hpp"
#include "tmcm_142_memory.hpp"
#include "tmcm_142_module.hpp"

namespace stator::tests {

inline std::uint8_t number(tmcl::Command command) {
  return static_cast<std::uint8_t>(command);
}

/// A module with a memory that is ready when the test says so.
struct Tmcm142Busy : testing::Test {
  static constexpr base::SimDuration kDiskTime{1'000'000};

  Tmcm142Busy() {
    module.device->connect_memory(memory);
    EXPECT_TRUE(module.device->connect_serial("usb", &usb));
    EXPECT_TRUE(module.device->connect_serial("rs232", &rs232));
  }

  void send(SerialCable& cable, const tmcl::Request& request) {
    cable.write(tmcl::encode(request));
    module.device->handle_serial(module.now);
  }
  void send(tmcl::Command command, int type, int motor, std::int32_t value = 0) {
    send(usb, request(command, type, motor, value));
  }
  static tmcl::Request request(tmcl::Command command, int type, int motor, std::int32_t value = 0) {
    return {.command = number(command),
            .type = static_cast<std::uint8_t>(type),
            .motor = static_cast<std::uint8_t>(motor),
            .value = value};
  }
  static std::vector<tmcl::Reply> replies(SerialCable& cable) {
    const std::vector<std::byte> bytes = cable.read();
    std::vector<tmcl::Reply> all;
    for (std::size_t i = 0; i + tmcl::kTelegramLength <= bytes.size(); i += 9) {
      tmcl::Telegram telegram{};
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(i), telegram.size(),
                  telegram.begin());
      all.push_back(tmcl::decode_reply(telegram));
    }
    return all;
  }
  std::optional<tmcl::Reply> reply() {
    const std::vector<tmcl::Reply> all = replies(usb);
    EXPECT_LE(all.size(), 1U);
    return all.empty() ? std::nullopt : std::optional(all.back());
  }
  std::optional<can::Frame> sent() {
    const can::Frame* pending = module.device->controller().pending();
    if (pending == nullptr) {
      return std::nullopt;
    }
    const can::Frame frame = *pending;
    module.device->controller().transmitted(frame);
    return frame;
  }
  void send_frame(std::initializer_list<unsigned> data) {
    module.device->controller().deliver(can::data_frame(1, data));
    module.device->handle_bus_events(module.now);
  }
  /// The disk is ready kDiskTime later, which is before the EEPROM is; then that is.
  void write(bool kept = true) {
    module.run(kDiskTime);
    memory.finish(kept);
    module.run(devices::tmcm_142::Eeprom::kWriteTime - kDiskTime);
  }
  /// A command that writes, and its status.
  std::optional<tmcl::Status> written(tmcl::Command command, int type, int motor,
                                      std::int32_t value = 0, bool kept = true) {
    send(command, type, motor, value);
    EXPECT_FALSE(reply()) << "before it is kept";
    write(kept);
    const std::optional<tmcl::Reply> last = reply();
    return last ? std::optional(last->status) : std::nullopt;
  }
  /// What another module finds in the same memory.
  std::int32_t kept_global(int parameter, int bank = 0) const {
    ModuleMemory copy;
    copy.images = memory.images;
    Tmcm142Module other;
    other.device->connect_memory(copy);
    return other.ggp(parameter, bank);
  }

  ModuleMemory memory{ModuleMemory::Answer::later};
  Tmcm142Module module;
  SerialCable usb;
  SerialCable rs232;
};

}  // namespace stator::tests
