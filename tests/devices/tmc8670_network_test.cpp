// What the bus sees of a TMC8670 beside its modes: identity, states, PDOs, emergencies, stored
// parameters, firmware update, supply.

#include <string>

#include "devices/tmc8670_chip.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/ethercat/units/led.hpp"

namespace stator::devices {
namespace {

using Bytes = tests::TestBus::Bytes;

class Tmc8670Network : public Tmc8670Chip {
 protected:
  std::uint32_t store(std::uint8_t subindex = 1) {
    return bus_->download<std::uint32_t>(0x1010, subindex, 0x65766173);
  }
  std::uint32_t restore(std::uint8_t subindex = 1) {
    return bus_->download<std::uint32_t>(0x1011, subindex, 0x64616F6C);
  }
  void power_cycle() {
    device_->set_power(false, bus_->now());
    bus_->pass(10_ms);
    device_->set_power(true, bus_->now());
  }
  /// The mailbox protocol FoE: one request, its answer.
  Bytes foe(unsigned operation, std::uint32_t number, const Bytes& rest) {
    const ethercat::DeviceDescription& d = device_->description();
    counter_ = counter_ % 7 + 1;
    Bytes mailbox(d.receive_mailbox.length);
    base::store_le(mailbox, 0, static_cast<std::uint16_t>(6 + rest.size()));
    mailbox[5] = static_cast<std::byte>(4 | counter_ << 4);
    mailbox[6] = static_cast<std::byte>(operation);
    base::store_le(mailbox, 8, number);
    std::ranges::copy(rest, mailbox.begin() + 12);
    EXPECT_TRUE(bus_->write(d.receive_mailbox.offset, mailbox));
    const Bytes reply = bus_->read(d.transmit_mailbox.offset, d.transmit_mailbox.length);
    return {reply.begin() + 6, reply.begin() + 12};
  }
  std::string version() {
    dictionary::Entry* entry = device_->dictionary().find(0x100A, 0);
    EXPECT_TRUE(device_->dictionary().prepare_read(*entry));
    return entry->text();
  }
  unsigned counter_ = 0;
};

TEST_F(Tmc8670Network, IdentityIsTheSameInRegistersEepromAndObjects) {
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(read<std::uint32_t>(0x1018, 1), 0x286U);
  EXPECT_EQ(read<std::uint32_t>(0x1018, 2), 0x01008670U);
  EXPECT_EQ(read<std::uint32_t>(0x1018, 3), 0x00010000U);
  EXPECT_EQ(base::load_le<std::uint32_t>(bus_->read(0x0E00, 4), 0), 0x01008670U);
  EXPECT_EQ(base::load_le<std::uint32_t>(bus_->read(0x0E08, 4), 0), 0x286U);
  const auto sii = ethercat::parse_sii_image(device_->controller().sii());
  ASSERT_TRUE(sii);
  EXPECT_EQ(sii->vendor_id, 0x286U);
  EXPECT_EQ(sii->product_code, 0x01008670U);
  EXPECT_EQ(sii->revision, 0x00010000U);
  EXPECT_EQ(sii->mailbox_protocols, 0x000C) << "CoE and FoE";
  EXPECT_EQ(sii->rx_pdos.size(), 6U);
  EXPECT_EQ(sii->tx_pdos.size(), 6U);
  EXPECT_EQ(sii->sync_managers.size(), 4U);
}

TEST_F(Tmc8670Network, EepromIsOneOf32KilobitsWithTwoAddressBytes) {
  EXPECT_EQ(device_->controller().sii().size(), 4096U);
  const Bytes words(device_->controller().sii().begin(), device_->controller().sii().end());
  EXPECT_EQ(base::load_le<std::uint16_t>(words, 0x3E * 2), 31) << "kbit - 1";
  EXPECT_EQ(base::load_le<std::uint16_t>(words, 0x3F * 2), 1);
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->read(0x0502, 2), 0) & 0x80, 0x80);
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->read(0x0140, 2), 0), 0x0C05) << "word 0";
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->read(0x0982, 2), 0), 1000) << "word 2";
}

