#include "stator/web/stream/traffic_map.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/canopen/cob_id.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/stack/pdo_configuration.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/named_device.hpp"
#include "stator/rack/core/wiring.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"
#include "stator/web/job.hpp"

namespace stator::web {

namespace {

using dictionary::Dictionary;
using dictionary::Entry;

constexpr std::size_t kMostMapped = 256;

/// Values of the entries 1 to n of an object whose entry 0 holds n.
template <typename Visit>
void for_each_value(const Dictionary& objects, std::uint16_t index, Visit visit) {
  const Entry* count = objects.find(index, 0);
  if (count == nullptr) {
    return;
  }
  for (std::uint64_t i = 1; i <= std::min<std::uint64_t>(count->value(), 0xFE); ++i) {
    if (const Entry* entry = objects.find(index, static_cast<std::uint8_t>(i))) {
      visit(entry->value());
    }
  }
}

void append_mapping(const Dictionary& objects, std::uint16_t mapping,
                    std::vector<MappedObject>& mapped) {
  std::size_t bit = mapped.empty() ? 0 : mapped.back().bit + mapped.back().bits;
  for_each_value(objects, mapping, [&](std::uint64_t value) {
    const ethercat::MappingEntry entry = ethercat::MappingEntry::decode(value);
    if (mapped.size() < kMostMapped) {
      mapped.push_back(
          {.index = entry.index, .subindex = entry.subindex, .bit = bit, .bits = entry.bits});
    }
    bit += entry.bits;
  });
}

std::vector<MappedObject> assigned(const Dictionary* objects, std::uint16_t assignment) {
  std::vector<MappedObject> mapped;
  if (objects != nullptr) {
    for_each_value(*objects, assignment, [&](std::uint64_t pdo) {
      append_mapping(*objects, static_cast<std::uint16_t>(pdo), mapped);
    });
  }
  return mapped;
}

void read_slave(const ethercat::SlaveController& controller, SlaveMap& slave) {
  namespace address = ethercat::register_address;
  std::array<std::byte, 2> station{};
  controller.peek(address::kStationAddress, station);
  slave.station = base::load_le<std::uint16_t>(station, 0);
  slave.fmmus.clear();
  for (unsigned i = 0; i < ethercat::SlaveController::kMaximumFmmus; ++i) {
    std::array<std::byte, ethercat::Fmmu::kRegisterLength> registers{};
    controller.peek(
        static_cast<std::uint16_t>(address::kFmmus + i * ethercat::Fmmu::kRegisterLength),
        registers);
    if (const auto fmmu = ethercat::Fmmu::decode(registers)) {
      slave.fmmus.push_back(*fmmu);
    }
  }
  for (std::size_t i = 0; i < slave.areas.size(); ++i) {
    std::array<std::byte, ethercat::SyncManager::kRegisterLength> registers{};
    controller.peek(static_cast<std::uint16_t>(address::kSyncManagers +
                                               i * ethercat::SyncManager::kRegisterLength),
                    registers);
    slave.areas[i] = {.start = base::load_le<std::uint16_t>(registers, 0),
                      .length = base::load_le<std::uint16_t>(registers, 2)};
  }
  slave.outputs = assigned(slave.objects, ethercat::kOutputAssignment);
  slave.inputs = assigned(slave.objects, ethercat::kInputAssignment);
}

/// `communication` is 1400h or 1800h, `mapping` 1600h or 1A00h.
void read_pdos(const Dictionary& objects, const char* kind, std::uint16_t communication,
               std::uint16_t mapping, NodeMap& node) {
  constexpr std::uint16_t kMostPdos = 16;
  for (std::uint16_t i = 0; i < kMostPdos; ++i) {
    const Entry* cob_id = objects.find(static_cast<std::uint16_t>(communication + i), 1);
    if (cob_id == nullptr || (cob_id->value() & canopen::kCobIdInvalid) != 0) {
      continue;
    }
    NodeMap::Pdo pdo{.name = fmt::format("{}{}", kind, i + 1)};
    append_mapping(objects, static_cast<std::uint16_t>(mapping + i), pdo.objects);
    node.pdos[canopen::can_id_of(cob_id->value())] = std::move(pdo);
  }
}

void read_node(const tmcl::Firmware* firmware, NodeMap& node) {
  node.pdos.clear();
  if (node.objects != nullptr) {
    read_pdos(*node.objects, "RPDO", 0x1400, 0x1600, node);
    read_pdos(*node.objects, "TPDO", 0x1800, 0x1A00, node);
  }
  node.tmcl_requests.clear();
  if (firmware != nullptr) {
    using tmcl::GlobalParameter;
    const auto configured = [firmware](GlobalParameter parameter) {
      return static_cast<std::uint32_t>(firmware->configuration(parameter));
    };
    node.tmcl_requests.push_back(configured(GlobalParameter::can_identifier));
    if (const auto second = configured(GlobalParameter::can_secondary_identifier); second != 0) {
      node.tmcl_requests.push_back(second);
    }
    node.tmcl_replies = configured(GlobalParameter::can_reply_identifier);
  }
}

std::uint8_t node_id_of(const product::Setup& setup) {
  const std::uint8_t* const node_id = setup.node_id();
  return node_id != nullptr ? *node_id : std::uint8_t{0};
}

/// Where each device of a segment stands in the order in which frames pass them.
std::vector<std::size_t> places_of(const rack::SegmentConfiguration& segment) {
  const std::vector<std::size_t> order = rack::frame_order(segment);
  std::vector<std::size_t> places(segment.devices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    places[order[i]] = i;
  }
  return places;
}

class TrafficMapJob final : public LookJob {
 public:
  TrafficMapJob(const State& state, TrafficMap& result)
      : state_(state), result_(result), map_(empty_traffic_map(state)) {
    for (const rack::SegmentConfiguration& segment : state.configuration().segments) {
      places_.push_back(places_of(segment));
    }
  }

