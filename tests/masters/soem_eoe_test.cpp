// What SOEM's EoE functions and eoe_test send.

#include <gtest/gtest.h>

#include "masters/soem.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::tests {
namespace {

/// The messages of SOEM's EoE: a header of two words, then data.
class SoemEoe : public ::testing::Test {
 protected:
  static devices::Tmcm3315Configuration configuration() {
    devices::Tmcm3315Configuration configuration;
    configuration.coe.ethernet_over_ethercat = true;
    return configuration;
  }
  SoemEoe() : bus(0), soem(bus) {
    bus.add_device(configuration());
    soem.config_init();
  }

  Bytes eoe(const Bytes& body) {
    EXPECT_EQ(soem.send_mailbox(0, soem.message(2, body)), 1U);
    const Bytes answer = soem.receive_mailbox(0);
    EXPECT_EQ(number(part(answer, 5, 1)) & 0x0F, 2U);
    return part(answer, 6);
  }

  DeviceBus bus;
  Soem soem;
};

TEST_F(SoemEoe, TheSiiAnnouncesIt) {
  bus.fpwr(Soem::station(0), 0x0500, bytes({2}));
  bus.fpwr(Soem::station(0), 0x0500, bytes({0}));
  EXPECT_EQ(soem.read_sii(0, 0x1C) & 0x02, 0x02U);
}

TEST_F(SoemEoe, AnIpAddressThatWasSetIsReadBack) {
  // MAC, address, subnet and gateway; addresses with their last octet first.
  const Bytes parameters = hex("0F 00 00 00 02 12 34 56 78 9A C8 09 A8 C0 00 FF FF FF 01 09 A8 C0");
  Bytes set = hex("02 01 00 00");
  set.insert(set.end(), parameters.begin(), parameters.end());
  EXPECT_EQ(to_hex(part(eoe(set), 0, 4)), "03 01 00 00") << "set IP response, success";
  const Bytes got = eoe(hex("06 01 00 00"));
  EXPECT_EQ(to_hex(part(got, 0, 4)), "07 01 00 00");
  EXPECT_EQ(to_hex(part(got, 4)), to_hex(parameters));
}

TEST_F(SoemEoe, AFrameWithATimeRequestIsAnsweredByItsTimeStamp) {
  // One fragment of 60 bytes: last, time requested, size in units of 32 bytes, frame number 5.
  Bytes frame = hex("00 05 80 50");
  frame.resize(4 + 60);
  const Bytes answer = eoe(frame);
  EXPECT_EQ(answer.size(), 8U);
  EXPECT_EQ(number(part(answer, 0, 1)) & 0x0F, 1U) << "time stamp response";
  EXPECT_EQ(number(part(answer, 2, 2)) >> 12, 5U) << "frame number";
}

}  // namespace
}  // namespace stator::tests
