#include "stator/ethercat/controller/slave_controller.hpp"

#include <algorithm>
#include <utility>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/al_transition.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

constexpr base::EventRule kHostWatchdog{
    "esc-pdi-watchdog", base::Severity::fault,
    "PDI watchdog expired: the host has not accessed the controller for {0} us"};
constexpr base::EventRule kReset{
    "esc-reset", base::Severity::warning,
    "{0} has reset the controller (keys R, E, S in {1:x4}), which was in {2}; it starts as after "
    "power-on: configure it again from Init on"};
constexpr base::EventRule kResetOut{"esc-reset-out", base::Severity::warning,
                                    "{0} has asked for a reset (keys R, E, S in {1:x4}) in {2}: "
                                    "RESET_OUT rises, and the chip starts "
                                    "as after power-on if the board leads that to NRESET"};
constexpr base::EventRule kSiiChecksum{
    "esc-sii-checksum", base::Severity::warning,
    "EEPROM not loaded: checksum byte in word 7 is {0:x2}, the first seven words give {1:x2}; "
    "process memory and host interface stay closed, so that no state is reached and no mailbox "
    "answers, until a master writes a valid image and reloads it (0400h to 0502h) or resets the "
    "device"};
/// Argument: {0} ms.
constexpr base::EventRule kSiiGivenUp{
    "esc-sii-given-up", base::Severity::fault,
    "EEPROM write answered without acknowledge (0502h bit 13): the word is not kept after {0} ms, "
    "the disk of the state directory is too slow; write it again"};
constexpr base::EventRule kSiiAbsent{
    "esc-sii-absent", base::Severity::warning,
    "EEPROM not loaded: none answers; process memory and host interface stay closed, so that no "
    "state is reached and no mailbox answers; give the device an SII image"};
constexpr base::EventRule kPhyNotFound{
    "esc-phy-not-found", base::Severity::warning,
    "port {0} gets no link: link detection looks for its PHY at address {1} of the management bus, "
    "and none or that of the other port answers; strap it to this address (\"phy_addresses\" in "
    "the rack file)"};

constexpr unsigned kAlStateMask = 0x0F;

/// Words of the EEPROM's configuration area and the registers they are copied to at each load.
struct ConfigurationWord {
  std::size_t word;
  std::size_t byte;  ///< 0 low, 1 high
  std::size_t register_address;
};
constexpr ConfigurationWord kConfigurationWords[] = {
    {0, 0, kPdiControl},
    {0, 1, kEscConfiguration},
    {1, 0, kPdiConfiguration},
    {1, 1, kSyncLatchConfiguration},
    {2, 0, kSyncPulseLength},
    {2, 1, kSyncPulseLength + 1},
    {3, 0, kExtendedPdiConfiguration},
    {3, 1, kExtendedPdiConfiguration + 1},
};
constexpr std::size_t kAliasWord = 4;
constexpr std::size_t kReceiveFifoWord = 5;
constexpr std::size_t kChecksumWord = 7;
constexpr std::size_t kFirstCategoryWord = 0x40;
constexpr std::uint16_t kParameterRamCategory = 1;
constexpr std::size_t kParameterRamLength = 128;

}  // namespace

SlaveController::SlaveController(const SlaveControllerConfiguration& configuration)
    : memory_(kRegisterSpace + configuration.ram_kilobytes * std::size_t{1024}),
      configuration_(configuration),
      register_map_(configuration.features, configuration.answered_features,
                    configuration.fmmu_count, configuration.sync_manager_count),
      sii_(registers(), configuration.sii_timing,
           has_feature(configuration.features, ControllerFeature::sii_eight_byte_read),
           configuration.sii_error_blocks_commands),
      mii_(registers(), configuration.mii,
           has_feature(configuration.features, ControllerFeature::mii_link_detection)) {
  if (configuration.host_controls_time) {
    register_map_.give_time_loop_to_host();
  }
  power_on_reset();
}

