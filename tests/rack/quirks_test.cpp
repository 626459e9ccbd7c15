// What a master sees of a device with a quirk, from the key in the rack file on.

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/test_bus.hpp"
#include "devices/tmcc160_module.hpp"
#include "source_paths.hpp"
#include "stator/bench/local_can_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/product/shell/quirk_keys.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using dictionary::AbortCode;
using ethercat::AlState;
using ::testing::HasSubstr;
using tests::TestBus;
using Bytes = TestBus::Bytes;

constexpr std::byte kAbort{0x80};

RackConfiguration slave_rack(const std::string& type, const std::string& quirks) {
  return parse_rack_file(
      fmt::format("[[segment]]\n[[segment.device]]\ntype = \"{}\"\n{}", type, quirks), "rack.toml",
      devices::products());
}

/// A device with CoE in Pre-Operational, and a master.
struct Slave {
  explicit Slave(const std::string& quirks, const std::string& type = "tmcm-3315",
                 bool start = true)
      : device(make_ethercat_device(slave_rack(type, quirks).segments[0].devices[0].setup, {})),
        bus(*device) {
    if (start) {
      bus.bring_to(AlState::pre_operational);
    }
  }

  Bytes sdo(std::initializer_list<unsigned> request) {
    Bytes bytes(8);
    std::ranges::transform(request, bytes.begin(),
                           [](unsigned byte) { return static_cast<std::byte>(byte); });
    return bus.sdo(bytes);
  }
  static AbortCode abort_of(const Bytes& answer) {
    return answer.at(0) == kAbort ? static_cast<AbortCode>(base::load_le<std::uint32_t>(answer, 4))
                                  : AbortCode{};
  }
  /// A mailbox message of CoE as it is, with its counter; its answer is left in the mailbox.
  void post(unsigned counter, unsigned service, std::initializer_list<unsigned> body) {
    const ethercat::MailboxArea area = device->description().receive_mailbox;
    Bytes mailbox(area.length);
    base::store_le(mailbox, 0, static_cast<std::uint16_t>(2 + body.size()));
    mailbox[5] = static_cast<std::byte>(3U | counter << 4U);
    base::store_le(mailbox, 6, static_cast<std::uint16_t>(service << 12U));
    std::ranges::transform(body, mailbox.begin() + 8,
                           [](unsigned byte) { return static_cast<std::byte>(byte); });
    EXPECT_TRUE(bus.write(area.offset, mailbox));
  }
  bool answered() { return (bus.read(0x080D, 1)[0] & std::byte{0x08}) != std::byte{0}; }
  /// The answer, which may take some firmware periods.
  Bytes fetch() {
    for (int period = 0; period < 10 && !answered(); ++period) {
      bus.pass(1_ms);
    }
    const ethercat::MailboxArea area = device->description().transmit_mailbox;
    return bus.read(area.offset, area.length);
  }

  std::unique_ptr<product::EtherCatDevice> device;
  TestBus bus;
};

/// The quirks of CoE are those of the stack, whatever the product.
class CoeQuirks : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Products, CoeQuirks, ::testing::Values("tmcm-3315", "tmc8670"),
                         [](const auto& product) {
                           return product.param == std::string("tmc8670") ? "Tmc8670" : "Tmcm3315";
                         });

TEST_P(CoeQuirks, CompleteAccessIsRefusedThoughTheSiiAnnouncesIt) {
  const std::initializer_list<unsigned> request{0x50, 0x18, 0x10, 0x01};
  EXPECT_EQ(Slave::abort_of(Slave("", GetParam()).sdo(request)), AbortCode{});
  Slave slave(R"(quirks = ["no-complete-access"])", GetParam());
  EXPECT_EQ(Slave::abort_of(slave.sdo(request)), AbortCode::unsupported_access);
  EXPECT_TRUE(slave.device->description().complete_access);
}