TEST_F(Tmc8670Network, RunsThroughAllStatesAndShowsThemOnItsLed) {
  using ethercat::LedCode;
  EXPECT_EQ(device_->controller().run_led(), ethercat::run_led_code(1));
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(bus_->read(0x0138, 1)[0], std::byte{0x0D});
  bus_->bring_to(AlState::operational);
  EXPECT_EQ(bus_->read(0x0138, 1)[0], std::byte{0x0F});
  EXPECT_EQ(device_->stack().output_bytes(), 13U);
  EXPECT_EQ(device_->stack().input_bytes(), 15U);
  EXPECT_EQ(bus_->request(AlState::init), 0x01);
  EXPECT_EQ(bus_->request(AlState::operational), 0x11) << "not in one step";
}

TEST_F(Tmc8670Network, AMasterAssignsAndMapsPdos) {
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(bus_->download<std::uint16_t>(0x1C12, 1, 0x1601), 0x06010003U) << "0 entries first";
  write<std::uint8_t>(0x1C12, 0);
  write<std::uint8_t>(0x1C13, 0);
  write<std::uint16_t>(0x1C12, 0x1605, 1);
  write<std::uint8_t>(0x1A00, 0);
  write<std::uint32_t>(0x1A00, 0x60410010, 1);
  write<std::uint32_t>(0x1A00, 0x20700210, 2);
  EXPECT_EQ(bus_->download<std::uint32_t>(0x1A00, 3, 0x60400010), 0x06040041U) << "an output";
  write<std::uint8_t>(0x1A00, 2);
  write<std::uint16_t>(0x1C13, 0x1A00, 1);
  write<std::uint16_t>(0x1C13, 0x1A01, 2);
  write<std::uint8_t>(0x1C13, 2);
  write<std::uint8_t>(0x1C12, 1);
  bus_->set_output_length(43);
  bus_->set_input_length(4 + 17);
  bus_->bring_to(AlState::operational);
  EXPECT_EQ(device_->stack().output_bytes(), 43U);
  EXPECT_EQ(device_->stack().input_bytes(), 21U);
  EXPECT_EQ(bus_->download<std::uint8_t>(0x1C12, 0, 0), 0x08000022U);
}

TEST_F(Tmc8670Network, AnOvervoltageIsAFaultWithEmergencyAndErrorCode) {
  Tmc8670Configuration configuration = tuned_chip();
  configuration.axis.supply.capacitance = 0.0;  // comes down with the source
  renew(configuration);
  go_operational();
  enable(3);
  set_input("axis0.supply_voltage", 70.0);
  bus_->pass(50_ms);
  EXPECT_EQ(statusword() & 0x004F, 0x0008) << "Fault";
  EXPECT_EQ(read<std::uint16_t>(0x603F), 0x3210);
  EXPECT_EQ(read<std::uint8_t>(0x1001), 0x05);
  auto emergencies = bus_->take_emergencies();
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergencies[0][0], 0x10);
  EXPECT_EQ(emergencies[0][1], 0x32);
  EXPECT_EQ(emergencies[0][2], 0x05);
  set_input("axis0.supply_voltage", 24.0);
  bus_->pass(50_ms);
  control(0x80);
  bus_->pass(5_ms);
  emergencies = bus_->take_emergencies();
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergencies[0][0], 0) << "fault reset";
  EXPECT_EQ(read<std::uint16_t>(0x603F), 0);
}

TEST_F(Tmc8670Network, ARefusedSetPointIsTold) {
  go_operational();
  base::store_le(bus_->outputs, 2, std::uint8_t{7});  // no mode
  bus_->exchange();
  const auto emergencies = bus_->take_emergencies();
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergencies[0][0], 0x20);
  EXPECT_EQ(emergencies[0][1], 0x63);
}

