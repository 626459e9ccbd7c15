#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stator::rack {

/// What a file keeps.
///
/// Its first line is "stator 1 KIND LENGTH CRC-32 PRODUCT", followed by LENGTH bytes of content as
/// they are. Changes of the content follow, each as a record that is appended (numbers of 32 bits,
/// little endian):
///
/// -  0  "Srec"
/// -  4  number of the change, from 1
/// -  8  check (byte 28) of the change before; of the first, CRC-32 of first line and content
/// - 12  length of the content afterwards
/// - 16  where the new bytes lie in it
/// - 20  how many they are
/// - 24  CRC-32 of the new bytes
/// - 28  CRC-32 of bytes 0 to 27
/// - 32  the new bytes, and a line feed
///
/// A record whose end is missing at the end of the file, or is zeros, was being written when the
/// process or the machine ended: nobody was told that it is kept, and it is passed over. Any other
/// record that does not hold is damage.
struct KeptFile {
  std::string kind;     ///< "eeprom", "firmware": one printable word
  std::string product;  ///< order code of the device it belongs to, printable
  std::vector<std::byte> content;
};

/// The largest content that is kept.
inline constexpr std::size_t kLargestContent = std::size_t{16} << 20;
/// Records of a file take no more than this; instead of a further one the file is written anew.
inline constexpr std::size_t kLongestLog = std::size_t{64} << 10;
/// More than any kept file has.
inline constexpr std::size_t kLargestFile = kLargestContent + kLongestLog + 200;

/// Where the records of a file end, and what the next one goes on from.
struct LogEnd {
  std::size_t log = 0;        ///< bytes of all records
  std::size_t length = 0;     ///< of the file up to here; what may follow was never kept
  std::uint32_t changes = 0;  ///< number of the last one
  std::uint32_t check = 0;
};

/// The bytes of a file without changes.
[[nodiscard]] std::vector<std::byte> encode(std::string_view kind, std::string_view product,
                                            std::span<const std::byte> content);
/// The reverse, with all changes made. Throws std::runtime_error that says what is wrong with the
/// bytes, without naming the file or a remedy.
[[nodiscard]] KeptFile decode(std::span<const std::byte> file);
/// Tells where the records end too.
[[nodiscard]] KeptFile decode(std::span<const std::byte> file, LogEnd& end);

/// The record that makes `after` of `before`, the content of a file that ends at `end`; then that
/// is its new end.
[[nodiscard]] std::vector<std::byte> encode_change(std::span<const std::byte> before,
                                                   std::span<const std::byte> after, LogEnd& end);

/// A file name for a device's name: letters, digits, '.', '_' and '-' stay, other bytes become %XX.
/// No two names have the same.
[[nodiscard]] std::string file_name_for(std::string_view device_name);

}  // namespace stator::rack
