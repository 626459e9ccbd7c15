#pragma once

#include <memory>
#include <string>

#include "link/file_descriptor.hpp"
#include "link/receive_wait.hpp"
#include "link/serial_link.hpp"

namespace stator::link {

/// A pseudo-terminal under a name that stays the same: programs open it like a serial port. The
/// name is a symbolic link that vanishes with the object; one that an earlier process has left
/// behind is replaced, anything else at that place is left alone.
///
/// The line is raw from the start, and stays usable however often programs open and close it. What
/// nobody reads waits in the kernel's buffer of some kilobytes; a program that wants a fresh start
/// discards it when it opens the port, as pyserial does.
class PtyLink final : public SerialLink {
 public:
  static base::Expected<std::unique_ptr<PtyLink>, LinkError> open(const std::string& path);
  ~PtyLink() override;

  base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                 base::SimDuration timeout) override;
  base::Expected<void, LinkError> send(std::span<const std::byte> bytes) override;
  void wake() noexcept override { wait_.wake(); }
  [[nodiscard]] const std::string& name() const override { return path_; }
  /// The terminal behind the name, e.g. "/dev/pts/4".
  [[nodiscard]] const std::string& terminal() const { return terminal_; }

 private:
  friend ReceiveWait;

  explicit PtyLink(std::string path) : path_(std::move(path)) {}

  base::Expected<void, LinkError> open_terminal();
  base::Expected<void, LinkError> place_name();
  [[nodiscard]] std::string name_leads_to() const;
  base::Expected<ReceiveWait::Taken, LinkError> take(std::span<std::byte> buffer,
                                                     base::SimDuration wait);

  std::string path_;
  std::string terminal_;
  FileDescriptor master_;
  /// Held open so that the line outlives its clients: without it the last one to close would take
  /// the settings with it, and reading here would fail.
  FileDescriptor client_end_;
  ReceiveWait wait_{WaitMode::block, base::SimDuration()};
};

}  // namespace stator::link
