#include "stator/replay/event_coding.hpp"

#include <type_traits>
#include <variant>

namespace stator::replay {

namespace {

using rack::CableEvent;
using rack::ErrorStateEvent;
using rack::FrameFaultEvent;
using rack::InputEvent;
using rack::PowerEvent;
using rack::SegmentFaultEvent;

/// Reads and writes the members of an event in the same order, so that both are written once:
/// `coder(member)` does either.
template <typename Coder>
void members(Coder& coder, CableEvent& event) {
  coder(event.device);
  coder(event.port);
  coder(event.intact);
}
template <typename Coder>
void members(Coder& coder, PowerEvent& event) {
  coder(event.device);
  coder(event.on);
}
template <typename Coder>
void members(Coder& coder, InputEvent& event) {
  coder(event.device);
  coder(event.input);
  coder(event.value);
  coder(event.logged);
}
template <typename Coder>
void members(Coder& coder, ErrorStateEvent& event) {
  coder(event.device);
  coder(event.state);
}
template <typename Coder>
void members(Coder& coder, FrameFaultEvent& event) {
  coder(event.bus);
  coder(event.device);
  coder(event.fault.kind);
  coder(event.fault.frames);
  coder(event.fault.identifier);
  coder(event.fault.delay);
}
template <typename Coder>
void members(Coder& coder, SegmentFaultEvent& event) {
  coder(event.segment);
  coder(event.fault.kind);
  coder(event.fault.port.slave);
  coder(event.fault.port.port);
  coder(event.fault.leaving);
  coder(event.fault.frames);
}

/// A flag in the number of an event: further members follow. The first recordings did not have
/// these; they are written only if one of them differs from its default.
constexpr std::uint64_t kHasFurther = 0x20;

template <typename Coder, typename Event>
void further_members(Coder& /*coder*/, Event& /*event*/) {}
template <typename Coder>
void further_members(Coder& coder, FrameFaultEvent& event) {
  coder(event.fault.probability);
  coder(event.fault.seed);
}
template <typename Coder>
void further_members(Coder& coder, SegmentFaultEvent& event) {
  coder(event.fault.delay);
  coder(event.fault.probability);
  coder(event.fault.seed);
}

template <typename Event>
bool has_further(const Event& /*event*/) {
  return false;
}
bool has_further(const FrameFaultEvent& event) {
  const can::FrameFault other;
  return event.fault.probability != other.probability || event.fault.seed != other.seed;
}
bool has_further(const SegmentFaultEvent& event) {
  const ethercat::FrameFault other;
  return event.fault.delay != other.delay || event.fault.probability != other.probability ||
         event.fault.seed != other.seed;
}

struct Writing {
  ByteWriter& writer;

  template <typename T>
  void operator()(const T& value) {
    if constexpr (std::is_same_v<T, rack::DeviceAddress>) {
      write_device(writer, value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      writer.text(value);
    } else if constexpr (std::is_same_v<T, base::SimDuration>) {
      writer.signed_number(value.nanoseconds());
    } else if constexpr (std::is_floating_point_v<T>) {
      writer.real(value);
    } else if constexpr (requires { value.has_value(); }) {
      writer.byte(value.has_value() ? 1 : 0);
      if (value) {
        (*this)(*value);
      }
    } else {
      writer.number(static_cast<std::uint64_t>(value));
    }
  }
};

struct Reading {
  ByteReader& reader;

  template <typename T>
  void operator()(T& value) {
    if constexpr (std::is_same_v<T, rack::DeviceAddress>) {
      value = read_device(reader);
    } else if constexpr (std::is_same_v<T, std::string>) {
      value = reader.text();
    } else if constexpr (std::is_same_v<T, base::SimDuration>) {
      value = base::SimDuration(reader.signed_number());
    } else if constexpr (std::is_floating_point_v<T>) {
      value = reader.real();
    } else if constexpr (requires { value.has_value(); }) {
      value.reset();
      if (reader.byte() != 0) {
        (*this)(value.emplace());
      }
    } else {
      value = static_cast<T>(reader.number());
    }
  }
};

template <std::size_t Index = 0>
std::optional<rack::RackEvent> read_alternative(ByteReader& reader, std::uint64_t number) {
  if constexpr (Index < std::variant_size_v<rack::RackEvent>) {
    if ((number & ~kHasFurther) != Index) {
      return read_alternative<Index + 1>(reader, number);
    }
    std::variant_alternative_t<Index, rack::RackEvent> event{};
    Reading reading{reader};
    members(reading, event);
    if ((number & kHasFurther) != 0) {
      further_members(reading, event);
    }
    return reader.good() ? std::optional<rack::RackEvent>(event) : std::nullopt;
  } else {
    return std::nullopt;
  }
}

}  // namespace

void write_device(ByteWriter& writer, rack::DeviceAddress device) {
  writer.byte(static_cast<unsigned>(device.kind));
  writer.number(device.network);
  writer.number(device.device);
}

rack::DeviceAddress read_device(ByteReader& reader) {
  rack::DeviceAddress device;
  device.kind = static_cast<rack::NetworkKind>(reader.byte());
  device.network = static_cast<std::size_t>(reader.number());
  device.device = static_cast<std::size_t>(reader.number());
  return device;
}

void write_event(ByteWriter& writer, const rack::RackEvent& event) {
  std::visit(
      [&writer, number = std::uint64_t{event.index()}](auto copy) {
        const bool further = has_further(copy);
        writer.number(number | (further ? kHasFurther : 0));
        Writing writing{writer};
        members(writing, copy);
        if (further) {
          further_members(writing, copy);
        }
      },
      event);
}

std::optional<rack::RackEvent> read_event(ByteReader& reader) {
  return read_alternative(reader, reader.number());
}

}  // namespace stator::replay