TEST_P(CoeQuirks, SdoInformationIsAnsweredByAMailboxError) {
  const std::initializer_list<unsigned> list_lengths{0x01, 0, 0, 0, 0, 0};
  Slave right("", GetParam());
  right.post(1, 8, list_lengths);
  EXPECT_EQ(right.fetch().at(5) & std::byte{0x0F}, std::byte{3}) << "CoE";
  Slave wrong(R"(quirks = ["no-sdo-information"])", GetParam());
  wrong.post(1, 8, list_lengths);
  const Bytes answer = wrong.fetch();
  EXPECT_EQ(answer.at(5) & std::byte{0x0F}, std::byte{0}) << "mailbox error";
  EXPECT_EQ(base::load_le<std::uint16_t>(answer, 8), 4) << "service not supported";
}

TEST_P(CoeQuirks, WhatNeedsSegmentsIsRefused) {
  // A complete download of 4000 bytes is too long for any mailbox of ours.
  const std::initializer_list<unsigned> request{0x31, 0x00, 0x16, 0x00, 0xA0, 0x0F, 0, 0};
  EXPECT_NE(Slave::abort_of(Slave("", GetParam()).sdo(request)), AbortCode::object_exceeds_mailbox);
  Slave slave(R"(quirks = ["no-segments"])", GetParam());
  EXPECT_EQ(Slave::abort_of(slave.sdo(request)), AbortCode::object_exceeds_mailbox);
}

TEST_P(CoeQuirks, TheToggleBitOfSegmentsStaysZero) {
  const auto second_answer = [](Slave&& slave) {
    // A complete download of 34 bytes, of which two segments come.
    EXPECT_EQ(slave.sdo({0x31, 0x00, 0x16, 0x00, 34, 0, 0, 0}).at(0), std::byte{0x60});
    EXPECT_EQ(slave.sdo({0x00, 0, 0, 0, 0, 0, 0, 0}).at(0), std::byte{0x20});
    return slave.sdo({0x10, 0, 0, 0, 0, 0, 0, 0}).at(0);
  };
  EXPECT_EQ(second_answer(Slave("", GetParam())), std::byte{0x30});
  EXPECT_EQ(second_answer(Slave(R"(quirks = ["toggle-stuck"])", GetParam())), std::byte{0x20});
}

TEST_P(CoeQuirks, ExpeditedUploadsDoNotSayTheirSize) {
  const std::initializer_list<unsigned> request{0x40, 0x01, 0x10, 0x00};
  EXPECT_EQ(Slave("", GetParam()).sdo(request).at(0), std::byte{0x4F});
  EXPECT_EQ(Slave(R"(quirks = ["size-not-indicated"])", GetParam()).sdo(request).at(0),
            std::byte{0x42});
}

TEST_P(CoeQuirks, AnAbortKeepsTheSizeBitsOfTheRequest) {
  const std::initializer_list<unsigned> request{0x23, 0xFF, 0x5F, 0x00, 1, 0, 0, 0};
  EXPECT_EQ(Slave("", GetParam()).sdo(request).at(0), std::byte{0x80});
  EXPECT_EQ(Slave(R"(quirks = ["abort-with-size"])", GetParam()).sdo(request).at(0),
            std::byte{0x83});
}

