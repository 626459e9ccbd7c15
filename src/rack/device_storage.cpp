#include "rack/device_storage.hpp"

#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "base/byte_order.hpp"
#include "ethercat/sii_image.hpp"
#include "rack/parameter_memory.hpp"

namespace stator::rack {

namespace {

using base::EventArgument;

constexpr const char* kEeprom = "eeprom";
constexpr const char* kFirmware = "firmware";
constexpr const char* kParameters = "parameters";

std::uint16_t alias_of(std::span<const std::byte> sii) {
  return base::load_le<std::uint16_t>(sii, ethercat::sii_word::kStationAlias * 2);
}

}  // namespace

/// Something of one device that is kept in files.
class DeviceStorage::Member {
 public:
  Member(DeviceStorage& storage, std::string name, std::string product,
         base::EventReporter reporter)
      : storage_(storage),
        position_(storage.members_.size()),
        name_(std::move(name)),
        product_(std::move(product)),
        reporter_(reporter) {}
  Member(const Member&) = delete;
  Member& operator=(const Member&) = delete;
  virtual ~Member() = default;

  /// Queues what has changed when it is time, or at once.
  virtual void service(base::SimTime /*now*/, bool /*at_once*/) {}
  virtual void finish(const BackgroundWriter::Result& result, base::SimTime now) = 0;

  void handle(const BackgroundWriter::Result& result, base::SimTime now) {
    error_ = result.error;
    if (!error_.empty()) {
      reporter_.report(now, rules::kNotWritten, {EventArgument(error_)});
    }
    finish(result, now);
  }
  /// What went wrong when its file was last written; empty: nothing.
  [[nodiscard]] const std::string& error() const { return error_; }

 protected:
  [[nodiscard]] std::string file_of(std::string_view kind) const {
    return fmt::format("{}.{}", file_name_for(name_), kind);
  }
  [[nodiscard]] std::string path_of(std::string_view kind) const {
    return storage_.directory_.path_of(file_of(kind));
  }

  /// Hands content to the background thread.
  void write(const char* kind, std::span<const std::byte> content, std::uint32_t version) {
    storage_.writer_.write(
        {file_of(kind), {kind, product_, {content.begin(), content.end()}}, position_, version});
  }

  [[noreturn]] void fail(const std::string& path, const std::string& reason) const {
    throw std::runtime_error(fmt::format(
        "{}: device \"{}\" cannot start from this file: {}. Delete it to start without "
        "it, or move it to {}.damaged to keep it aside; restore a copy, or name another "
        "state directory",
        path, name_, reason, path));
  }

  /// The content of one file; empty if there is none.
  [[nodiscard]] std::optional<std::vector<std::byte>> read(std::string_view kind) const {
    const auto bytes = storage_.directory_.read(file_of(kind));
    if (!bytes) {
      return std::nullopt;
    }
    KeptFile kept;
    try {
      kept = decode(*bytes);
    } catch (const std::runtime_error& error) {
      fail(path_of(kind), error.what());
    }
    if (kept.kind != kind || kept.product != product_) {
      fail(path_of(kind), fmt::format("it belongs to the {} of a {}, the device is a {}", kept.kind,
                                      kept.product, product_));
    }
    return std::move(kept.content);
  }

  [[nodiscard]] bool confirms_writes() const { return storage_.confirm_writes_; }
  [[nodiscard]] const std::string& product() const { return product_; }
  [[nodiscard]] const base::EventReporter& reporter() const { return reporter_; }

 private:
  DeviceStorage& storage_;
  std::size_t position_;
  std::string name_;
  std::string product_;
  base::EventReporter reporter_;
  std::string error_;
};

/// A device of any kind and the firmware image in its flash memory, if it takes one.
class DeviceStorage::DeviceMember : public Member, public devices::FirmwareKeeper {
 public:
  DeviceMember(DeviceStorage& storage, const std::string& name, const std::string& product,
               devices::Device& device, base::EventReporter reporter)
      : Member(storage, name, product, reporter),
        device_(device),
        firmware_path_(path_of(kFirmware)) {}
  ~DeviceMember() override {
    if (devices::FirmwareMemory* firmware = device_.firmware()) {
      firmware->set_keeper(nullptr);
    }
  }

  void restore_firmware() {
    devices::FirmwareMemory* firmware = device_.firmware();
    if (firmware == nullptr) {
      return;
    }
    if (const auto image = read(kFirmware)) {
      if (!firmware->restore(*image)) {
        fail(firmware_path_, fmt::format("it holds {} bytes, {} takes at most {}", image->size(),
                                         product(), firmware->capacity()));
      }
      reporter().report({}, rules::kFirmwareRestored,
                        {EventArgument(firmware_path_), EventArgument(image->size())});
    }
    firmware->set_keeper(this);
  }

  bool keep(std::span<const std::byte> image, std::uint32_t download) override {
    write(kFirmware, image, download);
    return !confirms_writes();
  }

  void finish(const BackgroundWriter::Result& result, base::SimTime /*now*/) override {
    if (result.kind == kFirmware) {
      device_.firmware()->finish(result.version, result.error.empty());
    }
  }

