#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/event.hpp"
#include "base/sim_time.hpp"
#include "canopen/non_volatile_memory.hpp"
#include "devices/can_device.hpp"
#include "devices/ethercat_device.hpp"
#include "rack/background_writer.hpp"
#include "rack/kept_file.hpp"

namespace stator::rack {

/// Keeps what real devices keep without power in files of a state directory: EEPROM content in
/// NAME.eeprom, a firmware image in NAME.firmware, stored parameters in NAME.parameters.
///
/// Files are written in a background thread, so neither a frame nor firmware waits for the disk.
/// A master writes an EEPROM word by word, hence its file follows when no word has come for
/// kQuietTime: it holds the content before a series of writes or after it. A firmware image counts
/// as stored, and the master gets its last acknowledge, when it is on the disk (confirm_writes);
/// stored parameters and the answer to the master's "save" likewise.
///
/// Not thread-safe: called by who owns the devices.
class DeviceStorage {
 public:
  static constexpr base::SimDuration kQuietTime{100'000'000};
  static constexpr base::SimDuration kRetryTime{5'000'000'000};  ///< after a failure

  /// Throws std::runtime_error as StateDirectory does.
  explicit DeviceStorage(const std::string& directory,
                         StateDirectory::Use use = StateDirectory::Use::own);
  /// Writes what has changed, unless the directory was only to be looked at.
  ~DeviceStorage();
  DeviceStorage(const DeviceStorage&) = delete;
  DeviceStorage& operator=(const DeviceStorage&) = delete;

  /// Gives the device what is kept under `name` and keeps its changes from now on. The device must
  /// outlive the storage. Throws std::runtime_error with file, reason and remedy for a file that is
  /// damaged or belongs to another product.
  void attach(const std::string& name, devices::EtherCatDevice& device,
              base::EventReporter reporter);
  void attach(const std::string& name, const std::string& product, devices::CanDevice& device,
              base::EventReporter reporter);

  /// True: firmware downloads and orders to store parameters end when they are on the disk;
  /// service() must then be called regularly. False (initially): they end at once and the file
  /// follows, so that what a master sees does not depend on the speed of a disk.
  void confirm_writes(bool confirm) { confirm_writes_ = confirm; }

  /// Looks for changes and for what has been written; cheap. `now` is the machine's time, as the
  /// real clock has it: in lockstep simulated time may stand still.
  void service(base::SimTime now);

  /// Waits until all that service() and downloads have handed to the background thread is written.
  void wait() { writer_.wait(); }
  /// Writes what has changed and waits until it is on the disk.
  void flush(base::SimTime now);
  /// Why, for each file that is not what its device takes for kept.
  [[nodiscard]] std::vector<std::string> unkept() const;

 private:
  class Member;
  class DeviceMember;
  class EtherCatMember;
  class ParameterMember;

  void attach_parameters(const std::string& name, const std::string& product,
                         devices::Device& device, base::EventReporter reporter);
  void handle_results(base::SimTime now);

  StateDirectory::Use use_;
  StateDirectory directory_;
  bool confirm_writes_ = false;
  base::SimTime now_;
  std::vector<std::unique_ptr<Member>> members_;
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
