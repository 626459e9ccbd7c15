#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "stator/link/serial/serial_link.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/link/system/receive_wait.hpp"

namespace stator::link {

/// A serial line as a TCP server: raw bytes, as pyserial's "socket://ADDRESS:PORT" and PyTrinamic's
/// socket_serial_tmcl speak. One program at a time has the line. The newest gets it: the connection
/// of the one before is closed, so a program that crashed or hangs keeps nobody out. What a program
/// has sent before it closed its connection is received; what is sent while nobody is connected is
/// dropped, as on a cable without anything at its end.
class TcpSerialLink final : public SerialLink {
 public:
  /// Listens at `port` of `address`, an IPv4 address in numbers; port 0: any free one.
  static base::Expected<std::unique_ptr<TcpSerialLink>, LinkError> open(
      const std::string& address, std::uint16_t port, const SerialLinkOptions& options = {});

  base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                 base::SimDuration timeout) override;
  base::Expected<void, LinkError> send(std::span<const std::byte> bytes) override;
  void wake() noexcept override { wait_.wake(); }
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Programs that have connected so far.
  [[nodiscard]] std::uint64_t clients() const { return clients_.load(std::memory_order_relaxed); }

 private:
  friend ReceiveWait;

  TcpSerialLink(FileDescriptor listener, const std::string& address, std::uint16_t port,
                const SerialLinkOptions& options);

  base::Expected<ReceiveWait::Taken, LinkError> take(std::span<std::byte> buffer,
                                                     base::SimDuration wait);
  [[nodiscard]] std::size_t read(std::span<std::byte> buffer);
  [[nodiscard]] bool sleep(base::SimDuration wait);
  void set_client(FileDescriptor client);

  FileDescriptor listener_;
  std::uint16_t port_;
  std::string name_;
  ReceiveWait wait_;
  std::atomic<std::uint64_t> clients_ = 0;
  std::mutex mutex_;  ///< held where another thread than the receiving one uses the client
  FileDescriptor client_;
};

}  // namespace stator::link