 private:
  devices::Device& device_;
  std::string firmware_path_;  ///< events refer to it
};

/// An EtherCAT device, which has an EEPROM too.
class DeviceStorage::EtherCatMember final : public DeviceMember {
 public:
  EtherCatMember(DeviceStorage& storage, const std::string& name, devices::EtherCatDevice& device,
                 base::EventReporter reporter)
      : DeviceMember(storage, name, device.description().order_code, device, reporter),
        device_(device),
        eeprom_path_(path_of(kEeprom)) {}

  void restore_eeprom() {
    if (const auto content = read(kEeprom)) {
      load_eeprom(*content);
    }
    written_words_ = device_.controller().sii_write_count();
  }

  void service(base::SimTime now, bool at_once) override {
    const std::uint32_t words = device_.controller().sii_write_count();
    if (words != written_words_) {
      written_words_ = words;
      due_ = now + kQuietTime;
    }
    if (due_ != base::SimTime::never() && (at_once || now >= due_)) {
      due_ = base::SimTime::never();
      write(kEeprom, device_.controller().sii(), 0);
    }
  }

  void finish(const BackgroundWriter::Result& result, base::SimTime now) override {
    DeviceMember::finish(result, now);
    if (result.kind == kEeprom && !result.error.empty()) {
      due_ = std::min(due_, now + kRetryTime);
    }
  }

 private:
  void load_eeprom(std::span<const std::byte> content) {
    const std::size_t size = device_.controller().sii().size();
    if (content.size() != size) {
      fail(eeprom_path_, fmt::format("it holds {} bytes, the EEPROM of a {} has {}", content.size(),
                                     product(), size));
    }
    // Said first, since loading it may have something to tell of the content.
    reporter().report({}, rules::kEepromRestored, {EventArgument(eeprom_path_)});
    device_.controller().load_sii(content);
    const std::uint16_t configured = device_.description().station_alias;
    if (configured != 0 && configured != alias_of(content)) {
      reporter().report({}, rules::kAliasOverruled,
                        {EventArgument(eeprom_path_), int{configured}, int{alias_of(content)}});
    }
  }

  devices::EtherCatDevice& device_;
  std::string eeprom_path_;  ///< events refer to it
  std::uint32_t written_words_ = 0;
  base::SimTime due_ = base::SimTime::never();  ///< when the EEPROM file is to be written
};

/// The parameters that a CANopen device stores.
class DeviceStorage::ParameterMember final : public Member, public ParameterKeeper {
 public:
  ParameterMember(DeviceStorage& storage, const std::string& name, const std::string& product,
                  base::EventReporter reporter)
      : Member(storage, name, product, reporter), path_(path_of(kParameters)), memory_(*this) {}

  void restore() {
    if (const auto content = read(kParameters)) {
      if (!memory_.restore(*content)) {
        fail(path_, "its parameter groups are cut off");
      }
      reporter().report({}, rules::kParametersRestored, {EventArgument(path_)});
    }
  }

  [[nodiscard]] canopen::NonVolatileMemory& memory() { return memory_; }

  bool keep_parameters(std::vector<std::byte> content, std::uint32_t version) override {
    write(kParameters, content, version);
    return !confirms_writes();
  }

  void finish(const BackgroundWriter::Result& result, base::SimTime /*now*/) override {
    memory_.finish(result.version, result.error.empty());
  }

 private:
  std::string path_;  ///< events refer to it
  ParameterMemory memory_;
};

DeviceStorage::DeviceStorage(const std::string& directory, StateDirectory::Use use)
    : use_(use), directory_(directory, use), writer_(directory_) {}

DeviceStorage::~DeviceStorage() {
  if (use_ == StateDirectory::Use::own) {
    flush(now_);
  }
}

void DeviceStorage::attach(const std::string& name, devices::EtherCatDevice& device,
                           base::EventReporter reporter) {
  if (device.stores_parameters()) {
    attach_parameters(name, device.description().order_code, device, reporter);
  }
  auto member = std::make_unique<EtherCatMember>(*this, name, device, reporter);
  member->restore_eeprom();
  member->restore_firmware();
  members_.push_back(std::move(member));
}

void DeviceStorage::attach(const std::string& name, const std::string& product,
                           devices::CanDevice& device, base::EventReporter reporter) {
  attach_parameters(name, product, device, reporter);
  auto member = std::make_unique<DeviceMember>(*this, name, product, device, reporter);
  member->restore_firmware();
  members_.push_back(std::move(member));
}

void DeviceStorage::attach_parameters(const std::string& name, const std::string& product,
                                      devices::Device& device, base::EventReporter reporter) {
  auto parameters = std::make_unique<ParameterMember>(*this, name, product, reporter);
  parameters->restore();
  device.connect_memory(parameters->memory());
  members_.push_back(std::move(parameters));
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

std::vector<std::string> DeviceStorage::unkept() const {
  std::vector<std::string> errors;
  for (const auto& member : members_) {
    if (!member->error().empty()) {
      errors.push_back(member->error());
    }
  }
  return errors;
}

void DeviceStorage::handle_results(base::SimTime now) {
  for (const BackgroundWriter::Result& result : writer_.take_results()) {
    members_[result.owner]->handle(result, now);
  }
}

}  // namespace stator::rack
