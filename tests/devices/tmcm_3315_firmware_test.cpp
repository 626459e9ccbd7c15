#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/sentences.hpp"
#include "devices/test_bus.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/ethercat/sii/sii_image.hpp"

namespace stator::devices {
namespace {

using namespace base::literals;
using ethercat::AlState;
using testing::Contains;
using testing::HasSubstr;
using Bytes = tests::TestBus::Bytes;

/// Firmware update as a master does it, and the rest of what the bus sees outside process data.
class Tmcm3315Firmware : public testing::Test {
 protected:
  static constexpr std::size_t kPacket = 500;

  explicit Tmcm3315Firmware(const Tmcm3315Configuration& configuration = {})
      : device_(configuration, base::EventReporter(&log_, 0)), bus_(device_) {}

  unsigned status() { return base::load_le<std::uint16_t>(bus_.read(0x0130, 2)); }
  unsigned status_code() { return base::load_le<std::uint16_t>(bus_.read(0x0134, 2)); }
  void configure_bootstrap() {
    const auto& d = device_.description();
    for (const auto& [channel, area, control] :
         {std::tuple{0, d.bootstrap_receive_mailbox, 0x26},
          std::tuple{1, d.bootstrap_transmit_mailbox, 0x22}}) {
      Bytes registers(8);
      base::store_le(registers, 0, area.offset);
      base::store_le(registers, 2, area.length);
      registers[4] = static_cast<std::byte>(control);
      registers[6] = std::byte{1};
      EXPECT_TRUE(bus_.write(static_cast<std::uint16_t>(0x0800 + 8 * channel), registers));
    }
  }
  void go_bootstrap() {
    bus_.request(AlState::init);
    configure_bootstrap();
    ASSERT_EQ(bus_.request(AlState::bootstrap), 0x03U);
  }

  /// Sends a mailbox message of `type`; the reply's payload.
  Bytes exchange(unsigned type, const Bytes& payload) {
    counter_ = counter_ % 7 + 1;
    const auto& d = device_.description();
    Bytes mailbox(d.receive_mailbox.length);
    base::store_le(mailbox, 0, static_cast<std::uint16_t>(payload.size()));
    mailbox[5] = static_cast<std::byte>(type | counter_ << 4);
    std::ranges::copy(payload, mailbox.begin() + 6);
    EXPECT_TRUE(bus_.write(d.receive_mailbox.offset, mailbox));
    if ((bus_.read(0x080D, 1)[0] & std::byte{8}) == std::byte{0}) {
      return {};
    }
    const Bytes reply = bus_.read(d.transmit_mailbox.offset, d.transmit_mailbox.length);
    return {reply.begin() + 6, reply.begin() + 6 + base::load_le<std::uint16_t>(reply, 0)};
  }
  Bytes foe(unsigned operation, std::uint32_t number, const Bytes& rest = {}) {
    Bytes payload(6);
    payload[0] = static_cast<std::byte>(operation);
    base::store_le(payload, 2, number);
    payload.insert(payload.end(), rest.begin(), rest.end());
    return exchange(4, payload);
  }
  static bool acknowledges(const Bytes& reply, std::uint32_t packet) {
    return reply.size() == 6 && reply[0] == std::byte{4} &&
           base::load_le<std::uint32_t>(reply, 2) == packet;
  }
  static Bytes slice(const Bytes& bytes, std::size_t offset) {
    const std::size_t from = std::min(offset, bytes.size());
    const std::size_t count = std::min(kPacket, bytes.size() - from);
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(from);
    return {begin, begin + static_cast<std::ptrdiff_t>(count)};
  }
  void download(const Bytes& image) {
    ASSERT_TRUE(acknowledges(foe(2, 0, {std::byte{'f'}}), 0));
    std::size_t offset = 0;
    std::uint32_t packet = 0;
    std::size_t sent = kPacket;
    while (sent == kPacket) {
      const Bytes data = slice(image, offset);
      sent = data.size();
      offset += sent;
      ++packet;
      ASSERT_TRUE(acknowledges(foe(3, packet, data), packet)) << packet;
    }
  }
  Bytes upload() {
    Bytes image;
    Bytes reply = foe(1, 0, {std::byte{'f'}});
    for (std::uint32_t packet = 1; reply.size() >= 6 && reply[0] == std::byte{3}; ++packet) {
      image.insert(image.end(), reply.begin() + 6, reply.end());
      reply = foe(4, packet);
    }
    EXPECT_TRUE(reply.empty());
    return image;
  }
  static Bytes image_of(std::size_t size) {
    Bytes image(size);
    for (std::size_t i = 0; i < size; ++i) {
      image[i] = static_cast<std::byte>(i * 31 + i / 251);
    }
    return image;
  }

