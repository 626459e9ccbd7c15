#include "stator/devices/generic/terminal.hpp"

#include <algorithm>
#include <span>
#include <string>

#include "stator/base/byte_order.hpp"
#include "stator/devices/generic/signals.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/ethercat/units/fmmu.hpp"

namespace stator::devices::generic {

namespace {

using dictionary::Entry;
using ethercat::ImportedPdo;
using ethercat::ImportedSlave;

constexpr std::uint16_t kDeviceEmulation = 0x0100;  ///< SII word 0: no host interface
constexpr std::uint16_t kProcessMemory = 0x1000;
constexpr std::uint8_t kOutputControl = 0x44;  ///< three buffers, the master writes, watchdog
constexpr std::uint8_t kInputControl = 0x00;
constexpr std::size_t kBits = 8;

/// Bits that the PDOs of a sync manager have by default.
std::size_t bits_of(std::span<const ImportedPdo> pdos, std::uint8_t channel) {
  std::size_t bits = 0;
  for (const ImportedPdo& pdo : pdos) {
    if (pdo.sync_manager == channel) {
      for (const ImportedPdo::Entry& entry : pdo.entries) {
        bits += entry.bits;
      }
    }
  }
  return bits;
}

std::span<const ImportedPdo> pdos_of(const ImportedSlave& file, std::uint8_t type) {
  return type == ethercat::kProcessOutputs ? file.receive_pdos : file.transmit_pdos;
}

ethercat::SlaveControllerConfiguration controller_of(const ImportedSlave& file,
                                                     const TerminalConfiguration& configuration) {
  ethercat::SlaveControllerConfiguration chip;
  chip.one_byte_sync_managers = true;
  chip.clock_deviation_ppb = configuration.clock_deviation_ppb;
  chip.sync_latch_reset = 0;
  chip.port_descriptor = 0;
  for (std::size_t port = 0; port < file.description.port_physics.size(); ++port) {
    const char physics = file.description.port_physics[port];
    const unsigned code = physics == 'Y' ? 3U : physics == ' ' ? 0U : 2U;
    chip.port_descriptor |= static_cast<std::uint8_t>(code << (2 * port));
  }
  return chip;
}

void copy(std::span<const std::byte> image, std::size_t bit, std::size_t bits, Entry& entry) {
  std::array<std::byte, sizeof(std::uint64_t)> value{};
  ethercat::copy_bits(value.data(), 0, image.data(), bit, bits);
  auto number = base::load_le<std::uint64_t>(value.data());
  if (dictionary::is_signed(entry.type()) && bits < 64 && (number >> (bits - 1)) != 0) {
    number |= ~std::uint64_t{0} << bits;
  }
  entry.set_value(number);
}

}  // namespace

ethercat::SiiContents sii_contents(const ImportedSlave& file) {
  ethercat::SiiContents contents;
  const ethercat::DeviceDescription& description = file.description;
  contents.vendor_id = description.vendor_id;
  contents.product_code = description.product_code;
  contents.revision = description.revision;
  contents.serial_number = description.serial_number;
  contents.station_alias = description.station_alias;
  contents.pdi_control = kDeviceEmulation;
  contents.size_kbit = std::max<std::uint16_t>(description.sii_size_kbit, 16);
  contents.grows = true;
  contents.group = description.group;
  contents.order_code = description.order_code;
  contents.name = description.name;
  contents.distributed_clocks = !file.clock_modes.empty();
  std::uint32_t next = kProcessMemory;
  for (std::size_t i = 0; i < file.sync_managers.size(); ++i) {
    const ethercat::ImportedSyncManager& manager = file.sync_managers[i];
    const auto channel = static_cast<std::uint8_t>(i);
    const bool outputs = manager.type == ethercat::kProcessOutputs;
    const std::size_t bits = bits_of(pdos_of(file, manager.type), channel);
    const auto length = static_cast<std::uint16_t>((bits + kBits - 1) / kBits);
    // The controller has no digital outputs in its registers (0F00h), only process memory.
    const std::uint16_t start =
        manager.start >= kProcessMemory ? manager.start : static_cast<std::uint16_t>(next);
    next = std::max<std::uint32_t>(next, start + 3U * length);
    contents.sync_managers.push_back({.start = start,
                                      .length = length,
                                      .control = manager.control != 0
                                                     ? manager.control
                                                     : (outputs ? kOutputControl : kInputControl),
                                      .enable = static_cast<std::uint8_t>(length != 0 ? 1 : 0),
                                      .type = manager.type});
    if (manager.type == ethercat::kProcessOutputs || manager.type == ethercat::kProcessInputs) {
      contents.fmmu_usage.push_back(outputs ? 1 : 2);
    }
  }
  const auto append = [](std::span<const ImportedPdo> pdos, std::vector<ethercat::SiiPdo>& out) {
    constexpr std::uint8_t kNotAssigned = 0xFF;
    for (const ImportedPdo& pdo : pdos) {
      ethercat::SiiPdo listed{.index = pdo.index,
                              .sync_manager = pdo.sync_manager.value_or(kNotAssigned),
                              .name = pdo.name};
      for (const ImportedPdo::Entry& entry : pdo.entries) {
        listed.entries.push_back(
            {.index = entry.index,
             .subindex = entry.subindex,
             .data_type =
                 static_cast<std::uint8_t>(entry.type ? *entry.type : dictionary::DataType{}),
             .bits = static_cast<std::uint8_t>(std::min<unsigned>(entry.bits, 0xFF)),
             .name = entry.name});
      }
      out.push_back(std::move(listed));
    }
  };
  append(file.transmit_pdos, contents.tx_pdos);
  append(file.receive_pdos, contents.rx_pdos);
  return contents;
}

Terminal::Terminal(const ImportedSlave& file, const TerminalConfiguration& configuration,
                   base::EventReporter reporter)
    : file_(file), description_(file.description), controller_(controller_of(file, configuration)) {
  description_.serial_number = configuration.serial_number;
  description_.station_alias = configuration.station_alias;
  description_.coe = false;
  dictionary_.add(file.objects.rows());
  dictionary_.finish();
  lay_out();
  inputs_.bind(dictionary_, [](const Entry&) { return false; });
  controller_.set_event_reporter(reporter);
  controller_.set_memory_partner(this);
  controller_.load_sii(sii_image());
}

std::vector<std::byte> Terminal::sii_image() const {
  ethercat::SiiContents contents = sii_contents(file_);
  contents.serial_number = description_.serial_number;
  contents.station_alias = description_.station_alias;
  return ethercat::compose_sii_image(contents);
}

void Terminal::lay_out() {
  for (std::size_t i = 0; i < file_.sync_managers.size(); ++i) {
    const std::uint8_t type = file_.sync_managers[i].type;
    if (type != ethercat::kProcessOutputs && type != ethercat::kProcessInputs) {
      continue;
    }
    Area area{.channel = static_cast<unsigned>(i), .outputs = type == ethercat::kProcessOutputs};
    std::size_t bit = 0;
    for (const ImportedPdo& pdo : pdos_of(file_, type)) {
      if (pdo.sync_manager != i) {
        continue;
      }
      for (const ImportedPdo::Entry& entry : pdo.entries) {
        Entry* object = dictionary_.find(entry.index, entry.subindex);
        if (object != nullptr && object->bits() == entry.bits && entry.bits <= 64) {
          area.items.push_back({.entry = object, .bit = bit, .bits = entry.bits});
        }
        bit += entry.bits;
      }
    }
    area.bytes = (bit + kBits - 1) / kBits;
    // Bits are moved as words: some bytes more.
    area.image.resize(area.bytes + sizeof(std::uint64_t) + 1);
    areas_.push_back(std::move(area));
  }
}

std::uint16_t Terminal::start_of(const Area& area) const {
  std::array<std::byte, 2> start{};
  controller_.peek(
      static_cast<std::uint16_t>(ethercat::register_address::kSyncManagers + 8 * area.channel),
      start);
  return base::load_le<std::uint16_t>(start, 0);
}

void Terminal::after_bus_write(base::SimTime /*time*/, std::uint16_t address, std::size_t length) {
  for (Area& area : areas_) {
    const std::uint16_t start = start_of(area);
    if (!area.outputs || area.bytes == 0 || address >= start + area.bytes ||
        address + length <= start) {
      continue;
    }
    controller_.read_process_data(start, std::span(area.image).first(area.bytes));
    controller_.finish_process_data(start, area.bytes);
    for (const Item& item : area.items) {
      copy(area.image, item.bit, item.bits, *item.entry);
    }
  }
}

void Terminal::before_bus_read(base::SimTime /*time*/, std::uint16_t address, std::size_t length) {
  for (Area& area : areas_) {
    const std::uint16_t start = start_of(area);
    if (area.outputs || area.bytes == 0 || address >= start + area.bytes ||
        address + length <= start) {
      continue;
    }
    std::ranges::fill(area.image, std::byte{0});
    for (const Item& item : area.items) {
      std::array<std::byte, sizeof(std::uint64_t)> value{};
      base::store_le(value.data(), item.entry->value());
      ethercat::copy_bits(area.image.data(), item.bit, value.data(), 0, item.bits);
    }
    controller_.write_process_data(start, std::span(area.image).first(area.bytes));
    controller_.finish_process_data(start, area.bytes);
  }
}

void Terminal::al_status_changed(base::SimTime /*time*/, std::uint16_t al_status) {
  constexpr unsigned kState = 0x0F;
  if (static_cast<ethercat::AlState>(al_status & kState) == ethercat::AlState::operational) {
    return;
  }
  for (const Area& area : areas_) {
    for (const Item& item : area.items) {
      if (area.outputs) {
        item.entry->set_value(0);
      }
    }
  }
}

void Terminal::controller_reset(base::SimTime /*time*/) {
  dictionary_.reset_values();
  inputs_.restore();
}

// A reset by register is over when it is asked for: there is no firmware to start again.
void Terminal::handle_bus_events(base::SimTime /*now*/) {
  static_cast<void>(controller_.take_reset_request());
}

void Terminal::set_power(bool /*on*/, base::SimTime now) {
  controller_.advance(now);
  static_cast<void>(controller_.take_reset_request());
}

double Terminal::al_state() const {
  std::array<std::byte, 1> status{};
  controller_.peek(ethercat::register_address::kAlStatus, status);
  return std::to_integer<unsigned>(status[0]);
}

std::vector<product::Signal> Terminal::signals() const {
  std::vector<product::Signal> all = device_signals(dictionary_, {});
  all.push_back({"al_state", "", base::SignalReader::bind<&Terminal::al_state>(*this)});
  return all;
}

std::vector<product::Input> Terminal::inputs() {
  std::vector<product::Input> all;
  inputs_.append(all);
  all.push_back(clock_deviation_input());
  return all;
}

}  // namespace stator::devices::generic