void SlaveController::power_on_reset() {
  register_map_.reset(registers());
  write_build_registers(configuration_, registers());
  station_address_ = 0;
  station_alias_ = 0;
  alias_enabled_ = false;
  enhanced_link_detection_ = false;
  al_event_request_ = 0;
  ecat_event_request_ = 0;
  ecat_event_mask_ = 0;
  interrupt_ = 0;
  frame_work_ = 0;
  for (SyncManager& manager : sync_managers_) {
    manager = SyncManager();
  }
  activations_.fill(0);
  changed_activations_ = 0;
  al_status_ = 1;
  al_control_taken_ = true;
  registers_unlocked_ = false;
  controller_unlocked_ = false;
  ports_.reset();
  reset_sequence_.reset();
  clock_unit_.reset(now_);
  sii_.reset();
  if (has_feature(configuration_.features, ControllerFeature::mii_management)) {
    mii_.reset();
  }
  process_data_watchdog_.stop();
  host_watchdog_.stop();
  update_watchdog_times();
  if (partner_ != nullptr) {
    partner_->controller_reset(now_);
  }
  load_configuration_area(true);
  for (unsigned port = 0; port < kPorts; ++port) {
    update_link(port);  // the PHYs have been reset too
  }
  apply_loop_control();
}

void SlaveController::hold_reset(bool hold) {
  if (held_in_reset() == hold) {
    return;
  }
  ports_.hold_in_reset(hold);
  restore_power();
  ports_.note_topology_change();
}

void SlaveController::restore_power() {
  std::fill(memory_.begin() + kRegisterSpace, memory_.end(), std::byte{0});
  power_on_reset();
  reset_requested_ = true;
}

void SlaveController::request_reset(Side by) {
  reset_requested_ = true;
  const std::optional<AlState> state = to_al_state(al_status_ & kAlStateMask);
  reporter_.report(now_, configuration_.reset_by_board ? kResetOut : kReset,
                   {by == Side::bus ? base::StaticText("the master") : base::StaticText("its host"),
                    static_cast<int>(ResetSequence::address(by)),
                    state ? to_text(*state) : base::StaticText("an unknown state")});
  if (configuration_.reset_by_board) {
    reset_sequence_.reset();
  } else {
    power_on_reset();
  }
}

void SlaveController::load_sii(std::span<const std::byte> image) {
  sii_.insert(image);
  sii_.reset();
  load_configuration_area(true);
}

void SlaveController::load_configuration_area(bool first) {
  advance_sync();  // pulses so far came with the settings so far
  if (first) {
    report_missing_phys();
  }
  const SiiInterface::LoadResult result = sii_.load();
  loaded_ = result == SiiInterface::LoadResult::loaded;
  std::array<std::byte, SiiInterface::kConfigurationAreaLength> content{};
  if (result != SiiInterface::LoadResult::no_eeprom) {
    content = sii_.configuration_area();
  }
  if (result == SiiInterface::LoadResult::bad_checksum) {
    reporter_.report(
        now_, kSiiChecksum,
        {std::to_integer<unsigned>(content[2 * kChecksumWord]), unsigned{sii_checksum(content)}});
  } else if (result == SiiInterface::LoadResult::no_eeprom) {
    reporter_.report(now_, kSiiAbsent);
  }
  if (loaded_) {
    for (const ConfigurationWord& entry : kConfigurationWords) {
      if (register_map_[entry.register_address].bus_reads) {
        memory_[entry.register_address] = content[2 * entry.word + entry.byte];
      }
    }
    if (first) {
      station_alias_ = base::load_le<std::uint16_t>(content, 2 * kAliasWord);
      base::store_le(registers(), kStationAlias, station_alias_);
      constexpr std::byte kAnyPort{0xF2};
      enhanced_link_detection_ = (memory_[kEscConfiguration] & kAnyPort) != std::byte{0};
      // Inverted, so that an EEPROM that says nothing leaves the reset value.
      const auto word = base::load_le<std::uint16_t>(content, 2 * kReceiveFifoWord);
      memory_[kReceiveFifoSize] = (memory_[kReceiveFifoSize] & std::byte{0xF8}) |
                                  static_cast<std::byte>(~unsigned{word} >> 9 & 7U);
      ports_.note_topology_change();
    }
    load_parameter_ram();
  }
  if (configuration_.device_emulation) {
    memory_[kEscConfiguration] |= std::byte{1};
  }
  open_host_interface();
  if (partner_ != nullptr) {
    partner_->parameters_changed(now_);
  }
  compile_mappings();
  update_dl_status();
  // Pulse length and mapping of the SYNC outputs may be others now.
  take_clock_work(clock_unit_.refresh(now_));
}