  tests::Sentences log_;
  Tmcm3315 device_;
  tests::TestBus bus_;
  unsigned counter_ = 0;
};

TEST_F(Tmcm3315Firmware, SiiOffersCoeAndFoeAndBootstrapMailboxes) {
  const auto sii = ethercat::parse_sii_image(device_.controller().sii());
  ASSERT_TRUE(sii);
  EXPECT_EQ(sii->mailbox_protocols, 0x000C) << "CoE and FoE, neither EoE nor SoE nor AoE";
  EXPECT_EQ(sii->bootstrap_receive_mailbox.offset, 0x1000);
  EXPECT_EQ(sii->bootstrap_receive_mailbox.length, 512);
  EXPECT_EQ(sii->bootstrap_transmit_mailbox.offset, 0x1200);
  EXPECT_EQ(sii->bootstrap_transmit_mailbox.length, 512);
}

TEST_F(Tmcm3315Firmware, OtherMailboxProtocols_AreNotSupported) {
  bus_.bring_to(AlState::pre_operational);
  for (const unsigned type : {1U, 2U, 5U, 15U}) {
    EXPECT_EQ(exchange(type, Bytes(8)),
              (Bytes{std::byte{1}, std::byte{0}, std::byte{2}, std::byte{0}}))
        << type;
  }
}

TEST_F(Tmcm3315Firmware, BootstrapIsEnteredFromInitOnly) {
  for (const AlState from :
       {AlState::pre_operational, AlState::safe_operational, AlState::operational}) {
    bus_.request(AlState::init);
    bus_.bring_to(from);
    EXPECT_EQ(bus_.request(AlState::bootstrap), static_cast<unsigned>(from) | 0x10U);
    EXPECT_EQ(status_code(), 0x0011U);
  }
  go_bootstrap();
}

TEST_F(Tmcm3315Firmware, BootstrapIsLeftToInitOnly) {
  go_bootstrap();
  for (const AlState to :
       {AlState::pre_operational, AlState::safe_operational, AlState::operational}) {
    EXPECT_EQ(bus_.request(to), 0x13U);
    EXPECT_EQ(status_code(), 0x0011U);
    bus_.write(0x0120, {std::byte{0x13}, std::byte{0}});
  }
  EXPECT_EQ(bus_.request(AlState::init), 0x01U);
  bus_.bring_to(AlState::operational);
}

TEST_F(Tmcm3315Firmware, BootstrapWithoutItsMailboxes_IsRefusedWith0015h) {
  EXPECT_EQ(bus_.request(AlState::bootstrap), 0x11U);
  EXPECT_EQ(status_code(), 0x0015U);
  EXPECT_THAT(log_.all, Contains(HasSubstr("SM0 is not enabled")));
}

TEST_F(Tmcm3315Firmware, FoeOutsideBootstrap_IsRefusedWith8008h) {
  for (const AlState state :
       {AlState::pre_operational, AlState::safe_operational, AlState::operational}) {
    bus_.request(AlState::init);
    bus_.bring_to(state);
    const Bytes reply = foe(2, 0, {std::byte{'f'}});
    ASSERT_GE(reply.size(), 6U);
    EXPECT_EQ(reply[0], std::byte{5});
    EXPECT_EQ(base::load_le<std::uint32_t>(reply, 2), 0x8008U);
  }
}

TEST_F(Tmcm3315Firmware, CoeInBootstrap_IsNotSupported) {
  go_bootstrap();
  EXPECT_EQ(exchange(3, Bytes(10)),
            (Bytes{std::byte{1}, std::byte{0}, std::byte{2}, std::byte{0}}));
}

TEST_F(Tmcm3315Firmware, ImagesOfEveryLength_AreLoadedAndReadBack) {
  for (const std::size_t size :
       {std::size_t{1}, kPacket - 1, kPacket, kPacket + 1, 20 * kPacket, std::size_t{100'000}}) {
    go_bootstrap();
    download(image_of(size));
    EXPECT_EQ(upload(), image_of(size)) << size;
    bus_.request(AlState::init);
  }
}

TEST_F(Tmcm3315Firmware, NoImageYet_IsNotFound) {
  go_bootstrap();
  const Bytes reply = foe(1, 0, {std::byte{'f'}});
  EXPECT_EQ(base::load_le<std::uint32_t>(reply, 2), 0x8001U);
}

TEST_F(Tmcm3315Firmware, PasswordOtherThanZero_HasNoRights) {
  go_bootstrap();
  EXPECT_EQ(base::load_le<std::uint32_t>(foe(2, 1, {std::byte{'f'}}), 2), 0x800AU);
}

TEST_F(Tmcm3315Firmware, LeavingBootstrapWithANewImage_RestartsTheFirmware) {
  bus_.bring_to(AlState::pre_operational);
  ASSERT_EQ(bus_.download<std::uint32_t>(0x6081, 0, 12'345), 0U);
  go_bootstrap();
  download(image_of(700));
  EXPECT_EQ(bus_.request(AlState::init), 0x01U);
  EXPECT_THAT(log_.all, Contains(HasSubstr("restarting with a new firmware image, 700 bytes")));
  bus_.bring_to(AlState::pre_operational);
  EXPECT_NE(bus_.upload<std::uint32_t>(0x6081), 12'345U) << "values are those of power-on";
  bus_.request(AlState::init);
  bus_.bring_to(AlState::operational);
}

TEST_F(Tmcm3315Firmware, LeavingBootstrapWithoutANewImage_ChangesNothing) {
  bus_.bring_to(AlState::pre_operational);
  ASSERT_EQ(bus_.download<std::uint32_t>(0x6081, 0, 12'345), 0U);
  go_bootstrap();
  ASSERT_TRUE(acknowledges(foe(2, 0, {std::byte{'f'}}), 0));
  ASSERT_TRUE(acknowledges(foe(3, 1, Bytes(kPacket)), 1));
  EXPECT_EQ(bus_.request(AlState::init), 0x01U);
  bus_.bring_to(AlState::pre_operational);
  EXPECT_EQ(bus_.upload<std::uint32_t>(0x6081), 12'345U);
  EXPECT_TRUE(device_.firmware()->image().empty());
}

TEST_F(Tmcm3315Firmware, DownloadBrokenByAResetOfTheController_LeavesTheOldImage) {
  go_bootstrap();
  download(image_of(700));
  ASSERT_TRUE(acknowledges(foe(2, 0, {std::byte{'f'}}), 0));
  ASSERT_TRUE(acknowledges(foe(3, 1, Bytes(kPacket)), 1));
  for (const char key : {'R', 'E', 'S'}) {
    bus_.write(0x0040, {static_cast<std::byte>(key)});
  }
  EXPECT_EQ(status(), 0x01U);
  go_bootstrap();
  EXPECT_EQ(upload(), image_of(700));
}

class Tmcm3315WithFlash : public Tmcm3315Firmware {
 protected:
  Tmcm3315WithFlash() : Tmcm3315Firmware(with_erase_time()) {}
  static Tmcm3315Configuration with_erase_time() {
    Tmcm3315Configuration configuration;
    configuration.coe.firmware_erase_time = 300_ms;
    return configuration;
  }
};

TEST_F(Tmcm3315WithFlash, DataAreBusyWhileItIsErased) {
  go_bootstrap();
  ASSERT_TRUE(acknowledges(foe(2, 0, {std::byte{'f'}}), 0));
  EXPECT_EQ(foe(3, 1, Bytes(3)).at(0), std::byte{6});
  bus_.pass(300_ms);
  EXPECT_TRUE(acknowledges(foe(3, 1, Bytes(3)), 1));
}

class Tmcm3315WithChoices : public Tmcm3315Firmware {
 protected:
  Tmcm3315WithChoices() : Tmcm3315Firmware(choices()) {}
  static Tmcm3315Configuration choices() {
    Tmcm3315Configuration configuration;
    configuration.coe.emergencies = false;
    configuration.coe.require_outputs = true;
    configuration.coe.identification = 5;
    return configuration;
  }
};

TEST_F(Tmcm3315WithChoices, IdentificationIsDeliveredAndAnnounced) {
  bus_.bring_to(AlState::pre_operational);
  bus_.write(0x0120, {std::byte{0x22}, std::byte{0}});
  EXPECT_EQ(status(), 0x22U);
  EXPECT_EQ(status_code(), 5U);
  Tmcm3315 plain(Tmcm3315Configuration{});
  EXPECT_NE(Bytes(plain.controller().sii().begin(), plain.controller().sii().end()),
            Bytes(device_.controller().sii().begin(), device_.controller().sii().end()));
}

TEST_F(Tmcm3315WithChoices, OperationalNeedsOutputs) {
  bus_.bring_to(AlState::safe_operational);
  EXPECT_EQ(bus_.request(AlState::operational), 0x14U);
  EXPECT_EQ(status_code(), 0x0019U);
}

TEST_F(Tmcm3315WithChoices, NoEmergencyIsSent) {
  bus_.write(0x0420, {std::byte{0}, std::byte{0}});
  bus_.bring_to(AlState::operational);
  ASSERT_EQ(bus_.download<std::int32_t>(0x607D, 1, 1000), 0U);  // the axis stands outside
  bus_.pass(2_ms);
  EXPECT_TRUE(bus_.take_emergencies().empty());
}

}  // namespace
}  // namespace stator::devices
