#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/refusal.hpp"

namespace stator::dictionary {

class Dictionary;

/// One entry of a built dictionary: its declaration, where it was placed, its value and its hooks.
/// Numeric values are kept as 64 bits, sign- or zero-extended as the type says; strings as text.
class Entry {
 public:
  /// Asked before a new value is stored; may refuse it. Gets the value as 64 bits.
  using CheckHook = base::Delegate<Verdict(const Entry&, std::uint64_t)>;
  /// Told after a new value was stored, also when it equals the old one.
  using WrittenHook = base::Delegate<void(const Entry&)>;
  /// Called before a value is read, to bring it up to date, also by who may only look; must not
  /// change anything when called twice, because a transfer asks for the size first and reads then.
  using ReadHook = base::Delegate<void(Entry&)>;
  /// Asked before a value is read; may refuse that.
  using ReadCheckHook = base::Delegate<Verdict(const Entry&)>;

  Entry() = default;
  // A copy would reach the same value, and of a const entry it would be one that can be set.
  Entry(const Entry&) = delete;
  Entry& operator=(const Entry&) = delete;
  Entry(Entry&&) = default;
  Entry& operator=(Entry&&) = default;
  ~Entry() = default;

  [[nodiscard]] const EntryDeclaration& declaration() const { return *declaration_; }
  [[nodiscard]] std::uint16_t index() const { return index_; }
  [[nodiscard]] std::uint8_t subindex() const { return declaration_->subindex; }
  [[nodiscard]] const std::string& name() const { return name_.str(); }
  /// The name for an event, which may be kept longer than the dictionary.
  [[nodiscard]] const base::SharedText& shared_name() const { return name_; }
  [[nodiscard]] DataType type() const { return declaration_->type; }
  /// Which axis the entry belongs to; 0 for those of the whole device.
  [[nodiscard]] std::uint8_t axis() const { return axis_; }
  /// The value after a reset: the declared default, with the node-ID added where it is relative.
  [[nodiscard]] std::uint64_t default_bits() const { return default_; }

  /// Length of the present value in bytes, as an SDO carries it.
  [[nodiscard]] std::size_t size() const {
    return is_string(type()) ? text_.size() : byte_length(type());
  }
  /// Length in bits in a PDO; 8 per character for strings.
  [[nodiscard]] std::size_t bits() const {
    return is_string(type()) ? text_.size() * 8 : bit_length(type());
  }

  [[nodiscard]] std::uint64_t value() const { return *value_; }
  [[nodiscard]] std::int64_t signed_value() const { return static_cast<std::int64_t>(*value_); }
  /// The value as a number, by the signedness of its type; 0 for a string.
  [[nodiscard]] double number() const {
    return is_signed(type()) ? static_cast<double>(signed_value()) : static_cast<double>(value());
  }
  [[nodiscard]] const std::string& text() const { return text_; }
  /// A string's or domain's value where it lies, until it is next set: for reading it in parts.
  [[nodiscard]] std::span<const std::byte> bytes() const { return std::as_bytes(std::span(text_)); }

  /// Stores without checks or hooks: for the code that owns the value.
  void set_value(std::uint64_t bits) { *value_ = bits; }
  void set_text(std::string_view text) { text_ = text; }

  [[nodiscard]] bool readable() const { return declaration_->access != Access::write_only; }
  [[nodiscard]] bool writable() const {
    return declaration_->access == Access::read_write || declaration_->access == Access::write_only;
  }

 private:
  friend class Dictionary;
  const EntryDeclaration* declaration_ = nullptr;
  std::uint16_t index_ = 0;
  std::uint8_t axis_ = 0;
  base::SharedText name_;
  std::string text_;
  std::uint64_t* value_ = nullptr;
  std::uint64_t default_ = 0;
  CheckHook check_;
  WrittenHook written_;
  ReadHook read_;
  ReadCheckHook read_check_;
};

/// A typed view of one entry's value for the code that owns it: no look-up, no checks, no hooks.
/// Valid as long as the dictionary. `Variable<const T>` is for code that only reads the value.
template <typename T>
class Variable {
 public:
  /// What the entry holds, and where.
  using Value = std::remove_const_t<T>;
  using Slot = std::conditional_t<std::is_const_v<T>, const std::uint64_t, std::uint64_t>;

