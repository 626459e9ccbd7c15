#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/event.hpp"
#include "stator/ethercat/eoe/eoe_message.hpp"
#include "stator/ethercat/eoe/eoe_reassembly.hpp"
#include "stator/ethercat/eoe/ethernet_frame_queue.hpp"
#include "stator/ethercat/eoe/ethernet_port.hpp"
#include "stator/ethercat/standard/mailbox_protocol.hpp"

namespace stator::ethercat {

/// What went through an EoE server since its construction.
struct EoeStatistics {
  std::uint64_t frames_received = 0;    ///< from the master, complete
  std::uint64_t frames_sent = 0;        ///< to the master, last fragment handed to the mailbox
  std::uint64_t receive_dropped = 0;    ///< a fragment was missing, out of order or too long
  std::uint64_t fragments_ignored = 0;  ///< rest of a frame that was lost before
  std::uint64_t send_dropped = 0;  ///< queue full, mailbox too small, or no frame of legal length
};

/// Ethernet over EtherCAT (ETG.1000.6 §5.7): Ethernet frames in fragments through the mailbox, and
/// the IP parameters that the master gives the slave. One port; the port number of a request is
/// returned in its response and not looked at otherwise. MAC filters are refused with result 0401h.
///
/// A time stamp is the low half of the nanoseconds of the device's time: at which the last fragment
/// of a frame was handled, if the master requested a time stamp response with it, or at which the
/// last fragment went into the mailbox, if the master wants time stamps appended (set IP parameter
/// request, flag bit 16).
class EoeServer final : public MailboxProtocol {
 public:
  static constexpr std::size_t kMaximumFrame = kMaximumEoeFrame;
  /// Frames that wait for the mailbox before the oldest is dropped.
  static constexpr std::size_t kQueuedFrames = 32;

  explicit EoeServer(base::EventReporter reporter) : reporter_(reporter) {}

  /// The network behind; null: frames from the master end here. Must outlive the server or be
  /// replaced before.
  void connect(EthernetPort* port) { port_ = port; }

  /// Takes the frames that wait at the port, as many as the queue has room for; the others stay
  /// there. They are queued for the master if `running`, else they are lost as in a cable that
  /// leads nowhere. To be called before the mailbox is served.
  void poll(bool running);

  /// Queues a frame for the master; one of more than kMaximumFrame bytes, or of none, is dropped.
  void queue_frame(std::span<const std::byte> frame);

  [[nodiscard]] MailboxType type() const override { return MailboxType::eoe; }
  [[nodiscard]] bool available_in(AlState state) const override {
    return state != AlState::init && state != AlState::bootstrap;
  }
  void reset() override;
  [[nodiscard]] MailboxReply handle(std::span<const std::byte> request, std::span<std::byte> reply,
                                    base::SimTime now) override;
  [[nodiscard]] bool has_message() const override { return unsent_ != 0 || !queue_.empty(); }
  [[nodiscard]] std::size_t next_message(std::span<std::byte> message, base::SimTime now) override;

  /// As set by the master; kept when the mailbox stops.
  [[nodiscard]] const IpParameters& ip_parameters() const { return ip_parameters_; }
  [[nodiscard]] const EoeStatistics& statistics() const { return statistics_; }

 private:
  [[nodiscard]] MailboxReply take_fragment(const EoeHeader& header, std::span<const std::byte> data,
                                           std::span<std::byte> reply, base::SimTime now);
  void report_dropped(const EoeHeader& header, std::uint8_t expected, std::size_t length,
                      base::SimTime now);
  [[nodiscard]] EoeResult set_ip(std::span<const std::byte> block, base::SimTime now);
  [[nodiscard]] MailboxReply get_ip(const EoeHeader& request, std::span<std::byte> reply) const;

  base::EventReporter reporter_;
  EthernetPort* port_ = nullptr;
  IpParameters ip_parameters_;
  EoeStatistics statistics_;

  EoeReassembly incoming_;
  bool append_time_stamp_ = false;
  bool drop_reported_ = false;  ///< since the mailbox started; the rest is only counted

  std::array<std::byte, kMaximumFrame> polled_{};  ///< scratch of poll()
  EthernetFrameQueue queue_{kQueuedFrames};
  std::array<std::byte, kMaximumFrame> sending_{};  ///< the frame whose fragments are being sent
  std::size_t sending_length_ = 0;
  std::size_t unsent_ = 0;  ///< bytes at the end of `sending_` the master has not got
  std::uint8_t sending_fragment_ = 0;
  std::uint8_t sending_number_ = 0;  ///< frame number, 4 bits
};

namespace rules {
/// {0}..{3} octets of the address, {4} prefix length of the subnet mask.
inline constexpr base::EventRule kEoeAddressSet{
    "eoe-address-set", base::Severity::information,
    "the master set IP address {0}.{1}.{2}.{3}/{4} by EoE"};
inline constexpr base::EventRule kEoeIpRefused{
    "eoe-ip-refused", base::Severity::refusal,
    "EoE set IP parameters answered with result 0001h: {0} ({1} bytes behind the EoE header)"};
/// {0}..{3} octets of the mask.
inline constexpr base::EventRule kEoeMaskRefused{
    "eoe-mask-refused", base::Severity::refusal,
    "EoE set IP parameters answered with result 0402h: {0}.{1}.{2}.{3} is no subnet mask, whose "
    "ones "
    "must all stand before its zeros, e.g. 255.255.255.0; nothing was changed"};
inline constexpr base::EventRule kEoeFilterRefused{
    "eoe-filter-refused", base::Severity::refusal,
    "EoE MAC filter request answered with result 0401h: this device passes every frame; leave the "
    "filter out of the master's configuration"};
inline constexpr base::EventRule kEoeFrameDropped{
    "eoe-frame-dropped", base::Severity::warning,
    "EoE frame {0} from the master dropped: expected fragment {1}, got fragment {2} with offset "
    "{3} "
    "and {4} bytes; fragments must come in order, all but the last in multiples of 32 bytes, {5} "
    "bytes together at most. Further losses are only counted"};
}  // namespace rules

}  // namespace stator::ethercat
