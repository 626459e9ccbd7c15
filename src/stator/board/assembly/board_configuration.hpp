#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "stator/board/lines/line.hpp"
#include "stator/board/peripheral/declaration.hpp"
#include "stator/board/peripheral/settings.hpp"

namespace stator::board {

/// One peripheral as it is wired.
struct PeripheralConfiguration {
  explicit PeripheralConfiguration(std::string its_name, const PeripheralType& its);

  /// Wire a pin, or name the peripheral that serves a connection. Throw std::invalid_argument with
  /// one sentence when the type has none of that name or there is no such line.
  void wire(std::string_view pin, unsigned line);
  void connect(std::string_view connection, std::string_view peripheral);

  std::string name;
  const PeripheralType* type;
  Settings settings;
  std::vector<Line> lines;               ///< of each declared pin
  std::vector<std::string> connections;  ///< name of the peripheral for each declared connection
};

struct BoardConfiguration {
  std::vector<PeripheralConfiguration> peripherals;
};

/// A configuration that cannot be built: which peripheral, and why, in one sentence.
class BoardError : public std::invalid_argument {
 public:
  BoardError(std::string peripheral, const std::string& reason)
      : std::invalid_argument(reason), peripheral_(std::move(peripheral)) {}
  [[nodiscard]] const std::string& peripheral() const { return peripheral_; }

 private:
  std::string peripheral_;
};

}  // namespace stator::board
