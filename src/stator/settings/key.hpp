#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/settings/reader.hpp"
#include "stator/settings/section.hpp"
#include "stator/settings/words.hpp"

namespace stator::settings {

// Configurations are structs; their keys are constants beside them. A key has a name, a range with
// its unit, a sentence and the path of members that leads to where its value belongs; type and
// default come from the member. Reading, schema, reference and completion come from the same row:
//
//   constexpr std::array kKeys{
//       number<&Load::inertia>("inertia", {0, 10, "kg m²"}, "At the motor shaft"),
//       number<&Load::minimum>("minimum", {-1, 1, "revolutions"}, "Lower end of the travel")};
//   constexpr std::array kRules{Rule<Load>{"minimum", below_maximum}};
//   constinit const Section<Load> kLoadKeys{kKeys, kRules};
//
// A path may go through arrays: number<&Sensor::track, 2, &Track::gain>.

/// What numbers may be.
struct Range {
  double minimum;
  double maximum;
  std::string_view unit{};
};

/// What whole numbers may be.
struct WholeRange {
  std::int64_t minimum;
  std::int64_t maximum;
  std::string_view unit{};
};

/// What durations may be.
struct DurationRange {
  base::SimDuration minimum;
  base::SimDuration maximum;
};

/// A word and the value it stands for.
struct Word {
  constexpr Word(std::string_view word, std::int64_t meaning) : name(word), value(meaning) {}
  template <typename Meaning>
  requires std::is_enum_v<Meaning>
  constexpr Word(std::string_view word, Meaning meaning)
      : Word(word, static_cast<std::int64_t>(meaning)) {}

  std::string_view name;
  std::int64_t value;
};

/// What a word, which must be there, stands for.
template <typename Meaning>
constexpr Meaning meaning_of(std::span<const Word> words, std::string_view word) {
  std::size_t i = 0;
  while (words[i].name != word) {
    ++i;
  }
  return static_cast<Meaning>(words[i].value);
}

/// The word for a value, which has one.
template <typename Meaning>
constexpr std::string_view name_of(std::span<const Word> words, Meaning meaning) {
  std::size_t i = 0;
  while (words[i].value != static_cast<std::int64_t>(meaning)) {
    ++i;
  }
  return words[i].name;
}

/// One key of the struct `T`. Made by the functions below.
template <typename T>
struct Key {
  std::string_view name;
  std::string_view summary;
  std::string_view unit{};
  WholeRange whole{};  ///< also of durations, in nanoseconds
  double minimum = 0.0;
  double maximum = 0.0;
  std::span<const Word> words{};
  bool needed = false;  ///< the table says nothing without it
  std::string_view
      explanation{};  ///< told where a needed one is missing; empty: what the words are
  /// Reads the key into `target`, which has the default.
  void (*read)(const Key&, Reader&, T& target);

