#include "stator/devices/tmcc160/tmcc160.hpp"

#include <algorithm>

#include "stator/canopen/eds/eds.hpp"
#include "stator/canopen/nmt/indicators.hpp"
#include "stator/devices/tmcc160/eds.hpp"
#include "stator/devices/tmcc160/emergencies.hpp"
#include "stator/devices/tmcc160/objects.hpp"
#include "stator/devices/tmcc160/parameter_groups.hpp"

namespace stator::devices {

namespace {

using base::SimTime;
using canopen::NmtState;
using tmcc160::AxisEmergency;
using tmcc160::Options;

constexpr std::uint8_t kOfDevice = 255;  // second additional byte of emergencies of the device

/// Arguments: {0} bytes.
constexpr base::EventRule kNewFirmware{
    "tmcc160-new-firmware", base::Severity::information,
    "restarting with a new firmware image, {0} bytes; the virtual module keeps the image and "
    "behaves as before, it does not run it"};

// What the document makes of CiA 301.
constexpr std::array<canopen::TransmissionTypes, 2> kReceiveTypes{{{0, 0}, {254, 255}}};
constexpr std::array<canopen::TransmissionTypes, 2> kTransmitTypes{{{0, 1}, {254, 255}}};
constexpr canopen::PdoRules kPdoRules{
    .receive_types = kReceiveTypes,
    .transmit_types = kTransmitTypes,
    .inhibit_unit = base::SimDuration(1'000'000),
    .inhibit_synchronous = true,
    .dummy_usage = 0,
    .mapping_locked = dictionary::AbortCode::device_state,
    .long_pdo = canopen::LongPdo::reject,
    .cob_id = {.produce_sync = false,
               .produce_time = false,
               .remote_requests = false,
               .receive_pdo_bit_30_set = true}};
constexpr canopen::EmergencyRules kEmergencyRules{.codes = tmcc160::kServiceEmergencies,
                                                  .change_valid_cob_id = true};
constexpr std::array<canopen::ErrorBehaviourValue, 2> kErrorBehaviour{
    {{0, canopen::ErrorReaction::stopped}, {1, canopen::ErrorReaction::none}}};

// A client that asks for a reset begins to wait for the boot-up message a moment later, in Python
// some milliseconds; a restarting microcontroller gives it that time.
constexpr base::SimDuration kResetTime{100'000'000};

canopen::PdoRules pdo_rules(const Tmcc160Configuration& configuration) {
  canopen::PdoRules rules = canopen::with_quirks(kPdoRules, configuration.quirks);
  rules.inhibit_synchronous = !configuration.options.event_driven_values;  // N-03
  return rules;
}

/// Arguments: {0} index, {1} subindex, {2} name, {3} the value that came.
constexpr base::EventRule kNoNodeId{
    "tmcc160-node-id", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} came; a node-ID is 1 to 127, and 255 stands for "
    "none, until LSS gives one"};

canopen::NodeConfiguration node_configuration(const Tmcc160Configuration& configuration) {
  canopen::NodeConfiguration node;
  node.node_id = configuration.node_id;
  node.boot_time = configuration.boot_time;
  node.reset_time = kResetTime;
  node.sdo.timeout = configuration.sdo_timeout;
  node.sdo.block_transfer = false;
  node.quirks = configuration.quirks;
  if (configuration.options.lss) {
    node.lss = canopen::LssConfiguration{};  // its address is 1018h
  }
  return node;
}

canopen::ParameterStorageRules storage_rules(const Options& options) {
  const std::span<const canopen::ParameterGroup> groups = tmcc160::kGroups;
  return options.stores_communication_objects
             ? canopen::ParameterStorageRules{groups, tmcc160::kCommandsWithCommunication}
             : canopen::ParameterStorageRules{groups.first(2), tmcc160::kCommands};
}

}  // namespace

