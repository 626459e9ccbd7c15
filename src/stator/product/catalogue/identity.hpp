#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stator::product {

/// What devices are wired with.
enum class NetworkKind : std::uint8_t {
  segment,  ///< EtherCAT
  bus,      ///< CAN
};

/// What a serial interface speaks.
enum class SerialProtocol : std::uint8_t {
  tmcl,       ///< telegrams of nine bytes
  registers,  ///< telegrams of five bytes that read and write a chip's registers
};

/// A serial interface of a product.
struct SerialInterface {
  std::string name;  ///< e.g. "usb"; a key of the device in a rack file
  SerialProtocol protocol = SerialProtocol::tmcl;
  std::optional<std::uint32_t>
      baud_rate{};  ///< bit/s; nothing: it has none, as USB, or any will do
};

/// What is known of a product whatever it is configured to.
struct Identity {
  std::string type;       ///< e.g. "tmcm-3315": what a rack file's `type` and commands name
  std::string summary{};  ///< what it is, in half a line
  std::string reached_over{};
  NetworkKind network = NetworkKind::segment;
  unsigned ports = 0;  ///< for EtherCAT cables, numbered from 0; see Product::ports()
  std::vector<SerialInterface> serial_interfaces{};
  bool own_firmware = true;  ///< false: its firmware, if any, is a program beside it
  bool host_port = false;    ///< it has pins for a firmware of the user's
  /// What a device is called in a rack file that gives it no name; empty: as its type.
  std::string usual_name{};

  /// The order code in capitals, for people and files, e.g. "TMCM-3315".
  [[nodiscard]] std::string name() const;
  [[nodiscard]] std::vector<std::string> serial_interface_names() const;
};

}  // namespace stator::product
