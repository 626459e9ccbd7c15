// Objects and emergencies of the devices of a bench, whatever network carries them.
#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/bench/bench_masters.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/master/can_sdo_client.hpp"
#include "stator/master/cia402/slave_drive_port.hpp"
#include "stator/master/text.hpp"
#include "stator/product/device/device.hpp"

namespace stator::bench {

using master::ErrorCode;

/// While one drive is waited for, all networks go on.
class Bench::BenchDrivePort final : public master::DrivePort {
 public:
  BenchDrivePort(Bench& bench, rack::DeviceAddress device) : bench_(bench), device_(device) {}

  master::Result<std::uint64_t> read(master::ObjectAddress object, std::size_t size) override {
    if (device_.kind == rack::NetworkKind::segment) {
      const auto position = bench_.mailbox_position(device_);
      if (!position) {
        return base::Unexpected{position.error()};
      }
      return slave(*position).read(object, size);
    }
    const auto data = bench_.upload(device_, object);
    return data ? master::number_of(*data, size, object, name()) : base::Unexpected{data.error()};
  }
  master::Result<void> write(master::ObjectAddress object, std::size_t size,
                             std::uint64_t bits) override {
    if (device_.kind == rack::NetworkKind::segment) {
      const auto position = bench_.mailbox_position(device_);
      if (!position) {
        return base::Unexpected{position.error()};
      }
      return slave(*position).write(object, size, bits);
    }
    std::array<std::byte, sizeof bits> data{};
    master::store_number(std::span(data).first(size), bits);
    return bench_.download(device_, object, std::span(data).first(size));
  }
  [[nodiscard]] bool cyclic(master::ObjectAddress object) const override {
    if (device_.kind != rack::NetworkKind::segment) {
      return false;
    }
    const auto position = bench_.mailbox_position(device_);
    return position && slave(*position).cyclic(object);
  }
  master::Result<void> run_cycle() override {
    bench_.cycle();
    return {};
  }
  [[nodiscard]] base::SimTime now() override { return bench_.now(); }
  [[nodiscard]] std::string name() const override { return bench_.name_of(device_); }

 private:
  /// A port to the slave where the last scan has found it.
  [[nodiscard]] master::SlaveDrivePort slave(std::size_t position) const {
    return {bench_.segments_[device_.network]->master, position};
  }

  Bench& bench_;
  rack::DeviceAddress device_;
};

master::Result<std::vector<std::byte>> Bench::upload(rack::DeviceAddress device,
                                                     master::ObjectAddress object) {
  if (device.kind == rack::NetworkKind::bus) {
    return can_client(device).upload(object);
  }
  const auto position = mailbox_position(device);
  if (!position) {
    return base::Unexpected{position.error()};
  }
  return segments_[device.network]->master.upload(*position, object);
}

master::Result<void> Bench::download(rack::DeviceAddress device, master::ObjectAddress object,
                                     std::span<const std::byte> data) {
  if (device.kind == rack::NetworkKind::bus) {
    return can_client(device).download(object, data);
  }
  const auto position = mailbox_position(device);
  if (!position) {
    return base::Unexpected{position.error()};
  }
  master::Master& master = segments_[device.network]->master;
  master::SlaveDrivePort process_data(master, *position);
  if (process_data.cyclic(object)) {
    return process_data.write(object, data.size(), master::load_number(data));
  }
  return master.download(*position, object, data);
}

master::Result<std::size_t> Bench::mailbox_position(rack::DeviceAddress device) {
  auto found = position(device);
  if (!found) {
    return found;
  }
  SegmentMaster& segment = *segments_[device.network];
  if (segment.mailboxes.insert(*found).second) {
    if (const auto started = segment.master.start_mailbox(*found); !started) {
      segment.mailboxes.erase(*found);
      return base::Unexpected{started.error()};
    }
  }
  return found;
}

std::vector<master::Emergency> Bench::emergencies_on_bus(rack::DeviceAddress device) {
  constexpr std::uint16_t kCobIdObject = 0x1014;
  constexpr std::uint32_t kInvalid = 0x80000000;
  constexpr std::uint32_t kUsualCobId = 0x80;
  constexpr std::size_t kHead = 3;
  std::uint32_t cob_id = kUsualCobId + node_id(device).value_or(0);
  const dictionary::Dictionary* const objects =
      std::as_const(*rack_).device(device).object_dictionary();
  if (const dictionary::Entry* const entry =
          objects != nullptr ? objects->find(kCobIdObject, 0) : nullptr;
      entry != nullptr) {
    std::array<std::byte, sizeof cob_id> bytes{};
    if (objects->read(*entry, bytes)) {
      cob_id = base::load_le<std::uint32_t>(bytes);
    }
  }
  std::vector<master::Emergency> found;
  const std::deque<can::TimedFrame>& all = frames(device.network);
  const std::uint64_t gone = forgotten_frames(device.network);
  const std::uint64_t before = std::max(frames_before(device.network), gone) - gone;
  for (auto i = static_cast<std::size_t>(before); i < all.size(); ++i) {
    const auto payload = all[i].frame.payload();
    if (!all[i].destroyed && (cob_id & kInvalid) == 0 && payload.size() == can::kMaximumData &&
        all[i].frame.identifier == cob_id) {
      found.push_back({base::load_le<std::uint16_t>(payload),
                       std::to_integer<std::uint8_t>(payload[2]),
                       {payload.begin() + kHead, payload.end()}});
    }
  }
  return found;
}

master::Result<std::vector<master::Emergency>> Bench::emergencies(rack::DeviceAddress device) {
  if (device.kind == rack::NetworkKind::bus) {
    if (!node_id(device)) {
      return master::fail(ErrorCode::protocol,
                          fmt::format("{} sends none, it is no CANopen node", name_of(device)));
    }
    return emergencies_on_bus(device);
  }
  const auto position = mailbox_position(device);
  if (!position) {
    return base::Unexpected{position.error()};
  }
  SegmentMaster& segment = *segments_[device.network];
  auto fetched = segment.master.take_emergencies(*position);
  if (!fetched) {
    return fetched;
  }
  for (master::Emergency& each : *fetched) {
    segment.emergencies.emplace_back(*position, std::move(each));
  }
  std::vector<master::Emergency> found;
  for (const auto& [where, emergency] : segment.emergencies) {
    if (where == *position) {
      found.push_back(emergency);
    }
  }
  return found;
}

void Bench::wait_for_boot_up(rack::DeviceAddress device) {
  const auto booted = [&] {
    return !rack_->powered(device) ||
           rack_->device(device).network_status().state != "Initialisation";
  };
  wait_until(booted, kBootTimeout);
}

master::CanSdoClient Bench::can_client(rack::DeviceAddress device) {
  const std::uint8_t node = node_id(device).value_or(0);
  wait_for_boot_up(device);
  return {node, [this, node, bus = device.network](const can::Frame& request) {
            return answer_to(bus, request, master::CanSdoClient::kAnswer + node, kSdoTimeout);
          }};
}

master::Result<master::DrivePort*> Bench::drive(rack::DeviceAddress device) {
  if (rack_->device(device).object_dictionary() == nullptr) {
    return master::fail(ErrorCode::argument,
                        fmt::format("{} is no drive of CiA 402", name_of(device)));
  }
  const auto known =
      std::ranges::find(drives_, device, [](const auto& each) { return each.first; });
  if (known != drives_.end()) {
    return known->second.get();
  }
  drives_.emplace_back(device, std::make_unique<BenchDrivePort>(*this, device));
  return drives_.back().second.get();
}

}  // namespace stator::bench
