#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/canopen/storage/non_volatile_memory.hpp"
#include "stator/devices/tmcm_142/module.hpp"
#include "stator/tmcl/interpreter/eeprom_keeper.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"

namespace stator::devices::tmcm_142 {

/// Brings what the module keeps without power to a memory that outlives the device: one image of
/// parameters and coordinates, one of the program, both in one order.
///
/// A write lasts kWriteTime, or longer if the memory takes longer; a memory that is ready at once
/// takes no time. If it fails the cells are again what they were before the command that wrote
/// them; if no host can be told of the failure the written values stay, and are written again every
/// kRetryTime.
///
/// Parameters: each cell in 4 bytes. Program: command, type, motor and 4 bytes of value for each,
/// up to the last that is not erased. Numbers are little endian.
class Eeprom final : public tmcl::EepromKeeper {
 public:
  static constexpr base::SimDuration kWriteTime{5'000'000};  ///< of a command, decision T-86
  static constexpr base::SimDuration kRetryTime{5'000'000'000};

  /// Both must outlive it.
  Eeprom(Module& module, tmcl::Firmware& firmware, base::EventReporter reporter)
      : module_(module), firmware_(firmware), reporter_(reporter) {}

  /// Takes over what `memory` holds, and keeps changes there from now on.
  void connect(canopen::NonVolatileMemory& memory);

  [[nodiscard]] Outcome keep(bool refusable, base::SimTime now) override;
  [[nodiscard]] Outcome outcome() const override { return outcome_; }

  /// Looks for what no command has written, and tries again what has failed; cheap.
  void service(base::SimTime now) {
    if (memory_ != nullptr && outcome_ != Outcome::busy && (changed() || now >= retry_)) {
      static_cast<void>(write(false, now));
    }
  }
  /// When poll() is to be called.
  [[nodiscard]] base::SimTime next_poll() const { return poll_; }
  /// Looks whether the write has ended; if not, again at `next`.
  void poll(base::SimTime now, base::SimTime next);
  /// The supply is gone: no host can be told any more that a write has failed.
  void abandon() { refusable_ = false; }

 private:
  enum Group : std::uint8_t { parameters_group, program_group };
  static constexpr std::array<Group, 2> kGroups{parameters_group, program_group};
  /// One of the two images.
  struct Image {
    std::uint64_t writes = 0;         ///< of its cells, as in `wanted`
    std::vector<std::byte> accepted;  ///< what the module holds, but for what is being written
    std::vector<std::byte> wanted;    ///< as ordered
    bool ordered = false;
    bool owed = false;  ///< `accepted` is still to be kept
  };

  [[nodiscard]] std::uint64_t writes(Group group) const {
    return group == parameters_group ? module_.eeprom_write_count()
                                     : firmware_.memory().write_count();
  }
  [[nodiscard]] bool changed() const {
    return writes(parameters_group) != images_[parameters_group].writes ||
           writes(program_group) != images_[program_group].writes;
  }
  [[nodiscard]] Outcome write(bool refusable, base::SimTime now);
  [[nodiscard]] Outcome end(bool kept, base::SimTime now);
  void take_back();
  void restore(Group group);
  [[nodiscard]] bool load(Group group, std::span<const std::byte> image);
  [[nodiscard]] bool load_parameters(std::span<const std::byte> image);
  [[nodiscard]] bool load_program(std::span<const std::byte> image);
  void copy(Group group, std::vector<std::byte>& image);
  void copy_parameters(std::vector<std::byte>& image);
  void copy_program(std::vector<std::byte>& image) const;

  Module& module_;
  tmcl::Firmware& firmware_;
  base::EventReporter reporter_;
  canopen::NonVolatileMemory* memory_ = nullptr;
  std::array<Image, 2> images_;
  std::vector<std::int32_t> cells_;

  Outcome outcome_ = Outcome::kept;
  bool refusable_ = false;
  bool reported_ = false;  ///< that something is owed
  base::SimTime poll_ = base::SimTime::never();
  base::SimTime retry_ = base::SimTime::never();  ///< of what is owed
};

}  // namespace stator::devices::tmcm_142
