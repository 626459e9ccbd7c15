#include "master/simulated_segment.hpp"

#include <algorithm>
#include <array>

#include "stator/ethercat/sii/sii_image.hpp"

namespace stator::master::test {

namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::Default;
using dictionary::EntryDeclaration;
using dictionary::ObjectCode;
using dictionary::PdoMapping;

constexpr std::string_view kLongText =
    "a text that is longer than one mailbox: 0123456789 0123456789 0123456789 0123456789 "
    "0123456789 0123456789 0123456789 0123456789 0123456789 0123456789 0123456789 0123456789 "
    "0123456789 0123456789 0123456789 0123456789 0123456789 0123456789 0123456789 the end";

constexpr EntryDeclaration variable(std::uint16_t index, std::string_view name, DataType type,
                                    Access access, PdoMapping mapping = PdoMapping::no,
                                    Default value = {}) {
  return {.index = index,
          .name = name,
          .type = type,
          .access = access,
          .mapping = mapping,
          .default_value = value};
}

constexpr EntryDeclaration record(std::uint16_t index, std::uint8_t subindex, DataType type,
                                  std::uint32_t value) {
  return {.index = index,
          .subindex = subindex,
          .name = subindex == 0 ? "Number of entries" : "Entry",
          .object_code = ObjectCode::record,
          .type = type,
          .default_value = value,
          .object_name = "Record"};
}

constexpr std::array kDeviceObjects{
    variable(0x1000, "Device type", DataType::unsigned32, Access::read_only, PdoMapping::no,
             dictionary::hex(0x00020192)),
    variable(0x1008, "Manufacturer device name", DataType::visible_string, Access::constant,
             PdoMapping::no, "SIM-2"),
    record(0x1018, 0, DataType::unsigned8, 4),
    record(0x1018, 1, DataType::unsigned32, 0x0286),
    record(0x1018, 2, DataType::unsigned32, 4711),
    record(0x1018, 3, DataType::unsigned32, 3),
    record(0x1018, 4, DataType::unsigned32, 0),
    record(0x1600, 0, DataType::unsigned8, 2),
    record(0x1600, 1, DataType::unsigned32, 0x60400010),
    record(0x1600, 2, DataType::unsigned32, 0x607A0020),
    record(0x1A00, 0, DataType::unsigned8, 2),
    record(0x1A00, 1, DataType::unsigned32, 0x60410010),
    record(0x1A00, 2, DataType::unsigned32, 0x60640020),
    record(0x1C00, 0, DataType::unsigned8, 4),
    record(0x1C00, 1, DataType::unsigned8, 1),
    record(0x1C00, 2, DataType::unsigned8, 2),
    record(0x1C00, 3, DataType::unsigned8, 3),
    record(0x1C00, 4, DataType::unsigned8, 4),
    record(0x1C12, 0, DataType::unsigned8, 1),
    record(0x1C12, 1, DataType::unsigned16, 0x1600),
    record(0x1C13, 0, DataType::unsigned8, 1),
    record(0x1C13, 1, DataType::unsigned16, 0x1A00),
    variable(0x2000, "Setting", DataType::unsigned16, Access::read_write, PdoMapping::no, 5),
    variable(0x2001, "Long text", DataType::visible_string, Access::read_write, PdoMapping::no,
             kLongText.data()),
    variable(0x2002, "Eight bytes", DataType::unsigned64, Access::read_write),
};

constexpr std::array kAxisObjects{
    variable(0x603F, "Error code", DataType::unsigned16, Access::read_only),
    variable(0x6040, "Controlword", DataType::unsigned16, Access::read_write, PdoMapping::receive),
    variable(0x6041, "Statusword", DataType::unsigned16, Access::read_only, PdoMapping::transmit),
    variable(0x6060, "Modes of operation", DataType::integer8, Access::read_write),
    variable(0x6061, "Modes of operation display", DataType::integer8, Access::read_only),
    variable(0x6064, "Position actual value", DataType::integer32, Access::read_only,
             PdoMapping::transmit),
    variable(0x606C, "Velocity actual value", DataType::integer32, Access::read_only),
    variable(0x607A, "Target position", DataType::integer32, Access::read_write,
             PdoMapping::receive),
    variable(0x6081, "Profile velocity", DataType::unsigned32, Access::read_write),
    variable(0x6083, "Profile acceleration", DataType::unsigned32, Access::read_write),
    variable(0x6084, "Profile deceleration", DataType::unsigned32, Access::read_write),
};

constexpr base::SimDuration kTick(1'000'000);
constexpr base::SimDuration kFrameTime(10'000);

ethercat::DeviceDescription describe(std::uint32_t serial_number) {
  ethercat::DeviceDescription description;
  description.vendor_id = 0x0286;
  description.vendor_name = "Simulation";
  description.product_code = 4711;
  description.revision = 3;
  description.serial_number = serial_number;
  description.order_code = "SIM-2-CoE";
  description.name = "SIM-2";
  description.group = "Drives";
  description.station_alias = 0x0042;
  description.receive_mailbox = {0x1000, 128};
  description.transmit_mailbox = {0x1080, 128};
  description.output_offset = 0x1100;
  description.input_offset = 0x1200;
  description.coe = true;
  description.sdo_information = true;
  description.complete_access = true;
  description.distributed_clocks = true;
  return description;
}

dictionary::Dictionary& fill(dictionary::Dictionary& dictionary) {
  dictionary.add(kDeviceObjects);
  dictionary.add(kAxisObjects);
  dictionary.add(kAxisObjects, {.axis = 1, .index_offset = 0x800, .name_prefix = "Axis 1: "});
  dictionary.finish();
  return dictionary;
}

}  // namespace

SimulatedSlave::SimulatedSlave(std::uint32_t serial_number)
    : description(describe(serial_number)),
      controller(ethercat::SlaveControllerConfiguration{}),
      stack(controller, fill(dictionary), description, *this, base::EventReporter()) {
  controller.load_sii(ethercat::build_sii_image(description, dictionary));
  stack.reset(base::SimTime());
  for (const unsigned axis : {0U, 1U}) {
    drives.emplace_back(dictionary, axis);
  }
}

void SimulatedSlave::advance(base::SimTime now) {
  for (; next_tick_ <= now; next_tick_ += kTick) {
    controller.advance(next_tick_);
    stack.process(next_tick_);
    for (SimulatedDrive& drive : drives) {
      drive.tick();
    }
    stack.publish_inputs(next_tick_);
  }
  controller.advance(now);
  stack.process(now);
}

SimulatedSegment::SimulatedSegment(std::size_t slaves) {
  for (std::size_t position = 0; position < slaves; ++position) {
    slaves_.push_back(std::make_unique<SimulatedSlave>(static_cast<std::uint32_t>(100 + position)));
    segment_.append(slaves_.back()->controller);
  }
}

void SimulatedSegment::wait(base::SimDuration duration) {
  now_ += duration;
  for (const auto& slave : slaves_) {
    slave->advance(now_);
  }
}

bool SimulatedSegment::lost(int& planned) {
  if (planned > 0) {
    --planned;
    return true;
  }
  return random_.below(2000) < loss_per_mille;
}

void SimulatedSegment::deliver(std::vector<std::byte> frame) {
  if (delay_answers > 0) {
    --delay_answers;
    delayed_ = std::move(frame);
    return;
  }
  if (double_answers) {
    arrived_.push_back(frame);
  }
  arrived_.push_back(std::move(frame));
}

Result<std::size_t> SimulatedSegment::exchange(std::span<const std::byte> frame,
                                               std::span<std::byte> reply,
                                               base::SimDuration timeout) {
  if (!frame.empty()) {
    ++frames;
    wait(kFrameTime);
    if (!delayed_.empty()) {
      arrived_.push_back(std::exchange(delayed_, {}));
    }
    std::vector<std::byte> copy(frame.begin(), frame.end());
    if (!lost(lose_requests) && segment_.process(copy, now_)) {
      for (const auto& slave : slaves_) {
        slave->handle_bus_events(now_);
      }
      if (!lost(lose_answers)) {
        deliver(std::move(copy));
      }
    }
  }
  if (arrived_.empty()) {
    wait(timeout);
    return std::size_t{0};
  }
  const std::vector<std::byte> answer = std::move(arrived_.front());
  arrived_.pop_front();
  const std::size_t length = std::min(answer.size(), reply.size());
  std::copy_n(answer.begin(), length, reply.begin());
  return length;
}

}  // namespace stator::master::test
