#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/board/lines/line.hpp"

namespace stator::board {

/// What a logic analyser notes.
struct TraceRecord {
  enum class Kind : std::uint8_t {
    low,
    high,
    unknown,    ///< records were lost before this one: the level until now is not known
    spi,        ///< one word: `bits` of both directions
    i2c_start,  ///< or repeated start
    i2c_byte,   ///< value = sent | acknowledged << 8
    i2c_stop,
  };

  base::SimTime time;
  Kind kind = Kind::low;
  std::uint8_t channel = 0;  ///< a line, or kSpiChannel or kI2cChannel
  std::uint8_t bits = 0;     ///< of an SPI word
  std::uint64_t value = 0;   ///< from the master
  std::uint64_t answer = 0;  ///< to the master
};

inline constexpr std::uint8_t kSpiChannel = 24;
inline constexpr std::uint8_t kI2cChannel = 25;
inline constexpr std::uint8_t kTraceChannels = 26;

/// The lines a decoder listens to.
struct DecodedLines {
  Line spi_sck = kNotWired;
  Line spi_mosi = kNotWired;
  Line spi_miso = kNotWired;
  Line spi_cs = kNotWired;
  bool spi_samples_falling_edge = false;
  Line i2c_scl = kNotWired;
  Line i2c_sda = kNotWired;
};

/// A logic analyser at the chip's lines. Takes edges in order of time into one of two blocks of
/// records; a full block goes to the sink at once, which keeps what it needs before it returns.
/// Nothing is allocated after construction.
class LogicTrace {
 public:
  using Sink = base::Delegate<void(std::span<const TraceRecord>)>;

  /// `lines`: bit n for line n. The sink is called in the cyclic path: it must not wait.
  LogicTrace(std::uint32_t lines, const DecodedLines& decoded, std::size_t block, Sink sink);

  [[nodiscard]] bool traces(Line line) const { return ((lines_ >> line) & 1U) != 0; }
  [[nodiscard]] std::uint32_t lines() const { return lines_; }
  [[nodiscard]] const DecodedLines& decoded() const { return decoded_; }

  /// The level a line has when the trace begins.
  void begin(base::SimTime now, Line line, bool level);
  void change(base::SimTime now, Line line, bool level);
  /// Gives away what has been noted so far.
  void flush();

 private:
  void note(const TraceRecord& record);
  void note_level(base::SimTime now, Line line, bool level);
  void decode_spi(base::SimTime now, Line line, bool level);
  void decode_i2c(base::SimTime now, Line line, bool level);

  std::uint32_t lines_;
  DecodedLines decoded_;
  Sink sink_;
  std::vector<TraceRecord> block_;
  std::size_t capacity_;
  std::array<bool, kLines> level_{};

  TraceRecord spi_{};  ///< the word under way
  bool i2c_busy_ = false;
  TraceRecord i2c_{};  ///< the byte under way
};

}  // namespace stator::board
