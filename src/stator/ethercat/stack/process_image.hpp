#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/stack/pdo_configuration.hpp"

namespace stator::ethercat {

/// The process data of one direction: which object stands at which bit. Compiled from assignment
/// and mapping objects when process data start, then only walked.
///
/// Outputs: unpack() brings the image into the dictionary. Inputs: pack() does the reverse.
class ProcessImage {
 public:
  /// One mapped object. Padding takes bits but has no item.
  struct Item {
    dictionary::Entry* entry = nullptr;
    std::uint32_t bit_offset = 0;
    std::uint8_t bit_length = 0;
    bool refused = false;  ///< the last value that came was not taken
  };

  /// Told of every value that the dictionary refuses, once until the object takes one again.
  using RefusedHook = base::Delegate<void(const dictionary::Entry&, const dictionary::Refusal&)>;

  /// Reserves room for `capacity_bytes`, the limit given to PdoConfiguration.
  ProcessImage(PdoDirection direction, std::size_t capacity_bytes);

  /// Reads assignment and mapping; on a refusal the image is empty.
  [[nodiscard]] dictionary::Verdict compile(dictionary::Dictionary& dictionary,
                                            const PdoConfiguration& configuration);
  void clear();

  [[nodiscard]] std::size_t bytes() const { return (bits_ + 7) / 8; }
  [[nodiscard]] std::span<const Item> items() const { return items_; }
  /// The raw data, bytes() long.
  [[nodiscard]] std::span<std::byte> data() { return std::span(data_).first(bytes()); }

  /// Writes every changed value of data() into the dictionary; returns how many were refused.
  std::size_t unpack(dictionary::Dictionary& dictionary, RefusedHook on_refused);
  /// Fills data() from the dictionary, read hooks included.
  void pack(const dictionary::Dictionary& dictionary);

 private:
  [[nodiscard]] dictionary::Verdict append_pdo(const dictionary::Entry& assigned,
                                               dictionary::Dictionary& dictionary,
                                               const PdoConfiguration& configuration);
  [[nodiscard]] dictionary::Verdict append_entry(const dictionary::Entry& source,
                                                 dictionary::Dictionary& dictionary,
                                                 const PdoConfiguration& configuration);

  PdoDirection direction_;
  std::vector<std::byte> data_;
  std::vector<Item> items_;
  std::size_t bits_ = 0;
};

}  // namespace stator::ethercat
