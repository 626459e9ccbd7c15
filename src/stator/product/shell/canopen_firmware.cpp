#include "stator/product/shell/canopen_firmware.hpp"

#include <algorithm>
#include <optional>

#include "stator/canopen/nmt/indicators.hpp"
#include "stator/product/shell/boot_loading.hpp"

namespace stator::product {

namespace {

using base::SimTime;
using canopen::NmtState;

constexpr std::uint16_t kFirstObject = 0x1000;
constexpr std::uint16_t kLastObject = 0xFFFF;

}  // namespace

CanOpenFirmware::CanOpenFirmware(const canopen::NodeConfiguration& node,
                                 const CanOpenFirmwareRules& rules,
                                 const std::function<void(dictionary::Dictionary&)>& declare,
                                 base::EventReporter reporter, const CanOpenIdentity& identity)
    : rules_(rules),
      reporter_(reporter),
      first_node_id_(node.node_id),
      firmware_(rules.firmware_capacity),
      node_(declared(declare, identity), controller_, reporter, node),
      emergencies_(dictionary_, controller_, reporter, rules.emergencies),
      sync_(dictionary_, emergencies_, rules.sync),
      pdos_(dictionary_, controller_, emergencies_, reporter, rules.pdos),
      error_behaviour_(
          dictionary_,
          {.state = base::Delegate<NmtState()>::bind<&CanOpenFirmware::nmt_state>(*this),
           .enter =
               base::Delegate<void(NmtState, SimTime)>::bind<&CanOpenFirmware::enter_state>(*this)},
          reporter, rules.error_behaviour),
      supervision_(controller_, emergencies_, error_behaviour_),
      next_tick_(SimTime() + rules.control_period) {
  wire_node();
}

CanOpenFirmware::CanOpenFirmware(const CanOpenOutline& outline, base::EventReporter reporter)
    : CanOpenFirmware({.node_id = outline.node_id},
                      {.control_period = outline.period, .bit_rate = outline.bit_rate},
                      [&outline](dictionary::Dictionary& objects) { objects.add(outline.objects); },
                      reporter,
                      {.vendor = outline.vendor,
                       .code = outline.code,
                       .revision = outline.revision,
                       .name = outline.name}) {
  start_firmware(SimTime());
}

dictionary::Dictionary& CanOpenFirmware::declared(
    const std::function<void(dictionary::Dictionary&)>& declare, const CanOpenIdentity& identity) {
  declare(dictionary_);
  if (!dictionary_.finished()) {
    standard_objects_.add_missing(dictionary_, identity);
    dictionary_.finish();
  }
  return dictionary_;
}

void CanOpenFirmware::wire_node() {
  node_.set_acceptance_filter(&controller_.filter());
  using At = base::Delegate<void(SimTime)>;
  canopen::NodeHooks hooks;
  hooks.reset_application = At::bind<&CanOpenFirmware::on_reset_application>(*this);
  hooks.reset_communication =
      base::Delegate<std::uint8_t(SimTime)>::bind<&CanOpenFirmware::on_reset_communication>(*this);
  hooks.assign_node_id =
      base::Delegate<void(std::uint8_t, SimTime)>::bind<&CanOpenFirmware::on_assign_node_id>(*this);
  hooks.state_changed =
      base::Delegate<void(NmtState, SimTime)>::bind<&CanOpenFirmware::on_state>(*this);
  node_.set_hooks(hooks);
  node_.add(emergencies_);
  node_.add(sync_);
  node_.add(pdos_);
  node_.set_emergency_sink(&emergencies_);
  node_.set_communication_error_reaction(&error_behaviour_);
  sync_.set_listener(canopen::SyncConsumer::Listener::bind<&canopen::PdoService::on_sync>(pdos_));
  pdos_.set_process_data_hook(At::bind<&CanOpenFirmware::on_process_data>(*this));
  supervision_.set_bus_off_hook(At::bind<&CanOpenFirmware::on_bus_off>(*this));
}

void CanOpenFirmware::start_firmware(SimTime now) {
  if (boot_loader_ != nullptr) {
    boot_loader_->restart();
  }
  controller_.clear();
  node_.power_on(now);
}

void CanOpenFirmware::on_reset_application(SimTime now) {
  dictionary_.reset_values(rules_.first_application_object, kLastObject);
  load_application(now);
  emergencies_.forget();
  restart(now);
}

std::uint8_t CanOpenFirmware::on_reset_communication(SimTime now) {
  const std::uint8_t node_id = reset_communication(now);
  supervision_.start();  // finds again what it had found and the node has forgotten
  return node_id;
}

void CanOpenFirmware::on_assign_node_id(std::uint8_t node_id, SimTime now) {
  dictionary_.set_node_id(node_id);
  dictionary_.reset_values(kFirstObject,
                           static_cast<std::uint16_t>(rules_.first_application_object - 1));
  load_communication(node_id, now);
}

dictionary::NetworkState CanOpenFirmware::network_state() const {
  return node_.state() == NmtState::operational ? dictionary::NetworkState::operational
                                                : dictionary::NetworkState::pre_operational;
}

SimTime CanOpenFirmware::next_deadline() const {
  if (!powered_) {
    return SimTime::never();
  }
  return in_boot_loader() ? next_tick_ : std::min(node_.next_deadline(), next_tick_);
}

void CanOpenFirmware::advance(SimTime now) {
  while (next_tick_ <= now) {
    step_world(next_tick_);
    const SimTime period = next_tick_;
    next_tick_ += rules_.control_period;
    if (powered_) {
      begin_period(period);
    }
  }
  step_world(now);
  if (powered_ && !in_boot_loader() && node_.next_deadline() <= now) {
    node_.advance(now);
    apply(now);
  }
}

void CanOpenFirmware::begin_period(SimTime now) {
  if (in_boot_loader()) {
    run_boot_loader(now);
    return;
  }
  node_.advance(now);
  supervision_.poll(now);
  process_bus(now);
  tick(now);
  pdos_.values_may_have_changed(now);
  node_.advance(now);
  if (boot_loader_ != nullptr) {
    boot_loader_->serve(now);
  }
}

void CanOpenFirmware::run_boot_loader(SimTime now) {
  if (boot_loader_->take_boot_request()) {
    node_.power_off(now);
    controller_.clear();
    restart(now);
  }
  boot_loader_->serve(now);
  if (boot_loader_->start_requested()) {
    keep_loaded_image(*boot_loader_, firmware_, rules_.new_firmware, reporter_, now);
    start_firmware(now);
  }
}

void CanOpenFirmware::handle_bus_events(SimTime now) {
  if (!powered_ || in_boot_loader()) {
    while (controller_.take()) {
    }
    return;
  }
  process_bus(now);
}

void CanOpenFirmware::process_bus(SimTime now) {
  while (const std::optional<can::Frame> frame = controller_.take()) {
    node_.receive(*frame, now);
    apply(now);
  }
}

void CanOpenFirmware::set_power(bool on, SimTime now) {
  powered_ = on;
  if (on) {
    start_firmware(now);
    return;
  }
  node_.power_off(now);
  if (boot_loader_ != nullptr) {
    boot_loader_->restart();
  }
  controller_.clear();
  restart(now);
}

Indicators CanOpenFirmware::indicators() const {
  bool event = false;
  for (unsigned cause = 0; cause <= canopen::kMaximumNodeId; ++cause) {
    event |=
        emergencies_.lasts(canopen::kLifeGuardOrHeartbeatError, static_cast<std::uint8_t>(cause));
  }
  const can::ErrorState state = controller_.error_state();
  Indicators all;
  all.add({"RUN", Indicator::Colour::green, canopen::run_led(node_.state())});
  all.add({"ERR", Indicator::Colour::red,
           canopen::error_led({.bus_off = state == can::ErrorState::bus_off,
                               .error_control_event = event,
                               .warning_limit_reached = state != can::ErrorState::error_active})});
  return all;
}

NetworkStatus CanOpenFirmware::network_status() const {
  return {.machine = "nmt", .state = to_text(node_.state())};
}

}  // namespace stator::product
