#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/product/device/ethercat_device.hpp"

// What a master may do to a slave in any order, and what has to hold whatever it does: random
// sequences of AL requests, sync managers, mailboxes, process data, clocks, watchdogs, silence,
// resets and power cycles at complete products.
namespace stator::tests {

/// One thing a master does, or that happens to it. What the numbers mean is its kind's business.
struct MasterAction {
  enum class Kind : std::uint8_t {
    request_state,  ///< `value`: AL control
    mailboxes,      ///< `value`: 0 as the EEPROM says, 1 too short, 2 off
    process_data,   ///< `value`: 0 as mapped, 1 wrong length, 2 as mapped without watchdog trigger
    exchange,       ///< `value`: cycles of a millisecond
    outputs_by_address,  ///< outputs written physically, without FMMU
    silence,             ///< `value`: milliseconds
    sync_on,             ///< `value`: SYNC0 cycle in microseconds
    sync_off,
    watchdog,        ///< `value`: 0420h
    sync_type,       ///< `value`: what is written to 1C32h:01
    upload,          ///< of an object that is there, one that is not, one that is write-only
    download,        ///< of what cannot be written at all or not now
    mailbox_repeat,  ///< the answer is asked for again
    controller_reset,
    power_cycle,
    bring_up,  ///< `value`: bit 0 with SYNC0, bits 1 and 2: 1C32h:01 written (1 or 2) or not (0)
  };
  Kind kind = Kind::request_state;
  std::uint32_t value = 0;

  [[nodiscard]] std::string text() const;
};

/// Makes the product anew, in its state as delivered.
using MakeDevice = std::function<std::unique_ptr<product::EtherCatDevice>(base::EventReporter)>;

/// `length` actions; the same for the same seed.
std::vector<MasterAction> random_actions(std::uint64_t seed, std::size_t length);

/// Does the actions to a new device; the first rule that was broken, or nothing.
std::optional<std::string> broken_rule(const MakeDevice& make,
                                       const std::vector<MasterAction>& actions);

/// As few of the actions as still break a rule.
std::vector<MasterAction> shortened(const MakeDevice& make, std::vector<MasterAction> actions);

}  // namespace stator::tests