TEST_F(Tmc8670Network, AHotJunctionIsToldAndABrokenOneStopsTheChip) {
  go_operational();
  EXPECT_NEAR(signal("axis0.junction_temperature"), 25.0 + 0.562 * 27.03, 1e-9);
  set_input("axis0.ambient_temperature", 90.0);
  bus_->pass(5_ms);
  EXPECT_EQ(bus_->take_emergencies().size(), 1U);
  EXPECT_EQ(told_.count("junction"), 1);
  set_input("axis0.ambient_temperature", 111.0);
  bus_->pass(5_ms);
  EXPECT_EQ(told_.count("absolute maximum"), 1);
  set_input("axis0.ambient_temperature", 25.0);
  power_cycle();
  bus_->pass(5_ms);
  EXPECT_EQ(told_.count("absolute maximum"), 1);
}

/// Takes as long, and fails, as a test wants.
class SlowMemory final : public canopen::NonVolatileMemory {
 public:
  [[nodiscard]] std::span<const std::byte> image(std::uint8_t /*group*/) const override {
    return {};
  }
  void store(std::span<const GroupImage> images) override {
    ++orders;
    groups += images.size();
    present = Status::busy;
  }
  [[nodiscard]] Status status() const override { return present; }
  Status present = Status::ready;
  int orders = 0;
  std::size_t groups = 0;
};

TEST_F(Tmc8670Network, StoringIsAnsweredWhenItIsDoneAndProcessDataGoOnMeanwhile) {
  SlowMemory memory;
  device_->connect_memory(memory);
  go_operational();
  for (const auto& [end, code] :
       {std::pair{SlowMemory::Status::ready, 0x00U}, {SlowMemory::Status::failed, 0x06060000U}}) {
    const std::array request{std::byte{0x23}, std::byte{0x10}, std::byte{0x10}, std::byte{1},
                             std::byte{'s'},  std::byte{'a'},  std::byte{'v'},  std::byte{'e'}};
    bus_->send_mailbox(request);
    for (int cycle = 0; cycle < 100; ++cycle) {
      bus_->exchange();
      bus_->pass(1_ms);
      ASSERT_TRUE(bus_->receive_mailbox().empty()) << "not done after " << cycle << " cycles";
    }
    memory.present = end;
    bus_->pass(1_ms);
    const Bytes answer = bus_->receive_mailbox();
    ASSERT_EQ(answer.size(), 8U);
    EXPECT_EQ(answer[0], code == 0 ? std::byte{0x60} : std::byte{0x80});
    EXPECT_EQ(base::load_le<std::uint32_t>(answer, 4), code);
    EXPECT_EQ(base::load_le<std::uint16_t>(bus_->read(0x0130, 2)), 8U) << "still Operational";
  }
  EXPECT_EQ(memory.orders, 2) << "all groups together";
  EXPECT_EQ(memory.groups, 6U);
}

