#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "devices/canopen_sequences/object_rules.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"

namespace stator::tests {

/// Which rule of the standards a node broke.
enum class Rule : std::uint8_t {
  boot_up,     ///< CiA 301 §7.2.8.3.3: one message when Initialisation ends, and nothing before
  node_id,     ///< CiA 305 §6: which node-ID it boots up with
  silence,     ///< services that the state does not have (CiA 301 table 38), identifiers
  sdo_answer,  ///< one answer per request, well formed
  sdo_abort_code,   ///< the precise one
  value,            ///< what was written reads back, what was refused left no trace
  error_register,   ///< 1001h shows what lasts
  emergency,        ///< one for each error, none without, in its inhibit time
  heartbeat,        ///< cadence and state
  guarding,         ///< toggle bit and state
  inhibit_time,     ///< of event-driven TPDOs
  event_timer,      ///< they come in time
  transmit_pdo,     ///< only when an event has happened, with the length of their mapping
  synchronous_pdo,  ///< at each SYNC and only there
  lss,              ///< one answer to what asks for one
};
[[nodiscard]] const char* to_text(Rule rule);

struct Violation {
  Rule rule{};
  std::string text;
};

enum class State : std::uint8_t {
  initialisation = 0,
  stopped = 4,
  operational = 5,
  pre_operational = 127
};

/// What CiA 301, CiA 305 and the product's decisions demand of a node, as far as can be said
/// without knowing how it works: it hears what the node hears, sees what the node sends, and tells
/// the first thing that is wrong. On a bus whose frames take no time.
class ReferenceNode {
 public:
  using Time = base::SimTime;
  using Key = std::pair<std::uint16_t, std::uint8_t>;
  struct Options {
    bool lss = false;
    bool stores_communication = false;
    base::SimDuration boot_time{};
    base::SimDuration reset_time{};
    base::SimDuration sdo_timeout{};
  };

  /// `defaults`: the values of the objects under test after the first boot-up of all.
  ReferenceNode(const Options& options, std::uint8_t node_id,
                const std::map<Key, std::uint32_t>& defaults);

  // What happens to the node.
  void power_on(Time now);
  void hear(const can::Frame& frame, Time now);
  void set_supply(bool good, Time now);
  // What it does.
  void see(const can::Frame& frame, Time now);
  /// All that the node sends at this instant has been seen.
  void settle(Time now);
  void pass(Time now);

  [[nodiscard]] const std::optional<Violation>& violation() const { return violation_; }
  /// Rules whose violation is passed over.
  void set_excepted(const std::set<Rule>& rules) { excepted_ = rules; }
  [[nodiscard]] std::uint8_t node_id() const { return node_id_; }
  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] std::uint32_t value(std::uint16_t index, std::uint8_t subindex) const;
  /// The toggle bit that the next segment must have.
  [[nodiscard]] bool next_toggle() const { return toggle_; }
  /// Mapped bytes of a PDO whose mapping object is `mapping`.
  [[nodiscard]] std::uint8_t mapped_bytes(std::uint16_t mapping) const;

 private:
  static constexpr std::size_t kPdos = 4;
  static constexpr std::uint32_t kInvalid = 0x80000000;

  /// What must answer a request: a value or a success, one of some aborts, or either.
  struct Answer {
    std::optional<std::array<std::uint8_t, 8>> success{};
    /// Bytes of `success` that are not looked at, bit n for byte n.
    unsigned open_bytes = 0;
    std::set<std::uint32_t> aborts{};
    /// Bytes 1 to 3 of an abort name the object.
    bool names_object = true;
    std::function<void(const can::Frame&)> on_success{};
  };
  enum class Transfer : std::uint8_t { none, upload, download };
  struct Error {
    std::uint8_t bits = 0;
    bool certain = true;
  };
  struct DueEmergency {
    std::uint16_t code = 0;
    Time since;
    bool must = true;
    std::uint8_t bits = 0;
  };
  struct TransmitState {
    std::optional<Time> sent;
    std::optional<Time> event_sent;  ///< while it was event-driven, from when inhibit time counts
    std::uint64_t data = 0;
    Time timer_base;  ///< the event timer counts from here or from `sent`
    Time free_until;  ///< may be sent without an event until then
    std::optional<Time> must_come_by;
    bool awaits_sync = false;
    bool came_at_sync = false;
  };
  struct ReceiveState {
    std::optional<std::uint64_t> waiting;
    std::uint16_t length_error = 0;
  };

  void fail(Rule rule, std::string text, Time now);
  void catch_up(Time now);

  // NMT, error control, LSS; reference_node.cpp.
  void hear_nmt(const can::Frame& frame, Time now);
  void initialise(bool application, base::SimDuration duration, Time now);
  void boot_up(std::uint8_t node_id, Time now);
  void enter(State state, bool by_itself, Time now);
  void hear_guarding(Time now);
  void hear_heartbeat(const can::Frame& frame, Time now);
  void hear_lss(const can::Frame& frame);
  void see_error_control(const can::Frame& frame, Time now);
  void see_emergency(const can::Frame& frame, Time now);
  void communication_error(const std::string& key, Time now);
  void raise(std::uint16_t code, const std::string& key, std::uint8_t bits, Time now,
             bool must = true);
  void make_uncertain(const std::string& key);
  [[nodiscard]] bool state_is(State state, Time now) const;
  [[nodiscard]] bool has_sdo(Time now) const;
  [[nodiscard]] base::SimDuration life_time() const;

