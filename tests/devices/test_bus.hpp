#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "stator/base/byte_order.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/abort_code.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/product/device/ethercat_device.hpp"

namespace stator::tests {

/// One device on a bus of its own and as much of a master as tests need: registers, state changes,
/// expedited SDOs, process data by physical address. Time moves only by pass() and, a little, with
/// each frame.
class TestBus {
 public:
  using Bytes = std::vector<std::byte>;
  using Emergency = std::array<std::uint8_t, 8>;

  explicit TestBus(product::EtherCatDevice& device) : device_(device) {
    segment_.append(device.controller());
  }

  [[nodiscard]] base::SimTime now() const { return now_; }

  void pass(base::SimDuration duration) {
    now_ += duration;
    device_.advance(now_);
  }
  /// Lets time pass and keeps the process data watchdog content, one exchange per millisecond.
  void pass_cyclically(base::SimDuration duration) {
    const base::SimTime end = now_ + duration;
    while (now_ < end) {
      exchange();
      pass(std::min(base::SimDuration(1'000'000), end - now_));
    }
  }

  Bytes read(std::uint16_t address, std::size_t length) {
    return transfer(ethercat::Command::aprd, address, Bytes(length));
  }
  /// A frame comes back, and the device has answered it.
  bool answers() {
    std::array<std::byte, ethercat::kMaximumFrameLength> buffer{};
    ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    builder.append(ethercat::Command::brd, 0, ethercat::physical_address(0, 0), Bytes(1));
    const auto frame = builder.finish();
    now_ += base::SimDuration(10'000);
    device_.advance(now_);
    const bool returned = segment_.process(frame, now_);
    device_.handle_bus_events(now_);
    return returned && ethercat::DatagramCursor(frame).next()->working_counter == 1;
  }
  /// False if the working counter stayed 0.
  bool write(std::uint16_t address, const Bytes& data) {
    transfer(ethercat::Command::apwr, address, data);
    return working_counter_ != 0;
  }

  /// AL status after requesting `state` and letting the device answer.
  std::uint16_t request(ethercat::AlState state) {
    write(0x0120, {std::byte{static_cast<std::uint8_t>(state)}, std::byte{0}});
    return base::load_le<std::uint16_t>(read(0x0130, 2));
  }
  /// Sync managers as the device's description says, then state by state up to `state`.
  void bring_to(ethercat::AlState state) {
    using enum ethercat::AlState;
    const ethercat::DeviceDescription& d = device_.description();
    configure(0, d.receive_mailbox.offset, d.receive_mailbox.length, 0x26);
    configure(1, d.transmit_mailbox.offset, d.transmit_mailbox.length, 0x22);
    EXPECT_EQ(request(pre_operational), static_cast<std::uint16_t>(pre_operational));
    if (state == pre_operational) {
      return;
    }
    configure(2, d.output_offset, output_length_, 0x64);
    configure(3, d.input_offset, input_length_, 0x20);
    EXPECT_EQ(request(safe_operational), static_cast<std::uint16_t>(safe_operational));
    if (state == safe_operational) {
      return;
    }
    exchange();
    EXPECT_EQ(request(operational), static_cast<std::uint16_t>(operational));
  }

  /// Sends `outputs` and reads `inputs`.
  void exchange() {
    write(device_.description().output_offset,
          Bytes(outputs.begin(), outputs.begin() + output_length_));
    const Bytes read_back = read(device_.description().input_offset, input_length_);
    std::ranges::copy(read_back, inputs.begin());
  }

  /// Expedited download; the abort code, or 0.
  template <typename T>
  std::uint32_t download(std::uint16_t index, std::uint8_t subindex, T value) {
    std::array<std::byte, 8> request{};
    request[0] = static_cast<std::byte>(0x23 | ((4 - sizeof(T)) << 2));
    base::store_le(request, 1, index);
    request[3] = std::byte{subindex};
    base::store_le(request, 4, value);
    const Bytes response = sdo(request);
    return response.at(0) == std::byte{0x80} ? base::load_le<std::uint32_t>(response, 4) : 0;
  }
  template <typename T>
  T upload(std::uint16_t index, std::uint8_t subindex = 0) {
    std::array<std::byte, 8> request{std::byte{0x40}};
    base::store_le(request, 1, index);
    request[3] = std::byte{subindex};
    const Bytes response = sdo(request);
    EXPECT_NE(response.at(0), std::byte{0x80}) << "upload of " << std::hex << index << " aborted";
    return base::load_le<T>(response, 4);
  }
  /// The eight bytes of an SDO request to the eight bytes of its response.
  Bytes sdo(std::span<const std::byte> request) {
    send_mailbox(request);
    for (int attempt = 0; attempt < 20; ++attempt) {
      if (const Bytes response = receive_mailbox(); !response.empty()) {
        return response;
      }
      pass(base::SimDuration(100'000));
    }
    ADD_FAILURE() << "no SDO response";
    return Bytes(8, std::byte{0x80});
  }

  /// Puts an SDO request into the mailbox.
  void send_mailbox(std::span<const std::byte> sdo_request) {
    const ethercat::MailboxArea area = device_.description().receive_mailbox;
    counter_ = static_cast<std::uint8_t>(counter_ % 7 + 1);
    Bytes mailbox(area.length);
    base::store_le(mailbox, 0, static_cast<std::uint16_t>(2 + sdo_request.size()));
    mailbox[5] = static_cast<std::byte>(0x03 | (counter_ << 4));
    base::store_le(mailbox, 6, static_cast<std::uint16_t>(0x2000));
    std::ranges::copy(sdo_request, mailbox.begin() + 8);
    EXPECT_TRUE(write(area.offset, mailbox));
  }

  /// The SDO part of a waiting response; empty if none waits. Emergencies are put aside.
  Bytes receive_mailbox() {
    const ethercat::MailboxArea area = device_.description().transmit_mailbox;
    while ((read(0x080D, 1)[0] & std::byte{0x08}) != std::byte{0}) {
      const Bytes mailbox = read(area.offset, area.length);
      const auto length = base::load_le<std::uint16_t>(mailbox, 0);
      const unsigned service = base::load_le<std::uint16_t>(mailbox, 6) >> 12U;
      if (service != 1) {
        return {mailbox.begin() + 8, mailbox.begin() + 6 + length};
      }
      Emergency emergency{};
      std::transform(mailbox.begin() + 8, mailbox.begin() + 16, emergency.begin(),
                     [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
      emergencies_.push_back(emergency);
    }
    return {};
  }

  /// Emergencies that have come since the last call.
  std::vector<Emergency> take_emergencies() {
    for (int idle = 0; idle < 3; ++idle) {
      receive_mailbox();
      pass(base::SimDuration(1'000'000));
    }
    return std::exchange(emergencies_, {});
  }

  /// Length of the outputs for a mapping of the test's own.
  void set_output_length(std::uint8_t length) { output_length_ = length; }

  void set_input_length(std::uint8_t length) { input_length_ = length; }

  static constexpr std::size_t kProcessData = 80;
  std::array<std::byte, kProcessData> outputs{};
  std::array<std::byte, kProcessData> inputs{};

 private:
  Bytes transfer(ethercat::Command command, std::uint16_t address, const Bytes& data) {
    std::array<std::byte, ethercat::kMaximumFrameLength> buffer{};
    ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    builder.append(command, 0, ethercat::physical_address(0, address), data);
    const auto frame = builder.finish();
    now_ += base::SimDuration(10'000);
    device_.advance(now_);
    EXPECT_TRUE(segment_.process(frame, now_));
    device_.handle_bus_events(now_);
    ethercat::DatagramCursor cursor(frame);
    const auto datagram = cursor.next();
    working_counter_ = datagram->working_counter;
    return {datagram->data, datagram->data + datagram->length};
  }

  void configure(unsigned channel, std::uint16_t start, std::size_t length, std::uint8_t control) {
    Bytes registers(8);
    base::store_le(registers, 0, start);
    base::store_le(registers, 2, static_cast<std::uint16_t>(length));
    registers[4] = std::byte{control};
    registers[6] = std::byte{1};
    EXPECT_TRUE(write(static_cast<std::uint16_t>(0x0800 + 8 * channel), registers));
  }

  product::EtherCatDevice& device_;
  ethercat::Segment segment_;
  base::SimTime now_;
  std::uint16_t working_counter_ = 0;
  std::uint8_t counter_ = 0;
  std::uint8_t output_length_ = 30;
  std::uint8_t input_length_ = 30;
  std::vector<Emergency> emergencies_;
};

}  // namespace stator::tests
