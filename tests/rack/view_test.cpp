// What can be had of a rack without its journal hearing of it: nothing that can be changed. Most of
// this is said by types, so that a way round the journal does not compile.

#include "stator/rack/core/view.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include <gtest/gtest.h>

#include "rack/rack_bench.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "stator/rack/run/task_queue.hpp"
#include "stator/rack/world/coupling.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;

/// What `rack.*Member(...)` gives cannot be changed by whoever gets it.
template <typename Given>
constexpr bool kOnlyToLookAt =
    !std::is_lvalue_reference_v<Given> || std::is_const_v<std::remove_reference_t<Given>>;

// A Rack's own functions would hide those of its View, so these are asked of a Rack.
static_assert(kOnlyToLookAt<decltype(std::declval<Rack&>().segment(0))>);
static_assert(kOnlyToLookAt<decltype(std::declval<Rack&>().bus(0))>);
static_assert(kOnlyToLookAt<decltype(std::declval<Rack&>().line(0))>);
static_assert(kOnlyToLookAt<decltype(std::declval<Rack&>().device({}))>);
static_assert(kOnlyToLookAt<decltype(std::declval<Rack&>().slave({}))>);
static_assert(kOnlyToLookAt<decltype(std::declval<Rack&>().node({}))>);
static_assert(kOnlyToLookAt<decltype(std::declval<Rack&>().name_of({}))>);
static_assert(kOnlyToLookAt<decltype(std::declval<Rack&>().inputs({}))>);
static_assert(kOnlyToLookAt<decltype(std::declval<Rack&>().signals())>);
static_assert(kOnlyToLookAt<decltype(std::declval<Rack&>().faults({}))>);
static_assert(!kOnlyToLookAt<int&> && kOnlyToLookAt<const int&>, "the question can be answered no");

// And what lies behind them: templates, so that what does not compile is an answer.
template <typename Segment>
concept ChangesSegment = requires(Segment& segment) {
  segment.set_power(std::size_t{0}, false);
}
|| requires(Segment& segment) {
  segment.slave(0).write(0, {});
};
template <typename Bus>
concept ChangesBus = requires(Bus& bus, can::Port& port) {
  bus.add(port);
}
|| requires(Bus& bus) {
  bus.touched(std::size_t{0});
};
template <typename Line>
concept ChangesLine = requires(Line& line) {
  line.connect({});
};
template <typename Device>
concept ChangesDevice = requires(Device& device) {
  device.set_power(false, {});
}
|| requires(Device& device) {
  device.advance({});
};
template <typename Input>
concept SetsInput = requires(Input& input) {
  input.set(0.0);
};
template <typename Watcher>
concept ActsOnRack = requires(Watcher& rack) {
  rack.execute({});
}
|| requires(Watcher& rack) {
  rack.advance({});
};

static_assert(!ChangesSegment<const ethercat::Segment> && ChangesSegment<ethercat::Segment>);
static_assert(!ChangesBus<const CanNetwork> && ChangesBus<CanNetwork>);
static_assert(!ChangesLine<const SerialLine> && ChangesLine<SerialLine>);
static_assert(!ChangesDevice<const product::Device> && ChangesDevice<product::Device>);
static_assert(!SetsInput<product::InputRange> && SetsInput<product::Input>);
static_assert(!ActsOnRack<const View> && !ActsOnRack<View> && ActsOnRack<Rack>);

// Objects of devices are seen as they are, and written by Rack::write_object() alone.
template <typename Objects>
concept WritesObjects = requires(Objects& objects, dictionary::Entry& entry) {
  objects.write(entry, std::span<const std::byte>(), dictionary::AccessContext());
}
|| requires(Objects& objects, dictionary::Entry& entry) {
  objects.write_from_pdo(entry, std::uint64_t{0});
}
|| requires(Objects& objects) {
  objects.reset_values();
};
template <typename Objects>
concept FindsEntriesToSet = requires(Objects& objects) {
  objects.find(0x6040, 0)->set_value(0);
}
|| requires(Objects& objects) {
  (*objects.require(0x6040, 0))->set_value(0);
};
template <typename Objects>
concept ListsEntriesToSet = requires(Objects& objects) {
  objects.entries().front().set_value(0);
}
|| requires(Objects& objects) {
  objects.objects().front().entries.front().set_value(0);
}
|| requires(Objects& objects) {
  objects.find(0x6040)->find(0)->set_value(0);
}
|| requires(Objects& objects) {
  objects.entries_of(*objects.find(0x6040)).front().set_value(0);
};
template <typename Objects>
concept SetsVariables = requires(Objects& objects) {
  objects.template variable<std::uint16_t>(0x6040).set(0);
};
template <typename Objects>
concept ReadsObjects = requires(Objects& objects, std::span<std::byte> value) {
  objects.read(*objects.find(0x6040, 0), value);
  objects.template variable<std::uint16_t>(0x6040).get();
};
template <typename Objects>
constexpr bool kWritable = WritesObjects<Objects> || FindsEntriesToSet<Objects> ||
                           ListsEntriesToSet<Objects> || SetsVariables<Objects>;

using SeenObjects =
    std::remove_pointer_t<decltype(std::declval<Rack&>().device({}).object_dictionary())>;
using SeenObjectsOfSlave =
    std::remove_reference_t<decltype(std::declval<Rack&>().slave({}).dictionary())>;
