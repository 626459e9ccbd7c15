#include "rack/fault_effects.hpp"

#include <stdexcept>
#include <utility>

#include "ethercat/register_addresses.hpp"
#include "rack/fault_commands.hpp"
#include "rack/fault_mailbox.hpp"
#include "rack/rack.hpp"
#include "rack/surroundings_faults.hpp"

namespace stator::rack {

namespace {

using base::SimTime;

ethercat::AlState al_state(const std::string& name) {
  if (name == "init") {
    return ethercat::AlState::init;
  }
  return name == "pre-operational" ? ethercat::AlState::pre_operational
                                   : ethercat::AlState::safe_operational;
}

/// A fault that is asked for where frames or bytes pass, and counted there.
template <typename Medium, typename Fault>
class InjectedEffect final : public FaultEffect {
 public:
  InjectedEffect(Medium& medium, Fault fault) : medium_(medium), fault_(std::move(fault)) {}

  void begin(SimTime /*now*/) override { number_ = medium_.inject(fault_); }
  void end(SimTime /*now*/) override { medium_.withdraw(number_); }
  [[nodiscard]] std::optional<std::uint64_t> hits() const override { return medium_.hits(number_); }

 private:
  Medium& medium_;
  Fault fault_;
  std::uint64_t number_ = 0;
};

/// The bus of a rack as InjectedEffect wants it: members are known when the fault begins.
class BusMedium {
 public:
  explicit BusMedium(CanNetwork& network) : network_(network) {}
  std::uint64_t inject(const FrameFaultEvent& fault) { return network_.inject(fault); }
  void withdraw(std::uint64_t number) { network_.withdraw(number); }
  [[nodiscard]] std::optional<std::uint64_t> hits(std::uint64_t number) const {
    return network_.bus().hits(number);
  }

 private:
  CanNetwork& network_;
};

class CanFrameEffect final : public FaultEffect {
 public:
  CanFrameEffect(CanNetwork& network, const FrameFaultEvent& fault)
      : medium_(network), injected_(medium_, fault) {}
  void begin(SimTime now) override { injected_.begin(now); }
  void end(SimTime now) override { injected_.end(now); }
  [[nodiscard]] std::optional<std::uint64_t> hits() const override { return injected_.hits(); }

 private:
  BusMedium medium_;
  InjectedEffect<BusMedium, FrameFaultEvent> injected_;
};

/// Two events of the rack: one at the begin, one at the end.
class EventEffect final : public FaultEffect {
 public:
  EventEffect(Rack& rack, RackEvent begin, std::optional<RackEvent> end)
      : rack_(rack), begin_(std::move(begin)), end_(std::move(end)) {}

  void begin(SimTime now) override { rack_.apply(begin_, now); }
  void end(SimTime now) override {
    if (end_) {
      rack_.apply(*end_, now);
    }
  }

 private:
  Rack& rack_;
  RackEvent begin_;
  std::optional<RackEvent> end_;
};

class LinkEffect final : public FaultEffect {
 public:
  LinkEffect(Rack& rack, const FaultConfiguration& fault)
      : rack_(rack),
        device_(*fault.target.device),
        port_(fault.target.port),
        flap_(fault.values.find<base::SimDuration>("flap")) {}

  void begin(SimTime now) override { set(false, now); }
  void end(SimTime now) override {
    if (!intact_) {
      set(true, now);
    }
    next_ = SimTime::never();
  }
  [[nodiscard]] SimTime next_step() const override { return next_; }
  void step(SimTime now) override { set(!intact_, now); }

 private:
  void set(bool intact, SimTime now) {
    intact_ = intact;
    rack_.apply(CableEvent{device_, port_, intact}, now);
    next_ = flap_ ? now + *flap_ : SimTime::never();
  }

  Rack& rack_;
  DeviceAddress device_;
  unsigned port_;
  std::optional<base::SimDuration> flap_;
  bool intact_ = true;
  SimTime next_ = SimTime::never();
};

/// An error of a slave's state machine: with `lasting` it goes no state up until the end.
class StateEffect final : public FaultEffect {
 public:
  StateEffect(ethercat::SlaveStack& stack, const FaultConfiguration& fault, bool lasting)
      : stack_(stack),
        target_(al_state(fault.values.get<std::string>("state"))),
        code_(static_cast<ethercat::AlStatusCode>(fault.values.whole("code"))),
        lasting_(lasting) {}

