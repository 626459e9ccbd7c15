#include "stator/rack/faults/fault_effects.hpp"

#include <stdexcept>
#include <utility>

#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/product/device/ethercat_device.hpp"
#include "stator/rack/faults/fault_commands.hpp"
#include "stator/rack/faults/fault_mailbox.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/networks/serial_faults.hpp"
#include "stator/rack/networks/serial_line.hpp"

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

/// A fault that a segment, a bus or a line applies to passing frames or bytes, and whose hits are
/// counted there.
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

/// Holds what an event of the rack sets.
template <typename Event>
class HoldEffect final : public FaultEffect {
 public:
  HoldEffect(faults::Target& target, Event event) : target_(target), event_(std::move(event)) {}

  void begin(SimTime now) override { target_.hold(event_, this, now); }
  void end(SimTime now) override { target_.release(event_, this, now); }

 private:
  faults::Target& target_;
  Event event_;
};

/// Two events of the rack: one at the begin, one at the end.
class EventEffect final : public FaultEffect {
 public:
  EventEffect(faults::Target& target, RackEvent begin, std::optional<RackEvent> end)
      : target_(target), begin_(std::move(begin)), end_(std::move(end)) {}

  void begin(SimTime now) override { target_.apply(begin_, now); }
  void end(SimTime now) override {
    if (end_) {
      target_.apply(*end_, now);
    }
  }

 private:
  faults::Target& target_;
  RackEvent begin_;
  std::optional<RackEvent> end_;
};

/// A cable that is out or, with `flap`, comes and goes. While it is in it holds nothing, so that
/// another fault of the same cable keeps it out.
class LinkEffect final : public FaultEffect {
 public:
  LinkEffect(faults::Target& target, const FaultConfiguration& fault)
      : target_(target),
        out_{*fault.target.device, fault.target.port, false},
        flap_(fault.values.find<base::SimDuration>("flap")) {}

  void begin(SimTime now) override {
    target_.hold(out_, this, now);
    is_out_ = true;
    next_ = flap_ ? now + *flap_ : SimTime::never();
  }
  void end(SimTime now) override {
    target_.release(out_, this, now);
    is_out_ = false;
    next_ = SimTime::never();
  }
  [[nodiscard]] SimTime next_step() const override { return next_; }
  void step(SimTime now) override {
    if (!is_out_) {
      begin(now);
      return;
    }
    end(now);
    next_ = now + *flap_;
  }

 private:
  faults::Target& target_;
  CableEvent out_;
  std::optional<base::SimDuration> flap_;
  bool is_out_ = false;
  SimTime next_ = SimTime::never();
};

/// A slave's state machine leaves for a lower state by itself; with `held` it has an error that
/// does not go away, and no step up succeeds until the end.
class StateEffect final : public FaultEffect {
 public:
  /// `held`: what the slave refuses steps up with, by the newest fault; null: with nothing.
  StateEffect(ethercat::SlaveStack& stack, const FaultConfiguration& fault,
              Overridable<ethercat::AlStatusCode>* held)
      : stack_(stack),
        target_(al_state(fault.values.get<std::string>("state"))),
        code_(static_cast<ethercat::AlStatusCode>(fault.values.whole("code"))),
        held_(held) {}

  void begin(SimTime now) override {
    if (held_ != nullptr && held_->hold(this, code_)) {
      stack_.refuse_steps_up(code_);
    }
    if (stack_.state() > target_) {
      stack_.step_down(target_, code_, now);
    } else if (held_ != nullptr) {
      stack_.raise_error(code_, now);
    }
  }
  void end(SimTime /*now*/) override {
    if (held_ != nullptr && held_->release(this)) {
      stack_.refuse_steps_up(held_->value());
    }
  }

 private:
  ethercat::SlaveStack& stack_;
  ethercat::AlState target_;
  ethercat::AlStatusCode code_;
  Overridable<ethercat::AlStatusCode>* held_;
};

class SiiEffect final : public FaultEffect {
 public:
  /// `held`: the bits of the byte that read wrong, by the newest fault.
  SiiEffect(ethercat::SlaveController& controller, const FaultConfiguration& fault,
            Overridable<std::uint8_t>& held)
      : controller_(controller),
        offset_(static_cast<std::size_t>(fault.values.whole("offset"))),
        mask_(static_cast<std::uint8_t>(fault.values.whole("mask"))),
        held_(held) {}

  void begin(SimTime /*now*/) override {
    if (held_.hold(this, mask_)) {
      controller_.corrupt_sii(offset_, mask_);
    }
  }
  void end(SimTime /*now*/) override {
    if (held_.release(this)) {
      controller_.corrupt_sii(offset_, held_.value());
    }
  }

 private:
  ethercat::SlaveController& controller_;
  std::size_t offset_;
  std::uint8_t mask_;
  Overridable<std::uint8_t>& held_;
};

product::EtherCatDevice& slave(const FaultSite& site, const FaultConfiguration& fault) {
  return site.target.slave(*fault.target.device);
}

ethercat::SlaveStack& stack(const FaultSite& site, const FaultConfiguration& fault) {
  ethercat::SlaveStack* found = slave(site, fault).slave_stack();
  if (found == nullptr) {
    throw std::runtime_error(fault.target.text + " has no firmware of its own");
  }
  return *found;
}

}  // namespace

