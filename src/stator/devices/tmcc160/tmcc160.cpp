#include "stator/devices/tmcc160/tmcc160.hpp"

#include <algorithm>

#include "stator/canopen/eds/eds.hpp"
#include "stator/devices/tmcc160/eds.hpp"
#include "stator/devices/tmcc160/emergencies.hpp"
#include "stator/devices/tmcc160/objects.hpp"
#include "stator/devices/tmcc160/parameter_groups.hpp"

namespace stator::devices {

namespace {

using base::SimTime;
using canopen::NmtState;
using drive::AxisEmergency;
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

/// Declares the objects with the defaults this drive leaves its box with.
void declare(dictionary::Dictionary& objects, const Tmcc160Configuration& configuration) {
  const Options& options = configuration.options;
  tmcc160::add_objects(objects, options);
  objects.set_default(0x2704, 0, configuration.bit_rate);
  objects.set_default(0x2705, 0, configuration.node_id);
  objects.set_default(0x1017, 0, options.heartbeat_time);
  objects.set_default(0x1800, 5, options.status_event_timer);
  objects.set_default(0x1801, 5, options.status_event_timer);
  if (options.event_driven_values) {
    for (const std::uint16_t pdo : {std::uint16_t{0x1802}, std::uint16_t{0x1803}}) {
      objects.set_default(pdo, 2, canopen::kEventDrivenProfile);
      objects.set_default(pdo, 3, tmcc160::kValueInhibitTime);
    }
  }
  if (options.cia_402_device_type) {
    objects.set_default(0x1000, 0, 0x00420192);
  }
  if (options.zero_gains) {
    for (const auto& [index, subindex] :
         {std::pair{0x2030, 4}, {0x2030, 5}, {0x2040, 5}, {0x2040, 6}, {0x2050, 4}}) {
      objects.set_default(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(subindex),
                          0);
    }
  }
  if (options.lss) {
    objects.set_default(0x1018, 4, configuration.serial_number);
  }
  if (canopen::is_node_id(configuration.node_id)) {
    objects.set_node_id(configuration.node_id);
  }
  objects.reset_values();
}

product::CanOpenFirmwareRules rules(const Tmcc160Configuration& configuration) {
  return {.control_period = Tmcc160::kControlPeriod,
          .emergencies = kEmergencyRules,
          .sync = {.refuse_shared_can_id = true},
          .pdos = pdo_rules(configuration),
          .error_behaviour = kErrorBehaviour,
          .firmware_capacity = Tmcc160::kFirmwareCapacity,
          .new_firmware = &kNewFirmware};
}

}  // namespace

Tmcc160::Tmcc160(const Tmcc160Configuration& configuration, base::EventReporter reporter)
    : CanOpenFirmware(
          node_configuration(configuration), rules(configuration),
          [&](dictionary::Dictionary& objects) { declare(objects, configuration); }, reporter),
      configuration_(configuration),
      eds_(tmcc160::eds(objects(), configuration.options.lss)),
      memory_(tmcc160::ParameterMemory::ScaleQuery::bind<&Tmcc160::position_scale>(*this)),
      storage_(objects(), memory_, reporter, storage_rules(configuration.options)),
      world_(configuration.axis),
      inputs_(objects(), world_.sensing()),
      objects_(objects(), configuration.options),
      serial_(kFirmwareCapacity, reporter) {
  set_boot_loader(serial_);
  objects_.set_limits(configuration.limits);
  wire_storage();
  start_firmware(SimTime());
}

void Tmcc160::wire_storage() {
  network_node().set_write_completion(&storage_);
  storage_.set_order_hook(
      canopen::ParameterStorage::OrderHook::bind<&Tmcc160::follow_order>(*this));
  if (!configuration_.options.lss) {
    return;
  }
  objects().on_check(0x2705, 0, dictionary::Entry::CheckHook::bind<&Tmcc160::check_node_id>(*this));
  canopen::LssHooks lss;
  lss.supports = base::Delegate<bool(std::uint32_t)>::bind<&Tmcc160::supports_bit_rate>(*this);
  lss.activate =
      base::Delegate<void(std::uint32_t, SimTime)>::bind<&Tmcc160::activate_bit_rate>(*this);
  lss.store =
      base::Delegate<bool(std::optional<std::uint8_t>,
                          std::optional<std::uint32_t>)>::bind<&Tmcc160::store_network>(*this);
  network_node().set_lss_hooks(lss);
}

void Tmcc160::connect_memory(canopen::NonVolatileMemory& memory) {
  memory_.connect(memory);
  start_firmware(now_);
}

void Tmcc160::load_application(SimTime now) {
  storage_.load(now);
  lss_bit_rate_.reset();
}

void Tmcc160::restart(SimTime /*now*/) {
  reported_errors_ = {};
  reported_resets_ = 0;
  axis_.emplace(
      objects(),
      drive::AxisConfiguration{.reactions = drive::reactions_of(tmcc160::kAxisEmergencies),
                               .control_period = kControlPeriod},
      reporter());
  objects_.attach(*axis_);
  axis_->set_position_scale(memory_.position_scale());
  axis_->conditions().network_operational = true;
  configure_axis();
}

std::uint8_t Tmcc160::reset_communication(SimTime now) {
  objects().reset_values(0x2704, 0x2705);
  storage_.load_communication(now);
  const auto stored = static_cast<std::uint32_t>(objects().find(0x2704, 0)->value()) * 1000U;
  bit_rate_ = lss_bit_rate_.value_or(stored);
  objects().find(0x2707, 0)->set_value(bit_rate_ / 1000);
  return static_cast<std::uint8_t>(objects().find(0x2705, 0)->value());
}

void Tmcc160::load_communication(std::uint8_t node_id, SimTime now) {
  storage_.load_communication(now);
  if (configuration_.options.eds) {
    canopen::store_eds(objects(), eds_);
  }
  objects().find(0x2708, 0)->set_value(node_id);
}

void Tmcc160::state_changed(NmtState state, SimTime now) {
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
  objects().find(0x2707, 0)->set_value(bit_rate / 1000);
}

bool Tmcc160::store_network(std::optional<std::uint8_t> node_id,
                            std::optional<std::uint32_t> bit_rate) {
  if (node_id) {
    objects().find(0x2705, 0)->set_value(*node_id);
  }
  if (bit_rate) {
    objects().find(0x2704, 0)->set_value(*bit_rate / 1000);
  }
  const std::array<std::byte, 4> signature{std::byte{'s'}, std::byte{'a'}, std::byte{'v'},
                                           std::byte{'e'}};
  return objects().write(*objects().find(0x2706, 0), signature, {}).has_value();
}

/// What has been stored or restored since counts at the next reset communication, not what LSS has
/// configured or activated before.
void Tmcc160::follow_order(const canopen::StorageCommand& command) {
  if ((command.groups & tmcc160::bit(tmcc160::Group::network)) != 0) {
    network_node().stored_node_id_changed();
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

bool Tmcc160::connect_serial(std::string_view interface, tmcl::SerialPort* port) {
  if (interface != kSerialInterfaces[0]) {
    return false;
  }
  serial_.connect(port);
  return true;
}

void Tmcc160::step_world(SimTime until) {
  plant::ServoAxis& plant = world_.plant();
  while (now_ + kCurrentPeriod <= until) {
    static_cast<void>(plant.step(axis_->step(plant.sensing()), kCurrentPeriod));
    now_ += kCurrentPeriod;
    // The first step after the firmware or a person did something is made; until one of them does
    // something again, a shaft at rest with the bridge off costs nothing.
    if (const std::int64_t restful = axis_->switched_off() ? plant.restful_steps() : 0;
        restful > 0) {
      const std::int64_t periods = std::min(restful, (until - now_) / kCurrentPeriod);
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
  configure_axis();
  axis_->conditions().shutdown_switch = !inputs_.enable();
  axis_->tick(now);
  report_errors(now);
}

void Tmcc160::apply(SimTime now) {
  if (!axis_->has_commands()) {
    return;
  }
  configure_axis();
  axis_->apply(now);
  report_errors(now);
  pdos().values_may_have_changed(now);
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
  drive::for_each_row_only_in(tmcc160::kAxisEmergencies, before, errors,
                              [&](const AxisEmergency& row) { report_error(row, false, now); });
  if (reset) {
    emergency_producer().report_reset(now);
  }
  drive::for_each_row_only_in(tmcc160::kAxisEmergencies, errors, before,
                              [&](const AxisEmergency& row) { report_error(row, true, now); });
}

void Tmcc160::report_error(const AxisEmergency& row, bool present, SimTime now) {
  const auto cause = static_cast<std::uint8_t>(row.error);
  const bool sent = row.documented || configuration_.options.undocumented_emergencies;
  const bool fault = row.reaction == drive::ErrorReaction::fault ||
                     row.reaction == drive::ErrorReaction::power_off;
  if (!present) {
    // Faults go with the fault reset, which is told once.
    if (sent && !fault) {
      emergency_producer().clear(row.code, cause, now);
    } else {
      emergency_producer().withdraw(row.code, cause);
    }
    return;
  }
  const canopen::Emergency emergency{
      .code = row.code,
      .error_register = row.register_bits,
      .information = {row.detail, row.of_device ? kOfDevice : std::uint8_t{0}},
      .cause = cause};
  if (sent) {
    emergency_producer().raise(emergency, now);
  } else {
    emergency_producer().note(emergency, now);
  }
}

std::vector<product::Signal> Tmcc160::signals() const {
  std::vector<product::Signal> signals;
  objects_.append_signals(signals);
  world_.append_signals(signals);
  return signals;
}

std::vector<product::Input> Tmcc160::inputs() {
  using Set = base::Delegate<void(double)>;
  std::vector<product::Input> inputs;
  world_.append_inputs(inputs);
  inputs.emplace_back("enable", "", 0.0, 1.0, Set::bind<&Tmcc160::input_enable>(*this),
                      product::InputGroup::switches, 1.0);
  inputs.emplace_back("analog_input_0", "count", 0.0, 4095.0,
                      Set::bind<&Tmcc160::input_analog<0>>(*this), product::InputGroup::lines);
  inputs.emplace_back("analog_input_1", "count", 0.0, 4095.0,
                      Set::bind<&Tmcc160::input_analog<1>>(*this), product::InputGroup::lines);
  inputs.emplace_back("analog_noise", "count", 0.0, 4095.0,
                      Set::bind<&product::AnalogNoise::set_amplitude>(inputs_.noise()),
                      product::InputGroup::lines);
  return inputs;
}

}  // namespace stator::devices
