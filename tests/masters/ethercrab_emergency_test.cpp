// ethercrab cannot take a message that it has not asked for, so emergencies can be switched off.

#include <gtest/gtest.h>

#include "masters/soem.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::tests {
namespace {

TEST(EthercrabEmergency, WithEmergenciesOffNoMessageComesUnasked) {
  for (const bool emergencies : {true, false}) {
    devices::Tmcm3315Configuration configuration;
    configuration.coe.emergencies = emergencies;
    DeviceBus bus(0);
    bus.add_device(configuration);
    Soem soem(bus);
    soem.config_init();
    EXPECT_EQ(soem.download(0, 0x607D, 1, 1000, 4), 0U);  // the axis stands at 0, outside
    bus.pass(5_ms);
    EXPECT_EQ(soem.mailbox_full(0), emergencies);
  }
}

}  // namespace
}  // namespace stator::tests