MadeEffect ethercat_frame_effect(const FaultSite& site, const FaultConfiguration& fault,
                                 ethercat::FrameFaultKind kind) {
  const DeviceAddress device = *fault.target.device;
  const ethercat::FrameFault frames{
      .kind = kind,
      .port = {device.device, fault.target.port},
      .leaving = fault.values.get<std::string>("direction") == "out",
      .frames = static_cast<unsigned>(fault.count),
      .delay = fault.values.find<base::SimDuration>("delay").value_or(base::SimDuration()),
      .probability = fault.probability,
      .seed = fault.seed};
  return std::make_unique<InjectedEffect<ethercat::Segment, ethercat::FrameFault>>(
      site.target.segment(device.network), frames);
}

MadeEffect working_counter_effect(const FaultSite& site, const FaultConfiguration& fault) {
  const DeviceAddress device = *fault.target.device;
  const ethercat::CountFault counts{
      .slave = device.device,
      .commands = command_mask(fault.values.get<std::string>("commands")),
      .datagrams = static_cast<unsigned>(fault.count),
      .probability = fault.probability,
      .seed = fault.seed};
  return std::make_unique<InjectedEffect<ethercat::Segment, ethercat::CountFault>>(
      site.target.segment(device.network), counts);
}

MadeEffect can_frame_effect(const FaultSite& site, const FaultConfiguration& fault,
                            can::FrameFaultKind kind) {
  FrameFaultEvent event;
  event.bus = fault.target.bus;
  if (fault.target.device) {
    event.device = fault.target.device->device;
  }
  event.fault = {
      .kind = kind,
      .frames = static_cast<unsigned>(fault.count),
      .delay = fault.values.find<base::SimDuration>("delay").value_or(base::SimDuration()),
      .probability = fault.probability,
      .seed = fault.seed};
  if (const auto identifier = fault.values.find<std::int64_t>("identifier")) {
    event.fault.identifier = static_cast<std::uint32_t>(*identifier);
  }
  return std::make_unique<CanFrameEffect>(site.target.bus(event.bus), event);
}

MadeEffect can_state_effect(const FaultSite& site, const FaultConfiguration& fault,
                            can::ErrorState state) {
  return std::make_unique<EventEffect>(site.target, ErrorStateEvent{*fault.target.device, state},
                                       std::nullopt);
}

MadeEffect serial_effect(const FaultSite& site, const FaultConfiguration& fault,
                         SerialFaultKind kind) {
  const SerialFault bytes{
      .kind = kind,
      .direction = fault.values.get<std::string>("direction") == "in"
                       ? SerialDirection::to_devices
                       : SerialDirection::to_programs,
      .count = fault.count,
      .probability = fault.probability,
      .seed = fault.seed,
      .bytes = static_cast<std::size_t>(fault.values.find<std::int64_t>("bytes").value_or(0)),
      .delay = fault.values.find<base::SimDuration>("delay").value_or(base::SimDuration())};
  if (SerialLine* line = site.target.line(fault.target.line)) {
    return std::make_unique<InjectedEffect<SerialLine, SerialFault>>(*line, bytes);
  }
  throw std::runtime_error("there is no serial line \"" + fault.target.line + "\"");
}

MadeEffect link_effect(const FaultSite& site, const FaultConfiguration& fault) {
  return std::make_unique<LinkEffect>(site.target, fault);
}

MadeEffect power_effect(const FaultSite& site, const FaultConfiguration& fault) {
  return std::make_unique<HoldEffect<PowerEvent>>(site.target,
                                                  PowerEvent{*fault.target.device, false});
}

MadeEffect mailbox_stall_effect(const FaultSite& site, const FaultConfiguration& fault) {
  return std::make_unique<InjectedEffect<MailboxFaults, MailboxFault>>(
      site.mailbox(*fault.target.device), mailbox_stall(fault));
}

MadeEffect mailbox_abort_effect(const FaultSite& site, const FaultConfiguration& fault) {
  return std::make_unique<InjectedEffect<MailboxFaults, MailboxFault>>(
      site.mailbox(*fault.target.device), mailbox_abort(fault));
}

MadeEffect al_error_effect(const FaultSite& site, const FaultConfiguration& fault) {
  return std::make_unique<StateEffect>(stack(site, fault), fault,
                                       &site.held.refusals[*fault.target.device]);
}

MadeEffect fall_back_effect(const FaultSite& site, const FaultConfiguration& fault) {
  return std::make_unique<StateEffect>(stack(site, fault), fault, nullptr);
}

MadeEffect sii_effect(const FaultSite& site, const FaultConfiguration& fault) {
  return std::make_unique<SiiEffect>(
      slave(site, fault).controller(), fault,
      site.held.sii_bits[{*fault.target.device, fault.values.whole("offset")}]);
}

MadeEffect clock_drift_effect(const FaultSite& site, const FaultConfiguration& fault) {
  return std::make_unique<HoldEffect<InputEvent>>(
      site.target, InputEvent{*fault.target.device, product::EtherCatDevice::kClockDeviation,
                              static_cast<double>(fault.values.whole("ppb"))});
}

MadeEffect input_effect(const FaultSite& site, const FaultConfiguration& fault) {
  const DeviceAddress device = *fault.target.device;
  const auto& input = fault.values.get<std::string>("input");
  std::optional<RackEvent> back;
  if (const auto value = fault.values.find<double>("back")) {
    back = InputEvent{device, input, *value};
  }
  return std::make_unique<EventEffect>(
      site.target, InputEvent{device, input, fault.values.get<double>("value")}, std::move(back));
}

}  // namespace stator::rack