void SlaveController::report_missing_phys() {
  if (!has_feature(configuration_.features, ControllerFeature::mii_link_detection)) {
    return;
  }
  for (unsigned port = 0; port < kPorts; ++port) {
    if (has_port(port) && MiiManagement::has_phy(port) && !mii_.finds(port)) {
      reporter_.report(now_, kPhyNotFound, {port, mii_.expected_address(port)});
    }
  }
}

void SlaveController::load_parameter_ram() {
  const std::span<const std::byte> content = sii_.content();
  constexpr std::size_t kHeader = 2 * kFirstCategoryWord;
  if (!has_feature(configuration_.features, ControllerFeature::parameter_ram) ||
      content.size() < kHeader + 4 ||
      base::load_le<std::uint16_t>(content, kHeader) != kParameterRamCategory) {
    return;
  }
  const std::size_t announced = base::load_le<std::uint16_t>(content, kHeader + 2) * std::size_t{2};
  const std::size_t length =
      std::min({announced, kParameterRamLength, content.size() - kHeader - 4});
  clear_registers(kParameterRam, kParameterRam + kParameterRamLength - 1);
  std::copy_n(content.begin() + kHeader + 4, length, memory_.begin() + kParameterRam);
}

void SlaveController::advance(base::SimTime now) {
  if (now <= now_) {
    return;
  }
  now_ = now;
  if (now_ >= next_deadline_) {
    expire(now_);
  }
}

void SlaveController::expire(base::SimTime now) {
  if (process_data_watchdog_.expire(now)) {
    count(kProcessDataWatchdogCounter);
    al_event_request_ |= al_event::kProcessDataWatchdog;
  }
  if (host_watchdog_.expire(now)) {
    count(kPdiWatchdogCounter);
    memory_[kErrorLedOverride] &= std::byte{0x0F};
    update_dl_status();
    const std::int64_t divider = base::load_le<std::uint16_t>(registers(), kWatchdogDivider);
    const std::int64_t time = base::load_le<std::uint16_t>(registers(), kPdiWatchdogTime);
    reporter_.report(now, kHostWatchdog, {(divider + 2) * time / 25});
  }
  const SiiInterface::Completion access = sii_.finish(now);
  if (access == SiiInterface::Completion::reload) {
    load_configuration_area(false);
  } else if (access == SiiInterface::Completion::given_up) {
    reporter_.report(now, kSiiGivenUp, {SiiInterface::kLongestWrite.nanoseconds() / 1'000'000});
  }
  if (now >= mii_.deadline()) {
    mii_.finish(now);
    update_link(0);
    update_link(1);
  }
  if (now >= clock_unit_.deadline()) {
    take_clock_work(clock_unit_.expire(now_));
  }
  if (now >= ports_.deadline()) {
    ports_.expire();
    update_dl_status();
  }
  update_deadline();
}

void SlaveController::update_deadline() {
  next_deadline_ =
      std::min({process_data_watchdog_.deadline(), host_watchdog_.deadline(), sii_.deadline(),
                mii_.deadline(), ports_.deadline(), clock_unit_.deadline()});
}

bool SlaveController::take_reset_request() {
  return std::exchange(reset_requested_, false);
}

void SlaveController::peek(std::uint16_t address, std::span<std::byte> out) const {
  const std::size_t from = std::min<std::size_t>(address, memory_.size());
  const std::size_t count = std::min(out.size(), memory_.size() - from);
  std::copy_n(memory_.begin() + static_cast<std::ptrdiff_t>(from), count, out.begin());
  std::fill(out.begin() + static_cast<std::ptrdiff_t>(count), out.end(), std::byte{0});
}

}  // namespace stator::ethercat
