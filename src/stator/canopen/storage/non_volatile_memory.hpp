#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace stator::canopen {

/// Memory that keeps parameters without supply, one image of bytes per group of parameters. What
/// is behind it may take its time, as an EEPROM does: an order is given, its end is asked for.
///
/// An implementation carries out an order as a whole: whenever the supply fails, the old images of
/// all its groups or the new ones are there. What is in an image is ParameterStorage's business,
/// its check sum included.
class NonVolatileMemory {
 public:
  enum class Status : std::uint8_t {
    ready,   ///< every order has been carried out, or none was given
    busy,    ///< an order is being carried out
    failed,  ///< the last order failed; the former images of its groups are still there
  };

  /// What is to become the image of a group; no bytes: it is to have none.
  struct GroupImage {
    std::uint8_t group = 0;
    std::span<const std::byte> bytes{};
  };

  NonVolatileMemory() = default;
  NonVolatileMemory(const NonVolatileMemory&) = delete;
  NonVolatileMemory& operator=(const NonVolatileMemory&) = delete;
  virtual ~NonVolatileMemory() = default;

  /// The image of `group` that is kept; empty if there is none. Valid until the next order.
  [[nodiscard]] virtual std::span<const std::byte> image(std::uint8_t group) const = 0;
  /// Orders all of `images` to be kept, or none of them. The bytes are copied. More orders may be
  /// given while one is carried out; status() stays failed until the next order that is given when
  /// it is not busy.
  virtual void store(std::span<const GroupImage> images) = 0;
  void store(std::uint8_t group, std::span<const std::byte> bytes) {
    store(std::array{GroupImage{group, bytes}});
  }
  [[nodiscard]] virtual Status status() const = 0;
};

}  // namespace stator::canopen
