#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/controller/frame_work.hpp"
#include "stator/ethercat/controller/slave_controller_configuration.hpp"
#include "stator/ethercat/registers/register_table.hpp"
#include "stator/ethercat/registers/time_stamp.hpp"
#include "stator/ethercat/standard/process_data_interface.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/ethercat/units/distributed_clock.hpp"
#include "stator/ethercat/units/latch_unit.hpp"
#include "stator/ethercat/units/sync_unit.hpp"

namespace stator::ethercat {

/// What a slave controller has to do after it has called its DistributedClockUnit, beside
/// FrameWork; 0 nearly always.
struct ClockWork {
  static constexpr unsigned kTakeEvents = 1U << 8;      ///< al_events(), bus_event() may be others
  static constexpr unsigned kUpdateDeadline = 1U << 9;  ///< deadline() is another
  static constexpr unsigned kAny = kTakeEvents | kUpdateDeadline;
};

/// The distributed clocks of a slave controller: clock, SYNC unit and latch unit together, what
/// accesses to their registers (0x0910..0x09FF) cause, and when SYNC pulses have to be looked at.
/// Works on the controller's register memory.
///
/// `now` is always the controller's present moment. Functions that return a number give the bits of
/// ClockWork and FrameWork that they leave to the controller.
class DistributedClockUnit {
 public:
  /// Keeps the references: follows what `configuration` and `reporter` become.
  DistributedClockUnit(std::span<std::byte, kRegisterSpace> registers,
                       const SlaveControllerConfiguration& configuration,
                       const base::EventReporter& reporter)
      : registers_(registers),
        configuration_(configuration),
        reporter_(reporter),
        clock_(registers, configuration.clock_deviation_ppb),
        sync_(registers),
        latch_(registers) {}

  /// As after power-on; the latch inputs keep their levels.
  void reset(base::SimTime now);

  /// Brings registers that `side` is going to read up to date. `frame_start` is when the present
  /// frame reached the processing unit.
  [[nodiscard]] unsigned before_read(AccessSide side, EffectSet effects, std::uint32_t address,
                                     std::size_t length, base::SimTime frame_start,
                                     base::SimTime now);
  /// `side` has read registers, or has acknowledged them by writing.
  [[nodiscard]] unsigned acknowledge(AccessSide side, EffectSet effects, std::uint32_t address,
                                     std::size_t length, base::SimTime now);
  /// Whether a condition lets `side` write a register byte that it has the right to write.
  [[nodiscard]] bool accepts_write(AccessSide side, Effect effect, std::size_t address) const;
  /// `side` has written `data` to registers.
  [[nodiscard]] unsigned after_write(AccessSide side, EffectSet effects, std::uint32_t address,
                                     std::span<const std::byte> data, base::SimTime now);

  // What a frame has left for its end, see FrameWork.
  /// Stores the receive times of the frame.
  void latch_receive_times(const FrameTiming& timing) { clock_.latch_receive_times(timing); }
  /// Compares the clock with the system time that came in the frame.
  [[nodiscard]] unsigned compare(const FrameTiming& timing, base::SimTime now);
  /// The start time has been written, as far as one frame or one access of the host goes.
  [[nodiscard]] unsigned finish_start_time(base::SimTime now);

  /// Accounts for all pulses up to `now`.
  [[nodiscard]] unsigned advance(base::SimTime now);
  /// The deadline has come.
  [[nodiscard]] unsigned expire(base::SimTime now);
  /// When a pulse comes of which the host must be told.
  [[nodiscard]] base::SimTime deadline() const { return deadline_; }
  /// Works out events and deadline anew, as pulse length or mapping of the outputs may be others.
  [[nodiscard]] unsigned refresh(base::SimTime now) {
    return ClockWork::kTakeEvents | schedule(now);
  }
  /// See SlaveController::set_clock_deviation().
  [[nodiscard]] unsigned set_deviation(std::int32_t ppb, base::SimTime now);

  /// System time, ns.
  [[nodiscard]] std::uint64_t system_time(base::SimTime t) const { return clock_.system_time(t); }