static_assert(ReadsObjects<SeenObjects> && !kWritable<SeenObjects>);
static_assert(ReadsObjects<SeenObjectsOfSlave> && !kWritable<SeenObjectsOfSlave>);
using Objects = dictionary::Dictionary;
static_assert(ReadsObjects<Objects> && WritesObjects<Objects> && FindsEntriesToSet<Objects> &&
              ListsEntriesToSet<Objects> && SetsVariables<Objects>);
static_assert(!std::is_copy_constructible_v<dictionary::Entry>, "a copy would reach the value");
static_assert(!std::is_constructible_v<dictionary::Variable<int>, dictionary::Variable<const int>>);

// A task that looks gets no rack to act on.
static_assert(
    std::is_same_v<decltype(&Look::look), bool (Look::*)(const View& rack, base::SimTime now)>);

// A signal is read by a function that only looks.
struct Counter {
  double looks() const { return 0.0; }
  double counts() { return ++count; }
  double count = 0.0;
};
template <auto Method>
concept ReadsASignal = requires(Counter& counter) {
  requires std::is_invocable_v<decltype(Method), const Counter&>;
  base::SignalReader::bind<Method>(counter);
};
static_assert(ReadsASignal<&Counter::looks> && !ReadsASignal<&Counter::counts>);

TEST(View, ALookIsDoneWithTheRackAndWakesNobody) {
  class ReadName final : public Look {
   public:
    bool look(const View& rack, base::SimTime /*now*/) override {
      name = rack.name_of(rack.addresses().front());
      return true;
    }
    std::string name;
  };
  EventLog log;
  RackConfiguration configuration = single_device_rack("tmcm-3315", devices::products());
  configuration.segments[0].devices[0].name = "gantry";
  Rack rack(configuration, log);
  TaskQueue queue;
  ReadName task;
  ASSERT_TRUE(queue.post(task));
  EXPECT_FALSE(queue.serve(rack, {}));
  EXPECT_EQ(task.name, "gantry");
}

TEST(View, GivesObjectsToReadAndWhatNamesOneToBeWritten) {
  EventLog log;
  Rack rack(single_device_rack("tmcm-3315", devices::products()), log);
  const View& view = rack;
  const dictionary::Dictionary& objects = *view.device({}).object_dictionary();
  const dictionary::Entry& velocity = *objects.find(0x6081, 0);
  const dictionary::Variable<const std::uint32_t> shown =
      objects.variable<std::uint32_t>(velocity.index());
  const std::array written{std::byte{0x39}, std::byte{0x30}, std::byte{0}, std::byte{0}};
  ASSERT_TRUE(rack.write_object({}, velocity, written, {}));
  EXPECT_EQ(velocity.value(), 12'345U);
  EXPECT_EQ(shown.get(), 12'345U);
  std::array<std::byte, 4> read{};
  ASSERT_TRUE(objects.read(velocity, read));
  EXPECT_EQ(read, written);
}

/// A load that grows with the speed of its shaft.
class Propeller final : public Coupling {
 public:
  void connect(CouplingPoints& points) override {
    speed_ = points.signal({}, "axis0.shaft_speed").read;
    load_.emplace(points.input({}, "axis0.load_torque"));
  }
  [[nodiscard]] base::SimTime next() const override { return next_; }
  void act(base::SimTime instant) override {
    wanted = 0.01 + 0.1 * speed_();
    load_->set(wanted);
    ++acts;
    next_ = instant + 50_us;
  }
  int acts = 0;
  double wanted = 0.0;

 private:
  base::SignalReader speed_;
  std::optional<CoupledInput> load_;
  base::SimTime next_;
};

TEST(Coupling, ActsAtItsMomentsUnlessAFaultHoldsItsInput) {
  EventLog log;
  const RackConfiguration configuration = single_device_rack("tmcm-3315", devices::products());
  Rack rack(configuration, log);
  auto propeller = std::make_unique<Propeller>();
  const Propeller& made = *propeller;
  rack.couple(std::move(propeller));
  rack.advance(base::SimTime(1_ms));
  EXPECT_EQ(made.acts, 21) << "at 0, 50 us ... 1 ms";
  EXPECT_EQ(rack.input_value({{}, "axis0.load_torque"}), made.wanted);
  ASSERT_TRUE(rack.inject(
      parse_fault("kind = 'load-step'\ndevice = 'tmcm-3315'\ntorque = 0.05", configuration),
      base::SimTime(1_ms)));
  rack.advance(base::SimTime(2_ms));
  EXPECT_EQ(rack.input_value({{}, "axis0.load_torque"}), 0.05);
  rack.clear_faults(std::nullopt, base::SimTime(2_ms));
  EXPECT_EQ(rack.input_value({{}, "axis0.load_torque"}), made.wanted);
  EXPECT_NE(made.wanted, 0.05);
}

TEST(Coupling, WhatDevicesHaveNotIsRefused) {
  class Lost final : public Coupling {
   public:
    void connect(CouplingPoints& points) override {
      static_cast<void>(points.signal({}, "axis9.shaft_speed"));
    }
    [[nodiscard]] base::SimTime next() const override { return base::SimTime::never(); }
    void act(base::SimTime /*instant*/) override {}
  };
  EventLog log;
  Rack rack(single_device_rack("tmcm-3315", devices::products()), log);
  EXPECT_THROW(rack.couple(std::make_unique<Lost>()), std::runtime_error);
}

}  // namespace
}  // namespace stator::rack