Tmcc160::Tmcc160(const Tmcc160Configuration& configuration, base::EventReporter reporter)
    : configuration_(configuration),
      reporter_(reporter),
      eds_([this] {
        tmcc160::add_objects(dictionary_, configuration_.options);
        set_defaults();
        return tmcc160::eds(dictionary_, configuration_.options.lss);
      }()),
      memory_(tmcc160::ParameterMemory::ScaleQuery::bind<&Tmcc160::position_scale>(*this)),
      node_(dictionary_, controller_, reporter, node_configuration(configuration)),
      emergencies_(dictionary_, controller_, reporter, kEmergencyRules),
      sync_(dictionary_, emergencies_, {.refuse_shared_can_id = true}),
      pdos_(dictionary_, controller_, emergencies_, reporter, pdo_rules(configuration)),
      error_behaviour_(
          dictionary_,
          {.state = base::Delegate<NmtState()>::bind<&Tmcc160::nmt_state>(*this),
           .enter = base::Delegate<void(NmtState, SimTime)>::bind<&Tmcc160::enter_state>(*this)},
          reporter, kErrorBehaviour),
      supervision_(controller_, emergencies_, error_behaviour_),
      storage_(dictionary_, memory_, reporter, storage_rules(configuration.options)),
      world_(configuration.axis),
      inputs_(dictionary_, world_.sensing()),
      objects_(dictionary_, configuration.options),
      serial_(kFirmwareCapacity, reporter) {
  objects_.set_limits(configuration.limits);
  wire_node();
  start_firmware(SimTime());
}

void Tmcc160::set_defaults() {
  const Options& options = configuration_.options;
  dictionary_.set_default(0x2704, 0, configuration_.bit_rate);
  dictionary_.set_default(0x2705, 0, configuration_.node_id);
  dictionary_.set_default(0x1017, 0, options.heartbeat_time);
  dictionary_.set_default(0x1800, 5, options.status_event_timer);
  dictionary_.set_default(0x1801, 5, options.status_event_timer);
  if (options.event_driven_values) {
    for (const std::uint16_t pdo : {std::uint16_t{0x1802}, std::uint16_t{0x1803}}) {
      dictionary_.set_default(pdo, 2, canopen::kEventDrivenProfile);
      dictionary_.set_default(pdo, 3, tmcc160::kValueInhibitTime);
    }
  }
  if (options.cia_402_device_type) {
    dictionary_.set_default(0x1000, 0, 0x00420192);
  }
  if (options.zero_gains) {
    for (const auto& [index, subindex] :
         {std::pair{0x2030, 4}, {0x2030, 5}, {0x2040, 5}, {0x2040, 6}, {0x2050, 4}}) {
      dictionary_.set_default(static_cast<std::uint16_t>(index),
                              static_cast<std::uint8_t>(subindex), 0);
    }
  }
  if (options.lss) {
    dictionary_.set_default(0x1018, 4, configuration_.serial_number);
    dictionary_.on_check(0x2705, 0,
                         dictionary::Entry::CheckHook::bind<&Tmcc160::check_node_id>(*this));
  }
  if (canopen::is_node_id(configuration_.node_id)) {
    dictionary_.set_node_id(configuration_.node_id);
  }
  dictionary_.reset_values();
}

void Tmcc160::wire_node() {
  node_.set_acceptance_filter(&controller_.filter());
  using At = base::Delegate<void(SimTime)>;
  canopen::NodeHooks hooks;
  hooks.reset_application = At::bind<&Tmcc160::reset_application>(*this);
  hooks.reset_communication =
      base::Delegate<std::uint8_t(SimTime)>::bind<&Tmcc160::reset_communication>(*this);
  hooks.assign_node_id =
      base::Delegate<void(std::uint8_t, SimTime)>::bind<&Tmcc160::assign_node_id>(*this);
  hooks.state_changed =
      base::Delegate<void(NmtState, SimTime)>::bind<&Tmcc160::follow_state>(*this);
  node_.set_hooks(hooks);
  node_.add(emergencies_);
  node_.add(sync_);
  node_.add(pdos_);
  node_.set_emergency_sink(&emergencies_);
  node_.set_communication_error_reaction(&error_behaviour_);
  node_.set_write_completion(&storage_);
  sync_.set_listener(canopen::SyncConsumer::Listener::bind<&canopen::PdoService::on_sync>(pdos_));
  pdos_.set_process_data_hook(At::bind<&Tmcc160::take_process_data>(*this));
  supervision_.set_bus_off_hook(At::bind<&Tmcc160::stop_at_bus_off>(*this));
  canopen::LssHooks lss;
  lss.supports = base::Delegate<bool(std::uint32_t)>::bind<&Tmcc160::supports_bit_rate>(*this);
  lss.activate =
      base::Delegate<void(std::uint32_t, SimTime)>::bind<&Tmcc160::activate_bit_rate>(*this);
  lss.store =
      base::Delegate<bool(std::optional<std::uint8_t>,
                          std::optional<std::uint32_t>)>::bind<&Tmcc160::store_network>(*this);
  node_.set_lss_hooks(lss);
  storage_.set_order_hook(
      canopen::ParameterStorage::OrderHook::bind<&Tmcc160::follow_order>(*this));
}

