#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stator::settings {

class Reader;

template <typename T>
struct Key;

/// What the values of several keys must be to each other.
template <typename T>
struct Rule {
  std::string_view key;  ///< that is refused
  /// The sentence against the values; empty: they are good.
  std::string (*problem)(const T&, const Reader&) = nullptr;
  // The same where the sentence is always the same.
  bool (*holds)(const T&) = nullptr;
  std::string_view sentence{};
};

/// The keys of one table, which fill a `T`. Who declares or reads one includes key.hpp.
template <typename T>
struct Section {
  std::span<const Key<T>> keys;
  std::span<const Rule<T>> rules{};
  /// Called if the table is there, before its keys are read. Null: its presence alone changes
  /// nothing.
  void (*when_given)(T&) = nullptr;
};

/// Reads the keys of a section into `target`, where others may read further keys of the table.
/// Returns whether what is needed is there and no rule of the section objects; rules are asked only
/// where what is needed is there.
template <typename T>
bool read_keys(const Section<T>& section, Reader& reader, T& target);

}  // namespace stator::settings
