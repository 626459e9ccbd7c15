// A CANopen device of one's own: a probe whose position goes out by TPDO 1 whenever it has changed.
// Node, SDO server, PDOs with their parameters, emergencies, heartbeat and the objects that say who
// it is come with what it is derived from.

#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>

#include <stator/bench.hpp>
#include <stator/canopen.hpp>

#include "bits.hpp"
#include "failed.hpp"

namespace {

using namespace stator;
using namespace base::literals;

/// What a rack file can say of one.
struct Probe {
  std::uint8_t node_id = 5;
};
constexpr std::array kRows{
    settings::whole<&Probe::node_id>("node_id", {1, 127}, "Of the probe"),
};
constexpr settings::Section<Probe> kKeys{kRows};

constexpr auto kObjects = std::to_array<dictionary::EntryDeclaration>({
    {.index = 0x6004,
     .name = "Position value",
     .type = dictionary::DataType::integer32,
     .access = dictionary::Access::read_only,
     .mapping = dictionary::PdoMapping::transmit,
     .unit = "mm"},
});

class ProbeDevice final : public product::CanOpenFirmware {
 public:
  ProbeDevice(const Probe& probe, base::EventReporter reporter)
      : CanOpenFirmware(
            {.node_id = probe.node_id, .name = "PROBE", .objects = kObjects, .period = 1_ms},
            reporter) {}

 private:
  /// It goes along at 100 mm/s.
  void tick(base::SimTime now) override {
    position_.set(static_cast<std::int32_t>(now.nanoseconds() / 10'000'000));
  }

  dictionary::Variable<std::int32_t> position_ = objects().variable<std::int32_t>(0x6004);
};

int listen_to_a_probe() {
  product::Catalogue catalogue = devices::products();
  catalogue.add(product::make<Probe, ProbeDevice>(
      {.type = "probe", .summary = "a probe", .network = product::NetworkKind::bus}, kKeys));

  const settings::Table probe{{"type", "probe"}, {"name", "probe"}, {"node_id", 9}};
  const settings::Table bus{{"device", settings::List{probe}}};
  bench::Bench bench(bench::load({{"bus", settings::List{bus}}}, catalogue));
  const rack::DeviceAddress device = bench.find("probe").value();
  const auto name = bench.upload(device, {0x1008, 0});
  if (failed(name) || failed(bench.go_operational())) {
    return 1;
  }
  std::printf("node 9 is a %.*s\n", static_cast<int>(name->size()),
              reinterpret_cast<const char*>(name->data()));
  bench.pass(100_ms);
  int values = 0;
  Bits bits;
  for (const can::TimedFrame& each : bench.frames(device.network)) {
    if (each.frame.identifier == 0x180 + 9) {
      ++values;
      bits.add(base::load_le<std::int32_t>(each.frame.payload(), 0));
    }
  }
  std::printf("%d values came by TPDO 1; it stands at %g mm\n", values,
              bench.signal("probe.position_value").read());
  bits.print();
  return values > 0 ? 0 : 1;
}

}  // namespace

int main() {
  try {
    return listen_to_a_probe();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
