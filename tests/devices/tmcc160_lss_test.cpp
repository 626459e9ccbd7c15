// Node-ID, bit rate and serial number of a drive with layer setting services (CiA 305) beside its
// own objects 2704h to 2708h: decisions H-08 and A-11.

#include <optional>

#include <gtest/gtest.h>

#include "devices/tmcc160_module.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"

namespace stator::tests {
namespace {

using AbortCode = dictionary::AbortCode;
constexpr AbortCode kNoError = Tmcc160Module::kNoError;
constexpr std::uint32_t kSave = 0x65766173;
constexpr std::uint32_t kLoad = 0x64616F6C;
constexpr std::uint32_t kSerialNumber = 0x12345678;

Tmcc160Configuration with_lss(std::uint8_t node_id) {
  Tmcc160Configuration configuration;
  configuration.options.lss = true;
  configuration.node_id = node_id;
  configuration.serial_number = kSerialNumber;
  return configuration;
}

/// A drive, its LSS master and its NMT master.
struct LssDrive {
  explicit LssDrive(std::uint8_t node_id = 1) : module(with_lss(node_id)) {}

  /// The answer to an LSS request: its bytes 1 to 4 as a number; nothing if none came.
  std::optional<std::uint32_t> lss(unsigned command, unsigned a = 0, unsigned b = 0) {
    module.frames.clear();
    module.send(can::data_frame(0x7E5, {command, a, b, 0, 0, 0, 0, 0}));
    for (const can::Frame& frame : module.frames) {
      if (frame.identifier == 0x7E4) {
        return base::load_le<std::uint32_t>(frame.data.data() + 1);
      }
    }
    return std::nullopt;
  }
  void configure_node_id(unsigned node_id) {
    lss(4, 1);
    EXPECT_EQ(lss(17, node_id), 0U);
    lss(4, 0);
  }
  /// NMT reset; the node-ID of the boot-up message, 0 if none came.
  unsigned reset(unsigned command) {
    module.frames.clear();
    module.nmt(command);
    return boot_up();
  }
  unsigned power_cycle() {
    module.device->set_power(false, module.now);
    module.frames.clear();
    module.device->set_power(true, module.now);
    return boot_up();
  }
  unsigned boot_up() {
    module.wait(510);
    for (const can::Frame& frame : module.frames) {
      if (frame.identifier > 0x700 && frame.identifier < 0x780 && frame.length == 1) {
        module.node_id = frame.identifier - 0x700;
        return module.node_id;
      }
    }
    return 0;
  }

