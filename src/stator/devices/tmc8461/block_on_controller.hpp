#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/board/assembly/board.hpp"
#include "stator/ethercat/controller/memory_partner.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/mfc/block/block.hpp"

namespace stator::devices::tmc8461 {

/// The two halves of the chip, slave controller and I/O block, joined as in silicon: parameter RAM,
/// process data, AL state, frames, SYNC and LATCH. Controller and block outlive it.
class BlockOnController final : public ethercat::MemoryPartner, private mfc::ProcessData {
 public:
  BlockOnController(ethercat::SlaveController& controller, mfc::Block& block);
  BlockOnController(const BlockOnController&) = delete;
  BlockOnController& operator=(const BlockOnController&) = delete;
  ~BlockOnController() override;

  /// What is wired to the block's pins: from now on the block goes through time with it, so that
  /// every access finds both at its moment. Null: nothing is wired. The board outlives the joint.
  void set_board(board::Board* board) { board_ = board; }

  /// Brings both to `to`, stopping at each SYNC pulse. A pulse before a frame that the controller
  /// has already seen is told at that frame.
  void advance(base::SimTime to);
  /// The next moment at which something happens by itself.
  [[nodiscard]] base::SimTime next_event();
  /// The block and what is wired to it alone; whoever acts on the block at `to` calls this first.
  void advance_block(base::SimTime to);
  /// LATCH_IN0 or 1 has `level` from the controller's now() on.
  void set_latch_input(unsigned input, bool level);

  // ethercat::MemoryPartner
  void start_of_frame(base::SimTime time) override;
  void end_of_frame(base::SimTime time) override;
  void before_bus_read(base::SimTime time, std::uint16_t address, std::size_t length) override;
  void after_bus_write(base::SimTime time, std::uint16_t address, std::size_t length) override;
  void parameters_changed(base::SimTime time) override;
  void al_status_changed(base::SimTime time, std::uint16_t al_status) override;
  void controller_reset(base::SimTime time) override;

 private:
  // mfc::ProcessData
  void read(std::uint16_t address, std::span<std::byte> out) override;
  void write(std::uint16_t address, std::span<const std::byte> data) override;
  void finish(std::uint16_t address, std::size_t length) override;

  void tell_pulses();

  ethercat::SlaveController& controller_;
  mfc::Block& block_;
  board::Board* board_ = nullptr;
  std::array<std::uint64_t, 2> pulses_{};  ///< of each SYNC output, as told to the block
  std::array<bool, 2> latches_{};
};

}  // namespace stator::devices::tmc8461
