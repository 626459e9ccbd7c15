#include "own_device.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "errors.hpp"
#include "session.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/canopen/eds/eds.hpp"
#include "stator/dictionary/content.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/product/shell/canopen_firmware.hpp"
#include "stator/product/shell/coe_keys.hpp"
#include "stator/product/shell/ethercat_firmware.hpp"
#include "stator/product/shell/quirk_keys.hpp"
#include "stator/settings/key.hpp"
#include "stator/settings/section.hpp"
#include "values.hpp"
#include "words.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

using Word = settings::Word;
template <typename T>
constexpr Word word(std::string_view name, T value) {
  return {name, static_cast<std::int64_t>(value)};
}

using dictionary::Access;
using dictionary::DataType;
using dictionary::PdoMapping;

constexpr std::array kTypes{word("boolean", DataType::boolean),
                            word("integer8", DataType::integer8),
                            word("integer16", DataType::integer16),
                            word("integer32", DataType::integer32),
                            word("integer64", DataType::integer64),
                            word("unsigned8", DataType::unsigned8),
                            word("unsigned16", DataType::unsigned16),
                            word("unsigned32", DataType::unsigned32),
                            word("unsigned64", DataType::unsigned64),
                            word("real32", DataType::real32),
                            word("real64", DataType::real64),
                            word("visible-string", DataType::visible_string),
                            word("octet-string", DataType::octet_string),
                            word("domain", DataType::domain)};
constexpr std::array kAccesses{word("rw", Access::read_write), word("ro", Access::read_only),
                               word("wo", Access::write_only), word("const", Access::constant)};
constexpr std::array kMappings{word("no", PdoMapping::no), word("receive", PdoMapping::receive),
                               word("transmit", PdoMapping::transmit),
                               word("both", PdoMapping::both)};

constexpr base::EventRule kFailed{
    "own-device-failed", base::Severity::fault,
    "the device's function {0}() ended with {1}; none of its functions is called any more"};
constexpr base::EventRule kRefused{"own-device-refused", base::Severity::refusal,
                                   "write to {0:x4}:{1:x2} \"{2}\" refused by the device: {3}"};

/// What a class of Python says of its devices. Constant: devices refer to it.
struct Outline {
  std::string type;
  std::string name;
  product::NetworkKind network = product::NetworkKind::segment;
  std::uint32_t vendor = 0;
  std::uint32_t code = 0;
  std::uint32_t revision = 1;
  std::uint32_t bit_rate = 1'000'000;
  base::SimDuration period{1'000'000};
  std::deque<std::string> texts;  ///< that declarations refer to
  std::vector<dictionary::EntryDeclaration> objects;
  // Which of its functions the class has made its own; others need not be called.
  bool starts = false;
  bool checks = false;
  bool writes = false;
  bool reads = false;
};

/// What a rack file can say of one.
struct Configuration {
  product::CoeOptions coe{};
  dictionary::Quirks quirks{};
  std::uint8_t node_id = 1;
};

constexpr std::array kSegmentRows{
    settings::keys<product::kCoeKeys, &Configuration::coe>(),
    settings::keys<product::kCoeQuirkKeys, &Configuration::quirks>(),
};
constexpr settings::Section<Configuration> kSegmentKeys{kSegmentRows};
constexpr std::array kBusRows{
    settings::whole<&Configuration::node_id>("node_id", {1, 127}, "Of the device on its bus"),
};
constexpr settings::Section<Configuration> kBusKeys{kBusRows};

std::string text_attribute(nb::handle object, const char* name) {
  return nb::cast<std::string>(object.attr(name));
}

/// The bits that an entry of that type keeps for what an SDO carries.
std::uint64_t bits_of(DataType type, std::span<const std::byte> bytes) {
  const dictionary::Content content = dictionary::decode(type, bytes);
  if (const auto* number = std::get_if<std::int64_t>(&content)) {
    return static_cast<std::uint64_t>(*number);
  }
  std::array<std::byte, sizeof(std::uint64_t)> all{};
  std::ranges::copy(bytes.first(std::min(bytes.size(), all.size())), all.begin());
  return base::load_le<std::uint64_t>(all.data());
}