void Tmcc160::connect_memory(canopen::NonVolatileMemory& memory) {
  memory_.connect(memory);
  start_firmware(now_);
}

void Tmcc160::start_firmware(SimTime now) {
  serial_.restart();
  controller_.clear();
  node_.power_on(now);
}

void Tmcc160::reset_application(SimTime now) {
  dictionary_.reset_values(0x2000, 0xFFFF);
  storage_.load(now);
  lss_bit_rate_.reset();
  emergencies_.forget();
  restart_axis();
}

void Tmcc160::restart_axis() {
  reported_errors_ = {};
  reported_resets_ = 0;
  axis_.emplace(dictionary_,
                drive::AxisConfiguration{.reactions = tmcc160::error_reactions(),
                                         .control_period = kControlPeriod},
                reporter_);
  objects_.attach(*axis_);
  axis_->set_position_scale(memory_.position_scale());
  axis_->conditions().network_operational = true;
  configure_axis();
}

std::uint8_t Tmcc160::reset_communication(SimTime now) {
  dictionary_.reset_values(0x2704, 0x2705);
  storage_.load_communication(now);
  supervision_.start();  // finds again what it had found and the node has forgotten
  const auto stored = static_cast<std::uint32_t>(dictionary_.find(0x2704, 0)->value()) * 1000U;
  bit_rate_ = lss_bit_rate_.value_or(stored);
  dictionary_.find(0x2707, 0)->set_value(bit_rate_ / 1000);
  return static_cast<std::uint8_t>(dictionary_.find(0x2705, 0)->value());
}

void Tmcc160::assign_node_id(std::uint8_t node_id, SimTime now) {
  dictionary_.set_node_id(node_id);
  dictionary_.reset_values(0x1000, 0x1FFF);
  storage_.load_communication(now);
  if (configuration_.options.eds) {
    canopen::store_eds(dictionary_, eds_);
  }
  dictionary_.find(0x2708, 0)->set_value(node_id);
}

void Tmcc160::follow_state(NmtState state, SimTime now) {
  if (!axis_) {
    return;
  }
  // Controlwords are obeyed in Pre-operational, too.
  axis_->conditions().network_operational = state != NmtState::stopped;
  if (state == NmtState::stopped) {
    axis_->network_stopped(now);
  }
  report_errors(now);
}

bool Tmcc160::supports_bit_rate(std::uint32_t bit_rate) {
  return std::ranges::find(tmcc160::kBitRates, std::int64_t{bit_rate / 1000}) !=
         tmcc160::kBitRates.end();
}

void Tmcc160::activate_bit_rate(std::uint32_t bit_rate, SimTime /*now*/) {
  bit_rate_ = bit_rate;
  lss_bit_rate_ = bit_rate;
  dictionary_.find(0x2707, 0)->set_value(bit_rate / 1000);
}

bool Tmcc160::store_network(std::optional<std::uint8_t> node_id,
                            std::optional<std::uint32_t> bit_rate) {
  if (node_id) {
    dictionary_.find(0x2705, 0)->set_value(*node_id);
  }
  if (bit_rate) {
    dictionary_.find(0x2704, 0)->set_value(*bit_rate / 1000);
  }
  const std::array<std::byte, 4> signature{std::byte{'s'}, std::byte{'a'}, std::byte{'v'},
                                           std::byte{'e'}};
  return dictionary_.write(*dictionary_.find(0x2706, 0), signature, {}).has_value();
}

