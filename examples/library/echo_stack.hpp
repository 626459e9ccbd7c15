#pragma once

// A slave stack of one's own: a slave without mailbox that gives the outputs of the master back as
// inputs. Nothing in it is Stator's but ethercat::ProcessDataInterface, of which a board has one
// over SPI: a stack from elsewhere is put there in its place.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include <stator/slave.hpp>

namespace echo {

using namespace stator;

inline constexpr std::uint16_t kOutputs = 0x1000;
inline constexpr std::uint16_t kInputs = 0x1100;
inline constexpr std::uint16_t kLength = 2;

/// The slave's software. It knows the controller through ProcessDataInterface only, so a board can
/// offer the same over SPI.
class EchoStack {
 public:
  explicit EchoStack(ethercat::ProcessDataInterface& controller) : controller_(controller) {}

  /// Takes what the bus brought; call after each frame and when time has passed.
  void process() {
    namespace event = ethercat::al_event;
    const std::uint32_t events = controller_.al_event_request();
    if ((events & event::kAlControl) != 0) {
      answer_state_request(load(0x0120));
    }
    if ((events & event::kProcessDataWatchdog) != 0 && (load(0x0440) & 1U) == 0 && state_ == 8) {
      show(4, 0x001B);
    }
    if ((events & event::sync_manager(0)) != 0 && state_ == 8) {
      std::array<std::byte, kLength> data{};
      controller_.read(kOutputs, data);
      controller_.write(kInputs, data);
    }
  }

 private:
  void answer_state_request(unsigned request) {
    const bool acknowledged = (request & 0x10U) != 0;
    const unsigned target = request & 0x0FU;
    if (failed_ && !acknowledged && target > state_) {
      return;
    }
    const bool up = (state_ == 1 && target == 2) || (state_ == 2 && target == 4) ||
                    (state_ == 4 && target == 8);
    const bool known = target == 1 || target == 2 || target == 4 || target == 8;
    if (!known || (!up && target > state_)) {
      show(state_, known ? 0x0011 : 0x0012);
    } else if (up && target == 4 && !process_data_configured()) {
      show(state_, 0x0017);
    } else {
      show(target, 0);
      if (up && target == 4) {
        controller_.write(kInputs, std::array<std::byte, kLength>{});
      }
    }
  }

  /// Sync managers 0 and 1 are where the EEPROM says, and switched on.
  bool process_data_configured() {
    return load(0x0800) == kOutputs && load(0x0802) == kLength && (load(0x0806) & 1U) != 0 &&
           load(0x0808) == kInputs && load(0x080A) == kLength && (load(0x080E) & 1U) != 0;
  }

  void show(unsigned state, unsigned status_code) {
    state_ = state;
    failed_ = status_code != 0;
    store(0x0134, status_code);
    store(0x0130, state | (failed_ ? 0x10U : 0U));
  }

  unsigned load(std::uint16_t address) {
    std::array<std::byte, 2> word{};
    controller_.read(address, word);
    return base::load_le<std::uint16_t>(word, 0);
  }
  void store(std::uint16_t address, unsigned value) {
    std::array<std::byte, 2> word{};
    base::store_le(word, 0, static_cast<std::uint16_t>(value));
    controller_.write(address, word);
  }

  ethercat::ProcessDataInterface& controller_;
  unsigned state_ = 1;
  bool failed_ = false;
};

/// Appends a category to the EEPROM's content: type, length in words, words (ETG.2010 table 3).
inline void append(std::vector<std::byte>& image, std::uint16_t type,
                   std::initializer_list<std::uint16_t> words) {
  const auto add_word = [&image](std::size_t word) {
    image.push_back(static_cast<std::byte>(word & 0xFF));
    image.push_back(static_cast<std::byte>(word >> 8));
  };
  add_word(type);
  add_word(words.size());
  std::ranges::for_each(words, add_word);
}

/// The EEPROM: host interface SPI, identity, name, and one PDO of 16 bits in each direction.
inline std::vector<std::byte> eeprom() {
  std::vector<std::byte> image(128);
  base::store_le(image, 2 * 0x00, std::uint16_t{0x0005});
  base::store_le(image, 2 * 0x07, std::uint16_t{ethercat::sii_checksum(image)});
  base::store_le(image, 2 * 0x0A, std::uint32_t{1});        // product code
  base::store_le(image, 2 * 0x3E, std::uint32_t{0x10001});  // 2 kbit, version 1
  append(image, 10, {0x0401, 'E' | 'c' << 8, 'h' | 'o' << 8});
  append(image, 30, {0, 0x0100, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});  // name: string 1
  append(image, 40, {0x0201});  // FMMUs: outputs, inputs
  append(image, 41,
         {kOutputs, kLength, 0x0064, 0x0301,   // SM0: three buffers, written, with watchdog
          kInputs, kLength, 0x0020, 0x0401});  // SM1: three buffers, read
  append(image, 50, {0x1A00, 0x0101, 0, 0, 0x6000, 0, 0x1006, 0});  // TxPDO in SM1
  append(image, 51, {0x1600, 0x0001, 0, 0, 0x7000, 0, 0x1006, 0});  // RxPDO in SM0
  image.resize(256, std::byte{0xFF});
  return image;
}

}  // namespace echo
