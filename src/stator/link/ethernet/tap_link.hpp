// The program's end of a TAP interface (Linux /dev/net/tun), and options of such a link.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "stator/link/ethernet/ethernet_link.hpp"
#include "stator/link/ethernet/link_counters.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/link/system/receive_wait.hpp"

namespace stator::link {

struct TapOptions {
  std::string interface;  ///< at most 15 characters
  WaitMode wait = WaitMode::block;
  base::SimDuration spin_time{200'000};  ///< of WaitMode::adaptive
  /// Frames of other EtherTypes are left out by receive(): a TAP interface also carries what the
  /// machine's own network stack wants to tell. Empty: every frame is taken.
  std::optional<std::uint16_t> ether_type = 0x88A4;
};

/// What an IP host is told about its interface.
struct InterfaceAddress {
  std::optional<std::array<std::uint8_t, 6>> mac_address;
  std::optional<std::array<std::uint8_t, 4>> address;      ///< IPv4
  std::optional<std::array<std::uint8_t, 4>> subnet_mask;  ///< IPv4
};

/// The far end of a TAP interface (Linux /dev/net/tun): what programs of this machine send on the
/// interface is received here, what is sent here they receive. The interface vanishes with the
/// link, unless it was made before ("ip tuntap add"). Needs CAP_NET_ADMIN, or an interface made for
/// this user and switched on before. A sleeping receive() notices wake() within 20 ms. Frames that
/// nobody took in time are counted by the interface ("ip -s link"), not here.
class TapLink final : public EthernetLink {
 public:
  /// Creates the interface or attaches to one that exists, and switches it on.
  static base::Expected<std::unique_ptr<TapLink>, LinkError> open(const TapOptions& options);

  /// A link on an open descriptor that delivers and takes one frame per read() and write(): an end
  /// of a socket pair, a TAP opened by somebody else.
  static base::Expected<std::unique_ptr<TapLink>, LinkError> adopt(FileDescriptor descriptor,
                                                                   const TapOptions& options);

  base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                 base::SimDuration timeout) override;
  base::Expected<void, LinkError> send(std::span<const std::byte> frame) override;
  void wake() noexcept override { wait_.wake(); }
  [[nodiscard]] LinkStatistics statistics() const override { return counters_.snapshot(); }
  [[nodiscard]] const std::string& name() const override { return options_.interface; }

  /// Gives the interface what `address` contains. Needs CAP_NET_ADMIN.
  base::Expected<void, LinkError> set_address(const InterfaceAddress& address);

 private:
  friend ReceiveWait;

  explicit TapLink(const TapOptions& options)
      : options_(options), wait_(options.wait, options.spin_time) {}

  base::Expected<void, LinkError> attach();
  base::Expected<void, LinkError> switch_on();
  base::Expected<ReceiveWait::Taken, LinkError> take(std::span<std::byte> buffer,
                                                     base::SimDuration wait);
  [[nodiscard]] bool wanted(std::span<const std::byte> frame) const;

  TapOptions options_;
  FileDescriptor descriptor_;
  FileDescriptor control_;  ///< any socket, for the interface's settings
  ReceiveWait wait_;
  LinkCounters counters_;
};

}  // namespace stator::link