/// What has been stored or restored since counts at the next reset communication, not what LSS has
/// configured or activated before.
void Tmcc160::follow_order(const canopen::StorageCommand& command) {
  if ((command.groups & tmcc160::bit(tmcc160::Group::network)) != 0) {
    node_.stored_node_id_changed();
    lss_bit_rate_.reset();
  }
}

dictionary::Verdict Tmcc160::check_node_id(const dictionary::Entry& entry, std::uint64_t value) {
  if (canopen::is_node_id(static_cast<unsigned>(value)) || value == canopen::kUnconfiguredNodeId) {
    return {};
  }
  return dictionary::refuse(
      dictionary::AbortCode::value_range_exceeded, kNoNodeId,
      {int{entry.index()}, int{entry.subindex()}, entry.shared_name(), value});
}

double Tmcc160::position_scale() const {
  return axis_ ? axis_->position_scale() : 1.0;
}

SimTime Tmcc160::next_deadline() const {
  if (!powered_) {
    return SimTime::never();
  }
  return serial_.in_boot_loader() ? next_tick_ : std::min(node_.next_deadline(), next_tick_);
}

bool Tmcc160::connect_serial(std::string_view interface, tmcl::SerialPort* port) {
  if (interface != kSerialInterfaces[0]) {
    return false;
  }
  serial_.connect(port);
  return true;
}

void Tmcc160::advance(SimTime now) {
  while (next_tick_ <= now) {
    step_until(next_tick_);
    const SimTime tick_time = next_tick_;
    next_tick_ += kControlPeriod;
    if (powered_) {
      tick(tick_time);
    }
  }
  step_until(now);
  if (powered_ && !serial_.in_boot_loader() && node_.next_deadline() <= now) {
    node_.advance(now);
    apply_commands(now);
  }
}

void Tmcc160::step_until(SimTime end) {
  plant::ServoAxis& plant = world_.plant();
  while (now_ + kCurrentPeriod <= end) {
    static_cast<void>(plant.step(axis_->step(plant.sensing()), kCurrentPeriod));
    now_ += kCurrentPeriod;
    // The first step after the firmware or a person did something is made; until one of them does
    // something again, a shaft at rest with the bridge off costs nothing.
    if (const std::int64_t restful = axis_->switched_off() ? plant.restful_steps() : 0;
        restful > 0) {
      const std::int64_t periods = std::min(restful, (end - now_) / kCurrentPeriod);
      plant.rest(periods);
      axis_->rest(static_cast<int>(periods), plant.sensing());
      now_ += kCurrentPeriod * periods;
    }
  }
}

/// Brings settings and conditions of the axis up to date. It follows the levels of its switches as
/// they change; here what 2005h makes of them may have changed.
void Tmcc160::configure_axis() {
  objects_.configure();
  axis_->conditions().set_switches(
      axis_->settings().reference.switches.pressed(drive::switch_levels(world_.sensing())));
}

void Tmcc160::tick(SimTime now) {
  if (serial_.in_boot_loader()) {
    run_boot_loader(now);
    return;
  }
  node_.advance(now);
  supervision_.poll(now);
  process_bus(now);
  configure_axis();
  axis_->conditions().shutdown_switch = !inputs_.enable();
  axis_->tick(now);
  report_errors(now);
  pdos_.values_may_have_changed(now);
  node_.advance(now);
  serial_.serve(now);
}

void Tmcc160::handle_bus_events(SimTime now) {
  if (!powered_ || serial_.in_boot_loader()) {
    while (controller_.take()) {
    }
    return;
  }
  process_bus(now);
}

void Tmcc160::process_bus(SimTime now) {
  while (const std::optional<can::Frame> frame = controller_.take()) {
    node_.receive(*frame, now);
    apply_commands(now);
  }
}

void Tmcc160::apply_commands(SimTime now) {
  if (!axis_->has_commands()) {
    return;
  }
  configure_axis();
  axis_->apply(now);
  report_errors(now);
  pdos_.values_may_have_changed(now);
}

void Tmcc160::set_power(bool on, SimTime now) {
  powered_ = on;
  if (on) {
    start_firmware(now);
    return;
  }
  node_.power_off(now);
  serial_.restart();
  controller_.clear();
  restart_axis();
}

