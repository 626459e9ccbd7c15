#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/expected.hpp"
#include "stator/canopen/pdo/pdo_rules.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

/// What stands in one PDO: objects of the dictionary one behind the other, bit by bit. Compiled
/// from the mapping object whenever that changes, then only walked. A PDO has at most eight bytes,
/// so that its data are one number of 64 bits, the first byte in the lowest bits.
class PdoMapping {
 public:
  /// One mapped object. A gap takes bits but has no item.
  struct Item {
    dictionary::Entry* entry = nullptr;
    std::uint8_t bit_offset = 0;
    std::uint8_t bit_length = 0;
    bool refused = false;  ///< the last value that came was not taken
  };
  /// Told when an object refuses the value that came, once until it takes one again, and told then
  /// too (without a refusal).
  using RefusedHook =
      base::Delegate<void(const Item&, const dictionary::Refusal*, std::uint64_t raw)>;

  /// `object` is the mapping object, 16xxh or 1Axxh.
  PdoMapping(dictionary::Dictionary& dictionary, const dictionary::Object& object,
             PdoDirection direction, const PdoRules& limits);

  // Rules for writes (CiA 301 §7.5.2.36), without those about the state of the PDO.

  /// Whether an entry of the mapping object may become `value`. 0 erases it.
  [[nodiscard]] dictionary::Verdict check_entry(const dictionary::Entry& entry,
                                                std::uint64_t value) const;
  /// Whether the first `count` entries can be mapped.
  [[nodiscard]] dictionary::Verdict check_count(const dictionary::Entry& entry,
                                                std::uint64_t count) const;

  // The mapping in use.

  /// Follows the mapping object. Entries that cannot be mapped end the mapping.
  void compile();
  /// Would compile() change nothing?
  [[nodiscard]] bool up_to_date() const;
  [[nodiscard]] std::span<const Item> items() const { return items_; }
  [[nodiscard]] bool empty() const { return bits_ == 0; }
  [[nodiscard]] std::uint8_t bytes() const { return static_cast<std::uint8_t>((bits_ + 7) / 8); }

  /// The present values, read hooks included.
  [[nodiscard]] std::uint64_t pack() const;
  /// Writes every changed value into the dictionary.
  void unpack(std::uint64_t data, RefusedHook on_refused);
  /// Forgets which values were not taken: the next one that is refused is told again.
  void forget_refusals();

 private:
  /// The entry, or null for a gap.
  [[nodiscard]] base::Expected<dictionary::Entry*, dictionary::Refusal> resolve(
      const dictionary::Entry& source, std::uint64_t value) const;
  [[nodiscard]] base::Expected<dictionary::Entry*, dictionary::Refusal> resolve_gap(
      const dictionary::Entry& source, std::uint64_t value) const;
  template <typename Visitor>
  unsigned walk(Visitor visit) const;

  dictionary::Dictionary* dictionary_;
  const dictionary::Object* object_;
  PdoDirection direction_;
  const PdoRules* rules_;
  std::vector<Item> items_;
  unsigned bits_ = 0;
};

}  // namespace stator::canopen
