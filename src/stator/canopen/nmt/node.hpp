// A CANopen node: its NMT state machine, services, settings and the hooks of the device it belongs
// to.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/acceptance_filter.hpp"
#include "stator/can/frame.hpp"
#include "stator/can/transmitter.hpp"
#include "stator/canopen/emergency/communication_errors.hpp"
#include "stator/canopen/emergency/emergency_sink.hpp"
#include "stator/canopen/emergency/emergency_storm.hpp"
#include "stator/canopen/nmt/error_control.hpp"
#include "stator/canopen/nmt/heartbeat_consumer.hpp"
#include "stator/canopen/nmt/lss_slave.hpp"
#include "stator/canopen/nmt_state.hpp"
#include "stator/canopen/node_id.hpp"
#include "stator/canopen/sdo/sdo_server.hpp"
#include "stator/canopen/service.hpp"
#include "stator/canopen/sync/time_stamp.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/dictionary/write_completion.hpp"

namespace stator::canopen {

struct NodeConfiguration {
  /// 1 to 127, or kUnconfiguredNodeId; NodeHooks::reset_communication may say another one.
  std::uint8_t node_id = 1;
  /// From switching on to the boot-up message.
  base::SimDuration boot_time{500'000'000};
  /// From an NMT reset to the boot-up message.
  base::SimDuration reset_time{1'000'000};
  SdoServerConfiguration sdo{};
  /// The node has the layer setting services.
  std::optional<LssConfiguration> lss{};
  /// Manufacturer-specific bytes of emergency 8130h, heartbeat or life guarding error.
  std::array<std::uint8_t, 5> life_guard_information{};
  /// What it does otherwise than a node should.
  dictionary::Quirks quirks{};
};

/// What a device does when its node's NMT state machine goes through Initialisation (CiA 301
/// §7.3.2.2.1) or changes state. Hooks may be left empty.
struct NodeHooks {
  /// Reset application: manufacturer and profile objects take the values they have after power-on.
  /// At power-on and on reset node, before reset_communication.
  base::Delegate<void(base::SimTime now)> reset_application;
  /// Reset communication: the communication objects take the values they have after power-on.
  /// Returns the stored node-ID, to work with from now on unless LSS was asked to configure another
  /// one since reset node.
  base::Delegate<std::uint8_t(base::SimTime now)> reset_communication;
  /// The node is about to boot up with this node-ID, that of reset_communication unless LSS has
  /// configured another one. COB-IDs that contain the node-ID are the device's to set here.
  base::Delegate<void(std::uint8_t node_id, base::SimTime now)> assign_node_id;
  /// The NMT state has changed, and every service knows.
  base::Delegate<void(NmtState state, base::SimTime now)> state_changed;
};

struct NodeStatistics {
  std::uint64_t received = 0;             ///< frames given to the node while it had supply
  std::uint64_t ignored = 0;              ///< those of them that no part of the node took
  std::uint64_t malformed_nmt = 0;        ///< NMT messages with a length other than 2
  std::uint64_t unknown_nmt_command = 0;  ///< NMT messages to this node with an unknown command
};

/// A CANopen slave (CiA 301): the NMT slave state machine, and the services it lets take part in
/// the traffic. Passive: frames and time come in, frames go out through the transmitter.
///
/// `receive` and `advance` must be called with times that do not go back; advance() at the latest
/// at next_deadline(), so that what the node does on the clock is done in time.
class Node {
 public:
  /// `dictionary` must be finished; all arguments by reference must outlive the node.
  Node(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
       base::EventReporter reporter, const NodeConfiguration& configuration = {});
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node() = default;

  // What belongs to it; all to be set before power_on().

  void set_hooks(const NodeHooks& hooks) { hooks_ = hooks; }
  /// Adds a service after those there are. It is started with the node, hears state changes, and is
  /// given frames in Pre-operational and Operational.
  void add(Service& service);
  /// Where errors of the node's own services are reported; null: nowhere.
  void set_emergency_sink(EmergencySink* sink) { communication_errors_.set_sink(sink); }
  /// What is done about a communication error; null: nothing.
  void set_communication_error_reaction(CommunicationErrorReaction* reaction) {
    communication_errors_.set_reaction(reaction);
  }
  /// Lets the node exclude data frames that none of its services takes by the filter of its
  /// controller; null: the node gets all frames.
  void set_acceptance_filter(can::AcceptanceFilter* filter) { filter_ = filter; }
  /// Decides when writes by SDO are complete; null: at once.
  void set_write_completion(dictionary::WriteCompletion* completion);
  /// What LSS needs of the device; ignored if the node has no LSS.
  void set_lss_hooks(const LssHooks& hooks);