/// The reverse: numbers as an SDO carries them.
std::vector<std::byte> bytes_of(DataType type, std::uint64_t bits) {
  std::array<std::byte, sizeof(std::uint64_t)> all{};
  base::store_le(all.data(), bits);
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(dictionary::byte_length(type))};
}

/// What a traceback says of the exception.
std::string last_line(std::string_view text) {
  while (text.ends_with('\n')) {
    text.remove_suffix(1);
  }
  return std::string(text.substr(text.rfind('\n') + 1));
}

class OutlineReader {
 public:
  explicit OutlineReader(nb::handle factory) : factory_(factory) {}

  Outline read() {
    outline_.type = text_attribute(factory_, "type");
    outline_.name = text_attribute(factory_, "name");
    if (outline_.type.empty()) {
      throw std::runtime_error(
          "a class of devices has no type; give it one, e.g. type = \"probe\"");
    }
    if (outline_.name.empty()) {
      outline_.name = outline_.type;
    }
    outline_.network = text_attribute(factory_, "network") == "bus" ? product::NetworkKind::bus
                                                                    : product::NetworkKind::segment;
    outline_.vendor = nb::cast<std::uint32_t>(factory_.attr("vendor"));
    outline_.code = nb::cast<std::uint32_t>(factory_.attr("code"));
    outline_.revision = nb::cast<std::uint32_t>(factory_.attr("revision"));
    if (outline_.network == product::NetworkKind::bus) {
      outline_.bit_rate = nb::cast<std::uint32_t>(factory_.attr("bit_rate"));
    }
    outline_.period = duration_of(nb::cast<double>(factory_.attr("period")), "period");
    if (outline_.period <= base::SimDuration()) {
      throw std::runtime_error(
          fmt::format("{}: the period must be longer than 0 s", outline_.type));
    }
    outline_.starts = own("start");
    outline_.checks = own("check");
    outline_.writes = own("written");
    outline_.reads = own("read");
    for (const nb::handle each : factory_.attr("objects")) {
      outline_.objects.push_back(declaration_of(each));
    }
    return std::move(outline_);
  }

 private:
  /// The class has a function of that name which is not the one that all have.
  [[nodiscard]] bool own(const char* function) const {
    const nb::object base = nb::module_::import_("stator._devices").attr("OwnDevice");
    return !factory_.attr(function).is(base.attr(function));
  }
  std::string_view kept(std::string text) { return outline_.texts.emplace_back(std::move(text)); }

  dictionary::EntryDeclaration declaration_of(nb::handle object) {
    dictionary::EntryDeclaration declaration;
    declaration.index = nb::cast<std::uint16_t>(object.attr("index"));
    declaration.subindex = nb::cast<std::uint8_t>(object.attr("subindex"));
    declaration.name = kept(text_attribute(object, "name"));
    declaration.object_name = kept(text_attribute(object, "object_name"));
    if (!declaration.object_name.empty() || declaration.subindex != 0) {
      declaration.object_code = dictionary::ObjectCode::record;
    }
    declaration.unit = kept(text_attribute(object, "unit"));
    declaration.type =
        static_cast<DataType>(number_of(kTypes, text_attribute(object, "type"), "type"));
    declaration.access =
        static_cast<Access>(number_of(kAccesses, text_attribute(object, "access"), "access"));
    declaration.mapping =
        static_cast<PdoMapping>(number_of(kMappings, text_attribute(object, "pdo"), "mapping"));
    read_values(object, declaration);
    return declaration;
  }

