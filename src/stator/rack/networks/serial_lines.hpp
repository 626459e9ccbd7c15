#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "stator/rack/networks/serial_line.hpp"
#include "stator/rack/world/device_configuration.hpp"

namespace stator::rack {

/// A device with the serial interfaces its configuration connects to lines.
struct SerialMember {
  const DeviceConfiguration& configuration;
  product::Device& device;
  CanNetwork* network = nullptr;  ///< the CAN bus it is on, if any
  std::size_t position = 0;       ///< its number there
};

/// All serial lines of a rack: one for each link that devices name. Those that name the same one
/// share it. They must outlive the lines.
class SerialLines {
 public:
  /// `settings` are those of lines that have some of their own.
  explicit SerialLines(std::span<const SerialLineConfiguration> settings)
      : settings_(settings.begin(), settings.end()) {}

  /// Connects a device to its lines. Throws std::runtime_error for an interface it has not.
  void add(const SerialMember& member);

  [[nodiscard]] std::size_t size() const { return lines_.size(); }
  [[nodiscard]] SerialLine& operator[](std::size_t index) { return *lines_[index]; }
  [[nodiscard]] const SerialLine& operator[](std::size_t index) const { return *lines_[index]; }

  /// Lets bytes come and go on all lines whose time has come, by their times, those of one moment
  /// by the numbers of their lines; the devices have been brought to `now`, and the lines to each
  /// of their deadlines before.
  void advance(base::SimTime now);
  /// The next one of all lines.
  [[nodiscard]] base::SimTime next_deadline() const;
  void set_power(const product::Device& device, bool on);
  /// Tells `journal` of the bytes of all lines by their numbers; null: nobody.
  void set_journal(Journal* journal);

 private:
  [[nodiscard]] SerialLine& line_to(const std::string& link);

  std::vector<SerialLineConfiguration> settings_;
  std::vector<std::unique_ptr<SerialLine>> lines_;
};

}  // namespace stator::rack
