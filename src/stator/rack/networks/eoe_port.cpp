#include "stator/rack/networks/eoe_port.hpp"

#include "stator/rack/observe/journal.hpp"

namespace stator::rack {

void EoePort::send(std::span<const std::byte> frame) {
  if (journal_ != nullptr) {
    journal_->eoe_frame_leaves(device_, frame);
  }
  if (output_.frame) {
    output_.frame(frame);
  }
}

void EoePort::set_ip_parameters(const ethercat::IpParameters& parameters) {
  if (output_.ip_parameters) {
    output_.ip_parameters(parameters);
  }
}

}  // namespace stator::rack
