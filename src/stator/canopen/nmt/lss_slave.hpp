// The layer setting services of a CANopen node (CiA 305), by which a master sets its node-ID and
// bit rate.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "stator/base/delegate.hpp"
#include "stator/base/event.hpp"
#include "stator/can/transmitter.hpp"
#include "stator/canopen/nmt/lss_protocol.hpp"
#include "stator/canopen/node_id.hpp"
#include "stator/canopen/service.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

struct LssConfiguration {
  /// Last part of the LSS address where the dictionary has no 1018h:04.
  std::uint32_t serial_number = 0;
};

/// What LSS needs of its device. Hooks may be left empty: then every bit rate of the standard table
/// is taken, activating does nothing, and storing is not supported.
struct LssHooks {
  /// Can the device work with this bit rate (bit/s)?
  base::Delegate<bool(std::uint32_t bit_rate)> supports;
  /// Work with this bit rate from now on.
  base::Delegate<void(std::uint32_t bit_rate, base::SimTime now)> activate;
  /// Keep node-ID and bit rate (nothing: unchanged) without supply; false if that fails. The
  /// node-ID may be kUnconfiguredNodeId.
  base::Delegate<bool(std::optional<std::uint8_t> node_id, std::optional<std::uint32_t> bit_rate)>
      store;
};

/// LSS slave (CiA 305): switch state, configure, store and inquire services, identification and
/// fastscan. It works in every NMT state, also in a node without a node-ID. The LSS address is
/// taken from 1018h. Its state is Waiting after every reset of the node.
class LssSlave final : public Service {
 public:
  LssSlave(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
           base::EventReporter reporter, const LssConfiguration& configuration);

  void set_hooks(const LssHooks& hooks) { hooks_ = hooks; }
  /// The supply has come, or reset node: what was configured and not stored is forgotten.
  void forget_configuration();
  /// The device has stored a node-ID otherwise than by LSS: the next reset communication puts that
  /// one into force, not one that LSS was asked to configure before.
  void forget_pending_node_id() { pending_node_id_.reset(); }
  /// The node-ID the node works with, to be told before start().
  void set_active_node_id(std::uint8_t node_id) { active_node_id_ = node_id; }
  /// The node-ID that the next reset communication puts into force (CiA 305: pending node-ID);
  /// nothing: the one the device has stored.
  [[nodiscard]] std::optional<std::uint8_t> pending_node_id() const { return pending_node_id_; }
  [[nodiscard]] bool configuring() const { return configuring_; }

  void start(base::SimTime now) override;
  bool receive(const can::Frame& frame, base::SimTime now) override;
  void advance(base::SimTime now) override;
  [[nodiscard]] base::SimTime next_deadline() const override { return activation_; }

 private:
  static constexpr std::size_t kAddressParts = 4;  ///< vendor, product, revision, serial number

  void switch_global(std::uint8_t mode, base::SimTime now);
  void switch_selective(std::size_t part, std::uint32_t value, base::SimTime now);
  void identify(std::size_t stage, std::uint32_t value);
  void fastscan(std::span<const std::byte> data, base::SimTime now);
  void configure(lss::Command command, std::span<const std::byte> data, base::SimTime now);
  [[nodiscard]] std::uint8_t configure_bit_timing(std::uint8_t table, std::uint8_t index,
                                                  base::SimTime now);
  [[nodiscard]] std::uint8_t store_configuration(base::SimTime now);
  void enter_configuration(base::SimTime now);
  [[nodiscard]] std::uint32_t address(std::size_t part) const;
  [[nodiscard]] bool unconfigured() const;
  void reply(lss::Command command, std::uint32_t data = 0);

  can::Transmitter& transmitter_;
  base::EventReporter reporter_;
  LssConfiguration configuration_;
  LssHooks hooks_;
  std::array<const dictionary::Entry*, kAddressParts> identity_{};  ///< 1018h:01 to 04
  std::uint8_t active_node_id_ = kUnconfiguredNodeId;
  std::optional<std::uint8_t> pending_node_id_;
  std::optional<std::uint32_t> pending_bit_rate_;
  base::SimTime activation_ = base::SimTime::never();
  bool configuring_ = false;
  std::size_t selective_matches_ = 0;  ///< parts of the address that matched, in order
  std::size_t identify_matches_ = 0;   ///< requests of an identification that matched, in order
  std::uint8_t fastscan_part_ = 0;     ///< part of the address being scanned
};

}  // namespace stator::canopen
