#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/rack/kept/background_writer.hpp"
#include "stator/rack/kept/kept_file.hpp"
#include "stator/rack/kept/kept_memory.hpp"
#include "stator/rack/kept/storage_completion.hpp"

namespace stator::product {
class CanDevice;
class Device;
class EtherCatDevice;
}  // namespace stator::product

namespace stator::rack {

/// Keeps what real devices keep without power in files of a state directory: EEPROM content in
/// NAME.eeprom, a firmware image in NAME.firmware, stored parameters in NAME.parameters, serial
/// EEPROMs on a board in NAME.PART.memory.
///
/// What a device says is kept is on the disk: files are written in a background thread, so that
/// neither a frame nor firmware waits, and the device is busy until its order has been carried out
/// or has failed. The end of an order is a completion, which whoever owns the devices hands to them
/// (Rack does, and tells its journal).
///
/// Not thread-safe but for busy(): called by who owns the devices.
class DeviceStorage {
 public:
  static constexpr base::SimDuration kRetryTime{5'000'000'000};  ///< after a failure

  /// When completions come.
  enum class Completions : std::uint8_t {
    before_time_moves,  ///< with a clock of its own: what is ordered ends before the next instant,
                        ///< so that nothing depends on the speed of a disk
    when_durable,       ///< with the machine's clock: with the first look after that
    recorded,           ///< when and as a recording says
    at_once,            ///< with the order: recordings made before format 2 have none
  };

  /// Throws std::runtime_error as StateDirectory does.
  explicit DeviceStorage(const std::string& directory,
                         StateDirectory::Use use = StateDirectory::Use::own);
  /// Writes what has been ordered, unless the directory was only to be looked at.
  ~DeviceStorage();
  DeviceStorage(const DeviceStorage&) = delete;
  DeviceStorage& operator=(const DeviceStorage&) = delete;

  /// Gives the device what is kept under `name` and keeps its changes from now on. The device must
  /// outlive the storage. Throws std::runtime_error with file, reason and remedy for a file that is
  /// damaged or belongs to another product.
  void attach(const std::string& name, product::EtherCatDevice& device,
              base::EventReporter reporter);
  void attach(const std::string& name, const std::string& product, product::CanDevice& device,
              base::EventReporter reporter);
  /// One more memory to keep.
  void add(std::unique_ptr<KeptMemory> memory);

  /// Initially before_time_moves.
  void set_completions(Completions completions) { completions_ = completions; }
  [[nodiscard]] Completions completions() const { return completions_; }

  /// Orders are under way; any thread may ask.
  [[nodiscard]] bool busy() const { return busy_.load(std::memory_order_acquire); }
  /// Orders that were given so far.
  [[nodiscard]] std::uint64_t orders() const { return orders_; }

  /// The completions that have come and no device has heard of; failures are reported as of `now`.
  [[nodiscard]] std::vector<StorageCompletion> take_completions(base::SimTime now);
  /// The same once all orders have been carried out, or have failed.
  [[nodiscard]] std::vector<StorageCompletion> wait_for_completions(base::SimTime now);
  /// Tells a device of the end of its order. False: there is no such memory.
  [[nodiscard]] bool has(std::size_t memory) const { return memory < memories_.size(); }
  bool complete(const StorageCompletion& completion, base::SimTime now);

  /// Retries from time to time to write contents that devices take for kept but that could not be
  /// written. `now` is the machine's time, as the real clock has it: in lockstep simulated time may
  /// stand still.
  void service(base::SimTime now);
  /// Waits until all that was ordered is on the disk or has failed, and tries once more what had
  /// failed. Devices hear nothing of it.
  void flush(base::SimTime now);
  /// For each file that does not hold what its device takes for kept, the reason.
  [[nodiscard]] std::vector<std::string> unkept() const;

 private:
  friend class KeptMemory;
  class EepromMemory;
  class FirmwareImage;
  class StoredParameters;

  void attach_firmware(const std::string& name, const std::string& product, product::Device& device,
                       base::EventReporter reporter);
  void attach_parameters(const std::string& name, const std::string& product,
                         product::Device& device, base::EventReporter reporter);
  void note_order();
  void take_results(base::SimTime now);
  void try_again(KeptMemory& memory);

  StateDirectory::Use use_;
  StateDirectory directory_;
  Completions completions_ = Completions::before_time_moves;
  std::uint64_t orders_ = 0;
  base::SimTime now_;  ///< of the last look
  std::atomic<bool> busy_{false};
  std::vector<std::unique_ptr<KeptMemory>> memories_;
  BackgroundWriter writer_;
};

// Arguments: {0} path, then what the rule adds.
namespace rules {
inline constexpr base::EventRule kEepromRestored{
    "storage-eeprom-restored", base::Severity::information,
    "EEPROM content taken from {0}; delete the file to start from the product's own"};
inline constexpr base::EventRule kAliasOverruled{
    "storage-alias-overruled", base::Severity::warning,
    "alias {1} of the rack file has no effect: the EEPROM content in {0} has alias {2}; delete "
    "that file, or write the alias over the bus"};
inline constexpr base::EventRule kFirmwareRestored{"storage-firmware-restored",
                                                   base::Severity::information,
                                                   "firmware image of {1} bytes taken from {0}"};
inline constexpr base::EventRule kParametersRestored{
    "storage-parameters-restored", base::Severity::information,
    "stored parameters taken from {0}; delete the file to start with the defaults"};
inline constexpr base::EventRule kNotWritten{"storage-not-written", base::Severity::fault, "{0}"};
}  // namespace rules

}  // namespace stator::rack
