#include "stator/board/lines/logic_trace.hpp"

namespace stator::board {

namespace {

TraceRecord blank(TraceRecord::Kind kind, std::uint8_t channel) {
  TraceRecord record;
  record.kind = kind;
  record.channel = channel;
  return record;
}

}  // namespace

LogicTrace::LogicTrace(std::uint32_t lines, const DecodedLines& decoded, std::size_t block,
                       Sink sink)
    : lines_(lines), decoded_(decoded), sink_(sink), capacity_(block) {
  block_.reserve(block);
  for (const Line line : {decoded.spi_sck, decoded.spi_mosi, decoded.spi_miso, decoded.spi_cs,
                          decoded.i2c_scl, decoded.i2c_sda}) {
    lines_ |= line < kLines ? std::uint32_t{1} << line : 0U;
  }
}

void LogicTrace::begin(base::SimTime now, Line line, bool level) {
  level_[line] = level;
  note_level(now, line, level);
}

void LogicTrace::change(base::SimTime now, Line line, bool level) {
  if (level_[line] == level) {
    return;
  }
  level_[line] = level;
  note_level(now, line, level);
  decode_spi(now, line, level);
  decode_i2c(now, line, level);
}

void LogicTrace::note_level(base::SimTime now, Line line, bool level) {
  TraceRecord record = blank(level ? TraceRecord::Kind::high : TraceRecord::Kind::low, line);
  record.time = now;
  note(record);
}

void LogicTrace::note(const TraceRecord& record) {
  block_.push_back(record);
  if (block_.size() == capacity_) {
    flush();
  }
}

void LogicTrace::flush() {
  if (!block_.empty()) {
    sink_(block_);
    block_.clear();
  }
}

void LogicTrace::decode_spi(base::SimTime now, Line line, bool level) {
  if (line == decoded_.spi_cs) {
    if (level && spi_.bits > 0) {
      spi_.time = now;
      note(spi_);
    }
    spi_ = blank(TraceRecord::Kind::spi, kSpiChannel);
    return;
  }
  const bool selected = decoded_.spi_cs < kLines && !level_[decoded_.spi_cs];
  if (line != decoded_.spi_sck || !selected || level == decoded_.spi_samples_falling_edge) {
    return;
  }
  const auto bit = [this](Line which) {
    return which < kLines && level_[which] ? std::uint64_t{1} : std::uint64_t{0};
  };
  spi_.value = spi_.value << 1U | bit(decoded_.spi_mosi);
  spi_.answer = spi_.answer << 1U | bit(decoded_.spi_miso);
  // A longer datagram is shown in pieces of 64 bits.
  if (++spi_.bits == 64) {
    spi_.time = now;
    note(spi_);
    spi_ = blank(TraceRecord::Kind::spi, kSpiChannel);
  }
}

void LogicTrace::decode_i2c(base::SimTime now, Line line, bool level) {
  if (line == decoded_.i2c_sda && decoded_.i2c_scl < kLines && level_[decoded_.i2c_scl]) {
    TraceRecord condition =
        blank(level ? TraceRecord::Kind::i2c_stop : TraceRecord::Kind::i2c_start, kI2cChannel);
    condition.time = now;
    note(condition);
    i2c_busy_ = !level;
    i2c_ = blank(TraceRecord::Kind::i2c_byte, kI2cChannel);
  } else if (line == decoded_.i2c_scl && level && i2c_busy_) {
    const bool bit = decoded_.i2c_sda < kLines && level_[decoded_.i2c_sda];
    if (++i2c_.bits < 9) {
      i2c_.value = i2c_.value << 1U | (bit ? 1U : 0U);
    } else {
      i2c_.value |= bit ? 0U : std::uint64_t{0x100};
      i2c_.time = now;
      note(i2c_);
      i2c_ = blank(TraceRecord::Kind::i2c_byte, kI2cChannel);
    }
  }
}

}  // namespace stator::board
