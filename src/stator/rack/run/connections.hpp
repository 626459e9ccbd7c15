#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stator/rack/core/rack_configuration.hpp"

namespace stator::rack {

/// How one program reaches a link of a rack.
struct Connection {
  std::string program;        ///< "SOEM", "python-canopen"
  std::string lines{};        ///< ready to paste; empty: it cannot, the explanation says what to do
  std::string explanation{};  ///< a sentence or two
  std::string_view guide;     ///< document below docs/, e.g. "how-to/links.md"
  std::string printed{};      ///< what `stator run` prints of it, whole lines; empty: nothing
};

/// How masters and other programs reach one link of a rack.
struct Connections {
  std::string where;  ///< "Masters send to 127.0.0.1": begins a sentence, without its end
  std::vector<Connection> programs;
};

/// Of a segment's link, which is not in-process: chosen by what the segment contains and what this
/// machine has, an axis to move, objects to list, the other end of a veth pair, and whether root is
/// needed.
[[nodiscard]] Connections connections_of(const SegmentConfiguration& segment);

/// Of a port of a bus, `port` as link::CanLink::name() has it.
[[nodiscard]] Connections connections_of(const BusConfiguration& bus, std::string_view port);

/// Of a serial line, `opened` as link::SerialLink::name() has it.
[[nodiscard]] Connections connections_of(const RackConfiguration& rack,
                                         const SerialLineConfiguration& line,
                                         std::string_view opened);

/// What `stator run` prints of them, as far as the programs are installed here.
[[nodiscard]] std::string printed(const Connections& connections);

}  // namespace stator::rack
