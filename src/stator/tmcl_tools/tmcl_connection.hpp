#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl_tools {

/// What a module answered.
struct TmclReply {
  tmcl::Status status = tmcl::Status::success;
  std::int32_t value = 0;
  std::string version;                    ///< of command 136 as text
  std::optional<tmcl::Instruction> cell;  ///< of the program memory, of command 134
};

/// A host's way to a module, for commands in direct mode.
class TmclConnection {
 public:
  using Error = std::string;  ///< one sentence

  TmclConnection() = default;
  TmclConnection(const TmclConnection&) = delete;
  TmclConnection& operator=(const TmclConnection&) = delete;
  virtual ~TmclConnection() = default;

  /// Sends a command and waits for its reply. An error: none came, or none that can be read.
  virtual base::Expected<TmclReply, Error> execute(const tmcl::Instruction& instruction) = 0;
  /// Lets time pass. True: meanwhile the module told that the target was reached (command 138).
  virtual bool pass(base::SimDuration duration) = 0;
  /// Sets what is around the module, where that can be reached.
  virtual base::Expected<void, Error> set_input(const std::string& assignment) = 0;
  /// With what one is connected, for people.
  [[nodiscard]] virtual std::string name() const = 0;
};

/// Commands to which no reply comes.
[[nodiscard]] bool has_reply(const tmcl::Instruction& instruction);

/// The reply in a telegram without its first byte, the host's address; eight bytes, or seven where
/// a CAN module sends no more.
[[nodiscard]] TmclReply reply_in(std::span<const std::byte> bytes,
                                 const tmcl::Instruction& instruction);

/// How to reach a module over a line or bus.
struct TmclHostOptions {
  std::uint8_t module_address = 1;
  std::uint8_t host_address = 2;
  std::uint16_t can_id = 1;
  std::uint16_t can_reply_id = 2;
  unsigned baud_rate = 9600;  ///< bit/s, of a serial interface of the machine
  base::SimDuration timeout{1'000'000'000};
};

/// "pty:PATH", "/dev/NAME" or "tcp:HOST:PORT". Throws Failure saying what went wrong.
[[nodiscard]] std::unique_ptr<TmclConnection> connect_tmcl_serial(const std::string& port,
                                                                  const TmclHostOptions& options);
/// A port of a CAN bus, see link::kCanLinkForms. Throws Failure.
[[nodiscard]] std::unique_ptr<TmclConnection> connect_tmcl_can(const std::string& port,
                                                               const TmclHostOptions& options);

}  // namespace stator::tmcl_tools
