// All PDOs of a CANopen node (CiA 301 §7.2.2), with counters of frames and errors.
#pragma once

#include <bitset>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/event.hpp"
#include "stator/can/transmitter.hpp"
#include "stator/canopen/emergency/emergency_sink.hpp"
#include "stator/canopen/pdo/pdo_rules.hpp"
#include "stator/canopen/pdo/receive_pdo.hpp"
#include "stator/canopen/pdo/transmit_pdo.hpp"
#include "stator/canopen/service.hpp"
#include "stator/canopen/sync/sync_consumer.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

struct PdoStatistics {
  std::uint64_t received = 0;        ///< frames taken by receive PDOs
  std::uint64_t length_errors = 0;   ///< too short or too long
  std::uint64_t outside_window = 0;  ///< synchronous ones that came after the synchronous window
  std::uint64_t refused_values = 0;  ///< objects that began to refuse what comes
};

/// All PDOs of a node (CiA 301 §7.2.2): those whose objects 14xxh and 16xxh, or 18xxh and 1Axxh,
/// its dictionary declares. Checks writes to these objects; a mapping is compiled when its PDO
/// changes, frames only walk it.
///
/// PDOs work in Operational. On entering it every valid event-driven transmit PDO is sent. On a
/// SYNC transmit PDOs are sampled and sent first, then the values of synchronous receive PDOs take
/// effect: what is sent belongs to the moment of the SYNC.
class PdoService final : public Service {
 public:
  PdoService(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
             EmergencySink& emergencies, base::EventReporter reporter, const PdoRules& rules = {});

  /// Told when all objects of a receive PDO, or of all synchronous ones at a SYNC, have their
  /// values, so that the device can obey them together.
  using ProcessDataHook = base::Delegate<void(base::SimTime)>;
  void set_process_data_hook(ProcessDataHook hook) { process_data_ = hook; }

  /// Mapped values may have changed since the last call: to be called by the device where that can
  /// happen, e.g. once per firmware period. A change is an event of the transmit PDO.
  void values_may_have_changed(base::SimTime now);
  /// Asks for a transmission of transmit PDO `number` (0 = 1800h), as an event does.
  void request(std::uint16_t number, base::SimTime now);
  void on_sync(const Sync& sync);

  void start(base::SimTime now) override;
  void on_state(NmtState state, base::SimTime now) override;
  bool receive(const can::Frame& frame, base::SimTime now) override;
  void advance(base::SimTime now) override;
  [[nodiscard]] base::SimTime next_deadline() const override;

  [[nodiscard]] std::span<const ReceivePdo> receive_pdos() const { return receive_; }
  [[nodiscard]] std::span<const TransmitPdo> transmit_pdos() const { return transmit_; }
  [[nodiscard]] const PdoStatistics& statistics() const { return statistics_; }

 private:
  /// Which PDO an object of the dictionary belongs to.
  struct Place {
    PdoDirection direction = PdoDirection::receive;
    bool mapping = false;  ///< 16xxh or 1Axxh
    std::uint16_t number = 0;
  };
  [[nodiscard]] static Place place_of(std::uint16_t index);
  void install_hooks(const dictionary::Object& object);
  /// The mapping of a PDO the dictionary declares; null for another one.
  [[nodiscard]] const PdoMapping* mapping_of(PdoDirection direction, std::uint16_t number);
  [[nodiscard]] bool is_valid(const Place& place) const;
  void mark_changed(PdoDirection direction, std::uint16_t number);

  // Rules for writes; pdo_service_objects.cpp.
  void close_further_pdos();
  [[nodiscard]] dictionary::Verdict check_communication(const dictionary::Entry& entry,
                                                        std::uint64_t value);
  [[nodiscard]] dictionary::Verdict check_transmission_type(const dictionary::Entry& entry,
                                                            PdoDirection direction,
                                                            std::uint64_t value) const;
  [[nodiscard]] dictionary::Verdict check_mapping(const dictionary::Entry& entry,
                                                  std::uint64_t value);
  void on_written(const dictionary::Entry& entry);

  void follow_changes(base::SimTime now);
  void follow_all(base::SimTime now);
  void rebuild_filter();
  void begin_process_data(base::SimTime now);
  void end_process_data();
  void receive_data(ReceivePdo& pdo, const can::Frame& frame, base::SimTime now);
  void check_length(ReceivePdo& pdo, const can::Frame& frame, base::SimTime now);
  void clear_errors(ReceivePdo& pdo, base::SimTime now);
  void clear_timeout(ReceivePdo& pdo, base::SimTime now);
  void check_timeouts(base::SimTime now);
  void on_refused(const PdoMapping::Item& item, const dictionary::Refusal* refusal,
                  std::uint64_t raw);
  [[nodiscard]] PdoMapping::RefusedHook refused_hook(const ReceivePdo& pdo, base::SimTime now);
  void process_data_have_come(base::SimTime now);

  dictionary::Dictionary& dictionary_;
  EmergencySink& emergencies_;
  base::EventReporter reporter_;
  PdoRules rules_;
  ProcessDataHook process_data_;
  std::vector<ReceivePdo> receive_;           ///< ascending number
  std::vector<TransmitPdo> transmit_;         ///< ascending number
  std::bitset<kCanIdMask + 1> data_can_ids_;  ///< of valid receive PDOs

  bool operational_ = false;
  bool changed_ = false;  ///< objects of a PDO were written; advance() follows them
  base::SimTime window_end_ = base::SimTime::never();
  PdoStatistics statistics_;
  // What on_refused() is about; set by refused_hook().
  const ReceivePdo* unpacking_ = nullptr;
  base::SimTime unpacking_time_;
};

}  // namespace stator::canopen
