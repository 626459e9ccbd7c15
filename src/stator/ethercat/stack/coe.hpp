#pragma once

#include <cstddef>
#include <cstdint>

#include "stator/base/event.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/ethercat/stack/emergency.hpp"
#include "stator/ethercat/stack/sdo_information.hpp"
#include "stator/ethercat/stack/sdo_server.hpp"
#include "stator/ethercat/stack/slave_stack_statistics.hpp"
#include "stator/ethercat/standard/mailbox_protocol.hpp"

namespace stator::ethercat {

/// Service field of the CoE header (ETG.1000.6 table 28).
enum class CoeService : std::uint8_t {
  emergency = 1,
  sdo_request = 2,
  sdo_response = 3,
  tx_pdo = 4,
  rx_pdo = 5,
  tx_pdo_remote_request = 6,
  rx_pdo_remote_request = 7,
  sdo_information = 8,
};

/// CAN application protocol over EtherCAT: sorts messages by service (ETG.1000.6 §5.6.1).
class CoeServer final : public MailboxProtocol {
 public:
  struct Features {
    bool complete_access = false;
    bool sdo_information = false;
    dictionary::Quirks quirks{};
  };

  CoeServer(dictionary::Dictionary& dictionary, const Features& features,
            base::EventReporter reporter, SlaveStackStatistics& statistics);

  [[nodiscard]] MailboxType type() const override { return MailboxType::coe; }
  [[nodiscard]] bool available_in(AlState state) const override {
    return state != AlState::init && state != AlState::bootstrap;
  }
  void reset() override;
  [[nodiscard]] MailboxReply handle(std::span<const std::byte> request, std::span<std::byte> reply,
                                    base::SimTime now) override;
  [[nodiscard]] bool has_message() const override;
  [[nodiscard]] std::size_t next_message(std::span<std::byte> message, base::SimTime now) override;
  /// Emergencies go to the master, fragments of SDO information to who asked.
  [[nodiscard]] bool next_message_is_answer() const override { return emergencies_.empty(); }

  /// The answer to a write is still to come.
  [[nodiscard]] bool answer_pending() const override { return sdo_.completing(); }

  /// See SdoServer::set_write_completion().
  void set_write_completion(dictionary::WriteCompletion* completion) {
    sdo_.set_write_completion(completion);
  }
  /// The state in which accesses now happen.
  void set_network_state(dictionary::NetworkState state) { sdo_.set_network_state(state); }

  /// See Mailbox::set_intervention().
  void set_intervention(MailboxIntervention* intervention) { sdo_.set_intervention(intervention); }

  /// False if the queue was full.
  bool queue_emergency(const EmergencyMessage& message);
  void drop_emergencies() { emergencies_.clear(); }

 private:
  EmergencyQueue emergencies_;
  SdoServer sdo_;
  SdoInformation information_;
  bool information_enabled_;
  SlaveStackStatistics& statistics_;
};

}  // namespace stator::ethercat