  Variable() = default;
  explicit Variable(Slot* slot) : slot_(slot) {}
  /// Where a value may be set it may also only be read.
  template <std::same_as<Value> Other>
  Variable(const Variable<Other>& other) : slot_(other.slot_) {}  // NOLINT: implicit

  [[nodiscard]] Value get() const { return static_cast<Value>(*slot_); }
  void set(Value value) requires(!std::is_const_v<T>) {
    if constexpr (std::is_signed_v<T>) {
      *slot_ = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
    } else {
      *slot_ = static_cast<std::uint64_t>(value);
    }
  }

 private:
  template <typename>
  friend class Variable;
  Slot* slot_ = nullptr;
};

/// All entries with one index, to be looked at; Dictionary::entries_of() gives them to be changed.
struct Object {
  std::uint16_t index = 0;
  base::SharedText name;
  ObjectCode code = ObjectCode::variable;
  std::uint8_t axis = 0;
  std::span<const Entry> entries;  ///< ascending subindex, without gaps being filled

  /// The entry with `subindex`, or null.
  [[nodiscard]] const Entry* find(std::uint8_t subindex) const;
  /// It has one entry: a variable or a domain.
  [[nodiscard]] bool single() const {
    return code == ObjectCode::variable || code == ObjectCode::domain_object;
  }
  /// Highest subindex; 0 for a variable.
  [[nodiscard]] std::uint8_t max_subindex() const { return entries.back().subindex(); }
};

/// Where a group of declarations goes: "axis 1 of three, 800h above axis 0".
struct Placement {
  std::uint8_t axis = 0;
  std::uint16_t index_offset = 0;
  std::string_view name_prefix{};  ///< e.g. "Axis 1: "
};

/// State in which an access happens.
struct AccessContext {
  NetworkState network_state = NetworkState::pre_operational;
};

/// An object dictionary (CiA 301 §7.4, ETG.1000.6 §5.6.7): a value built once, at start, from
/// declarations; afterwards values change, the structure does not, and nothing allocates except
/// the assignment of a longer string. Of a const dictionary values can be read, by read() or as
/// they lie, and nothing that is reached from it can be changed.
class Dictionary {
 public:
  Dictionary() = default;
  Dictionary(const Dictionary&) = delete;
  Dictionary& operator=(const Dictionary&) = delete;
  ~Dictionary() = default;

  /// Adds entries. The declarations must outlive the dictionary. Throws std::logic_error after
  /// finish().
  void add(std::span<const EntryDeclaration> declarations, const Placement& placement = {});

  /// Sorts, links and sets every default. Throws std::logic_error naming the offender if an entry
  /// is declared twice, subindex 0 is missing, a range is empty, or a default or a bound of a range
  /// is no value of the entry's type. A default outside its range is allowed: some documents print
  /// such.
  void finish();

  /// finish() has been called.
  [[nodiscard]] bool finished() const { return !values_.empty(); }

  /// Sets every value to its default, without hooks: what power-on does.
  void reset_values();
  /// The same for the objects from `first` to `last`.
  void reset_values(std::uint16_t first, std::uint16_t last);

  /// Changes the default of one entry, for products that leave their box differently configured;
  /// its value follows with the next reset. Throws std::logic_error if the entry does not exist or
  /// `bits` is no value of its type.
  void set_default(std::uint16_t index, std::uint8_t subindex, std::uint64_t bits);

  /// Changes the defaults that count from the node-ID (EntryDeclaration::node_id_relative); their
  /// values follow with the next reset. Before the first call the node-ID counts as 0.
  void set_node_id(std::uint8_t node_id);

  [[nodiscard]] std::span<const Object> objects() const { return objects_; }
  [[nodiscard]] std::span<const Entry> entries() const { return entries_; }
  /// The entries of one of this dictionary's objects, to be changed.
  [[nodiscard]] std::span<Entry> entries_of(const Object& object);

  /// The object, or null.
  [[nodiscard]] const Object* find(std::uint16_t index) const;
  /// The entry, or null.
  [[nodiscard]] const Entry* find(std::uint16_t index, std::uint8_t subindex) const;
  [[nodiscard]] Entry* find(std::uint16_t index, std::uint8_t subindex);
  /// The entry, or the refusal with the right abort code (object or subindex missing).
  [[nodiscard]] base::Expected<const Entry*, Refusal> require(std::uint16_t index,
                                                              std::uint8_t subindex) const;
  [[nodiscard]] base::Expected<Entry*, Refusal> require(std::uint16_t index, std::uint8_t subindex);

