#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"

namespace stator::rack {

class DeviceStorage;

/// One memory of a device whose content outlives the process: a file of the state directory.
///
/// What the device orders to be kept is durable, or has failed, some time later; the device hears
/// of it by finish() and is busy until then.
class KeptMemory {
 public:
  /// What it is called in messages and in the file, and where.
  struct Identity {
    std::string kind;       ///< "eeprom": the file's extension and what its first line says
    std::string name;       ///< of the device
    std::string product;    ///< the file belongs to one of these only
    std::string file = {};  ///< without extension; empty: as `name`
  };

  /// `storage` must outlive it; DeviceStorage::add() takes it over.
  KeptMemory(DeviceStorage& storage, Identity identity, base::EventReporter reporter);
  KeptMemory(const KeptMemory&) = delete;
  KeptMemory& operator=(const KeptMemory&) = delete;
  virtual ~KeptMemory() = default;

  /// What has become of the order with number `version`, and with it of all before.
  virtual void finish(std::uint32_t version, bool kept, base::SimTime now) = 0;
  /// What the device takes for kept now.
  [[nodiscard]] virtual std::vector<std::byte> content() const = 0;

 protected:
  /// The content of the file; nothing: there is none. Throws std::runtime_error with file, reason
  /// and remedy for one that is damaged or belongs to something else.
  [[nodiscard]] std::optional<std::vector<std::byte>> read() const;
  /// The device cannot take what is in the file.
  [[noreturn]] void fail(const std::string& reason) const;

  /// Orders that the file is to hold `content`. True: it counts as kept from now on, and the file
  /// follows (see DeviceStorage::Completions::at_once). False: finish() will be called with
  /// `version`, which must be greater than that of the order before.
  [[nodiscard]] bool order(std::span<const std::byte> content, std::uint32_t version);

  [[nodiscard]] const std::string& product() const { return identity_.product; }
  [[nodiscard]] const base::EventReporter& reporter() const { return reporter_; }
  /// Of the file.
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  friend class DeviceStorage;

  void write(std::span<const std::byte> content, std::uint32_t version);

  DeviceStorage& storage_;
  Identity identity_;
  base::EventReporter reporter_;
  std::string file_;
  std::string path_;

  // Written by DeviceStorage, which keeps account of the orders here.
  std::size_t number_ = 0;
  std::uint32_t ordered_ = 0;   ///< the newest order
  std::uint32_t finished_ = 0;  ///< the newest order of whose end the device knows
  std::uint32_t written_ = 0;   ///< the newest order of whose end the disk has told
  bool kept_ = true;            ///< that end
  std::string error_;           ///< why the file does not hold what the device takes for kept
  base::SimTime retry_ = base::SimTime::never();
};

}  // namespace stator::rack