TEST_F(Tmc8670Network, StoredParametersSurviveTheSupplyAndRestoredOnesAreTheDefaults) {
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(bus_->download<std::uint32_t>(0x1010, 1, 1), 0x08000020U) << "not the signature";
  write<std::int16_t>(0x2030, 1234, 3);
  write<std::uint32_t>(0x6083, 4321);
  write<std::uint16_t>(0x10F1, 9, 2);
  EXPECT_EQ(store(), 0U);
  write<std::int16_t>(0x2030, 999, 3);
  power_cycle();
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(read<std::int16_t>(0x2030, 3), 1234);
  EXPECT_EQ(device_->axis().stage().block().get(control::foc::field("PID_TORQUE_P")), 1234)
      << "in the chip, too";
  EXPECT_EQ(read<std::uint32_t>(0x6083), 4321U);
  EXPECT_EQ(read<std::uint16_t>(0x10F1, 2), 9);
  EXPECT_EQ(restore(4), 0U) << "the manufacturer's alone";
  power_cycle();
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(read<std::int16_t>(0x2030, 3), 1453) << "the default this chip was delivered with";
  EXPECT_EQ(read<std::uint32_t>(0x6083), 4321U);
  EXPECT_EQ(restore(), 0U);
  power_cycle();
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(read<std::uint32_t>(0x6083), 20'000U);
}

TEST_F(Tmc8670Network, FirmwareComesByFoeInBootstrapAndShowsItsVersion) {
  EXPECT_EQ(version(), "V1.00");
  const std::string image = "a virtual image that calls itself V2.17";
  Bytes data(image.size());
  std::ranges::transform(image, data.begin(), [](char c) { return static_cast<std::byte>(c); });
  for (const auto& [channel, area, control] :
       {std::tuple{0, device_->description().bootstrap_receive_mailbox, 0x26},
        std::tuple{1, device_->description().bootstrap_transmit_mailbox, 0x22}}) {
    Bytes registers(8);
    base::store_le(registers, 0, area.offset);
    base::store_le(registers, 2, area.length);
    registers[4] = static_cast<std::byte>(control);
    registers[6] = std::byte{1};
    EXPECT_TRUE(bus_->write(static_cast<std::uint16_t>(0x0800 + 8 * channel), registers));
  }
  ASSERT_EQ(bus_->request(AlState::bootstrap), 0x03);
  EXPECT_EQ(bus_->read(0x0138, 1)[0], std::byte{0x0E});
  EXPECT_EQ(foe(2, 0, {std::byte{'f'}})[0], std::byte{4}) << "write request acknowledged";
  EXPECT_EQ(foe(3, 1, data)[0], std::byte{4});
  EXPECT_EQ(version(), "V2.17");
  EXPECT_EQ(bus_->request(AlState::init), 0x01);
  bus_->pass(1_ms);
  EXPECT_EQ(told_.count("restarting with a new firmware image"), 1);
  EXPECT_EQ(version(), "V2.17");
  bus_->bring_to(AlState::operational);
}

TEST_F(Tmc8670Network, OutputsThatStayAwayEndOperational) {
  bus_->bring_to(AlState::operational);
  bus_->exchange();
  bus_->pass(150_ms);
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->read(0x0130, 2), 0), 0x14);
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->read(0x0134, 2), 0), 0x1B);
}

TEST_F(Tmc8670Network, SetPointsOfBeforeTheWatchdogMoveNothingInTheNextOperational) {
  bus_->bring_to(AlState::operational);
  base::store_le(bus_->outputs, 2, std::int8_t{9});
  base::store_le(bus_->outputs, 7, std::int32_t{500});
  for (const int controlword : {6, 7, 15}) {
    base::store_le(bus_->outputs, 0, static_cast<std::uint16_t>(controlword));
    bus_->pass_cyclically(10_ms);
  }
  bus_->pass_cyclically(300_ms);
  ASSERT_NEAR(read<std::int32_t>(0x606C), 500, 50);
  bus_->pass(2_s);
  ASSERT_EQ(device_->stack().status_code(), ethercat::AlStatusCode::sync_manager_watchdog);

  control(6);
  control(7);
  bus_->write(0x0120, {std::byte{0x18}, std::byte{0}});
  ASSERT_EQ(device_->stack().state(), AlState::operational);
  for (int k = 0; k < 90; ++k) {
    bus_->pass(1_ms);
    ASSERT_NEAR(read<std::int32_t>(0x606C), 0, 5) << k << " ms";
  }
  EXPECT_NE(statusword() & 0x006F, 0x0027) << "Operation enabled";
}

TEST_F(Tmc8670Network, AResetOfTheControllerInOperationalIsTold) {
  go_operational();
  for (const char key : {'R', 'E', 'S'}) {
    bus_->write(0x0040, {static_cast<std::byte>(key)});
  }
  EXPECT_EQ(device_->stack().state(), AlState::init);
  EXPECT_EQ(told_.count("the master has reset the controller (keys R, E, S in 0040h), which was in "
                        "Operational"),
            1);
}

TEST_F(Tmc8670Network, TheSecondReadingOfTheControllerRunsAsWell) {
  Tmc8670Configuration configuration = tuned_chip();
  configuration.controller = "silicon";
  renew(configuration);
  bus_->bring_to(AlState::operational);
  configuration.controller = "gold";
  EXPECT_THROW(Tmc8670{configuration}, std::logic_error);
}

}  // namespace
}  // namespace stator::devices
