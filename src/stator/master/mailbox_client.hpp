#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/ethercat/standard/mailbox_protocol.hpp"
#include "stator/master/al_control.hpp"
#include "stator/master/bus.hpp"
#include "stator/master/sdo_types.hpp"
#include "stator/master/slave.hpp"

namespace stator::master {

/// The master's end of one slave's mailbox (ETG.1000.4 §5.6): sends messages, fetches answers, has
/// lost ones repeated and puts emergencies aside.
class MailboxClient {
 public:
  /// All references must outlive the client. `idle` is called between two looks at the mailbox.
  MailboxClient(Bus& bus, const Station& station, const SlaveInformation& information,
                const Idle& idle);

  /// Writes the settings of sync managers 0 and 1; to be done in Init.
  Result<void> configure();

  /// Room for a message behind the mailbox header.
  [[nodiscard]] std::size_t capacity() const;
  [[nodiscard]] const Station& station() const { return station_; }

  /// Removes what still lies in the slave's mailbox, e.g. the late answer to an abandoned request,
  /// then sends `message` (without the mailbox header).
  Result<void> send(ethercat::MailboxType type, std::span<const std::byte> message);

  /// The next message of `type`, without the mailbox header. CoE emergencies are put aside,
  /// messages of other protocols are dropped. ErrorCode::mailbox when nothing came until `deadline`
  /// or the slave answered with a mailbox error.
  Result<std::vector<std::byte>> receive(ethercat::MailboxType type, base::SimTime deadline);

  /// When an answer to a request made now is overdue.
  [[nodiscard]] base::SimTime answer_deadline();

  /// Emergencies put aside, oldest first; forgets them.
  std::vector<Emergency> take_emergencies();
  /// Fetches emergencies the slave has ready, without a request of its own.
  Result<void> collect();

  /// Takes over what `other`, a client of the same slave, knows of it.
  void go_on_from(const MailboxClient& other);

 private:
  struct Message {
    ethercat::MailboxHeader header;
    std::vector<std::byte> data;
  };

  Result<bool> full();
  Result<Message> read_mailbox();
  Result<Message> fetch();
  Result<std::optional<Message>> fetch_if_full();
  [[nodiscard]] Error refusal(const Message& message) const;
  Result<void> request_repetition();
  Result<void> wait_until_full();
  Result<void> wait_before(base::SimTime deadline, const char* complaint);
  Result<void> write_message(std::span<const std::byte> mailbox, base::SimTime deadline);
  bool put_aside(const Message& message);

  Bus& bus_;
  Station station_;
  const SlaveInformation& information_;
  Idle idle_;
  std::uint8_t counter_ = 0;             ///< of the last request
  std::uint8_t last_counter_ = 0;        ///< of the last message of the slave
  std::optional<Message> early_answer_;  ///< came while its request was still being written
  std::vector<Emergency> emergencies_;
};

}  // namespace stator::master