  // The SYNC outputs (`output` 0 or 1) as SlaveController gives them out; call advance() first.
  /// next_sync_edge() stands since it was asked for last, and needs no advance().
  [[nodiscard]] bool knows_sync_edge(unsigned output, base::SimTime now) const {
    return !sync_.active() || (sync_edges_[output] && *sync_edges_[output] > now);
  }
  /// When the next pulse begins, as the clock runs at present; never() if none is to come.
  [[nodiscard]] base::SimTime next_sync_edge(unsigned output, base::SimTime now);
  /// Pulses since power-on.
  [[nodiscard]] std::uint64_t sync_pulse_count(unsigned output) const {
    return sync_.pulse_count(output);
  }
  /// True while a pulse lasts or waits for its acknowledge.
  [[nodiscard]] bool sync_output(unsigned output, base::SimTime now) const {
    return sync_.asserted(output, clock_.system_time(now));
  }
  /// What the pin does.
  [[nodiscard]] PinLevel sync_pin(unsigned output, base::SimTime now) const {
    return sync_.pin(output, clock_.system_time(now));
  }

  /// The level at latch input 0 or 1 is `level` from `now` on.
  [[nodiscard]] unsigned set_latch_input(unsigned input, bool level, base::SimTime now);
  /// The bus has exchanged a buffer in the frame that began at `t` (0x09F0).
  void latch_bus_change(base::SimTime t);
  /// The host has begun with a buffer (0x09F8), or exchanged one (0x09FC), at `t`.
  void latch_host_access(bool start, bool change, base::SimTime t);

  /// The bits of the AL event request that are the distributed clocks'.
  static constexpr std::uint32_t kAlEvents =
      al_event::kDcLatch | al_event::kDcSync0 | al_event::kDcSync1;
  /// Those of them that are pending.
  [[nodiscard]] std::uint32_t al_events() const {
    return sync_.al_events() | (latch_.event(AccessSide::host) ? al_event::kDcLatch : 0U);
  }
  /// DC latch event of the ECAT event request.
  [[nodiscard]] bool bus_event() const { return latch_.event(AccessSide::bus); }

 private:
  [[nodiscard]] bool register_bit(std::size_t address, unsigned bit) const {
    return (std::to_integer<unsigned>(registers_[address]) >> bit & 1U) != 0;
  }
  [[nodiscard]] unsigned take_system_time(std::uint32_t address, std::span<const std::byte> data);
  [[nodiscard]] unsigned take_host_system_time(std::uint32_t address,
                                               std::span<const std::byte> data, base::SimTime now);
  [[nodiscard]] unsigned take_start_time(AccessSide side, std::uint32_t address, std::size_t length,
                                         base::SimTime now);
  void report_activation(SyncUnit::Activation activation, base::SimTime now);
  [[nodiscard]] unsigned schedule(base::SimTime now);

  std::span<std::byte, kRegisterSpace> registers_;
  const SlaveControllerConfiguration& configuration_;
  const base::EventReporter& reporter_;
  DistributedClock clock_;
  SyncUnit sync_;
  LatchUnit latch_;
  TimeStamp<std::uint64_t> shown_system_time_{register_address::kSystemTime};
  /// 0x09F0 bus change, 0x09F8 host start, 0x09FC host change; local time.
  std::array<std::uint32_t, 3> buffer_events_{};
  std::array<TimeStamp<std::uint32_t>, 3> shown_buffer_events_{
      TimeStamp<std::uint32_t>{register_address::kEcatBufferChangeTime},
      TimeStamp<std::uint32_t>{register_address::kPdiBufferStartTime},
      TimeStamp<std::uint32_t>{register_address::kPdiBufferChangeTime}};
  base::SimTime deadline_ = base::SimTime::never();
  /// Next edge of each SYNC output, if known since the clock or the unit last changed.
  std::array<std::optional<base::SimTime>, SyncUnit::kOutputs> sync_edges_{};
  std::uint32_t received_system_time_ = 0;
  std::uint8_t start_time_bytes_ = 0;  ///< of 0x0990 that this frame has written
};

}  // namespace stator::ethercat