  // SDO; reference_sdo.cpp.
  void hear_sdo(const can::Frame& frame, Time now);
  void see_sdo(const can::Frame& frame, Time now);
  void end_transfer();
  [[nodiscard]] Answer initiate_upload(const can::Frame& frame);
  [[nodiscard]] Answer initiate_download(const can::Frame& frame, Time now);
  [[nodiscard]] Answer upload_segment(const can::Frame& frame);
  [[nodiscard]] Answer download_segment(const can::Frame& frame, Time now);
  [[nodiscard]] Answer write(const ObjectUnderTest& object, std::uint32_t raw, std::size_t size,
                             const std::array<std::uint8_t, 8>& success, Time now);

  // Values; reference_values.cpp.
  /// The abort codes of which one must refuse the value; none: it must be taken. `either`: both do.
  [[nodiscard]] std::set<std::uint32_t> judge(const ObjectUnderTest& object, std::uint32_t raw,
                                              bool& either) const;
  [[nodiscard]] std::set<std::uint32_t> judge_cob_id(const ObjectUnderTest& object,
                                                     std::uint32_t raw) const;
  [[nodiscard]] std::set<std::uint32_t> judge_mapping(const ObjectUnderTest& object,
                                                      std::uint32_t raw, bool& either) const;
  [[nodiscard]] bool can_id_in_use(std::uint32_t can_id) const;
  void written(const ObjectUnderTest& object, std::uint32_t raw, Time now);
  void store(const std::set<Stored>& groups, bool clear);
  void reset_values(bool application);
  void load_values(bool application);

  // Process data; reference_process_data.cpp.
  void hear_sync(Time now);
  bool hear_process_data(const can::Frame& frame, Time now);
  void apply(std::size_t pdo, std::uint64_t data, Time now);
  void see_process_data(std::size_t pdo, const can::Frame& frame, Time now);
  void process_data_state(bool operational, Time now);
  void pdo_written(const ObjectUnderTest& object, std::uint32_t before, Time now);
  void make_receive_errors_uncertain(std::size_t pdo);
  void check_process_data(Time now);
  [[nodiscard]] std::uint32_t transmit_value(std::size_t pdo, std::uint8_t subindex) const;
  [[nodiscard]] bool transmits(std::size_t pdo) const;
  [[nodiscard]] bool event_driven(std::size_t pdo) const;
  [[nodiscard]] base::SimDuration inhibit(std::size_t pdo) const;

  Options options_;
  std::optional<Violation> violation_;
  std::set<Rule> excepted_;

  State state_ = State::initialisation;
  State before_ = State::initialisation;
  Time changed_by_itself_at_ = Time::never();
  std::uint8_t node_id_;
  std::set<std::uint8_t> possible_node_ids_;
  Time boot_up_by_ = Time::never();
  bool supply_ = true;
  Time supply_certain_at_ = Time::never();

  std::map<Key, std::uint32_t> defaults_;  ///< those with the node-ID without it
  std::map<Key, std::uint32_t> values_;
  std::map<Stored, std::map<Key, std::uint32_t>> images_;

  std::optional<Answer> answer_;
  std::array<std::uint8_t, 3> requested_{};  ///< object of the request being answered
  Transfer transfer_ = Transfer::none;
  const ObjectUnderTest* transferred_ = nullptr;
  std::optional<std::size_t> announced_;
  std::size_t offset_ = 0;
  bool toggle_ = false;
  std::uint64_t segments_ = 0;  ///< data of a segmented download
  Time transfer_ends_ = Time::never();
  bool timed_out_ = false;  ///< its abort is to be seen

  Time heartbeat_from_ = Time::never();  ///< the next one comes from then …
  Time heartbeat_by_ = Time::never();    ///< … until then
  bool guard_answer_due_ = false;
  bool guard_toggle_ = false;
  Time life_end_ = Time::never();
  bool life_guarded_ = false;
  Time watched_until_ = Time::never();

  bool lss_configuring_ = false;
  std::optional<std::uint8_t> pending_node_id_;
  bool stored_since_pending_ = false;
  std::optional<std::array<int, 3>> lss_answer_;  ///< first bytes, -1: any

  std::map<std::string, Error> errors_;
  std::vector<DueEmergency> due_;
  Time emergencies_flow_since_;
  std::optional<Time> emergency_sent_;
  base::SimDuration emergency_inhibit_{};

  std::array<TransmitState, kPdos> transmit_;
  std::array<ReceiveState, kPdos> receive_;
  Time stimulus_;  ///< when something last could change what the node transmits
  std::optional<Time> sync_;
};

}  // namespace stator::tests
