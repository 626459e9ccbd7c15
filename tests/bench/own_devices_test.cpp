// Devices of a program's own, of an outline, in a rack with masters.
#include <array>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/base/byte_order.hpp"
#include "stator/bench/bench.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/product/shell/canopen_firmware.hpp"
#include "stator/product/shell/coe_keys.hpp"
#include "stator/product/shell/ethercat_firmware.hpp"
#include "stator/settings/key.hpp"

namespace stator::bench {
namespace {

using namespace base::literals;
using dictionary::Access;
using dictionary::DataType;
using dictionary::EntryDeclaration;
using dictionary::PdoMapping;
using settings::List;
using settings::Table;
using testing::ElementsAre;

struct Lamp {
  product::CoeOptions coe{};
  double watts = 5.0;
};
constexpr std::array kLampRows{
    settings::keys<product::kCoeKeys, &Lamp::coe>(),
    settings::number<&Lamp::watts>("watts", {0, 100, "W"}, "Of the lamp"),
};
constexpr settings::Section<Lamp> kLampKeys{kLampRows};
constexpr auto kLampObjects = std::to_array<EntryDeclaration>({
    {.index = 0x6000,
     .name = "Light",
     .type = DataType::unsigned16,
     .access = Access::read_only,
     .mapping = PdoMapping::transmit,
     .unit = "lm"},
    {.index = 0x7000,
     .name = "Dimming",
     .type = DataType::unsigned16,
     .mapping = PdoMapping::receive},
});

class LampDevice final : public product::EtherCatFirmware {
 public:
  LampDevice(const Lamp& lamp, base::EventReporter reporter)
      : EtherCatFirmware(
            {.vendor = 0x1234, .code = 7, .name = "LAMP", .objects = kLampObjects, .coe = lamp.coe},
            reporter),
        watts_(lamp.watts) {}

 private:
  void tick(base::SimTime /*now*/) override {
    light_.set(static_cast<std::uint16_t>(watts_ * dimming_.get()));
  }

  double watts_;
  dictionary::Variable<std::uint16_t> light_ = objects().variable<std::uint16_t>(0x6000);
  dictionary::Variable<std::uint16_t> dimming_ = objects().variable<std::uint16_t>(0x7000);
};

struct Probe {
  std::uint8_t node_id = 5;
};
constexpr std::array kProbeRows{
    settings::whole<&Probe::node_id>("node_id", {1, 127}, "Of the probe"),
};
constexpr settings::Section<Probe> kProbeKeys{kProbeRows};
constexpr auto kProbeObjects = std::to_array<EntryDeclaration>({
    {.index = 0x6004,
     .name = "Position value",
     .type = DataType::integer32,
     .access = Access::read_only,
     .mapping = PdoMapping::transmit},
    {.index = 0x6005,
     .name = "Position scale",
     .type = DataType::integer16,
     .mapping = PdoMapping::receive,
     .default_value = 1},
    {.index = 0x6006,
     .name = "Position raw",
     .type = DataType::integer64,
     .access = Access::read_only,
     .mapping = PdoMapping::transmit},
});

class ProbeDevice final : public product::CanOpenFirmware {
 public:
  ProbeDevice(const Probe& probe, base::EventReporter reporter)
      : CanOpenFirmware({.node_id = probe.node_id,
                         .vendor = 0x4321,
                         .code = 8,
                         .name = "PROBE",
                         .objects = kProbeObjects},
                        reporter) {}

 private:
  void tick(base::SimTime now) override {
    const auto steps = static_cast<std::int32_t>(now.nanoseconds() / 10'000'000);
    position_.set(steps * scale_.get());
  }

