#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "ethercat/raw_frame.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/ethercat/units/sii_interface.hpp"

namespace stator::ethercat::testing {

/// A 2048-byte SII image with a valid configuration area; word n above 8 holds n.
inline Bytes valid_sii(std::uint16_t alias = 0) {
  Bytes image(2048);
  image[0] = std::byte{0x05};
  base::store_le(image.data() + 8, alias);
  image[14] = std::byte{sii_checksum(image)};
  for (std::size_t word = 8; word < 1024; ++word) {
    base::store_le(image.data() + 2 * word, static_cast<std::uint16_t>(word));
  }
  return image;
}

/// Slaves in line and a master that sends raw frames, 10 us apart.
class TestBus {
 public:
  explicit TestBus(std::size_t slaves = 1, const SlaveControllerConfiguration& configuration = {}) {
    for (std::size_t i = 0; i < slaves; ++i) {
      add(configuration);
    }
  }

  SlaveController& add(const SlaveControllerConfiguration& configuration,
                       base::SimDuration cable_delay = base::SimDuration(10)) {
    slaves_.push_back(std::make_unique<SlaveController>(configuration));
    slaves_.back()->load_sii(valid_sii());
    segment_.append(*slaves_.back(), cable_delay);
    return *slaves_.back();
  }

  /// Adds a slave without any cable; its index.
  std::size_t add_unconnected(const SlaveControllerConfiguration& configuration = {}) {
    slaves_.push_back(std::make_unique<SlaveController>(configuration));
    slaves_.back()->load_sii(valid_sii());
    return segment_.add(*slaves_.back());
  }
  /// The master sends from `interface` from now on.
  TestBus& from(MasterInterface interface) {
    interface_ = interface;
    return *this;
  }
  /// Where the last frame came out.
  std::optional<MasterInterface> exit() const { return exit_; }

  SlaveController& slave(std::size_t position = 0) { return *slaves_[position]; }
  Segment& segment() { return segment_; }
  base::SimTime now() const { return now_; }
  void wait(base::SimDuration duration) {
    now_ += duration;
    segment_.advance(now_);
  }

  /// Adds a datagram to the next frame.
  TestBus& with(Command command, std::uint32_t address, const Bytes& data) {
    frame_.append(command, address, data);
    return *this;
  }
  /// Sends what was queued.
  std::vector<Answer> send() {
    now_ += base::SimDuration(10'000);
    exit_ = segment_.process(frame_.finish(), now_, interface_);
    return frame_.take_answers(exit_.has_value());
  }
  /// One datagram in a frame of its own.
  Answer transfer(Command command, std::uint32_t address, const Bytes& data) {
    return with(command, address, data).send().front();
  }

  Answer read(std::uint16_t position, std::uint16_t address, std::size_t length) {
    return transfer(Command::aprd, physical_address(auto_increment_address(position), address),
                    zeros(length));
  }
  Answer write(std::uint16_t position, std::uint16_t address, const Bytes& data) {
    return transfer(Command::apwr, physical_address(auto_increment_address(position), address),
                    data);
  }
  Answer broadcast_read(std::uint16_t address, std::size_t length) {
    return transfer(Command::brd, physical_address(0, address), zeros(length));
  }
  Answer broadcast_write(std::uint16_t address, const Bytes& data) {
    return transfer(Command::bwr, physical_address(0, address), data);
  }

  struct SyncManagerSetting {
    std::uint16_t start;
    std::uint16_t length;
    std::uint8_t control;
    std::uint8_t activate = 1;
  };
  void set_sync_manager(std::uint16_t position, unsigned channel,
                        const SyncManagerSetting& setting) {
    Bytes registers(8);
    base::store_le(registers.data(), setting.start);
    base::store_le(registers.data() + 2, setting.length);
    registers[4] = std::byte{setting.control};
    registers[6] = std::byte{setting.activate};
    write(position, static_cast<std::uint16_t>(0x0806 + 8 * channel), bytes({0}));
    write(position, static_cast<std::uint16_t>(0x0800 + 8 * channel), registers);
  }

  struct FmmuSetting {
    std::uint32_t logical;
    std::uint16_t length;
    std::uint16_t physical;
    std::uint8_t type;  ///< 1 read, 2 write
    std::uint8_t logical_start_bit = 0;
    std::uint8_t logical_stop_bit = 7;
    std::uint8_t physical_start_bit = 0;
  };
  void set_fmmu(std::uint16_t position, unsigned unit, const FmmuSetting& setting) {
    Bytes registers(16);
    base::store_le(registers.data(), setting.logical);
    base::store_le(registers.data() + 4, setting.length);
    registers[6] = std::byte{setting.logical_start_bit};
    registers[7] = std::byte{setting.logical_stop_bit};
    base::store_le(registers.data() + 8, setting.physical);
    registers[10] = std::byte{setting.physical_start_bit};
    registers[11] = std::byte{setting.type};
    registers[12] = std::byte{1};
    write(position, static_cast<std::uint16_t>(0x0600 + 16 * unit), registers);
  }

 private:
  std::vector<std::unique_ptr<SlaveController>> slaves_;
  Segment segment_;
  base::SimTime now_;
  MasterInterface interface_ = MasterInterface::primary;
  std::optional<MasterInterface> exit_;
  RawFrame frame_;
};

/// Host-side access in the manner of firmware.
inline Bytes host_read(SlaveController& slave, std::uint16_t address, std::size_t length) {
  Bytes data(length);
  slave.read(address, data);
  return data;
}
inline void host_write(SlaveController& slave, std::uint16_t address, const Bytes& data) {
  slave.write(address, data);
}

}  // namespace stator::ethercat::testing