  // Its life.

  /// The supply has come: Initialisation begins; the boot-up message comes a boot time later.
  void power_on(base::SimTime now);
  /// The supply has gone: nothing is sent or taken until power_on().
  void power_off(base::SimTime now);
  void receive(const can::Frame& frame, base::SimTime now);
  void advance(base::SimTime now);
  [[nodiscard]] base::SimTime next_deadline() const;

  [[nodiscard]] NmtState state() const { return state_; }
  /// The node-ID it works with, or kUnconfiguredNodeId.
  [[nodiscard]] std::uint8_t node_id() const { return node_id_; }
  [[nodiscard]] const NodeStatistics& statistics() const { return statistics_; }
  /// The network's time of day.
  [[nodiscard]] TimeStamp& time_stamp() { return time_stamp_; }
  [[nodiscard]] const SdoServer& sdo_server(std::size_t position = 0) const {
    return *sdo_servers_[position];
  }

  // What the device itself may cause.

  /// The NMT services of these names, as if the NMT master had asked for them.
  void reset_node(base::SimTime now);
  void reset_communication(base::SimTime now);
  /// Changes to Pre-operational, Operational or Stopped, as error behaviour (1029h) does. Nothing
  /// happens in Initialisation.
  void enter(NmtState state, base::SimTime now);
  /// The device has stored another node-ID otherwise than by LSS: reset communication takes it, not
  /// one that LSS was asked to configure before.
  void stored_node_id_changed();
  /// To be called when a communication object was changed otherwise than by SDO.
  void communication_objects_changed() { forget_ignored(); }

 private:
  static constexpr std::size_t kIdentifiers = 0x800;

  struct Member {
    Service* service = nullptr;
    bool in_stopped = false;      ///< it takes part in the traffic in Stopped, too
    bool writes_objects = false;  ///< what it receives may change communication objects
  };

  void enlist(Service& service, bool in_stopped, bool writes_objects);
  void ignore(std::uint32_t identifier) {
    ignored_identifiers_.set(identifier);
    if (filter_ != nullptr) {
      filter_->reject(identifier);
    }
  }
  void forget_ignored() {
    ignored_identifiers_.reset();
    if (filter_ != nullptr) {
      filter_->accept_all();
    }
  }
  void receive_nmt(const can::Frame& frame, base::SimTime now);
  [[nodiscard]] bool dispatch(const can::Frame& frame, base::SimTime now);
  void initialise(bool with_application, base::SimDuration until_boot_up, base::SimTime now);
  void finish_initialisation(base::SimTime now);
  void boot_up(base::SimTime now);
  [[nodiscard]] bool works(const Member& member) const;
  void change_state(NmtState state, base::SimTime now);
  void refresh_deadline() const;

  can::Transmitter& transmitter_;
  base::EventReporter reporter_;
  NodeConfiguration configuration_;
  NodeHooks hooks_;

  bool powered_ = false;
  NmtState state_ = NmtState::initialisation;
  std::uint8_t node_id_;
  base::SimTime boot_up_due_ = base::SimTime::never();
  bool awaits_node_id_ = false;  ///< Initialisation cannot end before LSS has given one
  NodeStatistics statistics_;
  /// Identifiers of data frames that no service takes in the present state; saves asking all
  /// services.
  std::bitset<kIdentifiers> ignored_identifiers_;
  can::AcceptanceFilter* filter_ = nullptr;
  mutable base::SimTime deadline_ = base::SimTime::never();
  mutable bool deadline_stale_ = true;

  CommunicationErrors communication_errors_;
  ErrorControl error_control_;
  HeartbeatConsumer heartbeat_consumer_;
  TimeStamp time_stamp_;
  std::optional<LssSlave> lss_;
  std::optional<EmergencyStorm> storm_;
  std::vector<std::unique_ptr<SdoServer>> sdo_servers_;
  std::vector<Member> members_;
};

}  // namespace stator::canopen
