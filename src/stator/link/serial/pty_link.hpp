#pragma once

#include <memory>
#include <string>
#include <utility>

#include "stator/link/serial/serial_link.hpp"
#include "stator/link/system/pseudo_terminal.hpp"
#include "stator/link/system/receive_wait.hpp"

namespace stator::link {

/// A PseudoTerminal that programs open like a serial port. What nobody reads waits in the kernel's
/// buffer of some kilobytes; a program that wants a fresh start discards it when it opens the port,
/// as pyserial does.
class PtyLink final : public SerialLink {
 public:
  static base::Expected<std::unique_ptr<PtyLink>, LinkError> open(
      const std::string& path, const SerialLinkOptions& options = {});

  base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                 base::SimDuration timeout) override;
  base::Expected<void, LinkError> send(std::span<const std::byte> bytes) override;
  void wake() noexcept override { wait_.wake(); }
  [[nodiscard]] const std::string& name() const override { return terminal_.path(); }
  /// The terminal behind the name, e.g. "/dev/pts/4".
  [[nodiscard]] const std::string& terminal() const { return terminal_.terminal(); }

 private:
  friend ReceiveWait;

  PtyLink(PseudoTerminal terminal, const SerialLinkOptions& options)
      : terminal_(std::move(terminal)), wait_(options.wait, options.spin_time) {}

  base::Expected<ReceiveWait::Taken, LinkError> take(std::span<std::byte> buffer,
                                                     base::SimDuration wait);

  PseudoTerminal terminal_;
  ReceiveWait wait_;
};

}  // namespace stator::link
