#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ethercat/hex.hpp"
#include "ethercat/raw_frame.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/segment/segment.hpp"

namespace stator::tests {

using ethercat::Command;
using ethercat::test::hex;
using ethercat::test::part;
using ethercat::test::to_hex;
using ethercat::testing::Answer;
using ethercat::testing::Bytes;
using ethercat::testing::bytes;
using ethercat::testing::little_endian;
using ethercat::testing::number;
using ethercat::testing::zeros;
using namespace base::literals;

/// Complete devices in line, treated as a rack treats them: brought to the moment at which a frame
/// arrives, then the frame, then their firmware takes what it brought. The master sends datagrams
/// one by one or several in a frame; frames are 20 us apart, as on a fast machine.
class DeviceBus {
 public:
  static constexpr base::SimDuration kFrameInterval{20'000};

  explicit DeviceBus(std::size_t devices = 1) {
    for (std::size_t i = 0; i < devices; ++i) {
      add_device({});
    }
  }

  devices::Tmcm3315& add_device(const devices::Tmcm3315Configuration& configuration) {
    devices_.push_back(std::make_unique<devices::Tmcm3315>(configuration));
    segment_.append(devices_.back()->controller());
    return *devices_.back();
  }
  /// A device of any kind, the first one at the master, others at the port of a slave by index in
  /// the order in which they were added. Of those `device()` knows nothing.
  void hang(std::unique_ptr<product::EtherCatDevice> device,
            std::optional<ethercat::SlavePort> at = std::nullopt,
            base::SimDuration cable_delay = ethercat::kDefaultCableDelay);
  /// A slave without firmware at the end of the line: a coupler without clock, a clock that is off.
  ethercat::SlaveController& add_controller(
      const ethercat::SlaveControllerConfiguration& configuration);

  [[nodiscard]] std::size_t size() const { return segment_.size(); }
  [[nodiscard]] devices::Tmcm3315& device(std::size_t position = 0) { return *devices_[position]; }
  [[nodiscard]] ethercat::Segment& segment() { return segment_; }
  [[nodiscard]] base::SimTime now() const { return now_; }

  void pass(base::SimDuration duration);
  /// Whether firmware runs; a device whose firmware hangs keeps a controller that answers.
  void set_firmware_running(bool running) { firmware_runs_ = running; }

  /// Adds a datagram to the next frame.
  DeviceBus& with(Command command, std::uint32_t address, const Bytes& data) {
    frame_.append(command, address, data);
    return *this;
  }
  /// Sends what was queued as one frame.
  std::vector<Answer> send();
  /// Sends a frame made elsewhere, changed in place; true if it comes back.
  bool send_raw(std::span<std::byte> frame);

  // One datagram in a frame of its own.
  Answer transfer(Command command, std::uint32_t address, const Bytes& data) {
    return with(command, address, data).send().front();
  }
  Answer aprd(std::size_t position, std::uint16_t address, std::size_t length) {
    return transfer(Command::aprd, at_position(position, address), zeros(length));
  }
  Answer apwr(std::size_t position, std::uint16_t address, const Bytes& data) {
    return transfer(Command::apwr, at_position(position, address), data);
  }
  Answer fprd(std::uint16_t station, std::uint16_t address, std::size_t length) {
    return transfer(Command::fprd, ethercat::physical_address(station, address), zeros(length));
  }
  Answer fpwr(std::uint16_t station, std::uint16_t address, const Bytes& data) {
    return transfer(Command::fpwr, ethercat::physical_address(station, address), data);
  }
  Answer brd(std::uint16_t address, std::size_t length) {
    return transfer(Command::brd, ethercat::physical_address(0, address), zeros(length));
  }
  Answer bwr(std::uint16_t address, const Bytes& data) {
    return transfer(Command::bwr, ethercat::physical_address(0, address), data);
  }
  Answer frmw(std::uint16_t station, std::uint16_t address, std::size_t length) {
    return transfer(Command::frmw, ethercat::physical_address(station, address), zeros(length));
  }
  Answer armw(std::size_t position, std::uint16_t address, std::size_t length) {
    return transfer(Command::armw, at_position(position, address), zeros(length));
  }
  Answer lrw(std::uint32_t logical, const Bytes& data) {
    return transfer(Command::lrw, logical, data);
  }

  static std::uint32_t at_position(std::size_t position, std::uint16_t address) {
    return ethercat::physical_address(
        ethercat::auto_increment_address(static_cast<std::uint16_t>(position)), address);
  }

 private:
  bool process(std::span<std::byte> frame);

  std::vector<std::unique_ptr<devices::Tmcm3315>> devices_;
  std::vector<std::unique_ptr<product::EtherCatDevice>> others_;
  std::vector<std::unique_ptr<ethercat::SlaveController>> controllers_;
  ethercat::Segment segment_;
  base::SimTime now_;
  bool firmware_runs_ = true;
  ethercat::testing::RawFrame frame_;
};

/// The 16 registers of an FMMU that maps whole bytes; `type` 1 reads, 2 writes.
Bytes fmmu(std::uint32_t logical, std::uint16_t length, std::uint16_t physical, std::uint8_t type);
/// The 8 registers of an enabled sync manager.
Bytes sync_manager(std::uint16_t start, std::uint16_t length, std::uint8_t control);

}  // namespace stator::tests
