#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "masters/device_bus.hpp"

namespace stator::tests {

/// The datagrams of SOEM in its order, lengths and grouping (one datagram per frame up to the
/// cyclic exchange), each with the checks that SOEM makes. Positions count from 0.
class Soem {
 public:
  static constexpr unsigned kInit = 0x01;
  static constexpr unsigned kPreOperational = 0x02;
  static constexpr unsigned kSafeOperational = 0x04;
  static constexpr unsigned kOperational = 0x08;

  explicit Soem(DeviceBus& bus) : bus_(bus) {}

  static std::uint16_t station(std::size_t position) {
    return static_cast<std::uint16_t>(0x1001 + position);
  }
  static constexpr std::uint16_t kReceiveMailbox = 0x1000;
  static constexpr std::uint16_t kTransmitMailbox = 0x1200;
  static constexpr std::uint16_t kMailboxLength = 512;
  static constexpr std::uint16_t kOutputs = 0x1800;
  static constexpr std::uint16_t kInputs = 0x1C00;
  static constexpr std::uint16_t kProcessData = 30;

  // Scan. The whole of it is config_init(): all slaves found, addressed and in Pre-Operational.
  unsigned count_slaves();
  void set_defaults();
  void set_addresses();
  void to_pre_operational();
  void config_init();

  /// Starts a read of one EEPROM double word; the error bits of before are cleared.
  void start_sii_read(std::size_t position, std::uint16_t word);
  /// Polls for the end of it, at most 20 ms, and fetches four bytes.
  std::uint32_t finish_sii_read(std::size_t position);
  std::uint32_t read_sii(std::size_t position, std::uint16_t word) {
    start_sii_read(position, word);
    return finish_sii_read(position);
  }
  /// Writes one word in the manner of eepromtool, then waits until it is done.
  void write_sii(std::size_t position, std::uint16_t word, std::uint16_t value);

  void request(std::size_t position, unsigned al_control);
  /// AL status once all slaves agree in it, ORed; polls at most 2 s.
  unsigned wait_for_all(unsigned state);

  /// Map: sync managers 2 and 3 and three FMMUs per slave. All outputs lie first, then all inputs,
  /// then a mailbox status byte per slave.
  void config_map();
  [[nodiscard]] std::size_t image_length() const { return bus_.size() * (2 * kProcessData + 1); }
  [[nodiscard]] unsigned expected_working_counter() const {
    return static_cast<unsigned>(3 * bus_.size());
  }
  void to_operational();
  /// One LRW over the image and FRMW 0x0910 in the same frame.
  std::vector<Answer> exchange(const Bytes& image);

  // Distributed clocks.
  struct Clock {
    std::uint32_t port0 = 0;
    std::uint32_t port1 = 0;
    std::uint32_t delay = 0;
  };
  /// Receive times, offsets against `host_time` and delays of a line, written into the slaves.
  std::vector<Clock> config_dc(std::uint64_t host_time);

  // Mailbox.
  /// Empties the read mailbox, then writes the whole write mailbox. The working counter.
  unsigned send_mailbox(std::size_t position, const Bytes& message);
  [[nodiscard]] bool mailbox_full(std::size_t position);
  /// Polls at most 700 ms and fetches the whole read mailbox; empty if nothing came.
  Bytes receive_mailbox(std::size_t position);
  /// A mailbox message with the next counter.
  Bytes message(unsigned type, const Bytes& body);
  /// CoE with its two-byte header.
  Bytes coe(unsigned service, const Bytes& body);
  /// The SDO answer from its command byte on, emergencies put aside.
  Bytes sdo(std::size_t position, const Bytes& request);
  Bytes upload(std::size_t position, std::uint16_t index, std::uint8_t subindex,
               bool complete = false);
  std::uint32_t download(std::size_t position, std::uint16_t index, std::uint8_t subindex,
                         std::uint32_t value, std::size_t length);
  std::vector<Bytes> emergencies;

 private:
  DeviceBus& bus_;
  unsigned counter_ = 0;
};

/// The value in an SDO upload answer, whether expedited or with its data behind the header.
Bytes upload_value(const Bytes& answer);

}  // namespace stator::tests