  bool look(const rack::View& rack, base::SimTime /*now*/) override {
    const auto& devices = state_.devices();
    if (device_ < devices.size()) {
      const rack::DeviceAddress address = devices[device_++].address;
      if (address.kind == rack::NetworkKind::segment) {
        read_slave(rack.slave(address).controller(),
                   map_.segments[address.network][places_[address.network][address.device]]);
      } else {
        read_node(rack.device(address).tmcl_firmware(),
                  map_.buses[address.network][address.device]);
      }
    }
    return device_ >= devices.size();
  }

  Response response() override {
    result_ = std::move(map_);
    return {};
  }

 private:
  const State& state_;
  TrafficMap& result_;
  TrafficMap map_;
  std::vector<std::vector<std::size_t>> places_;  ///< of each segment
  std::size_t device_ = 0;
};

}  // namespace

TrafficMap empty_traffic_map(const State& state) {
  TrafficMap map;
  const rack::RackConfiguration& configuration = state.configuration();
  map.segments.resize(configuration.segments.size());
  map.buses.resize(configuration.buses.size());
  std::vector<std::vector<std::size_t>> places;
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    places.push_back(places_of(configuration.segments[i]));
    map.segments[i].resize(places[i].size());
  }
  for (const DeviceRecord& device : state.devices()) {
    if (device.address.kind == rack::NetworkKind::segment) {
      const std::size_t network = device.address.network;
      map.segments[network][places[network][device.address.device]] = {.name = device.name,
                                                                       .objects = device.objects};
      continue;
    }
    const rack::BusConfiguration& bus = configuration.buses[device.address.network];
    map.buses[device.address.network].push_back(
        {.name = device.name,
         .objects = device.objects,
         .node_id = node_id_of(bus.devices[device.address.device].setup)});
  }
  return map;
}

std::unique_ptr<Job> make_traffic_map_job(const State& state, TrafficMap& result) {
  return std::make_unique<TrafficMapJob>(state, result);
}

}  // namespace stator::web
