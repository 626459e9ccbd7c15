#pragma once

#include <cstddef>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/tmcl/sessions/module_interface.hpp"

namespace stator::devices::tmcc160 {

/// The RS232/RS485 interface of the module (document L28-L30, L110-L112): through it the maker's
/// tool loads firmware. The CANopen firmware answers questions for its version there and obeys the
/// command that starts the boot loader; every other TMCL command it refuses, since the document
/// gives this interface no other use.
class SerialInterface final : public tmcl::ModuleInterface {
 public:
  /// `firmware_capacity`: of the memory, bytes.
  SerialInterface(std::size_t firmware_capacity, base::EventReporter reporter);

 private:
  [[nodiscard]] Answer execute(const tmcl::Request& request, base::SimTime now) override;
};

}  // namespace stator::devices::tmcc160
