#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace stator::board {

class Peripheral;
class Settings;

/// What a peripheral does with a line at one of its pins.
enum class PinUse : std::uint8_t {
  watches,   ///< is told of every edge
  averages,  ///< is told of the mean level: what a winding, a filter or an eye makes of PWM
  drives,    ///< push-pull, or open drain where it says so
  shares,    ///< drives and watches: SDA
};

/// One pin of a kind of peripheral.
struct PinDeclaration {
  std::string_view name;  ///< key in a rack file
  PinUse use;
  bool optional = false;
  std::string_view description;
};

/// One number or text a peripheral is built with.
struct ParameterDeclaration {
  std::string_view name;  ///< key in a rack file
  std::string_view unit;  ///< empty: a plain number, or a text
  double minimum = 0.0;
  double maximum = 0.0;
  double value = 0.0;  ///< by default
  std::string_view description;
  bool is_text = false;
  std::string_view text{};  ///< by default
};

/// What one peripheral may get from another on the board.
enum class ConnectionKind : std::uint8_t { analog, shaft };

struct ConnectionDeclaration {
  std::string_view name;  ///< key in a rack file; its value names the other peripheral
  ConnectionKind kind;
  bool optional = false;
  std::string_view description;
};

/// One kind of peripheral, declared once beside its model; rack files, documents and `stator
/// describe` follow from the table of all (peripheral_types.hpp).
struct PeripheralType {
  std::string_view name;     ///< "type" in a rack file
  std::string_view summary;  ///< what it is, in half a line
  std::span<const PinDeclaration> pins;
  std::span<const ParameterDeclaration> parameters;
  std::span<const ConnectionDeclaration> connections;
  /// Throws std::invalid_argument with one sentence when the parameters contradict each other or a
  /// text names nothing.
  std::unique_ptr<Peripheral> (*make)(const Settings& settings);
};

/// Index of a pin, parameter or connection by name.
template <typename Declaration>
[[nodiscard]] constexpr std::optional<std::size_t> find_declared(
    std::span<const Declaration> declarations, std::string_view name) {
  for (std::size_t k = 0; k < declarations.size(); ++k) {
    if (declarations[k].name == name) {
      return k;
    }
  }
  return std::nullopt;
}

}  // namespace stator::board
