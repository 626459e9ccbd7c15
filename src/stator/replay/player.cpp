#include "stator/replay/player.hpp"

#include <algorithm>
#include <bit>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/product/device/device.hpp"
#include "stator/rack/core/host_pins.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/networks/eoe_port.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "stator/replay/session_recorder.hpp"
#include "stator/replay/step_text.hpp"

namespace stator::replay {

Player::Player(RecordingReader& recording, rack::Rack& rack,
               const rack::RackConfiguration& configuration)
    : recording_(recording),
      rack_(rack),
      configuration_(configuration),
      ports_are_steps_(recording.header().version >= kVersionWithPorts),
      signals_(rack.signals()),
      values_(signals_.size()) {
  if (names_of(signals_) != recording.header().signal_names) {
    throw std::runtime_error(fmt::format(
        "the rack has other signals than the recorded one ({} instead of {}); the recording is of "
        "program version {}: replay it with that",
        signals_.size(), recording.header().signal_names.size(), recording.header().program));
  }
  for (const rack::BusConfiguration& bus : configuration.buses) {
    port_counts_.push_back(bus.wire && !ports_are_steps_ ? bus.ports.size() : 0);
  }
  if (rack::DeviceStorage* storage = rack.storage(); storage != nullptr) {
    completions_before_ = storage->completions();
    storage->set_completions(recording.header().version == kOldestVersion
                                 ? rack::DeviceStorage::Completions::at_once
                                 : rack::DeviceStorage::Completions::recorded);
  }
  open_ports();
  for (std::size_t line = 0; line < rack.line_count(); ++line) {
    lines_.push_back(std::make_unique<Output>());
    rack.connect_line(line, rack::SerialLine::Output::bind<&Output::take>(*lines_.back()));
  }
  for (const rack::DeviceAddress& device : rack.addresses()) {
    if (rack.connect_eoe(device, {})) {
      Output& output = eoe_[device];
      rack.connect_eoe(
          device, {.frame = [&output](std::span<const std::byte> frame) { output.take(frame); },
                   .ip_parameters = {}});
    }
  }
}

Player::~Player() {
  close_ports();
  if (rack_.storage() != nullptr) {
    rack_.storage()->set_completions(completions_before_);
  }
  for (std::size_t line = 0; line < lines_.size(); ++line) {
    rack_.connect_line(line, {});
  }
  for (const auto& [device, output] : eoe_) {
    rack_.connect_eoe(device, {});
  }
}

void Player::open_ports() {
  ports_.resize(port_counts_.size());
  for (std::size_t bus = 0; bus < port_counts_.size(); ++bus) {
    for (std::size_t i = 0; i < port_counts_[bus]; ++i) {
      ports_[bus].push_back(std::make_unique<rack::BusPort>(rack_, bus));
    }
  }
}

void Player::close_ports() {
  ports_.clear();
}

// A place has the number that is free, as it had when it was recorded: the rack has no other ports.
void Player::open_port_of_step() {
  auto& ports = ports_[in(step_.network, ports_.size())];
  auto port = std::make_unique<rack::BusPort>(
      rack_, step_.network,
      rack::BusPort::Options{.hears_errors = step_.hears_errors, .lossy = step_.lossy});
  if (port->number() != step_.port) {
    throw std::runtime_error(fmt::format("the recording opens port {} of {}, which cannot be",
                                         step_.port, rack_.bus(step_.network).name()));
  }
  ports.resize(std::max(ports.size(), step_.port + 1));
  ports[step_.port] = std::move(port);
}

void Player::close_port_of_step() {
  static_cast<void>(port_of_step());
  ports_[step_.network][step_.port].reset();
}

rack::BusPort& Player::port_of_step() {
  const auto& ports = ports_[in(step_.network, ports_.size())];
  const auto& port = ports[in(step_.port, ports.size())];
  if (port == nullptr) {
    throw std::runtime_error(fmt::format("the recording uses port {} of {}, which is not open",
                                         step_.port, rack_.bus(step_.network).name()));
  }
  return *port;
}

std::unique_ptr<rack::BusPort> Player::take_port(std::size_t bus, std::size_t port) {
  return bus < ports_.size() && port < ports_[bus].size() ? std::move(ports_[bus][port]) : nullptr;
}

std::optional<Difference> Player::play(base::SimTime until, const std::string& mark) {
  at_mark_ = false;
  while (!difference_) {
    if (!std::exchange(step_waits_, false) && !recording_.next(step_)) {
      if (recording_.ending() == RecordingEnding::finished) {
        static_cast<void>(require_quiet_outputs());
      }
      break;
    }
    if (step_.time > until) {
      step_waits_ = true;
      break;
    }
    now_ = step_.time;
    ++counts_.steps;
    do_step();
    if (step_.kind == StepKind::mark && !mark.empty() && step_.name == mark) {
      at_mark_ = true;
      break;
    }
  }
  return difference_;
}

void Player::do_step() {
  // Steps that are only compared may stand between a call and the bytes that it put out: earlier
  // versions recorded them in this order when they restored a snapshot.
  const bool compares = step_.kind == StepKind::bytes_leave || step_.kind == StepKind::signals ||
                        step_.kind == StepKind::frame_leaves ||
                        step_.kind == StepKind::host_answers ||
                        step_.kind == StepKind::eoe_frame_leaves;
  if (!compares && !require_quiet_outputs()) {
    return;
  }
  if (const auto command = command_of_step()) {
    rack_.execute(*command);
    return;
  }
  switch (step_.kind) {
    case StepKind::frame_comes:
      ++counts_.frames;
      frame_ = step_.bytes;
      exit_ = rack_.process_frame(in(step_.network, rack_.segment_count()), frame_, step_.time,
                                  step_.interface);
      break;
    case StepKind::frame_leaves:
      compare_frame();
      break;
    case StepKind::release:
      release(in(step_.network, rack_.segment_count()));
      break;
    case StepKind::can_frame_leaves:
      compare_can_frame();
      break;
    case StepKind::ports_replaced:
      rack_.execute({rack::command::ReplacePorts{}});
      if (!ports_are_steps_) {
        close_ports();
        open_ports();
      }
      break;
    case StepKind::port_opened:
      open_port_of_step();
      break;
    case StepKind::port_closed:
      close_port_of_step();
      break;
    case StepKind::bytes_leave:
      compare_output(*lines_[in(step_.network, lines_.size())],
                     fmt::format("serial line {}", step_.network));
      break;
    case StepKind::host_answers:
      if (miso_ != step_.bytes) {
        differ("answer at the pins of a chip", to_hex(step_.bytes), to_hex(miso_));
      }
      break;
    case StepKind::eoe_frame_leaves:
      compare_output(eoe_[bridged_of_step()],
                     fmt::format("EoE of {}", rack_.name_of(step_.device)));
      break;
    case StepKind::signals:
      compare_signals();
      break;
    default:
      break;
  }
}

std::size_t Player::in(std::size_t index, std::size_t size) {
  if (index >= size) {
    throw std::runtime_error("the recording is of another rack: it has more networks");
  }
  return index;
}

std::optional<rack::Command> Player::command_of_step() {
  namespace command = rack::command;
  switch (step_.kind) {
    case StepKind::advance:
      return command::Advance{step_.time};
    case StepKind::bus_events:
      return command::TakeBusEvents{in(step_.network, rack_.segment_count()), step_.time};
    case StepKind::carrier:
      return command::SetCarrier{in(step_.network, rack_.segment_count()), step_.interface,
                                 step_.up, step_.time};
    case StepKind::can_frame_comes:
      ++counts_.can_frames;
      static_cast<void>(port_of_step());
      return command::PutCanFrame{step_.network, step_.port, step_.can.frame};
    case StepKind::bytes_come:
      counts_.bytes += step_.bytes.size();
      return command::PutBytes{in(step_.network, rack_.line_count()), step_.bytes, step_.time};
    case StepKind::event:
      return command::ApplyEvent{*step_.event, step_.time};
    case StepKind::fault:
      return command::InjectFault{fault_of_step(), step_.time};
    case StepKind::fault_cleared:
      return command::ClearFault{step_.fault, step_.time};
    case StepKind::completion:
      if (rack_.storage() == nullptr || !rack_.storage()->has(step_.completion.memory)) {
        throw std::runtime_error("the recording is of another rack: it keeps more in files");
      }
      return command::CompleteStorage{step_.completion, step_.time};
    case StepKind::object_read:
      require_object();
      return command::ReadObject{step_.device, step_.index, step_.subindex};
    case StepKind::object_written:
      require_object();
      return command::WriteObject{step_.device, step_.index, step_.subindex, step_.bytes,
                                  step_.time};
    case StepKind::host_select:
      return command::SelectHostSpi{chip_of_step(), step_.spi};
    case StepKind::host_transfer:
      miso_.assign(step_.bytes.size(), std::byte{0});
      return command::TransferHostSpi{chip_of_step(), step_.spi, step_.bytes, miso_, step_.pause};
    case StepKind::host_deselect:
      return command::DeselectHostSpi{chip_of_step(), step_.spi, step_.surplus_clocks};
    case StepKind::host_pin:
      return command::SetHostPin{chip_of_step(), step_.pin, step_.up};
    case StepKind::eoe_frame_comes:
      return command::PutEoeFrame{bridged_of_step(), step_.bytes};
    case StepKind::mark:
      return command::Mark{step_.name};
    default:
      return std::nullopt;
  }
}

void Player::release(std::size_t segment) {
  frame_.resize(ethercat::kMaximumFrameLength);
  const auto released = rack_.release_frame(segment, step_.time, frame_);
  exit_ = released ? std::optional(released->exit) : std::nullopt;
  frame_.resize(released ? released->length : 0);
}

rack::FaultConfiguration Player::fault_of_step() const {
  try {
    return rack::parse_fault(step_.name, configuration_);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("the recording has a fault that this rack cannot have: " +
                             std::string(error.what()));
  }
}

void Player::differ(std::string place, std::string expected, std::string got) {
  difference_ =
      Difference{step_.number, step_.time, std::move(place), std::move(expected), std::move(got)};
}

void Player::compare_frame() {
  if (exit_ == step_.exit && (!exit_ || std::ranges::equal(frame_, step_.bytes))) {
    return;
  }
  const auto [expected, got] = explain_frames({step_.exit, step_.bytes}, {exit_, frame_});
  differ(fmt::format("EtherCAT frame {}", counts_.frames), expected, got);
}

void Player::compare_can_frame() {
  const auto got = port_of_step().take();
  if (got && got->frame == step_.can.frame && got->time == step_.can.time &&
      got->destroyed == step_.can.destroyed) {
    return;
  }
  differ(fmt::format("{}, port {}", rack_.bus(step_.network).name(), step_.port),
         to_text(step_.can), got ? to_text(*got) : "no frame");
}

void Player::compare_output(Output& output, std::string place) {
  if (output.first() != nullptr && *output.first() == step_.bytes) {
    output.pop();
    return;
  }
  differ(std::move(place), to_hex(step_.bytes),
         output.first() == nullptr ? "nothing" : to_hex(*output.first()));
}

bool Player::require_quiet_outputs() {
  for (std::size_t line = 0; line < lines_.size(); ++line) {
    if (const auto* bytes = lines_[line]->first(); bytes != nullptr) {
      differ(fmt::format("serial line {}", line), "nothing", to_hex(*bytes));
      return false;
    }
  }
  const auto sent =
      std::ranges::find_if(eoe_, [](const auto& each) { return each.second.first() != nullptr; });
  if (sent == eoe_.end()) {
    return true;
  }
  const auto& [device, output] = *sent;
  differ(fmt::format("EoE of {}", rack_.name_of(device)), "nothing", to_hex(*output.first()));
  return false;
}

void Player::compare_signals() {
  for (const auto& [index, value] : step_.values) {
    if (index >= values_.size()) {
      throw std::runtime_error("the recording is of another rack: it has more signals");
    }
    values_[index] = value;
  }
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const double got = signals_[i].read();
    if (std::bit_cast<std::uint64_t>(got) != std::bit_cast<std::uint64_t>(values_[i])) {
      differ("signal " + signals_[i].name, fmt::format("{} {}", values_[i], signals_[i].unit),
             fmt::format("{} {}", got, signals_[i].unit));
      return;
    }
  }
}

void Player::require_object() {
  const dictionary::Dictionary* objects =
      exists(step_.device) ? rack_.device(step_.device).object_dictionary() : nullptr;
  if (objects == nullptr || objects->find(step_.index, step_.subindex) == nullptr) {
    throw std::runtime_error(
        fmt::format("the recording is of another rack: {:04X}h:{:02X} is not there", step_.index,
                    step_.subindex));
  }
}

rack::DeviceAddress Player::chip_of_step() {
  if (!exists(step_.device) || step_.device.kind != rack::NetworkKind::segment ||
      !rack::HostPins::exist(rack_, step_.device)) {
    throw std::runtime_error("the recording is of another rack: a chip is not there");
  }
  return step_.device;
}

rack::DeviceAddress Player::bridged_of_step() {
  if (!eoe_.contains(step_.device)) {
    throw std::runtime_error("the recording is of another rack: a bridge of EoE is not there");
  }
  return step_.device;
}

bool Player::exists(rack::DeviceAddress device) {
  const auto all = rack_.addresses();
  return std::ranges::find(all, device) != all.end();
}

}  // namespace stator::replay