  dictionary::Variable<std::int32_t> position_ = objects().variable<std::int32_t>(0x6004);
  dictionary::Variable<std::int16_t> scale_ = objects().variable<std::int16_t>(0x6005);
};

product::Catalogue catalogue() {
  product::Catalogue all;
  all.add(product::make<Lamp, LampDevice>(
      {.type = "lamp", .network = product::NetworkKind::segment}, kLampKeys));
  all.add(product::make<Probe, ProbeDevice>({.type = "probe", .network = product::NetworkKind::bus},
                                            kProbeKeys));
  return all;
}

rack::RackConfiguration lamp_rack() {
  const Table lamp{{"type", "lamp"}, {"name", "lamp"}, {"watts", 7.5}};
  return load({{"segment", List{Table{{"device", List{lamp}}}}}}, catalogue());
}

rack::RackConfiguration probe_rack() {
  const Table probe{{"type", "probe"}, {"name", "probe"}, {"node_id", 9}};
  return load({{"bus", List{Table{{"device", List{probe}}}}}}, catalogue());
}

/// An object's value as a number.
std::uint64_t upload(Bench& bench, const char* device, master::ObjectAddress object) {
  const auto data = bench.upload(*bench.find(device), object);
  return data ? master::load_number(*data) : ~std::uint64_t{0};
}

TEST(OwnDevices, ALampOnEtherCatIsDimmedByProcessData) {
  Bench bench(lamp_rack());
  const auto reached = bench.go_operational();
  ASSERT_TRUE(reached) << reached.error().text;
  ASSERT_TRUE(
      bench.download(*bench.find("lamp"), {0x7000, 0}, std::array{std::byte{40}, std::byte{0}}));
  bench.pass(3_ms);
  EXPECT_EQ(bench.signal("lamp.light").read(), 300.0);
  EXPECT_EQ(bench.signal("lamp.light").unit, "lm");
  EXPECT_EQ(bench.signal("lamp.dimming").read(), 40.0);
  EXPECT_EQ(upload(bench, "lamp", {0x1018, 2}), 7U);
}

TEST(OwnDevices, ALampForgetsWithItsSupply) {
  Bench bench(lamp_rack());
  ASSERT_TRUE(bench.go_operational());
  ASSERT_TRUE(
      bench.download(*bench.find("lamp"), {0x7000, 0}, std::array{std::byte{40}, std::byte{0}}));
  bench.pass(3_ms);
  bench.inject({{"kind", "power-off"}, {"device", "lamp"}, {"for", "10ms"}});
  bench.pass(20_ms);
  EXPECT_EQ(bench.signal("lamp.light").read(), 0.0);
}

TEST(OwnDevices, OutputsOfOneByteWouldDoNothing) {
  class Small final : public product::EtherCatFirmware {
   public:
    explicit Small(std::span<const EntryDeclaration> objects)
        : EtherCatFirmware({.name = "SMALL", .objects = objects}, {}) {}

   private:
    void tick(base::SimTime /*now*/) override {}
  };
  std::vector<EntryDeclaration> objects{{.index = 0x7000,
                                         .name = "Value",
                                         .type = DataType::unsigned8,
                                         .mapping = PdoMapping::receive}};
  EXPECT_THROW(Small{objects}, std::logic_error);
  objects.front().type = DataType::unsigned16;
  EXPECT_NO_THROW(Small{objects});
}

TEST(OwnDevices, AProductHasWhatMembersOfItsConfigurationSay) {
  const auto lamp = catalogue().find("lamp");
  const product::Setup setup = lamp->defaults();
  EXPECT_NE(setup.coe(), nullptr);
  EXPECT_EQ(setup.quirks(), nullptr);
  EXPECT_EQ(setup.node_id(), nullptr);
  EXPECT_EQ(lamp->identity().ports, 2U);
  EXPECT_EQ(*catalogue().find("probe")->defaults().node_id(), 5);
}

TEST(OwnDevices, AProbeOnCanSaysWhoItIs) {
  Bench bench(probe_rack());
  EXPECT_EQ(upload(bench, "probe", {0x1000, 0}), 0U);
  EXPECT_EQ(upload(bench, "probe", {0x1001, 0}), 0U);
  EXPECT_EQ(upload(bench, "probe", {0x1014, 0}), 0x89U);
  EXPECT_EQ(upload(bench, "probe", {0x1018, 0}), 4U);
  EXPECT_EQ(upload(bench, "probe", {0x1018, 1}), 0x4321U);
  EXPECT_EQ(upload(bench, "probe", {0x1018, 2}), 8U);
  const auto name = bench.upload(*bench.find("probe"), {0x1008, 0});
  ASSERT_TRUE(name);
  EXPECT_EQ(name->size(), 5U);
}

TEST(OwnDevices, ObjectsOfAProbeAreMappedInPdosOfEightBytes) {
  Bench bench(probe_rack());
  EXPECT_EQ(upload(bench, "probe", {0x1400, 1}), 0x209U);
  EXPECT_EQ(upload(bench, "probe", {0x1600, 1}), 0x60050010U);
  EXPECT_EQ(upload(bench, "probe", {0x1800, 1}), 0x189U);
  EXPECT_EQ(upload(bench, "probe", {0x1800, 2}), 255U);
  EXPECT_EQ(upload(bench, "probe", {0x1A00, 0}), 1U);
  EXPECT_EQ(upload(bench, "probe", {0x1A00, 1}), 0x60040020U);
  EXPECT_EQ(upload(bench, "probe", {0x1801, 1}), 0x289U);
  EXPECT_EQ(upload(bench, "probe", {0x1A01, 1}), 0x60060040U);
}

TEST(OwnDevices, AProbeSendsWhatHasChangedAndTakesWhatComes) {
  Bench bench(probe_rack());
  ASSERT_TRUE(bench.go_operational());
  bench.send(0, can::data_frame(0x209, std::array{std::byte{2}, std::byte{0}}));
  bench.pass(5_ms);
  bench.begin_deed();
  bench.pass(30_ms);
  std::vector<std::int32_t> steps;
  std::int32_t last = 0;
  for (std::size_t i = bench.frames_before(0); i < bench.frames(0).size(); ++i) {
    const can::Frame& frame = bench.frames(0)[i].frame;
    if (frame.identifier == 0x189) {
      const auto value = base::load_le<std::int32_t>(frame.payload(), 0);
      steps.push_back(last == 0 ? 0 : value - last);
      last = value;
    }
  }
  EXPECT_THAT(steps, ElementsAre(0, 2, 2));
  EXPECT_EQ(bench.signal("probe.position_value").read(), last);
}

TEST(OwnDevices, WhatGoesIntoNoPdoIsAMistakeOfTheDeclaration) {
  class Many final : public product::CanOpenFirmware {
   public:
    explicit Many(std::span<const EntryDeclaration> objects)
        : CanOpenFirmware({.name = "MANY", .objects = objects}, {}) {}

   private:
    void tick(base::SimTime /*now*/) override {}
  };
  std::vector<EntryDeclaration> objects;
  for (std::uint16_t i = 0; i < 5; ++i) {
    objects.push_back({.index = static_cast<std::uint16_t>(0x6000 + i),
                       .name = "Value",
                       .type = DataType::unsigned64,
                       .mapping = PdoMapping::transmit});
  }
  EXPECT_THROW(Many{objects}, std::logic_error);
  objects.pop_back();
  EXPECT_NO_THROW(Many{objects});
}

}  // namespace
}  // namespace stator::bench
