#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "stator/manual/axis.hpp"
#include "stator/manual/network_master.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::manual {

/// An axis of a module with TMCL, commanded directly.
class TmclAxis final : public Axis {
 public:
  /// Sends a command to the module and waits for the reply.
  using Ask = std::function<master::Result<tmcl::Reply>(const tmcl::Instruction&)>;

  /// Notes the command with which the module has again what it had before, for the case that
  /// another master speaks before the axis sends it; nothing: it has all it had.
  using Owe = std::function<void(const std::optional<tmcl::Instruction>&)>;

  /// Stops a program that runs on the module, as it would go on commanding the motor, until leave()
  /// lets it run on, with the motor on the way on which the program had sent it.
  TmclAxis(
      Ask ask, const AxisPlace& place, Owe owe = [](const auto&) {});

  [[nodiscard]] const AxisDescription& description() const override { return description_; }
  master::Result<AxisStatus> look() override;
  master::Result<void> execute(const Command& given) override;
  master::Result<void> leave() override;

 private:
  /// Sends a command that must succeed; its reply's value.
  master::Result<std::int32_t> command(tmcl::Instruction instruction);
  master::Result<std::int32_t> parameter(std::uint8_t number);
  master::Result<void> set_speed(std::int32_t speed);
  /// The module moves with its own speed again, if a move had another.
  master::Result<void> give_back_speed();
  master::Result<void> jog(std::int64_t velocity);
  master::Result<void> move(const Command& given);
  master::Result<void> stop();
  void note_motion();
  void resume_motion();

  Ask ask_;
  Owe owe_;
  std::uint8_t motor_;
  /// The module's own maximum positioning speed (axis parameter 4) while a move has another.
  std::optional<std::int32_t> own_speed_;
  bool program_ran_ = false;
  /// What the program had the motor do: move there, or else turn with this velocity.
  std::optional<std::int32_t> program_target_;
  std::int32_t program_velocity_ = 0;
  AxisDescription description_;
};

}  // namespace stator::manual