  void begin(SimTime now) override {
    if (lasting_) {
      stack_.refuse_steps_up(code_);
    }
    if (stack_.state() > target_) {
      stack_.step_down(target_, code_, now);
    } else if (lasting_) {
      stack_.raise_error(code_, now);
    }
  }
  void end(SimTime /*now*/) override { stack_.refuse_steps_up(ethercat::AlStatusCode::no_error); }

 private:
  ethercat::SlaveStack& stack_;
  ethercat::AlState target_;
  ethercat::AlStatusCode code_;
  bool lasting_;
};

class SiiEffect final : public FaultEffect {
 public:
  SiiEffect(ethercat::SlaveController& controller, const FaultConfiguration& fault)
      : controller_(controller),
        offset_(static_cast<std::size_t>(fault.values.whole("offset"))),
        mask_(static_cast<std::uint8_t>(fault.values.whole("mask"))) {}

  void begin(SimTime /*now*/) override { controller_.corrupt_sii(offset_, mask_); }
  void end(SimTime /*now*/) override { controller_.corrupt_sii(offset_, 0); }

 private:
  ethercat::SlaveController& controller_;
  std::size_t offset_;
  std::uint8_t mask_;
};

class ClockEffect final : public FaultEffect {
 public:
  ClockEffect(ethercat::SlaveController& controller, std::int32_t ppb)
      : controller_(controller), ppb_(ppb) {}

  void begin(SimTime now) override {
    before_ = controller_.configuration().clock_deviation_ppb;
    set(ppb_, now);
  }
  void end(SimTime now) override { set(before_, now); }

 private:
  void set(std::int32_t ppb, SimTime now) {
    controller_.advance(now);
    controller_.set_clock_deviation(ppb);
  }