  /// A handle for the code that owns the value; of a const dictionary one that only reads. Throws
  /// std::logic_error if the entry does not exist or T has not the size and signedness of its type.
  template <typename T>
  [[nodiscard]] Variable<T> variable(std::uint16_t index, std::uint8_t subindex = 0) {
    return Variable<T>(kept_as<T>(index, subindex).value_);
  }
  template <typename T>
  [[nodiscard]] Variable<const T> variable(std::uint16_t index, std::uint8_t subindex = 0) const {
    return Variable<const T>(kept_as<T>(index, subindex).value_);
  }

  /// Hooks of one entry; throw std::logic_error if it does not exist.
  void on_check(std::uint16_t index, std::uint8_t subindex, Entry::CheckHook hook);
  void on_written(std::uint16_t index, std::uint8_t subindex, Entry::WrittenHook hook);
  void on_read(std::uint16_t index, std::uint8_t subindex, Entry::ReadHook hook);
  void on_read_check(std::uint16_t index, std::uint8_t subindex, Entry::ReadCheckHook hook);

  /// Asks the axis' owner for the state of its power drive; needed for DriveCondition. Returns no
  /// text when the axis is in Switch on disabled, else the state's name.
  using DriveStateQuery = base::Delegate<base::StaticText(std::uint8_t axis)>;
  void set_drive_state_query(DriveStateQuery query) { drive_state_ = query; }

  /// Reads an entry as an SDO carries it: little-endian, exactly entry.size() bytes into `out`,
  /// which must be at least that long (call prepare_read first when the size matters). `entry` is
  /// one of this dictionary.
  [[nodiscard]] Verdict read(const Entry& entry, std::span<std::byte> out) const;
  /// Runs the read hook and checks readability; entry.size() is then the size of the value. `entry`
  /// is one of this dictionary.
  [[nodiscard]] Verdict prepare_read(const Entry& entry) const;

  /// Checks what can be said before the data are there: access, network state and, if it is known,
  /// the length in bytes.
  [[nodiscard]] Verdict prepare_write(const Entry& entry, std::optional<std::size_t> size,
                                      const AccessContext& context) const;
  /// Writes an entry as an SDO carries it; every check of the declaration, then the check hook,
  /// then the value, then the written hook. Texts have no range and no check hook.
  [[nodiscard]] Verdict write(Entry& entry, std::span<const std::byte> data,
                              const AccessContext& context);

  /// Writes a number as process data brings it: range and hooks are checked, access by SDO and
  /// network state are not. Nothing happens when the value is unchanged.
  [[nodiscard]] Verdict write_from_pdo(Entry& entry, std::uint64_t raw);

 private:
  /// The entry, if its value is kept as a T.
  template <typename T>
  [[nodiscard]] const Entry& kept_as(std::uint16_t index, std::uint8_t subindex) const {
    static_assert(std::is_integral_v<T> || std::is_enum_v<T>, "values are kept as integers");
    return existing(index, subindex, sizeof(T), std::is_signed_v<T>);
  }
  [[nodiscard]] const Entry& existing(std::uint16_t index, std::uint8_t subindex, std::size_t size,
                                      bool wants_signed) const;
  [[nodiscard]] const Entry& existing(std::uint16_t index, std::uint8_t subindex) const;
  [[nodiscard]] Entry& existing(std::uint16_t index, std::uint8_t subindex);
  /// The entry that somebody who may only look has been given, as the dictionary has it.
  [[nodiscard]] Entry& own(const Entry& entry) const { return entries_[position(entry)]; }
  [[nodiscard]] std::size_t position(const Entry& entry) const {
    return static_cast<std::size_t>(&entry - entries_.data());
  }
  [[nodiscard]] Verdict check_value(const Entry& entry, std::uint64_t bits) const;
  void link_values();
  void link_objects();

  /// Mutable, because a read hook brings a value up to date when it is asked for, and asking is all
  /// that who has a const dictionary can do. Nothing else in a const function changes an entry.
  mutable std::vector<Entry> entries_;
  std::vector<Object> objects_;
  std::vector<std::uint64_t> values_;  ///< one per entry; never grows, so pointers stay valid
  DriveStateQuery drive_state_;
};

}  // namespace stator::dictionary