  [[nodiscard]] KeyWords key_words() const { return {name, summary, unit}; }
  [[nodiscard]] std::set<std::string> names() const {
    std::set<std::string> all;
    for (const Word& word : words) {
      all.emplace(word.name);
    }
    return all;
  }
};

namespace internal {

/// Whether a key that is needed is there and has been read; what is wrong is told.
template <typename T>
bool is_good(const Key<T>& key, Reader& reader) {
  const std::string name(key.name);
  reader.note_required(name);
  if (reader.describes()) {
    return true;
  }
  if (!reader.contains(name)) {
    reader.refuse_missing(name, key.explanation.empty() ? "it is one of: " + joined(key.names())
                                                        : std::string(key.explanation));
  }
  return !reader.is_refused(name);
}

}  // namespace internal

template <typename T>
bool read_keys(const Section<T>& section, Reader& reader, T& target) {
  if (section.when_given != nullptr) {
    section.when_given(target);
  }
  for (const Key<T>& key : section.keys) {
    key.read(key, reader, target);
  }
  for (const Key<T>& key : section.keys) {
    if (key.needed && !internal::is_good(key, reader)) {
      return false;
    }
  }
  bool good = true;
  for (const Rule<T>& rule : section.rules) {
    const std::string sentence = rule.problem != nullptr ? rule.problem(target, reader)
                                 : rule.holds(target)    ? std::string()
                                                         : std::string(rule.sentence);
    if (!sentence.empty()) {
      reader.refuse(std::string(rule.key), sentence);
      good = false;
    }
  }
  return good;
}

/// Reads a table that has the keys of the section and no others.
template <typename T>
void read_section(const Section<T>& section, Reader& reader, T& target) {
  read_keys(section, reader, target);
  reader.finish();
}

namespace internal {

template <typename T, typename C>
C class_of(T C::*);

template <auto First, auto...>
struct OwnerOf {
  using Type = decltype(class_of(First));
};
/// The struct that a path begins in.
template <auto... Path>
using Owner = typename OwnerOf<Path...>::Type;

template <auto Step, auto... Rest>
constexpr auto& follow(auto& object) {
  auto& next = [&]() -> auto& {
    if constexpr (std::is_member_pointer_v<decltype(Step)>) {
      return object.*Step;
    } else {
      return object[Step];
    }
  }
  ();
  if constexpr (sizeof...(Rest) == 0) {
    return next;
  } else {
    return follow<Rest...>(next);
  }
}

template <typename T>
struct HeldBy {
  using Type = T;
};
template <typename T>
struct HeldBy<std::optional<T>> {
  using Type = T;
};
/// What a member keeps, be it optional or not.
template <typename Member>
using Held = typename HeldBy<std::remove_reference_t<Member>>::Type;
template <typename Member>
inline constexpr bool kIsOptional = !std::is_same_v<Held<Member>, std::remove_reference_t<Member>>;

/// Of a range of texts.
std::set<std::string> set_of(const auto& texts) {
  std::set<std::string> all;
  for (const auto& text : texts) {
    all.emplace(text);
  }
  return all;
}

/// A key whose value `Read` reads into the member at the end of the path.
template <auto Read, auto... Path>
constexpr auto row(std::string_view name, std::string_view summary, std::string_view unit = {}) {
  using T = Owner<Path...>;
  return Key<T>{.name = name,
                .summary = summary,
                .unit = unit,
                .read = [](const Key<T>& key, Reader& reader, T& target) {
                  Read(key, reader, follow<Path...>(target));
                }};
}
template <auto Read, auto... Path>
constexpr auto row(std::string_view name, std::string_view summary, WholeRange range,
                   std::span<const Word> words = {}) {
  auto key = row<Read, Path...>(name, summary, range.unit);
  key.whole = range;
  key.words = words;
  return key;
}
template <auto Read, auto... Path>
constexpr auto row(std::string_view name, std::string_view summary, Range range) {
  auto key = row<Read, Path...>(name, summary, range.unit);
  key.minimum = range.minimum;
  key.maximum = range.maximum;
  return key;
}

inline constexpr auto kReadWhole = [](const auto& key, Reader& reader, auto& member) {
  if constexpr (!kIsOptional<decltype(member)>) {
    reader.integer(key.key_words(), key.whole.minimum, key.whole.maximum, member);
  } else if (const auto value =
                 reader.integer(key.key_words(), key.whole.minimum, key.whole.maximum)) {
    member = static_cast<Held<decltype(member)>>(*value);
  }
};

inline constexpr auto kReadDuration = [](const auto& key, Reader& reader, auto& member) {
  const base::SimDuration minimum(key.whole.minimum);
  const base::SimDuration maximum(key.whole.maximum);
  if constexpr (!kIsOptional<decltype(member)>) {
    reader.duration(key.key_words(), minimum, maximum, member);
  } else if (const auto value = reader.duration(key.key_words(), minimum, maximum)) {
    member = *value;
  }
};

inline constexpr auto kReadWord = [](const auto& key, Reader& reader, auto& member) {
  if constexpr (!kIsOptional<decltype(member)>) {
    for (const Word& each : key.words) {
      if (each.value == static_cast<std::int64_t>(member)) {
        reader.note_default(key.key_words(), '"' + std::string(each.name) + '"');
      }
    }
  }
  if (const auto given = reader.choice(key.key_words(), key.names())) {
    member = meaning_of<Held<decltype(member)>>(key.words, *given);
  }
};

inline constexpr auto kReadWholes = [](const auto& key, Reader& reader, auto& member) {
  Held<decltype(member)> array{};
  if (const auto numbers =
          reader.integers(key.key_words(), array.size(), key.whole.minimum, key.whole.maximum)) {
    for (std::size_t i = 0; i < array.size(); ++i) {
      array[i] = static_cast<typename decltype(array)::value_type>((*numbers)[i]);
    }
    member = array;
  }
};

/// With one of the words instead, which leaves the member empty.
template <const auto& Read>
inline constexpr auto kReadOrWord = [](const auto& key, Reader& reader, auto& member) {
  reader.either(
      reader.is_text(std::string(key.name)), [&] { Read(key, reader, member); },
      [&] {
        static_cast<void>(reader.choice(key.key_words(), key.names()));
        member.reset();
      });
};

template <const auto& Below>
inline constexpr auto kReadTable = [](const auto& key, Reader& reader, auto& member) {
  if (auto table = reader.section(key.key_words())) {
    read_section(Below, *table, member);
  }
};

template <const auto& Below>
inline constexpr auto kReadTables = [](const auto& key, Reader& reader, auto& array) {
  std::vector<Reader> tables = reader.sections({key.name, key.summary});
  if (tables.size() > array.size()) {
    reader.refuse(std::string(key.name), std::to_string(tables.size()) + " " +
                                             std::string(key.unit) + " are given, the device has " +
                                             std::to_string(array.size()));
  }
  for (std::size_t i = 0; i < array.size() && i < tables.size(); ++i) {
    read_section(Below, tables[i], array[i]);
  }
};

/// Reads the keys of the alternative that the variant holds; a description has those of all.
template <typename Alternative, typename Variant>
void read_alternative(const Section<Alternative>& section, Reader& reader, Variant& variant) {
  if (auto* const there = std::get_if<Alternative>(&variant)) {
    read_keys(section, reader, *there);
  } else if (reader.describes()) {
    Alternative each{};
    read_keys(section, reader, each);
  }
}

template <const auto&... Below>
inline constexpr auto kReadAlternative = [](const auto& key, Reader& reader, auto& member) {
  if (auto table = reader.section(key.key_words())) {
    (read_alternative(Below, *table, member), ...);
    table->finish();
  }
};

template <const auto& Below>
inline constexpr auto kReadKeys =
    [](const auto& /*key*/, Reader& reader, auto& member) { read_keys(Below, reader, member); };

inline constexpr auto kReadBoolean = [](const auto& key, Reader& reader, bool& member) {
  reader.boolean(key.key_words(), member);
};
inline constexpr auto kReadNumber = [](const auto& key, Reader& reader, auto& member) {
  if constexpr (!kIsOptional<decltype(member)>) {
    reader.number(key.key_words(), key.minimum, key.maximum, member);
  } else if (const auto value = reader.number(key.key_words(), key.minimum, key.maximum)) {
    member = *value;
  }
};
inline constexpr auto kReadDegrees = [](const auto& key, Reader& reader, double& member) {
  reader.degrees(key.key_words(), key.minimum, key.maximum, member);
};
inline constexpr auto kReadText = [](const auto& key, Reader& reader, auto& member) {
  if constexpr (!kIsOptional<decltype(member)>) {
    reader.text(key.key_words(), member);
  } else if (auto text = reader.text(key.key_words())) {
    member = std::move(text);
  }
};
inline constexpr auto kReadTexts = [](const auto& key, Reader& reader,
                                      std::vector<std::string>& member) {
  reader.texts(key.key_words(), member);
};
inline constexpr auto kReadOutput = [](const auto& key, Reader& reader, std::string& member) {
  member = reader.output(key.key_words());
};
template <auto Names, auto Find>
inline constexpr auto kReadPreset = [](const auto& key, Reader& reader, auto& member) {
  if (const auto given = reader.choice(key.key_words(), set_of(Names()))) {
    member = Find(*given);
  }
};

}  // namespace internal

/// true or false.
template <auto... Path>
constexpr auto boolean(std::string_view name, std::string_view summary) {
  return internal::row<internal::kReadBoolean, Path...>(name, summary);
}

/// A number; into an optional member, too.
template <auto... Path>
constexpr auto number(std::string_view name, Range range, std::string_view summary) {
  return internal::row<internal::kReadNumber, Path...>(name, summary, range);
}

/// An angle, degrees in the file and radians in the member.
template <auto... Path>
constexpr auto degrees(std::string_view name, Range range, std::string_view summary) {
  return internal::row<internal::kReadDegrees, Path...>(name, summary, range);
}

/// A whole number; into an optional member or one of any integral type.
template <auto... Path>
constexpr auto whole(std::string_view name, WholeRange range, std::string_view summary) {
  return internal::row<internal::kReadWhole, Path...>(name, summary, range);
}

/// A whole number, or one of some words, which leaves the optional member empty.
template <auto... Path>
constexpr auto whole_or_word(std::string_view name, WholeRange range, std::span<const Word> words,
                             std::string_view summary) {
  return internal::row<internal::kReadOrWord<internal::kReadWhole>, Path...>(name, summary, range,
                                                                             words);
}

/// As many whole numbers as the array that the path leads to has; into an optional one, too.
template <auto... Path>
constexpr auto wholes(std::string_view name, WholeRange range, std::string_view summary) {
  return internal::row<internal::kReadWholes, Path...>(name, summary, range);
}

/// The same, or one of some words, which leaves the optional member empty.
template <auto... Path>
constexpr auto wholes_or_word(std::string_view name, WholeRange range, std::span<const Word> words,
                              std::string_view summary) {
  return internal::row<internal::kReadOrWord<internal::kReadWholes>, Path...>(name, summary, range,
                                                                              words);
}

/// A duration with its unit; into an optional member, too.
template <auto... Path>
constexpr auto duration(std::string_view name, DurationRange range, std::string_view summary) {
  return internal::row<internal::kReadDuration, Path...>(
      name, summary, WholeRange{range.minimum.nanoseconds(), range.maximum.nanoseconds()});
}

/// A text; into an optional member, too.
template <auto... Path>
constexpr auto text(std::string_view name, std::string_view summary) {
  return internal::row<internal::kReadText, Path...>(name, summary);
}

/// A list of texts.
template <auto... Path>
constexpr auto texts(std::string_view name, std::string_view summary) {
  return internal::row<internal::kReadTexts, Path...>(name, summary);
}

/// The name of a file to be written.
template <auto... Path>
constexpr auto output(std::string_view name, std::string_view summary) {
  return internal::row<internal::kReadOutput, Path...>(name, summary);
}

/// One of some words, each of which stands for a value of an enumeration, a truth value or a
/// number.
template <auto... Path>
constexpr auto word(std::string_view name, std::span<const Word> words, std::string_view summary) {
  return internal::row<internal::kReadWord, Path...>(name, summary, WholeRange{}, words);
}

/// A name that fills what the path leads to, e.g. a motor's: keys after it change single values.
/// `Names` returns a range of names, `Find` the values for one of them.
template <auto Names, auto Find, auto... Path>
constexpr auto preset(std::string_view name, std::string_view summary) {
  return internal::row<internal::kReadPreset<Names, Find>, Path...>(name, summary);
}

/// A table; its keys are those of `Below`, which belong to what the path leads to.
template <const auto& Below, auto... Path>
constexpr auto section(std::string_view name, std::string_view summary) {
  return internal::row<internal::kReadTable<Below>, Path...>(name, summary);
}

/// A table for each element of an array, first come first; `plural` is what people call several.
template <const auto& Below, auto... Path>
constexpr auto sections(std::string_view name, std::string_view plural, std::string_view summary) {
  return internal::row<internal::kReadTables<Below>, Path...>(name, summary, plural);
}

/// A table whose keys depend on which alternative of a std::variant is there: `Below` are sections
/// of the alternatives, in the order in which descriptions have them.
template <auto Member, const auto&... Below>
constexpr auto alternatives(std::string_view name, std::string_view summary) {
  return internal::row<internal::kReadAlternative<Below...>, Member>(name, summary);
}

/// One of some texts, which is kept as it is. `Names` returns a range of texts.
template <auto Names, auto... Path>
constexpr auto one_of(std::string_view name, std::string_view summary) {
  return preset<Names, [](const std::string& text) { return text; }, Path...>(name, summary);
}

/// The keys of `Below` on this level, without a table of their own.
template <const auto& Below, auto... Path>
constexpr auto keys() {
  return internal::row<internal::kReadKeys<Below>, Path...>({}, {});
}

/// A key without which the table says nothing. Where it is missing that is told with the
/// explanation, e.g. "it says how long", for words also without one; of several the first.
template <typename T>
constexpr Key<T> needed(Key<T> key, std::string_view explanation = {}) {
  key.needed = true;
  key.explanation = explanation;
  return key;
}

/// The keys of several arrays in one, in their order: what structs of several types have in common
/// comes from a template of theirs.
template <typename T, std::size_t... Counts>
constexpr auto rows(const std::array<Key<T>, Counts>&... arrays) {
  std::array<Key<T>, (Counts + ...)> all{};
  std::size_t place = 0;
  const auto append = [&](const auto& array) {
    for (const Key<T>& key : array) {
      all[place] = key;
      ++place;
    }
  };
  (append(arrays), ...);
  return all;
}

/// What no other form says: `Read` does all of it.
template <typename T, void (*Read)(const KeyWords&, Reader&, T&)>
constexpr auto custom(std::string_view name, std::string_view summary, std::string_view unit = {}) {
  return Key<T>{.name = name,
                .summary = summary,
                .unit = unit,
                .read = [](const Key<T>& key, Reader& reader, T& target) {
                  Read(key.key_words(), reader, target);
                }};
}

}  // namespace stator::settings
