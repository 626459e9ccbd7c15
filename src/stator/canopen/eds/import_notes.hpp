// What a reader of files remarks, of each kind no more than somebody reads.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "stator/dictionary/import_report.hpp"

namespace stator::canopen {

/// Adds to a report. A file that has the same flaw ten thousand times gets kMostOfARule notes of it
/// and one that counts the others, so that no file decides how long its report becomes.
class ImportNotes {
 public:
  static constexpr std::size_t kMostOfARule = 50;

  explicit ImportNotes(dictionary::ImportReport& report) : report_(report) {}

  /// Adds a note, or counts it.
  void add(dictionary::ImportKind kind, std::size_t line, std::string_view rule, std::string text) {
    Count& count = counts_.try_emplace(std::string(rule), Count{kind}).first->second;
    if (++count.all <= kMostOfARule) {
      report_.add(kind, line, std::string(rule), std::move(text));
    }
  }

  /// Says how many there were beyond those that were added; to be called once, at the end.
  void finish() {
    for (const auto& [rule, count] : counts_) {
      if (count.all > kMostOfARule) {
        report_.add(count.kind, 0, rule,
                    std::to_string(count.all - kMostOfARule) + " more of the same kind");
      }
    }
  }

 private:
  struct Count {
    dictionary::ImportKind kind;
    std::size_t all = 0;
  };
  dictionary::ImportReport& report_;
  std::map<std::string, Count, std::less<>> counts_;
};

}  // namespace stator::canopen
