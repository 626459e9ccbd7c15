// What happens at the ports and what it causes: error counters, DL status and its event.

#include <algorithm>

#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

}  // namespace

void SlaveController::count_malformed_frame() {
  count(kProcessingUnitErrors);
}

void SlaveController::count_receive_error(unsigned port, ReceiveError error) {
  if (!ports_.open(port)) {
    return;  // only enabled ports count
  }
  switch (error) {
    case ReceiveError::invalid_frame:
      count(kReceiveErrors + 2 * std::size_t{port});
      break;
    case ReceiveError::physical:
      count(kReceiveErrors + 1 + 2 * std::size_t{port});
      break;
    case ReceiveError::forwarded_error:
      count(kForwardedErrors + std::size_t{port});
      break;
  }
}

void SlaveController::set_link(unsigned port, bool up) {
  take_link_change(port, ports_.set_carrier(port, up));
}

void SlaveController::set_link_partner(unsigned port, LinkPartner partner) {
  take_link_change(port, ports_.set_partner(port, partner));
}

void SlaveController::hold_link_pin(unsigned port, std::optional<bool> level) {
  take_link_change(port, ports_.hold_pin(port, level));
}

void SlaveController::take_link_change(unsigned port, Ports::LinkChange change) {
  if (change == Ports::LinkChange::lost) {
    count(kLostLinks + std::size_t{port});
  }
  if (change != Ports::LinkChange::none) {
    update_dl_status();
  }
}

void SlaveController::receive_at_closed_port(unsigned port) {
  if (ports_.receive_at_closed(port)) {
    update_dl_status();
  }
}

void SlaveController::update_dl_status() {
  const bool host_alive = host_open_ && (host_polling_ || host_watchdog_.running());
  if (ports_.show_dl_status((loaded_ ? 0x01U : 0U) | (host_alive ? 0x02U : 0U) |
                            (enhanced_link_detection_ ? 0x04U : 0U))) {
    set_ecat_event(ecat_event::kDlStatus, true);
  }
}

void SlaveController::apply_loop_control() {
  ports_.apply_loop_control(now_);
  next_deadline_ = std::min(next_deadline_, ports_.deadline());
  update_dl_status();
}

}  // namespace stator::ethercat
