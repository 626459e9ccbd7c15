// Objects that store and restore parameters: 1010h, 1011h (CiA 301 §7.5.2.13, §7.5.2.14), and
// 1020h.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/event.hpp"
#include "stator/canopen/storage/non_volatile_memory.hpp"
#include "stator/canopen/storage/parameter_image.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/write_completion.hpp"

namespace stator::canopen {

inline constexpr std::uint16_t kStoreParameters = 0x1010;
inline constexpr std::uint16_t kRestoreParameters = 0x1011;
inline constexpr std::uint16_t kVerifyConfiguration = 0x1020;
/// "save" and "load", as they must be written to store and restore (CiA 301 §7.5.2.13, §7.5.2.14).
inline constexpr std::uint32_t kSaveSignature = 0x65766173;
inline constexpr std::uint32_t kLoadSignature = 0x64616F6C;

/// Parameters that are stored and restored together.
struct ParameterGroup {
  std::uint8_t number = 0;  ///< names its image in the non-volatile memory
  std::span<const ParameterRange> ranges{};
  bool communication = false;  ///< loaded on reset communication too, not only on reset node
};

/// An object whose subindex stores or restores groups, e.g. 1010h:02.
struct StorageCommand {
  enum class Action : std::uint8_t { store, restore };
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  Action action = Action::store;
  std::uint32_t groups = 0;  ///< bit n for the group with number n
  std::uint32_t reads = 1;   ///< 1: the device does so on command
};

struct ParameterStorageRules {
  std::span<const ParameterGroup> groups{};
  std::span<const StorageCommand> commands{};
  /// How long an order takes at least in memory that is ever busy: that of a page of an EEPROM.
  base::SimDuration write_time{5'000'000};
};

/// Stores parameters in a non-volatile memory and restores their defaults, on a signature written
/// to 1010h, 1011h or an object of the product (CiA 301 §7.5.2.13, §7.5.2.14).
///
/// What a command names is one order to the memory: all of its groups are old or all are new,
/// whatever happens meanwhile. The write is complete, and answered, when the memory has carried it
/// out and its write time has passed; if it fails, with 06060000h. A wrong signature is refused
/// with 08000020h. Restored defaults take effect with the next load(): restoring only takes the
/// image away.
///
/// Where 1020h is declared, a write to any stored parameter sets both its entries to 0: the
/// configuration they date is no longer the one in the device (CiA 301 §7.5.2.23).
class ParameterStorage final : public dictionary::WriteCompletion {
 public:
  /// Every command's entry must be declared. `memory` must outlive the storage.
  ParameterStorage(dictionary::Dictionary& dictionary, NonVolatileMemory& memory,
                   base::EventReporter reporter, const ParameterStorageRules& limits);

  /// Told of each order to store or restore once the memory has it; null: nobody.
  using OrderHook = base::Delegate<void(const StorageCommand&)>;
  void set_order_hook(OrderHook hook) { ordered_ = hook; }

  /// Gives every parameter that has been stored its stored value, without hooks; to be called after
  /// the defaults were set. A damaged image changes nothing and raises an event.
  void load(base::SimTime now) { load_groups(false, now); }
  /// The same for the groups that reset communication brings back.
  void load_communication(base::SimTime now) { load_groups(true, now); }

  [[nodiscard]] std::optional<dictionary::Verdict> poll(const dictionary::Entry& entry,
                                                        base::SimTime now) override;

 private:
  void date_becomes_unknown(const dictionary::Entry& changed);
  [[nodiscard]] const StorageCommand* find(const dictionary::Entry& entry) const;
  [[nodiscard]] dictionary::Verdict check_signature(const dictionary::Entry& entry,
                                                    std::uint64_t value);
  void on_written(const dictionary::Entry& entry);
  void show_capability(dictionary::Entry& entry);
  void load_groups(bool communication_only, base::SimTime now);

  dictionary::Dictionary& dictionary_;
  NonVolatileMemory& memory_;
  base::EventReporter reporter_;
  ParameterStorageRules rules_;
  OrderHook ordered_;
  std::vector<std::vector<std::byte>> images_;  ///< being stored, by place of the group
  std::vector<NonVolatileMemory::GroupImage> order_;
  bool ordered_now_ = false;  ///< the end of the last order has not been asked for yet
  base::SimTime earliest_;    ///< end of that order
};

namespace rules {
inline constexpr base::EventRule kStorageSignature{
    "storage-signature", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3:x8} is not the signature {4:x8} (\"{5}\"); nothing "
    "was done"};
inline constexpr base::EventRule kStorageBusy{
    "storage-busy", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: the non-volatile memory still carries out the order "
    "before; try again"};
inline constexpr base::EventRule kStorageFailed{
    "storage-failed", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" failed: the non-volatile memory could not be written; the "
    "values stored before are still there"};
inline constexpr base::EventRule kStoredParametersDamaged{
    "stored-parameters-damaged", base::Severity::warning,
    "stored parameters of group {0} are damaged; their defaults are used; store them anew"};
inline constexpr base::EventRule kStoredParametersForeign{
    "stored-parameters-foreign", base::Severity::warning,
    "stored parameters of group {0} name objects this device does not store; these were passed "
    "over"};
}  // namespace rules

}  // namespace stator::canopen
