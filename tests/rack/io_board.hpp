#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "rack/fault_bench.hpp"
#include "source_paths.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmc8461/mfc_configuration_keys.hpp"
#include "stator/mfc/block/memory_map.hpp"
#include "stator/rack/file/rack_file_steps.hpp"

namespace stator::rack {

/// The rack racks/io-board.toml without its events, and a master that has brought it to
/// Operational. Registers are process data; nothing else reaches the chip.
class IoBoard : public tests::WithFaults<tests::SegmentBench> {
 public:
  static RackConfiguration without_events() {
    RackConfiguration rack =
        load_rack_file(STATOR_SOURCE_DIR "/racks/io-board.toml", devices::products());
    rack.events.clear();
    return rack;
  }

  explicit IoBoard(RackConfiguration rack_configuration = without_events())
      : WithFaults(std::move(rack_configuration)) {
    bring_to_operational(1);
  }

  /// A register the master writes, from the next cycle on.
  void put(std::string_view name, std::uint64_t value) {
    const auto place = find(0, name);
    ASSERT_TRUE(place) << name;
    for (unsigned byte = 0; byte < place->size; ++byte) {
      master.outputs(0)[place->offset + byte] = static_cast<std::byte>(value >> (8 * byte));
    }
  }
  /// A register as the last cycle has brought it.
  [[nodiscard]] std::uint64_t get(std::string_view name) {
    const auto place = find(1, name);
    EXPECT_TRUE(place) << name;
    std::uint64_t value = 0;
    for (unsigned byte = place ? place->size : 0; byte-- > 0;) {
      value = value << 8U | std::to_integer<std::uint64_t>(master.inputs(0)[place->offset + byte]);
    }
    return value;
  }
  [[nodiscard]] std::int32_t get_signed(std::string_view name) {
    return static_cast<std::int32_t>(get(name));
  }
  void cycles(unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      const auto done = master.run_cycle();
      ASSERT_TRUE(done) << done.error().text;
    }
  }
  /// The master is silent.
  void silence(base::SimDuration duration) { port.wait(duration); }

  /// One datagram of the SPI master with chip select `select`; the answer to it.
  std::uint64_t spi(unsigned select, std::uint64_t data, unsigned bits) {
    put("SPI_CONF", select);
    put("SPI_LENGTH", bits - 1);
    put("SPI_TX_DATA", data);
    cycles(3);  // the data go first, so the settings hold from the second on
    return get("SPI_RX_DATA") & ((std::uint64_t{1} << bits) - 1);
  }
  /// One command of the I2C master; the status behind it. The command comes before address and data
  /// in process data, so these go a cycle ahead.
  std::uint64_t i2c(std::uint64_t command) {
    cycles(1);
    put("I2C_CONTROL", command);
    cycles(1);
    put("I2C_CONTROL", 0);
    cycles(1);
    return get("I2C_STATUS");
  }

  [[nodiscard]] double signal(const std::string& name) {
    return SegmentBench::signal("io." + name);
  }
  void input(const std::string& name, double value) {
    rack.apply(InputEvent{{0, 0}, name, value}, port.now());
  }

 private:
  struct Place {
    std::size_t offset = 0;
    unsigned size = 0;
  };

  [[nodiscard]] std::optional<Place> find(unsigned block, std::string_view name) const {
    for (const mfc::MappedRegister& mapped : map_.registers(block)) {
      if (mfc::kRegisters[mapped.number].name == name) {
        return Place{mapped.address - map_.block(block).start, mapped.size};
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] static mfc::Configuration configuration() {
    const std::string path = STATOR_SOURCE_DIR "/examples/mfc/io-board.toml";
    devices::tmc8461::MfcConfigurationFile file;
    read_tree(
        parse_rack_tree(read_rack_text(path), path), path, "the configuration",
        [&](settings::Reader& root) { devices::tmc8461::read_mfc_configuration(root, file); });
    return file.configuration;
  }

  mfc::MemoryMap map_{configuration()};
};

}  // namespace stator::rack