void Tmcc160::run_boot_loader(SimTime now) {
  if (serial_.take_boot_request()) {
    node_.power_off(now);
    controller_.clear();
    restart_axis();
  }
  serial_.serve(now);
  if (!serial_.start_requested()) {
    return;
  }
  if (const std::span<const std::byte> image = serial_.loaded_image(); !image.empty()) {
    // It fits, since the boot loader has no more memory; what cannot be kept leaves the old one.
    static_cast<void>(firmware_.open_for_writing("serial"));
    static_cast<void>(firmware_.append(image));
    static_cast<void>(firmware_.commit());
    reporter_.report(now, kNewFirmware, {base::EventArgument(image.size())});
  }
  start_firmware(now);
}

void Tmcc160::report_errors(SimTime now) {
  const drive::AxisErrors errors = axis_->errors();
  const bool reset = axis_->fault_resets() != reported_resets_;
  if (!reset && errors == reported_errors_) {
    return;
  }
  const drive::AxisErrors before = reported_errors_;
  reported_errors_ = errors;
  reported_resets_ = axis_->fault_resets();
  for (const AxisEmergency& row : tmcc160::kAxisEmergencies) {
    if (before.has(row.error) && !errors.has(row.error)) {
      report_error(row, false, now);
    }
  }
  if (reset) {
    emergencies_.report_reset(now);
  }
  for (const AxisEmergency& row : tmcc160::kAxisEmergencies) {
    if (errors.has(row.error) && !before.has(row.error)) {
      report_error(row, true, now);
    }
  }
}

void Tmcc160::report_error(const AxisEmergency& row, bool present, SimTime now) {
  const auto cause = static_cast<std::uint8_t>(row.error);
  const bool told = row.documented || configuration_.options.undocumented_emergencies;
  const bool fault = row.reaction == drive::ErrorReaction::fault ||
                     row.reaction == drive::ErrorReaction::power_off;
  if (!present) {
    // Faults go with the fault reset, which is told once.
    if (told && !fault) {
      emergencies_.clear(row.code, cause, now);
    } else {
      emergencies_.withdraw(row.code, cause);
    }
    return;
  }
  const canopen::Emergency emergency{
      .code = row.code,
      .error_register = row.register_bits,
      .information = {row.detail, row.of_device ? kOfDevice : std::uint8_t{0}},
      .cause = cause};
  if (told) {
    emergencies_.raise(emergency, now);
  } else {
    emergencies_.note(emergency, now);
  }
}

std::vector<product::Signal> Tmcc160::signals() {
  std::vector<product::Signal> signals;
  objects_.append_signals(signals);
  world_.append_signals(signals);
  return signals;
}

std::vector<product::Input> Tmcc160::inputs() {
  using Set = base::Delegate<void(double)>;
  std::vector<product::Input> inputs;
  world_.append_inputs(inputs);
  inputs.push_back({"enable", "", 0.0, 1.0, Set::bind<&Tmcc160::input_enable>(*this)});
  inputs.push_back(
      {"analog_input_0", "count", 0.0, 4095.0, Set::bind<&Tmcc160::input_analog<0>>(*this)});
  inputs.push_back(
      {"analog_input_1", "count", 0.0, 4095.0, Set::bind<&Tmcc160::input_analog<1>>(*this)});
  inputs.push_back({"analog_noise", "count", 0.0, 4095.0,
                    Set::bind<&product::AnalogNoise::set_amplitude>(inputs_.noise())});
  return inputs;
}

product::Indicators Tmcc160::indicators() {
  bool event = false;
  for (unsigned cause = 0; cause <= canopen::kMaximumNodeId; ++cause) {
    event |=
        emergencies_.lasts(canopen::kLifeGuardOrHeartbeatError, static_cast<std::uint8_t>(cause));
  }
  const can::ErrorState state = controller_.error_state();
  product::Indicators all;
  all.add({"RUN", product::Indicator::Colour::green, canopen::run_led(node_.state())});
  all.add({"ERR", product::Indicator::Colour::red,
           canopen::error_led({.bus_off = state == can::ErrorState::bus_off,
                               .error_control_event = event,
                               .warning_limit_reached = state != can::ErrorState::error_active})});
  return all;
}

product::NetworkStatus Tmcc160::network_status() {
  return {.machine = "nmt", .state = to_text(node_.state())};
}

}  // namespace stator::devices
