// What SOEM's firm_update sends: Bootstrap, then a file by FoE; and its FoE read.

#include <algorithm>

#include <gtest/gtest.h>

#include "masters/soem.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {
namespace {

class SoemFirmware : public ::testing::Test {
 protected:
  static constexpr unsigned kBootstrap = 0x03;
  static constexpr unsigned kFoe = 4;
  enum Operation : unsigned { read = 1, write = 2, data = 3, acknowledge = 4, error = 5, busy = 6 };

  SoemFirmware() : bus(1), soem(bus) { soem.config_init(); }

  /// Init, the mailboxes that the SII gives for Bootstrap, Bootstrap.
  void go_bootstrap() {
    const std::uint16_t station = Soem::station(0);
    soem.request(0, Soem::kInit);
    ASSERT_EQ(soem.wait_for_all(Soem::kInit), Soem::kInit);
    bus.fpwr(station, 0x0500, bytes({2}));
    bus.fpwr(station, 0x0500, bytes({0}));
    const std::uint32_t receive = soem.read_sii(0, 0x14);
    const std::uint32_t transmit = soem.read_sii(0, 0x16);
    bus.fpwr(station, 0x0500, bytes({1}));
    ASSERT_EQ(receive, Soem::kReceiveMailbox | Soem::kMailboxLength << 16U);
    ASSERT_EQ(transmit, Soem::kTransmitMailbox | Soem::kMailboxLength << 16U);
    bus.fpwr(station, 0x0806, zeros(1));
    bus.fpwr(station, 0x080E, zeros(1));
    bus.fpwr(station, 0x0800, sync_manager(Soem::kReceiveMailbox, Soem::kMailboxLength, 0x26));
    bus.fpwr(station, 0x0808, sync_manager(Soem::kTransmitMailbox, Soem::kMailboxLength, 0x22));
    soem.request(0, kBootstrap);
    ASSERT_EQ(soem.wait_for_all(kBootstrap), kBootstrap);
  }
  /// Sends a FoE message with its 32-bit field and returns the answer from its operation on.
  Bytes foe(unsigned operation, std::uint32_t field, const Bytes& content) {
    Bytes body = bytes({operation, 0, 0, 0, 0, 0});
    base::store_le(body, 2, field);
    body.insert(body.end(), content.begin(), content.end());
    EXPECT_EQ(soem.send_mailbox(0, soem.message(kFoe, body)), 1U);
    const Bytes answer = soem.receive_mailbox(0);
    EXPECT_EQ(number(part(answer, 5, 1)) & 0x0F, kFoe);
    return part(answer, 6);
  }
  static unsigned operation_of(const Bytes& answer) {
    return static_cast<unsigned>(number(part(answer, 0, 1)));
  }
  static std::uint32_t field_of(const Bytes& answer) {
    return static_cast<std::uint32_t>(number(part(answer, 2, 4)));
  }
  /// The name of a file, without an end mark.
  static Bytes name(std::string_view text) {
    Bytes result;
    std::ranges::transform(text, std::back_inserter(result),
                           [](char c) { return static_cast<std::byte>(c); });
    return result;
  }
  static Bytes file(std::size_t length) {
    Bytes content(length);
    for (std::size_t i = 0; i < length; ++i) {
      content[i] = static_cast<std::byte>(i * 7 + i / 256);
    }
    return content;
  }
  void download(const Bytes& content) {
    Bytes answer = foe(write, 0, name("firmware.bin"));
    ASSERT_EQ(operation_of(answer), acknowledge);
    ASSERT_EQ(field_of(answer), 0U) << "packet 0 acknowledges the request";
    std::uint32_t packet = 1;
    for (std::size_t offset = 0;; offset += kPacket, ++packet) {
      const Bytes chunk = part(content, offset, kPacket);
      answer = foe(data, packet, chunk);
      ASSERT_EQ(operation_of(answer), acknowledge);
      ASSERT_EQ(field_of(answer), packet);
      if (chunk.size() < kPacket) {
        break;
      }
    }
  }
  Bytes upload() {
    Bytes content;
    Bytes answer = foe(read, 0, name("firmware.bin"));
    for (std::uint32_t packet = 1;; ++packet) {
      EXPECT_EQ(operation_of(answer), data);
      EXPECT_EQ(field_of(answer), packet);
      const Bytes chunk = part(answer, 6);
      content.insert(content.end(), chunk.begin(), chunk.end());
      if (operation_of(answer) != data || chunk.size() < kPacket) {
        // The acknowledge of the last packet has no answer.
        Bytes last = bytes({acknowledge, 0, 0, 0, 0, 0});
        base::store_le(last, 2, packet);
        EXPECT_EQ(soem.send_mailbox(0, soem.message(kFoe, last)), 1U);
        return content;
      }
      answer = foe(acknowledge, packet, {});
    }
  }
  static constexpr std::size_t kPacket = Soem::kMailboxLength - 12;

  DeviceBus bus;
  Soem soem;
};

TEST_F(SoemFirmware, BootstrapIsReachedFromInitWithTheMailboxesOfTheSii) {
  ASSERT_NO_FATAL_FAILURE(go_bootstrap());
}

TEST_F(SoemFirmware, EachPacketIsAcknowledgedWithItsNumberAndTheFileReadsBack) {
  ASSERT_NO_FATAL_FAILURE(go_bootstrap());
  const Bytes content = file(2 * kPacket + 77);
  ASSERT_NO_FATAL_FAILURE(download(content));
  EXPECT_EQ(upload(), content);
}

TEST_F(SoemFirmware, AFileOfWholePacketsEndsWithAnEmptyOne) {
  ASSERT_NO_FATAL_FAILURE(go_bootstrap());
  const Bytes content = file(3 * kPacket);
  ASSERT_NO_FATAL_FAILURE(download(content));
  EXPECT_EQ(upload(), content);
}

TEST_F(SoemFirmware, AFileThatIsNotThereIsRefusedWithItsErrorCode) {
  ASSERT_NO_FATAL_FAILURE(go_bootstrap());
  const Bytes answer = foe(read, 0, name("firmware.bin"));
  EXPECT_EQ(operation_of(answer), error);
  EXPECT_EQ(field_of(answer), 0x8001U);
}

TEST_F(SoemFirmware, AfterTheUpdateInitLeadsBackToOperation) {
  ASSERT_NO_FATAL_FAILURE(go_bootstrap());
  ASSERT_NO_FATAL_FAILURE(download(file(kPacket + 1)));
  soem.request(0, Soem::kInit);
  EXPECT_EQ(soem.wait_for_all(Soem::kInit), Soem::kInit);
  soem.config_init();
  soem.config_map();
  soem.to_operational();
}

}  // namespace
}  // namespace stator::tests
