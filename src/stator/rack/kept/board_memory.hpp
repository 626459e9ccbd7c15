#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/board/peripheral/kept_content.hpp"
#include "stator/rack/kept/kept_memory.hpp"

namespace stator::rack {

/// The content of one part on the board of a device, e.g. of a serial EEPROM, in the file
/// DEVICE.PART.memory. A page that is written is an order.
class BoardMemory final : public KeptMemory, public board::ContentKeeper {
 public:
  /// Gives the part what is kept of it; it must outlive the memory. Throws std::runtime_error for a
  /// file that is damaged, or is of a part of another size.
  BoardMemory(DeviceStorage& storage, const std::string& device, const std::string& product,
              const board::KeptPart& part, base::EventReporter reporter);
  ~BoardMemory() override;

  [[nodiscard]] bool keep(std::span<const std::byte> content) override {
    return order(content, ++writes_);
  }
  void finish(std::uint32_t version, bool kept, base::SimTime now) override;
  [[nodiscard]] std::vector<std::byte> content() const override;

 private:
  board::KeptContent& part_;
  std::uint32_t writes_ = 0;
};

// Arguments: {0} path.
namespace rules {
inline constexpr base::EventRule kBoardMemoryRestored{
    "storage-board-memory-restored", base::Severity::information,
    "content of a part on the board taken from {0}; delete the file to start with a blank one"};
}  // namespace rules

}  // namespace stator::rack
