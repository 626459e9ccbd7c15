#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/expected.hpp"
#include "base/sim_time.hpp"
#include "link/error.hpp"

namespace stator::link {

/// The forms open_serial_link() reads, for messages and help texts.
inline constexpr std::string_view kSerialLinkForms = "pty:PATH";

/// A serial line to programs of this machine: bytes in both directions, without frames.
class SerialLink {
 public:
  SerialLink() = default;
  SerialLink(const SerialLink&) = delete;
  SerialLink& operator=(const SerialLink&) = delete;
  virtual ~SerialLink() = default;

  /// Waits at most `timeout` for bytes and moves those there are into `buffer`. Returns how many;
  /// 0: none came in time, or wake() ended the wait.
  virtual base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                         base::SimDuration timeout) = 0;
  /// Sends all of `bytes` or none. Never waits: LinkErrorCode::queue_full when nobody reads.
  virtual base::Expected<void, LinkError> send(std::span<const std::byte> bytes) = 0;
  /// Ends the present receive() within 20 ms, or the next one. From any thread.
  virtual void wake() noexcept = 0;
  /// What a program opens.
  [[nodiscard]] virtual const std::string& name() const = 0;
};

/// `text` has one of the forms.
[[nodiscard]] bool is_serial_link(std::string_view text);

/// Opens a serial line as people write it. The error says what went wrong, or which forms there
/// are.
[[nodiscard]] base::Expected<std::unique_ptr<SerialLink>, LinkError> open_serial_link(
    std::string_view text);

}  // namespace stator::link