TEST_P(CoeQuirks, AnSdoIsAnsweredAfterItsTime) {
  Slave slave("quirks.slow-sdo = \"50ms\"", GetParam());
  slave.post(1, 2, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  slave.bus.pass(45_ms);
  EXPECT_FALSE(slave.answered());
  slave.bus.pass(7_ms);
  EXPECT_TRUE(slave.answered());
  EXPECT_EQ(slave.fetch().at(8) & std::byte{0xE0}, std::byte{0x40});
}

TEST_P(CoeQuirks, ARequestThatComesMeanwhileWaits) {
  Slave slave("quirks.slow-sdo = \"20ms\"", GetParam());
  slave.post(1, 2, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  slave.bus.pass(5_ms);
  slave.post(2, 2, {0x40, 0x01, 0x10, 0x00, 0, 0, 0, 0});
  slave.bus.pass(17_ms);
  EXPECT_EQ(slave.fetch().at(9), std::byte{0x00}) << "1000h";
  slave.bus.pass(5_ms);
  EXPECT_FALSE(slave.answered());
  slave.bus.pass(20_ms);
  EXPECT_EQ(slave.fetch().at(9), std::byte{0x01}) << "1001h";
}

TEST_P(CoeQuirks, ARepeatRequestIsNeverAcknowledged) {
  const auto acknowledged = [](Slave& slave) {
    slave.bus.write(0x080E, {std::byte{0x03}});
    slave.bus.pass(3_ms);
    return (slave.bus.read(0x080F, 1)[0] & std::byte{0x02}) != std::byte{0};
  };
  Slave right("", GetParam());
  EXPECT_TRUE(acknowledged(right));
  Slave wrong(R"(quirks = ["no-mailbox-repeat"])", GetParam());
  EXPECT_FALSE(acknowledged(wrong));
}

TEST_P(CoeQuirks, ARepeatedRequestIsCarriedOutAgain) {
  const auto answers_twice = [](Slave& slave) {
    const std::initializer_list<unsigned> request{0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0};
    slave.post(5, 2, request);
    slave.fetch();
    slave.post(5, 2, request);
    slave.bus.pass(3_ms);
    return slave.answered();
  };
  Slave right("", GetParam());
  EXPECT_FALSE(answers_twice(right));
  Slave wrong(R"(quirks = ["repeats-executed"])", GetParam());
  EXPECT_TRUE(answers_twice(wrong));
}

TEST_P(CoeQuirks, MailboxCountersOfAnswersAreZero) {
  const auto counter = [](Slave& slave) {
    slave.post(1, 2, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    return std::to_integer<unsigned>(slave.fetch().at(5)) >> 4U;
  };
  Slave right("", GetParam());
  EXPECT_NE(counter(right), 0U);
  Slave wrong(R"(quirks = ["mailbox-counter-zero"])", GetParam());
  EXPECT_EQ(counter(wrong), 0U);
}

TEST_P(CoeQuirks, TheMappingCannotBeWritten) {
  EXPECT_EQ(Slave("", GetParam()).bus.download<std::uint8_t>(0x1600, 0, 0), 0U);
  EXPECT_EQ(
      Slave(R"(quirks = ["fixed-mapping"])", GetParam()).bus.download<std::uint8_t>(0x1600, 0, 0),
      0x06010002U);
}

TEST(CoeProcessDataQuirks, OnlyOnePdoCanBeAssigned) {
  const auto assign_two = [](const std::string& quirks) {
    Slave slave(quirks, "tmc8670");
    EXPECT_EQ(slave.bus.download<std::uint8_t>(0x1C12, 0, 0), 0U);
    EXPECT_EQ(slave.bus.download<std::uint16_t>(0x1C12, 1, 0x1600), 0U);
    EXPECT_EQ(slave.bus.download<std::uint16_t>(0x1C12, 2, 0x1601), 0U);
    return slave.bus.download<std::uint8_t>(0x1C12, 0, 2);
  };
  EXPECT_EQ(assign_two(""), 0U);
  EXPECT_EQ(assign_two(R"(quirks = ["one-pdo"])"), 0x06040042U);
}

TEST(CoeProcessDataQuirks, ProcessDataOfAnyLengthAreTaken) {
  const auto status = [](Slave& slave, std::uint8_t outputs, std::uint8_t inputs) {
    const ethercat::DeviceDescription& d = slave.device->description();
    const auto configure = [&](std::uint16_t address, std::uint16_t start, std::uint8_t length,
                               std::uint8_t control) {
      Bytes registers(8);
      base::store_le(registers, 0, start);
      registers[2] = std::byte{length};
      registers[4] = std::byte{control};
      registers[6] = std::byte{1};
      EXPECT_TRUE(slave.bus.write(address, registers));
    };
    configure(0x0810, d.output_offset, outputs, 0x64);
    configure(0x0818, d.input_offset, inputs, 0x20);
    return slave.bus.request(AlState::safe_operational);
  };
  Slave right("");
  EXPECT_EQ(status(right, 5, 40), 0x12) << "refused, still Pre-Operational";
  Slave wrong(R"(quirks = ["any-process-data-length"])");
  EXPECT_EQ(status(wrong, 5, 40), 0x04);
  // Both buffers go on changing hands.
  wrong.bus.set_output_length(5);
  wrong.bus.set_input_length(40);
  for (int cycle = 0; cycle < 5; ++cycle) {
    wrong.bus.exchange();
    wrong.bus.pass(1_ms);
  }
  EXPECT_EQ(wrong.bus.request(AlState::operational), 0x08);
  wrong.bus.pass_cyclically(300_ms);
  EXPECT_EQ(base::load_le<std::uint16_t>(wrong.bus.read(0x0130, 2)), 0x08) << "no watchdog";
}

TEST_P(CoeQuirks, TheSiiTellsAnotherIdentityThanTheDictionary) {
  Slave slave(
      "[segment.device.quirks]\nwrong-vendor = 0x123\nwrong-product = 0x456\n"
      "wrong-revision = 7\n"
      "wrong-name = \"Ghost\"\n",
      GetParam());
  const auto sii = slave.device->controller().sii();
  EXPECT_EQ(base::load_le<std::uint32_t>(sii, 16), 0x123U);
  EXPECT_EQ(base::load_le<std::uint32_t>(sii, 20), 0x456U);
  EXPECT_EQ(base::load_le<std::uint32_t>(sii, 24), 7U);
  const std::string text(reinterpret_cast<const char*>(sii.data()), sii.size());
  EXPECT_THAT(text, HasSubstr("Ghost"));
  EXPECT_NE(slave.bus.upload<std::uint32_t>(0x1018, 1), 0x123U);
  EXPECT_NE(slave.bus.upload<std::uint32_t>(0x1018, 2), 0x456U);
  EXPECT_NE(slave.bus.upload<std::uint32_t>(0x1018, 3), 7U);
}

TEST_P(CoeQuirks, AStormOfEmergenciesComes) {
  Slave slave("quirks.emergency-storm = 100", GetParam());
  std::size_t came = 0;
  for (int i = 0; i < 100; ++i) {
    for (const TestBus::Emergency& emergency : slave.bus.take_emergencies()) {
      EXPECT_EQ(emergency[0] | emergency[1] << 8U, 0xFF77);
      ++came;
    }
    slave.bus.pass(7_ms);
  }
  EXPECT_NEAR(static_cast<double>(came),
              100e-9 * static_cast<double>(slave.bus.now().nanoseconds()), 20.0);
}

TEST(CoeQuirksOfARack, LateBootKeepsADeviceWithoutPower) {
  RackConfiguration configuration =
      slave_rack("tmcm-3315",
                 "name = \"x\"\nquirks = [\"late-boot\"]\n"
                 "[[event]]\nat = \"10s\"\naction = \"power-off\"\ndevice = \"x\"\n"
                 "[[event]]\nat = \"11s\"\naction = \"power-on\"\ndevice = \"x\"\n");
  EventLog log;
  Rack rack(configuration, log);
  const auto powered_at = [&](base::SimDuration time) {
    rack.advance(base::SimTime() + time);
    return rack.powered({0, 0, NetworkKind::segment});
  };
  EXPECT_FALSE(powered_at(1_ms));
  EXPECT_FALSE(powered_at(2999_ms));
  EXPECT_TRUE(powered_at(3001_ms));
  EXPECT_FALSE(powered_at(10'500_ms));
  EXPECT_FALSE(powered_at(13'900_ms)) << "late again";
  EXPECT_TRUE(powered_at(14'001_ms));
}

TEST(Quirks, AreRefusedWhereAProductDoesNotHaveThem) {
  const auto refused = [](const std::string& rack) -> std::string {
    try {
      static_cast<void>(parse_rack_file(rack, "rack.toml", devices::products()));
    } catch (const RackFileError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(refused("[[bus]]\n[[bus.device]]\ntype = \"tmcc160\"\n"
                      "quirks = [\"no-complete-acess\"]\n"),
              HasSubstr("it must be one of: abort-with-size"));
  EXPECT_THAT(refused("[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\n"
                      "quirks = [\"late-bot\"]\n"),
              HasSubstr("did you mean \"late-boot\"?"));
  EXPECT_THAT(refused("[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\n"
                      "quirks.no-boot-up-message = true\n"),
              HasSubstr("unknown key \"no-boot-up-message\""));
  EXPECT_THAT(refused("[[segment]]\n[[segment.device]]\ntype = \"tmc8461\"\n"
                      "quirks = [\"late-boot\"]\n"),
              HasSubstr("unknown key \"quirks\""));
}

TEST(Quirks, StandInTheirPageWithWhatTheyDo) {
  std::ifstream file(STATOR_SOURCE_DIR "/docs/how-to/quirks.md");
  const std::string page{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  for (const dictionary::QuirkDeclaration& quirk : dictionary::quirks()) {
    EXPECT_THAT(page, HasSubstr(fmt::format("| `{}` | {} | {} | {} | {} |", quirk.name,
                                            quirk.coe ? "yes" : "", quirk.canopen ? "yes" : "",
                                            quirk.summary, quirk.trap)));
  }
}

/// Whether a test of a suite that begins with `suite` names the quirk.
bool is_tried(const std::string& source, const std::string& suite, std::string_view quirk) {
  const std::array<std::string, 2> names{fmt::format("\"{}\\\"", quirk),
                                         fmt::format("{} = ", quirk)};
  for (std::size_t at = source.find("\nTEST"); at != std::string::npos;) {
    const std::size_t end = source.find("\nTEST", at + 1);
    const std::string test = source.substr(at, end - at);
    const std::string name = test.substr(test.find('(') + 1);
    if (name.starts_with(suite) &&
        (test.find(fmt::format("\"{}\"", quirk)) != std::string::npos ||
         test.find(names[0]) != std::string::npos || test.find(names[1]) != std::string::npos)) {
      return true;
    }
    at = end;
  }
  return false;
}

TEST(Quirks, EachIsTriedOnEveryNetworkThatHasIt) {
  std::ifstream file(STATOR_SOURCE_DIR "/tests/rack/quirks_test.cpp");
  const std::string source{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  for (const dictionary::QuirkDeclaration& quirk : dictionary::quirks()) {
    EXPECT_TRUE(!quirk.coe || is_tried(source, "Coe", quirk.name)) << quirk.name << " of CoE";
    EXPECT_TRUE(!quirk.canopen || is_tried(source, "CanOpen", quirk.name))
        << quirk.name << " of CANopen";
  }
  EXPECT_FALSE(is_tried(source, "Coe", "no-such-quirk"));
}

tests::Tmcc160Module node(const std::string& quirks) {
  const RackConfiguration rack = parse_rack_file(
      "[[bus]]\n[[bus.device]]\ntype = \"tmcc160\"\n" + quirks, "rack.toml", devices::products());
  return tests::Tmcc160Module(rack.buses[0].devices[0].setup.as<devices::Tmcc160Configuration>());
}

TEST(CanOpenQuirks, ExpeditedUploadsDoNotSayTheirSize) {
  auto module = node(R"(quirks = ["size-not-indicated"])");
  module.boot();
  EXPECT_EQ(module.sdo({0x40, 0x01, 0x10, 0}).at(0), 0x42);
}

TEST(CanOpenQuirks, AnAbortKeepsTheSizeBitsOfTheRequest) {
  auto module = node(R"(quirks = ["abort-with-size"])");
  module.boot();
  EXPECT_EQ(module.sdo({0x2F, 0xFF, 0x5F, 0, 1}).at(0), 0x83);
}

TEST(CanOpenQuirks, WhatNeedsSegmentsIsRefused) {
  auto right = node("");
  right.boot();
  EXPECT_EQ(right.sdo({0x40, 0x08, 0x10, 0}).at(0), 0x41);
  auto module = node(R"(quirks = ["no-segments"])");
  module.boot();
  EXPECT_EQ(tests::Tmcc160Module::abort_of(module.sdo({0x40, 0x08, 0x10, 0})),
            AbortCode::command_specifier_unknown);
}

/// A request with as many bytes as there are, and the first byte of its answer; 0 if none came.
unsigned short_request(tests::Tmcc160Module& module, std::initializer_list<unsigned> bytes) {
  module.frames.clear();
  module.send(can::data_frame(0x601, bytes));
  module.wait(3);
  return module.frames.empty() ? 0U : std::to_integer<unsigned>(module.frames.front().data[0]);
}

TEST(CanOpenQuirks, RequestsWithoutTheBytesThatCarryNothingAreTaken) {
  auto right = node("");
  right.boot();
  EXPECT_EQ(short_request(right, {0x40, 0x00, 0x10, 0}), 0U) << "CiA 301: eight bytes";
  EXPECT_THAT(right.sentences.back(), HasSubstr("has 4 data bytes, must have 8"));
  auto module = node(R"(quirks = ["short-sdo"])");
  module.boot();
  EXPECT_EQ(short_request(module, {0x40, 0x00, 0x10, 0}), 0x43U) << "upload";
  EXPECT_EQ(short_request(module, {0x40, 0x08, 0x10, 0}), 0x41U) << "a segmented one";
  EXPECT_EQ(short_request(module, {0x60}), 0x01U) << "all seven letters";
  EXPECT_EQ(short_request(module, {0x2F, 0x60, 0x60, 0, 3}), 0x60U) << "expedited download";
  EXPECT_EQ(module.read(0x6060), 3);
  EXPECT_EQ(short_request(module, {0x20, 0x60, 0x60, 0}), 0x60U) << "segmented download";
  EXPECT_EQ(short_request(module, {0x0D, 1}), 0x20U) << "its one segment";
  EXPECT_EQ(module.read(0x6060), 1);
  EXPECT_EQ(short_request(module, {0x40, 0x00, 0x50, 0}), 0x80U) << "refusals too";
  EXPECT_EQ(short_request(module, {}), 0U);
  EXPECT_EQ(short_request(module, {0x40, 0x00, 0x10}), 0U) << "no subindex";
  EXPECT_EQ(short_request(module, {0x2B, 0x40, 0x60, 0, 6}), 0U) << "one byte of two";
  EXPECT_EQ(module.read(0x6040), 0);
}

TEST(CanOpenQuirks, BlockTransferIsRefusedAndSegmentsAreTaken) {
  // Initiate block upload of the EDS, 127 segments a block, no CRC. A TMCC160 has none anyway; what
  // a node does that has is in tests/canopen/sdo_block_test.cpp.
  constexpr std::array<std::uint8_t, 8> kBlockUpload{0xA0, 0x21, 0x10, 0, 127};
  auto module = node("eds = true\nquirks = [\"no-block-transfer\"]");
  module.boot();
  EXPECT_EQ(tests::Tmcc160Module::abort_of(module.sdo(kBlockUpload)),
            AbortCode::command_specifier_unknown);
  EXPECT_EQ(module.sdo({0x40, 0x21, 0x10, 0}).at(0), 0x41) << "segments are the way back";
}

TEST(CanOpenQuirks, LateBootKeepsANodeSilent) {
  RackConfiguration configuration =
      parse_rack_file("[[bus]]\n[[bus.device]]\ntype = \"tmcc160\"\nquirks = [\"late-boot\"]\n",
                      "rack.toml", devices::products());
  EventLog log;
  Rack rack(configuration, log);
  bench::LocalCanPort port(rack, 0, configuration.cycle, configuration.step);
  port.wait(2'999_ms);
  EXPECT_FALSE(port.receive());
  port.wait(600_ms);
  const auto boot_up = port.receive();
  ASSERT_TRUE(boot_up);
  EXPECT_EQ(boot_up->frame, can::data_frame(0x701, {0}));
}

TEST(CanOpenQuirks, TheToggleBitStaysZero) {
  auto module = node("eds = true\nquirks = [\"toggle-stuck\"]");
  module.boot();
  EXPECT_EQ(module.sdo({0x40, 0x21, 0x10, 0}).at(0), 0x41);
  EXPECT_EQ(module.sdo({0x60}).at(0) & 0x10U, 0U);
  EXPECT_EQ(module.sdo({0x70}).at(0) & 0xF0U, 0U) << "10h would be right";
}

TEST(CanOpenQuirks, AnSdoIsAnsweredAfterItsTime) {
  auto module = node("quirks.slow-sdo = \"30ms\"");
  module.boot();
  module.send(can::data_frame(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0}));
  module.wait(28);
  EXPECT_TRUE(module.frames.empty());
  module.wait(3);
  ASSERT_EQ(module.frames.size(), 1U);
  EXPECT_EQ(module.frames[0].identifier, 0x581U);
}

TEST(CanOpenQuirks, OnlyTheFirstPdoCanBeMadeValid) {
  auto module = node(R"(quirks = ["one-pdo"])");
  module.boot();
  EXPECT_EQ(module.read(0x1400, 1) & 0x80000000, 0);
  EXPECT_NE(module.read(0x1401, 1) & 0x80000000, 0);
  EXPECT_EQ(module.write(0x1401, 1, module.read(0x1401, 1) & 0x7FFFFFFF),
            AbortCode::value_range_exceeded);
}

TEST(CanOpenQuirks, TheMappingCannotBeWritten) {
  auto module = node(R"(quirks = ["fixed-mapping"])");
  module.boot();
  EXPECT_EQ(module.write(0x1400, 1, module.read(0x1400, 1) | 0x80000000),
            tests::Tmcc160Module::kNoError);
  EXPECT_EQ(module.write(0x1600, 0, 0), AbortCode::read_only);
}

TEST(CanOpenQuirks, TheNodeIsThereWithoutABootUpMessage) {
  auto module = node(R"(quirks = ["no-boot-up-message"])");
  module.wait(502);
  EXPECT_TRUE(module.frames.empty());
  EXPECT_EQ(module.sdo({0x40, 0x00, 0x10, 0}).size(), 8U);
}

TEST(CanOpenQuirks, TheDictionaryTellsAnotherIdentity) {
  auto module = node("quirks = { wrong-vendor = 77, wrong-product = 55, wrong-revision = 3 }");
  module.boot();
  EXPECT_EQ(module.read(0x1018, 1), 77);
  EXPECT_EQ(module.read(0x1018, 2), 55);
  EXPECT_EQ(module.read(0x1018, 3), 3);
}

TEST(CanOpenQuirks, AStormOfEmergenciesComes) {
  auto module = node("quirks.emergency-storm = 50");
  module.boot();
  module.take_emergencies();
  module.wait(1000);
  const std::vector<std::string> came = module.take_emergencies();
  EXPECT_NEAR(static_cast<double>(came.size()), 50.0, 1.0);
  ASSERT_FALSE(came.empty());
  EXPECT_THAT(came.front(), HasSubstr("77 FF 80"));
}

}  // namespace
}  // namespace stator::rack
