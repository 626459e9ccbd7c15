#pragma once

#include <cstddef>
#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::ethercat {

/// Logic on the controller's chip that shares its memory, such as an I/O block whose registers are
/// mapped into process data. SlaveController::set_memory_partner() makes the controller tell it
/// what happens, at the controller's now(). It answers through read_process_data() and its
/// neighbours, which it may call from here; nothing else of the controller.
class MemoryPartner {
 public:
  MemoryPartner() = default;
  MemoryPartner(const MemoryPartner&) = delete;
  MemoryPartner& operator=(const MemoryPartner&) = delete;
  virtual ~MemoryPartner() = default;

  /// A frame begins to pass; it ends after its last datagram, at the same simulated time.
  virtual void start_of_frame(base::SimTime time) = 0;
  virtual void end_of_frame(base::SimTime time) = 0;

  /// The bus is about to read `length` bytes of process memory from `address` on: the last moment
  /// to bring them up to date.
  virtual void before_bus_read(base::SimTime time, std::uint16_t address, std::size_t length) = 0;
  /// The bus has written `length` bytes of process memory from `address` on. Of an area behind a
  /// sync manager it is told as a whole, when its last byte has come.
  virtual void after_bus_write(base::SimTime time, std::uint16_t address, std::size_t length) = 0;

  /// The parameter RAM (0x0580..0x05FF) was written by bus or host, or loaded from the EEPROM.
  virtual void parameters_changed(base::SimTime time) = 0;
  /// AL status (0x0130) has another value; bits 3:0 are the state.
  virtual void al_status_changed(base::SimTime time, std::uint16_t al_status) = 0;
  /// The controller was reset, and with it the chip. parameters_changed() follows.
  virtual void controller_reset(base::SimTime time) = 0;
};

}  // namespace stator::ethercat