  /// Default and limits.
  void read_values(nb::handle object, dictionary::EntryDeclaration& declaration) {
    const nb::object initial = object.attr("default");
    if (dictionary::is_string(declaration.type)) {
      const std::vector<std::byte> bytes = bytes_of_default(initial, declaration);
      declaration.default_value.text =
          kept({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
      return;
    }
    declaration.default_value.number = number_of_default(initial, declaration);
    const nb::object minimum = object.attr("minimum");
    const nb::object maximum = object.attr("maximum");
    if (minimum.is_none() != maximum.is_none()) {
      throw std::runtime_error(
          fmt::format("{:04X}h:{:02X} \"{}\": a minimum goes with a maximum; give both or none",
                      declaration.index, declaration.subindex, declaration.name));
    }
    if (!minimum.is_none()) {
      declaration.range = dictionary::Range{number_of_default(minimum, declaration),
                                            number_of_default(maximum, declaration)};
    }
  }

  static std::vector<std::byte> bytes_of_default(nb::handle value,
                                                 const dictionary::EntryDeclaration& declaration) {
    return to_bytes(declaration.type, value,
                    fmt::format("{:04X}h:{:02X} \"{}\"", declaration.index, declaration.subindex,
                                declaration.name));
  }
  static dictionary::Number number_of_default(nb::handle value,
                                              const dictionary::EntryDeclaration& declaration) {
    return bits_of(declaration.type, bytes_of_default(value, declaration));
  }

  nb::handle factory_;
  Outline outline_;
};

class Behaviour;

/// What an instance of Python reaches its device by; empty once that is gone.
struct DeviceLink {
  Behaviour* behaviour = nullptr;
};

/// The side of a device that calls functions of Python: its instance.
class Behaviour {
 public:
  Behaviour(std::shared_ptr<const Outline> outline, const std::function<nb::object()>& make,
            std::shared_ptr<DeviceFailure> failure)
      : outline_(std::move(outline)), failure_(std::move(failure)) {
    const nb::gil_scoped_acquire interpreter;
    link_->behaviour = this;
    instance_ = make();
    instance_.attr("_device") = nb::cast(link_);
  }
  Behaviour(const Behaviour&) = delete;
  Behaviour& operator=(const Behaviour&) = delete;
  virtual ~Behaviour() {
    const nb::gil_scoped_acquire interpreter;
    link_->behaviour = nullptr;
    instance_.reset();
  }

  [[nodiscard]] nb::object instance() const { return instance_; }

  // What functions of Python may do while they are called.

  nb::object value(std::uint16_t index, std::uint8_t subindex) {
    const dictionary::Entry& entry = entry_of(index, subindex);
    if (dictionary::is_string(entry.type())) {
      return to_python(entry.type(), entry.bytes());
    }
    return to_python(entry.type(), bytes_of(entry.type(), entry.value()));
  }
  void set_value(std::uint16_t index, std::uint8_t subindex, nb::handle value) {
    dictionary::Entry& entry = entry_of(index, subindex);
    set(entry, to_bytes(entry, value));
  }
  void emergency(std::uint16_t code, std::uint8_t error_register, const nb::bytes& data) {
    require_called();
    const std::vector<std::byte> bytes = to_vector(data);
    std::array<std::uint8_t, 5> additional{};
    if (bytes.size() > additional.size()) {
      throw std::runtime_error(
          fmt::format("an emergency carries {} bytes of the manufacturer, not "
                      "{}",
                      additional.size(), bytes.size()));
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      additional[i] = std::to_integer<std::uint8_t>(bytes[i]);
    }
    send(code, error_register, additional, now_);
  }
  [[nodiscard]] std::string state() const {
    require_called();
    return std::string(network_state_text());
  }

 protected:
  [[nodiscard]] const Outline& outline() const { return *outline_; }
  [[nodiscard]] virtual dictionary::Dictionary& own_objects() = 0;
  [[nodiscard]] virtual const base::EventReporter& own_reporter() const = 0;
  [[nodiscard]] virtual std::string_view network_state_text() const = 0;
  virtual void send(std::uint16_t code, std::uint8_t error_register,
                    const std::array<std::uint8_t, 5>& additional, base::SimTime now) = 0;

  /// Has entries call the functions that the class has. To be called once the objects are there.
  void connect() {
    dictionary::Dictionary& objects = own_objects();
    for (const dictionary::EntryDeclaration& each : outline_->objects) {
      if (outline_->checks) {
        objects.on_check(each.index, each.subindex,
                         dictionary::Entry::CheckHook::bind<&Behaviour::check>(*this));
      }
      if (outline_->writes) {
        objects.on_written(each.index, each.subindex,
                           dictionary::Entry::WrittenHook::bind<&Behaviour::written>(*this));
      }
      if (outline_->reads) {
        objects.on_read(each.index, each.subindex,
                        dictionary::Entry::ReadHook::bind<&Behaviour::read>(*this));
      }
    }
  }
  void start(base::SimTime now) {
    now_ = now;
    if (outline_->starts) {
      call("start", [this] { instance_.attr("start")(); });
    }
  }
  void step(base::SimTime now) {
    now_ = now;
    call("step", [this, now] { instance_.attr("step")(now.seconds()); });
  }

 private:
  dictionary::Verdict check(const dictionary::Entry& entry, std::uint64_t bits) {
    dictionary::Verdict verdict;
    call("check", [&] {
      try {
        instance_.attr("check")(entry.index(), entry.subindex(),
                                to_python(entry.type(), bytes_of(entry.type(), bits)));
      } catch (nb::python_error& error) {
        const nb::object refused = nb::module_::import_("stator._errors").attr("ObjectRefused");
        if (!error.matches(refused)) {
          throw;
        }
        verdict = dictionary::refuse(
            static_cast<dictionary::AbortCode>(
                nb::cast<std::uint32_t>(error.value().attr("abort_code"))),
            kRefused,
            {base::EventArgument(entry.index()), base::EventArgument(entry.subindex()),
             base::EventArgument(entry.shared_name()),
             base::EventArgument(base::SharedText(nb::cast<std::string>(nb::str(error.value()))))});
      }
    });
    return verdict;
  }
  void written(const dictionary::Entry& entry) {
    call("written", [&] {
      instance_.attr("written")(entry.index(), entry.subindex(),
                                value(entry.index(), entry.subindex()));
    });
  }
  void read(dictionary::Entry& entry) {
    call("read", [&] {
      const nb::object value = instance_.attr("read")(entry.index(), entry.subindex());
      if (!value.is_none()) {
        set(entry, to_bytes(entry, value));
      }
    });
  }

  static void set(dictionary::Entry& entry, std::span<const std::byte> bytes) {
    if (dictionary::is_string(entry.type())) {
      entry.set_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    } else {
      entry.set_value(bits_of(entry.type(), bytes));
    }
  }

  /// Does `work`, which calls `function` of the instance, with the interpreter's lock. What that
  /// throws is kept, and afterwards nothing is called any more.
  template <typename Work>
  void call(const char* function, Work&& work) {
    const nb::gil_scoped_acquire interpreter;
    if (failed_) {
      return;
    }
    const std::thread::id outer = std::exchange(caller_, std::this_thread::get_id());
    try {
      work();
    } catch (const std::exception& error) {
      failed_ = true;
      failure_->keep();
      own_reporter().report(now_, kFailed,
                            {base::EventArgument(base::SharedText(function)),
                             base::EventArgument(base::SharedText(last_line(error.what())))});
    }
    caller_ = outer;
  }

  void require_called() const {
    if (caller_ != std::this_thread::get_id()) {
      throw std::runtime_error(
          "objects of a device of one's own are reached this way by its own functions while they "
          "are called; elsewhere they are those of rack[NAME].objects");
    }
  }
  dictionary::Entry& entry_of(std::uint16_t index, std::uint8_t subindex) {
    require_called();
    const auto entry = own_objects().require(index, subindex);
    if (!entry) {
      throw refusal(entry.error());
    }
    return **entry;
  }

  std::shared_ptr<const Outline> outline_;
  std::shared_ptr<DeviceFailure> failure_;
  std::shared_ptr<DeviceLink> link_ = std::make_shared<DeviceLink>();
  nb::object instance_;
  base::SimTime now_;
  std::thread::id caller_;  ///< which is in a function of the instance
  bool failed_ = false;
};

using Make = std::function<nb::object()>;

class SegmentDevice final : public product::EtherCatFirmware, public Behaviour {
 public:
  SegmentDevice(const std::shared_ptr<const Outline>& outline, const Configuration& configuration,
                const Make& make, std::shared_ptr<DeviceFailure> failure,
                base::EventReporter reporter)
      : EtherCatFirmware({.vendor = outline->vendor,
                          .code = outline->code,
                          .revision = outline->revision,
                          .name = outline->name,
                          .objects = outline->objects,
                          .period = outline->period,
                          .coe = configuration.coe,
                          .quirks = configuration.quirks},
                         reporter),
        Behaviour(outline, make, std::move(failure)) {
    connect();
    start(base::SimTime());
  }

 private:
  void restart(base::SimTime now) override { start(now); }
  void tick(base::SimTime now) override { step(now); }
  dictionary::Dictionary& own_objects() override { return objects(); }
  [[nodiscard]] const base::EventReporter& own_reporter() const override { return reporter(); }
  [[nodiscard]] std::string_view network_state_text() const override {
    return network_status().state;
  }
  void send(std::uint16_t code, std::uint8_t error_register,
            const std::array<std::uint8_t, 5>& additional, base::SimTime now) override {
    send_emergency(code, error_register, additional, now);
  }
};

class BusDevice final : public product::CanOpenFirmware, public Behaviour {
 public:
  BusDevice(const std::shared_ptr<const Outline>& outline, const Configuration& configuration,
            const Make& make, std::shared_ptr<DeviceFailure> failure, base::EventReporter reporter)
      : CanOpenFirmware({.node_id = configuration.node_id,
                         .vendor = outline->vendor,
                         .code = outline->code,
                         .revision = outline->revision,
                         .name = outline->name,
                         .objects = outline->objects,
                         .period = outline->period,
                         .bit_rate = outline->bit_rate},
                        reporter),
        Behaviour(outline, make, std::move(failure)) {
    connect();
    start(base::SimTime());
    const std::array<std::int64_t, 1> bit_rates{outline->bit_rate / 1000};
    eds_ = canopen::eds_text(objects(), {.file_name = outline->type + ".eds",
                                         .title = outline->name,
                                         .date = "01-01-2026",
                                         .product_name = outline->name,
                                         .order_code = outline->name,
                                         .bit_rates = bit_rates});
  }
  [[nodiscard]] std::string_view eds() const override { return eds_; }

 private:
  void load_application(base::SimTime now) override { start(now); }
  void tick(base::SimTime now) override { step(now); }
  dictionary::Dictionary& own_objects() override { return objects(); }
  [[nodiscard]] const base::EventReporter& own_reporter() const override { return reporter(); }
  [[nodiscard]] std::string_view network_state_text() const override {
    return network_status().state;
  }
  /// Code 0000h says that all errors are gone.
  void send(std::uint16_t code, std::uint8_t error_register,
            const std::array<std::uint8_t, 5>& additional, base::SimTime now) override {
    if (code == 0) {
      emergency_producer().forget();
      emergency_producer().report_reset(now);
    } else {
      emergency_producer().raise(
          {.code = code, .error_register = error_register, .information = additional}, now);
    }
  }

  std::string eds_;
};

/// A product of which devices are made by a function of Python.
class OwnProduct final : public product::Product {
 public:
  OwnProduct(std::shared_ptr<const Outline> outline, nb::object factory,
             std::shared_ptr<DeviceFailure> failure)
      : outline_(std::move(outline)), factory_(std::move(factory)), failure_(std::move(failure)) {
    constexpr unsigned kPorts = 2;
    identity_ = {.type = outline_->type,
                 .summary = "a device in Python",
                 .network = outline_->network,
                 .ports = on_bus() ? 0 : kPorts};
  }
  OwnProduct(const OwnProduct&) = delete;
  OwnProduct& operator=(const OwnProduct&) = delete;
  ~OwnProduct() override {
    const nb::gil_scoped_acquire interpreter;
    factory_.reset();
  }

  [[nodiscard]] const product::Identity& identity() const override { return identity_; }
  [[nodiscard]] product::Setup defaults() const override {
    return {shared_from_this(), Configuration{}};
  }
  void read_keys(settings::Reader& reader, product::Setup& setup) const override {
    settings::read_keys(on_bus() ? kBusKeys : kSegmentKeys, reader, setup.as<Configuration>());
  }
  [[nodiscard]] std::unique_ptr<product::Device> make(const product::Setup& setup,
                                                      base::EventReporter reporter) const override {
    const auto& configuration = setup.as<Configuration>();
    const Make make = [this] { return factory_(); };
    try {
      if (on_bus()) {
        return std::make_unique<BusDevice>(outline_, configuration, make, failure_, reporter);
      }
      return std::make_unique<SegmentDevice>(outline_, configuration, make, failure_, reporter);
    } catch (const std::logic_error& error) {
      // Of declarations, which here are the user's.
      throw std::runtime_error(fmt::format("{}: {}", outline_->type, error.what()));
    }
  }
  [[nodiscard]] const product::CoeOptions* coe(const product::Setup& setup) const override {
    return on_bus() ? nullptr : &setup.as<Configuration>().coe;
  }
  [[nodiscard]] const dictionary::Quirks* quirks(const product::Setup& setup) const override {
    return on_bus() ? nullptr : &setup.as<Configuration>().quirks;
  }
  [[nodiscard]] const std::uint8_t* node_id(const product::Setup& setup) const override {
    return on_bus() ? &setup.as<Configuration>().node_id : nullptr;
  }

 private:
  [[nodiscard]] bool on_bus() const { return outline_->network == product::NetworkKind::bus; }

  std::shared_ptr<const Outline> outline_;
  nb::object factory_;
  std::shared_ptr<DeviceFailure> failure_;
  product::Identity identity_;
};

Behaviour& behaviour_of(const DeviceLink& link) {
  if (link.behaviour == nullptr) {
    throw std::runtime_error("the device is gone with its rack");
  }
  return *link.behaviour;
}

}  // namespace

void DeviceFailure::keep() {
  const std::scoped_lock lock(mutex_);
  if (!exception_) {
    exception_ = std::current_exception();
    kept_ = true;
  }
}

void DeviceFailure::raise() {
  if (!kept_.load(std::memory_order_relaxed)) {
    return;
  }
  std::exception_ptr exception;
  {
    const std::scoped_lock lock(mutex_);
    exception = std::exchange(exception_, nullptr);
    kept_ = false;
  }
  if (exception) {
    std::rethrow_exception(exception);
  }
}

void add_own_products(product::Catalogue& catalogue, nb::handle factories,
                      const std::shared_ptr<DeviceFailure>& failure) {
  for (const nb::handle each : factories) {
    auto outline = std::make_shared<const Outline>(OutlineReader(each).read());
    catalogue.add(std::make_shared<OwnProduct>(std::move(outline), nb::borrow(each), failure));
  }
}

nb::object instance_of(const product::Device& device) {
  const auto* const behaviour = dynamic_cast<const Behaviour*>(&device);
  return behaviour != nullptr ? behaviour->instance() : nb::none();
}

void bind_own_devices(nb::module_& module) {
  nb::class_<DeviceLink>(module, "DeviceLink", "What an instance reaches its device by.")
      .def(
          "value",
          [](const DeviceLink& self, std::uint16_t index, std::uint8_t subindex) {
            return behaviour_of(self).value(index, subindex);
          },
          "index"_a, "subindex"_a = 0,
          nb::sig("def value(self, index: int, subindex: int = 0) -> bool | int | float | str | "
                  "bytes"),
          "The value of an object.")
      .def(
          "set_value",
          [](const DeviceLink& self, std::uint16_t index, std::uint8_t subindex, nb::handle value) {
            behaviour_of(self).set_value(index, subindex, value);
          },
          "index"_a, "subindex"_a, "value"_a, "Sets it, without any check.")
      .def(
          "emergency",
          [](const DeviceLink& self, std::uint16_t code, std::uint8_t error_register,
             const nb::bytes& data) { behaviour_of(self).emergency(code, error_register, data); },
          "code"_a, "error_register"_a, "data"_a, "Sends an emergency.")
      .def_prop_ro(
          "state", [](const DeviceLink& self) { return behaviour_of(self).state(); },
          "Of the network, in the standard's words.");
}

}  // namespace stator::python
