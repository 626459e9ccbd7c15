// An EtherCAT device of one's own: a lamp that a master dims. Its class says what it does, a table
// which objects it has; slave controller, state machine, mailbox, process data, EEPROM and the keys
// of a rack file come with what it is derived from.

#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>

#include <stator/bench.hpp>
#include <stator/device.hpp>

#include "bits.hpp"
#include "failed.hpp"

namespace {

using namespace stator;
using namespace base::literals;
using dictionary::Access;
using dictionary::DataType;
using dictionary::PdoMapping;

/// What a rack file can say of one.
struct Lamp {
  product::CoeOptions coe{};
  double watts = 5.0;
};
constexpr std::array kRows{
    settings::keys<product::kCoeKeys, &Lamp::coe>(),
    settings::number<&Lamp::watts>("watts", {0, 100, "W"}, "Of the lamp"),
};
constexpr settings::Section<Lamp> kKeys{kRows};

constexpr auto kObjects = std::to_array<dictionary::EntryDeclaration>({
    {.index = 0x6000,
     .name = "Light",
     .type = DataType::unsigned16,
     .access = Access::read_only,
     .mapping = PdoMapping::transmit,
     .unit = "lm"},
    {.index = 0x7000,
     .name = "Dimming",
     .type = DataType::unsigned16,
     .mapping = PdoMapping::receive,
     .range = dictionary::Range{0, 100},
     .unit = "%"},
});

class LampDevice final : public product::EtherCatFirmware {
 public:
  LampDevice(const Lamp& lamp, base::EventReporter reporter)
      : EtherCatFirmware({.vendor = 0x1234,
                          .code = 1,
                          .name = "LAMP",
                          .objects = kObjects,
                          .period = 1_ms,
                          .coe = lamp.coe},
                         reporter),
        watts_(lamp.watts),
        light_(objects().variable<std::uint16_t>(0x6000)),
        dimming_(objects().variable<std::uint16_t>(0x7000)) {}

 private:
  void tick(base::SimTime /*now*/) override {
    light_.set(static_cast<std::uint16_t>(watts_ * dimming_.get()));
  }

  double watts_;
  dictionary::Variable<std::uint16_t> light_;
  dictionary::Variable<std::uint16_t> dimming_;
};

int dim_a_lamp() {
  product::Catalogue catalogue = devices::products();
  catalogue.add(product::make<Lamp, LampDevice>(
      {.type = "lamp", .summary = "a lamp", .network = product::NetworkKind::segment}, kKeys));

  const settings::Table lamp{{"type", "lamp"}, {"name", "lamp"}, {"watts", 7.5}};
  const settings::Table segment{{"device", settings::List{lamp}}};
  bench::Bench bench(bench::load({{"segment", settings::List{segment}}}, catalogue));
  const rack::DeviceAddress device = bench.find("lamp").value();
  if (failed(bench.go_operational())) {
    return 1;
  }
  Bits bits;
  for (const int percent : {0, 40, 100}) {
    const std::array value{static_cast<std::byte>(percent), std::byte{0}};
    if (failed(bench.download(device, {0x7000, 0}, value))) {
      return 1;
    }
    bench.pass(5_ms);
    const double light = bench.signal("lamp.light").read();
    std::printf("%3d %% makes %g %s\n", percent, light, bench.signal("lamp.light").unit.c_str());
    bits.add(light);
  }
  bits.print();
  return 0;
}

}  // namespace

int main() {
  try {
    return dim_a_lamp();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