  ethercat::SlaveController& controller_;
  std::int32_t ppb_;
  std::int32_t before_ = 0;
};

std::unique_ptr<FaultEffect> ethercat_frame(Rack& rack, const FaultConfiguration& fault) {
  const DeviceAddress device = *fault.target.device;
  const ethercat::FrameFault frames{
      .kind = static_cast<ethercat::FrameFaultKind>(fault.kind->variant),
      .port = {device.device, fault.target.port},
      .leaving = fault.values.get<std::string>("direction") == "out",
      .frames = static_cast<unsigned>(fault.count),
      .delay = fault.values.find<base::SimDuration>("delay").value_or(base::SimDuration()),
      .probability = fault.probability,
      .seed = fault.seed};
  return std::make_unique<InjectedEffect<ethercat::Segment, ethercat::FrameFault>>(
      rack.segment(device.network), frames);
}

std::unique_ptr<FaultEffect> working_counter(Rack& rack, const FaultConfiguration& fault) {
  const DeviceAddress device = *fault.target.device;
  const ethercat::CountFault counts{
      .slave = device.device,
      .commands = command_mask(fault.values.get<std::string>("commands")),
      .datagrams = static_cast<unsigned>(fault.count),
      .probability = fault.probability,
      .seed = fault.seed};
  return std::make_unique<InjectedEffect<ethercat::Segment, ethercat::CountFault>>(
      rack.segment(device.network), counts);
}

std::unique_ptr<FaultEffect> can_frame(Rack& rack, const FaultConfiguration& fault) {
  FrameFaultEvent event;
  event.bus = fault.target.bus;
  if (fault.target.device) {
    event.device = fault.target.device->device;
  }
  event.fault = {
      .kind = static_cast<can::FrameFaultKind>(fault.kind->variant),
      .frames = static_cast<unsigned>(fault.count),
      .delay = fault.values.find<base::SimDuration>("delay").value_or(base::SimDuration()),
      .probability = fault.probability,
      .seed = fault.seed};
  if (const auto identifier = fault.values.find<std::int64_t>("identifier")) {
    event.fault.identifier = static_cast<std::uint32_t>(*identifier);
  }
  return std::make_unique<CanFrameEffect>(rack.bus(event.bus), event);
}

std::unique_ptr<FaultEffect> serial(Rack& rack, const FaultConfiguration& fault) {
  const SerialFault bytes{
      .kind = static_cast<SerialFaultKind>(fault.kind->variant),
      .direction = fault.values.get<std::string>("direction") == "in"
                       ? SerialDirection::to_devices
                       : SerialDirection::to_programs,
      .count = fault.count,
      .probability = fault.probability,
      .seed = fault.seed,
      .bytes = static_cast<std::size_t>(fault.values.find<std::int64_t>("bytes").value_or(0)),
      .delay = fault.values.find<base::SimDuration>("delay").value_or(base::SimDuration())};
  for (std::size_t i = 0; i < rack.line_count(); ++i) {
    if (rack.line(i).configuration().link == fault.target.line) {
      return std::make_unique<InjectedEffect<SerialLine, SerialFault>>(rack.line(i), bytes);
    }
  }
  throw std::runtime_error("there is no serial line \"" + fault.target.line + "\"");
}

std::unique_ptr<FaultEffect> set_input(Rack& rack, const FaultConfiguration& fault) {
  const DeviceAddress device = *fault.target.device;
  const auto& input = fault.values.get<std::string>("input");
  std::optional<RackEvent> back;
  if (const auto value = fault.values.find<double>("back")) {
    back = InputEvent{device, input, *value};
  }
  return std::make_unique<EventEffect>(
      rack, InputEvent{device, input, fault.values.get<double>("value")}, std::move(back));
}

devices::EtherCatDevice& slave(Rack& rack, const FaultConfiguration& fault) {
  const DeviceAddress address = *fault.target.device;
  return *rack.devices(address.network)[address.device].device;
}

ethercat::SlaveStack& stack(Rack& rack, const FaultConfiguration& fault) {
  ethercat::SlaveStack* found = slave(rack, fault).slave_stack();
  if (found == nullptr) {
    throw std::runtime_error(fault.target.text + " has no firmware of its own");
  }
  return *found;
}

}  // namespace

std::unique_ptr<FaultEffect> make_fault_effect(Rack& rack, const FaultConfiguration& fault,
                                               MailboxFaults* mailbox) {
  switch (fault.kind->action) {
    case FaultAction::ethercat_frame:
      return ethercat_frame(rack, fault);
    case FaultAction::can_frame:
      return can_frame(rack, fault);
    case FaultAction::serial:
      return serial(rack, fault);
    case FaultAction::link_down:
      return std::make_unique<LinkEffect>(rack, fault);
    case FaultAction::power_off:
      return std::make_unique<EventEffect>(rack, PowerEvent{*fault.target.device, false},
                                           PowerEvent{*fault.target.device, true});
    case FaultAction::mailbox_stall:
    case FaultAction::mailbox_abort:
      return std::make_unique<InjectedEffect<MailboxFaults, MailboxFault>>(*mailbox,
                                                                           mailbox_fault(fault));
    case FaultAction::al_error:
      return std::make_unique<StateEffect>(stack(rack, fault), fault, true);
    case FaultAction::fall_back:
      return std::make_unique<StateEffect>(stack(rack, fault), fault, false);
    case FaultAction::working_counter:
      return working_counter(rack, fault);
    case FaultAction::sii_corruption:
      return std::make_unique<SiiEffect>(slave(rack, fault).controller(), fault);
    case FaultAction::clock_drift:
      return std::make_unique<ClockEffect>(slave(rack, fault).controller(),
                                           static_cast<std::int32_t>(fault.values.whole("ppb")));
    case FaultAction::can_error_state:
      return std::make_unique<EventEffect>(
          rack,
          ErrorStateEvent{*fault.target.device, static_cast<can::ErrorState>(fault.kind->variant)},
          std::nullopt);
    case FaultAction::surroundings:
      return make_surroundings_effect(rack, fault);
    case FaultAction::set_input:
      return set_input(rack, fault);
  }
  throw std::runtime_error("a fault without effect");
}

}  // namespace stator::rack
