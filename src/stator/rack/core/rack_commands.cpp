// Rack::execute(): carries out commands as a recording has them, each by the function of Rack for
// it.
#include <variant>

#include "stator/rack/core/bus_port.hpp"
#include "stator/rack/core/internal/telling.hpp"
#include "stator/rack/core/nested_calls.hpp"

namespace stator::rack {

/// Overloads by the command's kind.
class Rack::Execution {
 public:
  explicit Execution(Rack& rack) : rack_(rack), parts_(*rack.parts_) {}

  void operator()(const command::Advance& command) { rack_.advance(command.now); }
  void operator()(const command::TakeBusEvents& command) {
    rack_.handle_bus_events(command.segment, command.now);
  }
  void operator()(const command::SetCarrier& command) {
    rack_.set_carrier(command.segment, command.interface, command.up, command.now);
  }
  void operator()(const command::ReleaseFrame& command) {
    std::array<std::byte, ethercat::kMaximumFrameLength> buffer{};
    static_cast<void>(rack_.release_frame(command.segment, command.now, buffer));
  }
  void operator()(const command::PutCanFrame& command) {
    rack_.tell(command);
    static_cast<void>(parts_.buses[command.bus].ports[command.port]->port_.put(command.frame));
  }
  // The owner of the ports replaces them.
  void operator()(const command::ReplacePorts& command) { rack_.tell(command); }
  void operator()(const command::PutBytes& command) {
    rack_.put(command.line, command.bytes, command.now);
  }
  void operator()(const command::ApplyEvent& command) { rack_.apply(command.event, command.now); }
  void operator()(const command::InjectFault& command) {
    static_cast<void>(rack_.inject(command.fault, command.now));
  }
  void operator()(const command::ClearFault& command) {
    static_cast<void>(rack_.clear_faults(command.id, command.now));
  }
  void operator()(const command::ReadObject& command) {
    std::vector<std::byte> value;
    static_cast<void>(rack_.read_object(
        command.device, entry(command.device, command.index, command.subindex), value));
  }
  void operator()(const command::WriteObject& command) {
    static_cast<void>(rack_.write_object(command.device,
                                         entry(command.device, command.index, command.subindex),
                                         command.value, command.now));
  }
  void operator()(const command::CompleteStorage& command) {
    static_cast<void>(rack_.complete(command.completion, command.now));
  }
  void operator()(const command::SelectHostSpi& command) {
    rack_.tell(command);
    const NestedCalls nested(parts_.inside);
    host(command.device).select(command.spi);
  }
  void operator()(const command::TransferHostSpi& command) {
    Journal* journal = rack_.listening();
    rack_.tell(command);
    const NestedCalls nested(parts_.inside);
    host(command.device).transfer(command.spi, command.mosi, command.miso, command.pause);
    if (journal != nullptr) {
      journal->host_spi_answers(command.miso);
    }
  }
  void operator()(const command::DeselectHostSpi& command) {
    rack_.tell(command);
    const NestedCalls nested(parts_.inside);
    host(command.device).deselect(command.spi, command.surplus_clocks);
  }
  void operator()(const command::SetHostPin& command) {
    rack_.tell(command);
    const NestedCalls nested(parts_.inside);
    host(command.device).set_pin(command.pin, command.level);
  }
  void operator()(const command::PutEoeFrame& command) {
    rack_.tell(command);
    parts_.eoe_ports.at(command.device)->put(command.frame);
  }
  void operator()(const command::Mark& command) { rack_.tell(command); }

 private:
  [[nodiscard]] const dictionary::Entry& entry(DeviceAddress device, std::uint16_t index,
                                               std::uint8_t subindex) {
    return *rack_.device(device).object_dictionary()->find(index, subindex);
  }
  [[nodiscard]] product::HostPort& host(DeviceAddress device) {
    return *parts_.slave(device).host_port();
  }

  Rack& rack_;
  RackParts& parts_;
};

void Rack::execute(const Command& command) {
  std::visit(Execution(*this), command);
}

}  // namespace stator::rack
