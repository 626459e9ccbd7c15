#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ethercat/raw_frame.hpp"
#include "masters/master_sequence.hpp"
#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/product/device/ethercat_device.hpp"

namespace stator::tests {

/// A product on a cable of its own, a master, and the rules that ETG.1000 has for what is between
/// them. The first rule that is broken stays.
///
/// - 0130h bit 4 is set exactly while 0134h is not 0.
/// - The state changes on request only, along the state machine, or downwards with an error.
/// - A request is refused with the code the standard has for it; an error that was not acknowledged
///   blocks all but Init.
/// - Outputs act in Operational only, and only those that came since Safe-Operational was entered.
/// - The working counter of process data is complete while their channels are as they were when
///   Safe-Operational was entered.
/// - The watchdog ends Operational after 0400h and 0420h as they stand, and never before.
/// - Above Init, every request to the mailbox has exactly one answer of the right service.
/// - Who brings the slave up by the book reaches Operational, whatever was before.
class SlaveRules {
 public:
  explicit SlaveRules(const MakeDevice& make);

  void perform(const MasterAction& action);
  [[nodiscard]] const std::optional<std::string>& broken() const { return broken_; }

 private:
  using Bytes = ethercat::testing::Bytes;
  using Answer = ethercat::testing::Answer;

  struct Status {
    unsigned state = 1;
    bool error = false;
    unsigned code = 0;
    bool operator==(const Status&) const = default;
  };

  // Frames.
  void pass(base::SimDuration duration);
  Answer transfer(ethercat::Command command, std::uint32_t address, const Bytes& data);
  Answer read(std::uint16_t address, std::size_t length);
  unsigned write(std::uint16_t address, const Bytes& data);
  // What the master does.
  void request(unsigned control);
  void set_mailboxes(std::uint32_t how);
  void set_process_data(std::uint32_t how);
  void set_channel(unsigned channel, std::uint16_t start, std::size_t length, std::uint8_t control);
  void note_outputs(bool accepted);
  void exchange();
  void exchange_cycles(std::uint32_t cycles);
  void be_silent(base::SimDuration duration);
  void start_sync(std::uint32_t cycle_us);
  void write_sync_type(std::uint32_t type);
  void try_uploads();
  void try_downloads();
  void repeat_answer();
  void reset_controller();
  void cycle_power();
  void bring_up(bool sync, std::uint32_t sync_type);
  /// The mailbox message that answers the SDO, or nothing if the mailbox stays empty.
  std::optional<Bytes> ask(const Bytes& sdo);
  /// The next message that is no emergency.
  std::optional<Bytes> fetch(base::SimDuration limit);
  void expect_abort(const Bytes& sdo, std::uint32_t code);
  void start_anew();

  // What has to hold.
  void fail(std::string rule);
  /// Reads the state, and looks whether it may be what it is.
  void observe();
  void check_change(const Status& before, const Status& after);
  void check_watchdog();
  void check_outputs();
  /// The code with which the request has to be refused, 0 if it has to be granted; nothing where
  /// these rules do not know.
  [[nodiscard]] std::optional<unsigned> expected_code(unsigned control) const;
  /// To SDOs, which Bootstrap does not know.
  [[nodiscard]] bool answers_mailbox() const {
    return status_.state != 1 && status_.state != 3 && mailboxes_right_;
  }
  [[nodiscard]] base::SimDuration watchdog_time() const;

  static constexpr std::uint32_t kRight = 0;
  static constexpr std::uint32_t kWrongLength = 1;
  static constexpr std::uint32_t kWithoutTrigger = 2;
  static constexpr std::uint32_t kOff = 3;

  std::unique_ptr<product::EtherCatDevice> device_;
  ethercat::Segment segment_;
  ethercat::testing::RawFrame frame_;
  base::SimTime now_;
  std::optional<std::string> broken_;

  std::size_t output_bytes_ = 0;
  std::size_t input_bytes_ = 0;
  std::size_t target_offset_ = 0;  ///< of 607Ah in the outputs

  Status status_;
  std::optional<unsigned> requested_;  ///< AL control written since the state was last seen
  bool mailboxes_right_ = false;
  std::uint32_t channels_ = kOff;
  bool trigger_ = false;         ///< of the watchdog, since Safe-Operational was entered
  bool sync_touched_ = false;    ///< SYNC0 or 1C32h was set since power-on
  std::uint32_t sync_type_ = 0;  ///< what was written to 1C32h:01 since power-on
  std::uint32_t watchdog_count_ = 1000;
  base::SimTime first_expiry_from_;  ///< no earlier than this may the watchdog's time begin
  base::SimTime last_expiry_from_;   ///< and no later

  std::uint32_t token_ = 0;  ///< 607Ah in the last outputs sent
  /// What 607Ah may be, oldest first: as it was seen last, then what was sent to a slave in
  /// Operational since.
  std::vector<std::uint32_t> permitted_;
  std::optional<std::uint32_t> waiting_;  ///< sent since Safe-Operational was entered
  unsigned counter_ = 0;                  ///< of the mailbox
};

}  // namespace stator::tests
