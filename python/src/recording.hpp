// Recordings of a rack of the package: what stands at their beginning, and whether there can be
// one.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "configuration.hpp"
#include "stator/rack/core/command.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/observe/journal.hpp"
#include "stator/replay/recording_format.hpp"

namespace stator::python {

/// The beginning of a recording of the rack that `source` and `configuration` describe, at
/// power-on. `links`: it is on links, else on a bench. Throws std::runtime_error for a rack that no
/// recording can hold.
[[nodiscard]] replay::RecordingHeader header_of(const Source& source,
                                                const rack::RackConfiguration& configuration,
                                                bool links);

/// Notices whether anything was done to a rack, so that it is no longer as at power-on.
class Untouched final : public rack::Journal {
 public:
  [[nodiscard]] bool untouched() const { return untouched_; }

  void command(const rack::Command& /*command*/) override { untouched_ = false; }
  void advanced(base::SimTime /*now*/) override {}
  void frame_comes(std::size_t /*segment*/, ethercat::MasterInterface /*entry*/,
                   base::SimTime /*arrival*/, std::span<const std::byte> /*frame*/) override {
    untouched_ = false;
  }
  void frame_leaves(std::optional<ethercat::MasterInterface> /*exit*/,
                    std::span<const std::byte> /*frame*/) override {}
  // A recording begins with the ports that are there.
  void port_opened(std::size_t /*bus*/, std::size_t /*port*/, bool /*hears_errors*/,
                   bool /*lossy*/) override {}
  void port_closes(std::size_t /*bus*/, std::size_t /*port*/) override {}
  void can_frame_leaves(std::size_t /*bus*/, std::size_t /*port*/,
                        const can::TimedFrame& /*frame*/) override {}
  void bytes_leave(std::size_t /*line*/, std::span<const std::byte> /*bytes*/) override {}
  void host_spi_answers(std::span<const std::byte> /*miso*/) override {}
  void eoe_frame_leaves(rack::DeviceAddress /*device*/,
                        std::span<const std::byte> /*frame*/) override {}

 private:
  bool untouched_ = true;
};

}  // namespace stator::python
