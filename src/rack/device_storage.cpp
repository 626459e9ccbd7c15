#include "rack/device_storage.hpp"

#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "base/byte_order.hpp"
#include "ethercat/sii_image.hpp"

namespace stator::rack {

namespace {

using base::EventArgument;

constexpr const char* kEeprom = "eeprom";
constexpr const char* kFirmware = "firmware";

std::uint16_t alias_of(std::span<const std::byte> sii) {
  return base::load_le<std::uint16_t>(sii, ethercat::sii_word::kStationAlias * 2);
}

}  // namespace

/// One device and its two files.
class DeviceStorage::Member final : public devices::FirmwareKeeper {
 public:
  Member(DeviceStorage& storage, std::size_t position, const std::string& name,
         devices::EtherCatDevice& device, base::EventReporter reporter)
      : storage_(storage),
        position_(position),
        name_(name),
        device_(device),
        reporter_(reporter),
        eeprom_file_(file_name_for(name) + ".eeprom"),
        firmware_file_(file_name_for(name) + ".firmware"),
        eeprom_path_(storage.directory_.path_of(eeprom_file_)),
        firmware_path_(storage.directory_.path_of(firmware_file_)) {}
  ~Member() override {
    if (devices::FirmwareMemory* firmware = device_.firmware()) {
      firmware->set_keeper(nullptr);
    }
  }

  void restore() {
    if (const auto content = read(eeprom_file_, eeprom_path_, kEeprom)) {
      restore_eeprom(*content);
    }
    written_words_ = device_.controller().sii_write_count();
    devices::FirmwareMemory* firmware = device_.firmware();
    if (firmware == nullptr) {
      return;
    }
    if (const auto image = read(firmware_file_, firmware_path_, kFirmware)) {
      if (!firmware->restore(*image)) {
        fail(firmware_path_, fmt::format("it holds {} bytes, {} takes at most {}", image->size(),
                                         product(), firmware->capacity()));
      }
      reporter_.report({}, rules::kFirmwareRestored,
                       {EventArgument(firmware_path_), EventArgument(image->size())});
    }
    firmware->set_keeper(this);
  }

  /// Queues the EEPROM's content when it is time, or at once.
  void service(base::SimTime now, bool at_once) {
    const std::uint32_t words = device_.controller().sii_write_count();
    if (words != written_words_) {
      written_words_ = words;
      due_ = now + kQuietTime;
    }
    if (due_ != base::SimTime::never() && (at_once || now >= due_)) {
      due_ = base::SimTime::never();
      const auto content = device_.controller().sii();
      storage_.writer_.write(
          {eeprom_file_, {kEeprom, product(), {content.begin(), content.end()}}, position_, 0});
    }
  }

  bool keep(std::span<const std::byte> image, std::uint32_t download) override {
    storage_.writer_.write({firmware_file_,
                            {kFirmware, product(), {image.begin(), image.end()}},
                            position_,
                            download});
    return !storage_.confirm_firmware_;
  }

  void handle(const BackgroundWriter::Result& result, base::SimTime now) {
    const bool kept = result.error.empty();
    if (!kept) {
      error_ = result.error;
      reporter_.report(now, rules::kNotWritten, {EventArgument(error_)});
    }
    if (result.kind == kFirmware) {
      device_.firmware()->finish(result.version, kept);
    } else if (!kept) {
      due_ = std::min(due_, now + kRetryTime);
    }
  }

 private:
  [[nodiscard]] const std::string& product() const { return device_.description().order_code; }

  [[noreturn]] void fail(const std::string& path, const std::string& reason) const {
    throw std::runtime_error(
        fmt::format("{}: device \"{}\" cannot start from this file: {}. Delete it to start without "
                    "it, restore a copy, or name another state directory",
                    path, name_, reason));
  }

  /// The content of one file; empty if there is none.
  [[nodiscard]] std::optional<std::vector<std::byte>> read(const std::string& file,
                                                           const std::string& path,
                                                           std::string_view kind) const {
    const auto bytes = storage_.directory_.read(file);
    if (!bytes) {
      return std::nullopt;
    }
    KeptFile kept;
    try {
      kept = decode(*bytes);
    } catch (const std::runtime_error& error) {
      fail(path, error.what());
    }
    if (kept.kind != kind || kept.product != product()) {
      fail(path, fmt::format("it belongs to the {} of a {}, the device is a {}", kept.kind,
                             kept.product, product()));
    }
    return std::move(kept.content);
  }

  void restore_eeprom(std::span<const std::byte> content) {
    const std::size_t size = device_.controller().sii().size();
    if (content.size() != size) {
      fail(eeprom_path_, fmt::format("it holds {} bytes, the EEPROM of a {} has {}", content.size(),
                                     product(), size));
    }
    device_.controller().load_sii(content);
    reporter_.report({}, rules::kEepromRestored, {EventArgument(eeprom_path_)});
    const std::uint16_t configured = device_.description().station_alias;
    if (configured != 0 && configured != alias_of(content)) {
      reporter_.report({}, rules::kAliasOverruled,
                       {EventArgument(eeprom_path_), int{configured}, int{alias_of(content)}});
    }
  }

  DeviceStorage& storage_;
  std::size_t position_;
  std::string name_;
  devices::EtherCatDevice& device_;
  base::EventReporter reporter_;
  std::string eeprom_file_;
  std::string firmware_file_;
  std::string eeprom_path_;  ///< events refer to it
  std::string firmware_path_;
  std::string error_;
  std::uint32_t written_words_ = 0;
  base::SimTime due_ = base::SimTime::never();  ///< when the EEPROM file is to be written
};

DeviceStorage::DeviceStorage(const std::string& directory)
    : directory_(directory), writer_(directory_) {}

DeviceStorage::~DeviceStorage() {
  flush(now_);
}

void DeviceStorage::attach(const std::string& name, devices::EtherCatDevice& device,
                           base::EventReporter reporter) {
  auto member = std::make_unique<Member>(*this, members_.size(), name, device, reporter);
  member->restore();
  members_.push_back(std::move(member));
}

void DeviceStorage::service(base::SimTime now) {
  now_ = now;
  for (const auto& member : members_) {
    member->service(now, false);
  }
  handle_results(now);
}

void DeviceStorage::flush(base::SimTime now) {
  now_ = now;
  for (const auto& member : members_) {
    member->service(now, true);
  }
  writer_.wait();
  handle_results(now);
}

void DeviceStorage::handle_results(base::SimTime now) {
  for (const BackgroundWriter::Result& result : writer_.take_results()) {
    members_[result.owner]->handle(result, now);
  }
}

}  // namespace stator::rack
