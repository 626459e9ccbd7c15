#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/registers/register_table.hpp"

namespace stator::ethercat {

/// How long the controller is busy with the EEPROM.
struct SiiTiming {
  base::SimDuration read = base::SimDuration(100'000);      ///< four or eight bytes over I2C
  base::SimDuration write = base::SimDuration(500'000);     ///< one word
  base::SimDuration reload = base::SimDuration(1'000'000);  ///< the configuration area
};

/// Stores the content of an EEPROM beyond the life of the process.
class SiiKeeper {
 public:
  SiiKeeper() = default;
  SiiKeeper(const SiiKeeper&) = delete;
  SiiKeeper& operator=(const SiiKeeper&) = delete;
  virtual ~SiiKeeper() = default;

  /// Takes the content as it is to be once a word has been written. True: it counts as kept; false:
  /// finish_write() will be called with what has become of it.
  [[nodiscard]] virtual bool keep_sii(std::span<const std::byte> content) = 0;
};

/// CRC-8 (x^8 + x^2 + x + 1, start FFh) over the first seven words of an SII image: the low byte of
/// word 7 of a valid one (ETG.2010 table 2). `image` must have at least 14 bytes.
[[nodiscard]] std::uint8_t sii_checksum(std::span<const std::byte> image);

/// The EEPROM and registers 0x0500..0x050F through which master or host read and write it word by
/// word (ETG.1000.4 §6.5; TMC8461 datasheet "SII EEPROM interface"). Works on the controller's
/// register memory. Busy is a deadline; finish() completes what is due.
///
/// With a keeper a written word is busy until it is kept, its write time at least. If it cannot be
/// kept, the cell has its old content and the error bit for a missing acknowledge is set. The same
/// bit ends an access after kLongestWrite, whatever becomes of the word: until that is known the
/// EEPROM acknowledges nothing, as in its write cycle.
class SiiInterface {
 public:
  /// Far beyond what masters wait for a word (10 to 20 ms): a disk that hangs must not make the
  /// interface hang as well.
  static constexpr base::SimDuration kLongestWrite{500'000'000};

  SiiInterface(std::span<std::byte, kRegisterSpace> registers, SiiTiming timing,
               bool eight_byte_read, bool error_blocks_commands = false)
      : registers_(registers),
        timing_(timing),
        eight_byte_read_(eight_byte_read),
        error_blocks_commands_(error_blocks_commands) {}

  /// Puts an EEPROM with `image` on the board. Its size is the next power of two from 128 bytes on;
  /// what the image does not fill reads FFh, as erased cells do. Empty: no EEPROM answers.
  void insert(std::span<const std::byte> image);
  [[nodiscard]] std::span<const std::byte> content() const { return content_; }
  /// From now on the byte at `offset` reads with the bits of `mask` inverted, as from a worn cell;
  /// the content stays. A mask of 0 heals it. Allocates.
  void corrupt(std::size_t offset, std::uint8_t mask);
  /// What is read at `offset` < content().size().
  [[nodiscard]] std::byte cell(std::size_t offset) const;

  /// Null: what is written lasts as long as the EEPROM.
  void set_keeper(SiiKeeper* keeper) { keeper_ = keeper; }
  /// What has become of the word that the keeper took last.
  void finish_write(bool kept, base::SimTime now);

  /// Why the configuration area was not taken over.
  enum class LoadResult : std::uint8_t { loaded, no_eeprom, bad_checksum };
  /// The configuration area as it is read.
  static constexpr std::size_t kConfigurationAreaLength = 16;
  [[nodiscard]] std::array<std::byte, kConfigurationAreaLength> configuration_area() const;
  /// Checks the configuration area and sets the status bits "checksum error" and "not loaded".
  LoadResult load();

  /// Register state after power-on; the content stays.
  void reset();

  [[nodiscard]] bool busy() const { return deadline_ != base::SimTime::never(); }
  [[nodiscard]] bool host_owns() const;
  [[nodiscard]] bool bus_may_write() const { return !host_owns() && !busy(); }
  [[nodiscard]] bool host_may_write() const { return host_owns() && !busy(); }
  /// 0x0501 bit 0 is writable for the host while 0x0500 offers the EEPROM.
  [[nodiscard]] bool host_may_take() const;

  /// After a write to 0x0500: a forced bus access takes the EEPROM from the host.
  void update_owner();

  /// What became of a command.
  enum class CommandResult : std::uint8_t {
    started,
    idle,               ///< command 0: error bits cleared
    invalid,            ///< no such command
    not_write_enabled,  ///< write without 0x0502 bit 0 in the same frame
    error_pending,      ///< ignored: an earlier error has to be cleared first
    no_acknowledge,     ///< no EEPROM on the board
    still_writing,      ///< no acknowledge: a word is still being kept though its access has ended
  };
  /// Runs what a write to 0x0502..0x0503 has left in the command bits.
  CommandResult start_command(base::SimTime now);

  /// A new frame begins: write enable of an earlier frame is over.
  void start_of_frame();

  /// What finish() completed.
  enum class Completion : std::uint8_t {
    nothing,
    access,
    reload,
    given_up,  ///< a write, after kLongestWrite
  };
  Completion finish(base::SimTime now);
  [[nodiscard]] base::SimTime deadline() const { return deadline_; }

  /// Clears or sets the bits the controller shows in 0x0502 besides commands.
  void refresh_status();

 private:
  enum class Command : std::uint8_t {
    idle = 0,
    read = 1,
    write = 2,
    reload = 4,
  };

  void set_status(std::uint16_t clear, std::uint16_t set);
  void read_words();
  void begin_write(base::SimTime now);
  [[nodiscard]] Completion end_write(base::SimTime now);
  void settle_write();
  void end_access();
  [[nodiscard]] std::size_t byte_address() const;

  std::span<std::byte, kRegisterSpace> registers_;
  SiiTiming timing_;
  bool eight_byte_read_;
  bool error_blocks_commands_;
  std::vector<std::byte> content_;
  struct WornCell {
    std::size_t offset;
    std::byte mask;
  };
  std::vector<WornCell> worn_;
  base::SimTime deadline_ = base::SimTime::never();
  Command command_ = Command::idle;

  /// The word that is being written.
  struct Write {
    std::size_t offset = 0;
    std::array<std::byte, 2> word{};
    bool under_way = false;      ///< it has not reached the cell yet
    std::optional<bool> kept{};  ///< the keeper's verdict
    base::SimTime time_out;      ///< of the access
  };
  Write write_;
  SiiKeeper* keeper_ = nullptr;
};

}  // namespace stator::ethercat
