#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "stator/board/lines/logic_trace.hpp"

namespace stator::board {

/// Writes what a logic trace noted as a value change dump (IEEE 1364-2005 §18.2), timescale 1 ns:
/// one wire per line, and one string each for decoded SPI words and I2C bytes, the extension that
/// GTKWave reads. Makes text only; where it goes is its caller's business.
class VcdFormat {
 public:
  /// `names`: of the lines, by number; they may contain no blanks.
  VcdFormat(std::string_view scope, const LogicTrace& trace,
            const std::array<std::string, kLines>& names);

  /// Declarations up to $enddefinitions; the file begins with it.
  [[nodiscard]] const std::string& header() const { return header_; }
  /// Appends the text of `records`, which follow those of the last call in time.
  void append(std::string& text, std::span<const TraceRecord> records);
  /// Appends a last moment, up to which all levels stay as they are; nothing if it is none later.
  void finish(std::string& text, base::SimTime time);

 private:
  void append_time(std::string& text, base::SimTime time);

  std::string header_;
  std::optional<base::SimTime> time_;
};

/// The name of a line on the chip: "MFCIO00".."MFCIO15", "MFC_HV0".."MFC_HV7" (mfc_pins.csv).
[[nodiscard]] std::string line_name(Line line);

}  // namespace stator::board