  static constexpr unsigned kResetNode = 129;
  static constexpr unsigned kResetCommunication = 130;
  Tmcc160Module module;
};
struct Tmcc160Lss : testing::Test, LssDrive {};

TEST_F(Tmcc160Lss, TheSerialNumberStandsInTheIdentityAsLssTellsIt) {
  module.boot();
  EXPECT_EQ(module.read(0x1018, 0), 4);
  EXPECT_EQ(module.read(0x1018, 4), kSerialNumber);
  EXPECT_EQ(module.write(0x1018, 4, 1), AbortCode::read_only);
  lss(4, 1);
  EXPECT_EQ(lss(93), kSerialNumber);
  EXPECT_NE(module.device->eds().find("[1018sub4]"), std::string_view::npos);
  EXPECT_EQ(module.device->eds().find("0x12345678"), std::string_view::npos)
      << "one data sheet for all drives";
  Tmcc160Module without;
  without.boot();
  EXPECT_EQ(without.read(0x1018, 0), 3);
  without.upload(0x1018, 4);
  EXPECT_EQ(without.abort, AbortCode::subindex_does_not_exist);
}

TEST_F(Tmcc160Lss, ANodeIdThatWasNotStoredLastsUntilResetNode) {
  module.boot();
  configure_node_id(33);
  EXPECT_EQ(reset(kResetCommunication), 33U);
  EXPECT_EQ(module.read(0x2708), 33);
  EXPECT_EQ(module.read(0x2705), 1) << "the stored one";
  EXPECT_EQ(reset(kResetCommunication), 33U);
  EXPECT_EQ(reset(kResetNode), 1U);
  configure_node_id(33);
  EXPECT_EQ(power_cycle(), 1U);
}

TEST_F(Tmcc160Lss, ANodeIdStoredByObjectsCountsAfterLssConfiguredAnotherOne) {
  for (const unsigned command : {kResetCommunication, kResetNode}) {
    LssDrive drive;
    drive.module.boot();
    drive.configure_node_id(33);
    EXPECT_EQ(drive.module.write(0x2705, 0, 9), kNoError);
    EXPECT_EQ(drive.module.write(0x2706, 0, kSave), kNoError);
    EXPECT_EQ(drive.reset(command), 9U);
    EXPECT_EQ(drive.module.read(0x2708), 9);
    EXPECT_EQ(drive.module.write(0x1011, 2, kLoad), kNoError);
    EXPECT_EQ(drive.reset(command), 1U) << "restored defaults";
  }
}

TEST_F(Tmcc160Lss, StoringWithoutConfiguringKeepsWhatObjectsHaveStored) {
  module.boot();
  EXPECT_EQ(module.write(0x2705, 0, 9), kNoError);
  EXPECT_EQ(module.write(0x2706, 0, kSave), kNoError);
  lss(4, 1);
  EXPECT_EQ(lss(23), 0U);
  EXPECT_EQ(reset(kResetNode), 9U);
}

TEST_F(Tmcc160Lss, WhatLssStoresIsTakenByEveryReset) {
  module.boot();
  lss(4, 1);
  EXPECT_EQ(lss(17, 33), 0U);
  EXPECT_EQ(lss(23), 0U);
  EXPECT_EQ(reset(kResetCommunication), 33U);
  EXPECT_EQ(reset(kResetNode), 33U);
  EXPECT_EQ(power_cycle(), 33U);
  EXPECT_EQ(module.read(0x2705), 33);
}

TEST_F(Tmcc160Lss, AnActivatedBitRateLastsUntilResetNodeOrUntilOneIsStored) {
  constexpr unsigned k500 = 2;  // in the table of CiA 305
  module.boot();
  const auto activate = [this] {
    lss(4, 1);
    EXPECT_EQ(lss(19, 0, k500), 0U);
    lss(21, 10);
    lss(4, 0);
    module.wait(20);
    EXPECT_EQ(module.device->bit_rate(), 500'000U);
  };
  activate();
  EXPECT_EQ(reset(kResetCommunication), 1U);
  EXPECT_EQ(module.device->bit_rate(), 500'000U);
  EXPECT_EQ(module.read(0x2707), 500);
  EXPECT_EQ(module.read(0x2704), 1000) << "the stored one";
  EXPECT_EQ(reset(kResetNode), 1U);
  EXPECT_EQ(module.device->bit_rate(), 1'000'000U);
  activate();
  EXPECT_EQ(module.write(0x2704, 0, 125), kNoError);
  EXPECT_EQ(module.write(0x2706, 0, kSave), kNoError);
  EXPECT_EQ(reset(kResetCommunication), 1U);
  EXPECT_EQ(module.device->bit_rate(), 125'000U);
}

TEST_F(Tmcc160Lss, NoNodeIdCanBeStoredAndOneGivenAgain) {
  module.boot();
  lss(4, 1);
  EXPECT_EQ(lss(17, 255), 0U);
  EXPECT_EQ(lss(23), 0U);
  EXPECT_EQ(module.read(0x2705), 255);
  EXPECT_EQ(power_cycle(), 0U) << "silent";
  EXPECT_EQ(lss(76), 0U) << "here is one without a node-ID";
  lss(4, 1);
  EXPECT_EQ(lss(94), 255U);
  EXPECT_EQ(lss(17, 44), 0U);
  EXPECT_EQ(lss(23), 0U);
  module.frames.clear();
  module.send(can::data_frame(0x7E5, {4, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(boot_up(), 44U);
  EXPECT_EQ(module.read(0x2705), 44);
  EXPECT_EQ(power_cycle(), 44U);
}

TEST_F(Tmcc160Lss, ADriveDeliveredWithoutANodeIdWaitsForOne) {
  LssDrive drive(255);
  EXPECT_EQ(drive.boot_up(), 0U);
  drive.module.send(can::data_frame(0x000, {1, 0}));
  EXPECT_EQ(drive.module.device->node().state(), canopen::NmtState::initialisation);
  drive.lss(4, 1);
  EXPECT_EQ(drive.lss(17, 7), 0U);
  drive.module.frames.clear();
  drive.module.send(can::data_frame(0x7E5, {4, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(drive.boot_up(), 7U);
  EXPECT_EQ(drive.module.read(0x1014), 0x87);
  EXPECT_EQ(drive.module.read(0x1018, 4), kSerialNumber);
}

TEST_F(Tmcc160Lss, ObjectsTakeANodeIdOrNone) {
  module.boot();
  for (const std::int64_t node_id : {128, 200, 254}) {
    EXPECT_EQ(module.write(0x2705, 0, node_id), AbortCode::value_range_exceeded);
  }
  EXPECT_EQ(
      module.sentences.back(),
      "write to 2705h:00h \"Node ID\" refused: 254 came; a node-ID is 1 to 127, and 255 stands "
      "for none, until LSS gives one");
  EXPECT_EQ(module.write(0x2705, 0, 0), AbortCode::value_too_low);
  EXPECT_EQ(module.write(0x2705, 0, 255), kNoError);
  EXPECT_EQ(module.write(0x2705, 0, 127), kNoError);
  Tmcc160Module without;
  without.boot();
  EXPECT_EQ(without.write(0x2705, 0, 255), AbortCode::value_too_high);
}

}  // namespace
}  // namespace stator::tests
