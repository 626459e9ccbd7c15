// ESI files of tests/data/esi_files as they are read.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "source_paths.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/ethercat/standard/imported_slave.hpp"
#include "stator/formats/esi/esi_reader.hpp"

namespace stator::tests {

inline std::string esi_file_text(const std::string& name) {
  std::ifstream file(STATOR_TEST_DATA "/esi_files/" + name + ".xml", std::ios::binary);
  EXPECT_TRUE(file) << name;
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A file that must be read, and questions about what came of it.
class ReadEsi {
 public:
  explicit ReadEsi(const std::string& name, const formats::EsiChoice& choice = {}) {
    auto slave = formats::read_esi(esi_file_text(name), choice, report_);
    if (!slave) {
      ADD_FAILURE() << name << ": " << slave.error().rule << ": " << slave.error().text;
      return;
    }
    slave_ = std::move(*slave);
    dictionary::Dictionary built;  // throws if a declaration contradicts itself
    built.add(slave_.objects.rows(), {});
    EXPECT_NO_THROW(built.finish()) << name;
  }

  const ethercat::ImportedSlave* operator->() const { return &slave_; }

  [[nodiscard]] const dictionary::EntryDeclaration* find(std::uint16_t index,
                                                         std::uint8_t subindex) const {
    const auto& rows = slave_.objects.rows();
    const auto found = std::ranges::find_if(rows, [&](const dictionary::EntryDeclaration& row) {
      return row.index == index && row.subindex == subindex;
    });
    return found == rows.end() ? nullptr : &*found;
  }
  [[nodiscard]] dictionary::EntryDeclaration row(std::uint16_t index,
                                                 std::uint8_t subindex = 0) const {
    const dictionary::EntryDeclaration* const found = find(index, subindex);
    EXPECT_NE(found, nullptr) << std::hex << index << ':' << int{subindex};
    return found == nullptr ? dictionary::EntryDeclaration{} : *found;
  }
  [[nodiscard]] std::int64_t value(std::uint16_t index, std::uint8_t subindex = 0) const {
    return row(index, subindex).default_value.number.as_signed();
  }
  /// Subindices of an object.
  [[nodiscard]] std::vector<int> subindices(std::uint16_t index) const {
    std::vector<int> found;
    for (const dictionary::EntryDeclaration& each : slave_.objects.rows()) {
      if (each.index == index) {
        found.push_back(each.subindex);
      }
    }
    return found;
  }
  /// How many notes a rule has.
  [[nodiscard]] std::ptrdiff_t notes(std::string_view rule, dictionary::ImportKind kind) const {
    return std::ranges::count_if(report_.notes, [&](const dictionary::ImportNote& note) {
      return note.rule == rule && note.kind == kind && !note.text.empty();
    });
  }
  [[nodiscard]] std::size_t line(std::string_view rule) const {
    const auto found = std::ranges::find(report_.notes, rule, &dictionary::ImportNote::rule);
    return found == report_.notes.end() ? 0 : found->line;
  }
  [[nodiscard]] std::string all_notes() const {
    std::string all;
    for (const dictionary::ImportNote& note : report_.notes) {
      all += std::to_string(note.line) + " " + note.rule + ": " + note.text + "\n";
    }
    return all;
  }

 private:
  dictionary::ImportReport report_;
  ethercat::ImportedSlave slave_;
};

/// Why a file gives no device.
inline dictionary::ImportError esi_refusal(const std::string& name,
                                           const formats::EsiChoice& choice = {}) {
  dictionary::ImportReport report;
  const auto slave = formats::read_esi(esi_file_text(name), choice, report);
  EXPECT_FALSE(slave) << name;
  return slave ? dictionary::ImportError{} : slave.error();
}

}  // namespace stator::tests
