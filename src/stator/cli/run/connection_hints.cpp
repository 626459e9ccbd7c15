#include "stator/cli/run/connection_hints.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/wiring.hpp"

namespace stator::cli {

namespace {

namespace fs = std::filesystem;

std::optional<int> read_number(const fs::path& path) {
  std::ifstream file(path);
  int number = 0;
  if (file >> number) {
    return number;
  }
  return std::nullopt;
}

/// The interface at the other end when `interface` is one of a veth pair in this network namespace.
std::optional<std::string> veth_peer(const std::string& interface) {
  const fs::path net = "/sys/class/net";
  const auto own = read_number(net / interface / "ifindex");
  const auto peer = read_number(net / interface / "iflink");
  if (!own || !peer || *own == *peer) {
    return std::nullopt;
  }
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(net, error)) {
    if (read_number(entry.path() / "ifindex") == peer &&
        read_number(entry.path() / "iflink") == own) {
      return entry.path().filename().string();
    }
  }
  return std::nullopt;
}

bool installed(std::string_view program) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): no thread of a run changes the environment
  const char* path = std::getenv("PATH");
  std::istringstream directories(path == nullptr ? "" : path);
  for (std::string directory; std::getline(directories, directory, ':');) {
    if (::access((fs::path(directory) / program).c_str(), X_OK) == 0) {
      return true;
    }
  }
  return false;
}

bool has_axis(const rack::DeviceConfiguration& device) {
  return !product::Setup(device.setup).axes().empty();
}

/// " --position N" of the first device with an axis, where it is not the first; nothing if there is
/// none: a slave controller chip has an I/O block and no CiA 402, a junction nothing at all.
std::optional<std::string> position_of_axis(const rack::SegmentConfiguration& segment) {
  const std::vector<std::size_t> order = rack::frame_order(segment);
  const auto found = std::ranges::find_if(
      order, [&segment](std::size_t device) { return has_axis(segment.devices[device]); });
  if (found == order.end()) {
    return std::nullopt;
  }
  const auto position = found - order.begin();
  return position == 0 ? "" : fmt::format(" --position {}", position);
}

/// Some device has objects that slaveinfo can list.
bool has_objects(const rack::SegmentConfiguration& segment) {
  return std::ranges::any_of(segment.devices, [](const rack::DeviceConfiguration& device) {
    return device.setup.product().has_objects(device.setup);
  });
}

std::string stator_hints(const rack::SegmentConfiguration& segment, const std::string& sudo,
                         const std::string& link) {
  std::string text = fmt::format("  {}stator scan --link {}\n", sudo, link);
  if (const auto position = position_of_axis(segment)) {
    text += fmt::format("  {}stator move --link {}{} --revolutions 10\n", sudo, link, *position);
  }
  return text;
}

/// Masters that send datagrams: ours; those that open interfaces cannot.
std::string udp_hints(const rack::SegmentConfiguration& segment) {
  const link::LinkAddress& link = segment.link;
  link::LinkAddress there = link;
  std::string text;
  if (link.name == "0.0.0.0") {
    there.name = "127.0.0.1";
    text = "Masters on this machine send to 127.0.0.1, others to an address of this machine:\n";
  } else {
    text = fmt::format("Masters send to {}:\n", link.name);
  }
  return text + stator_hints(segment, "", link::to_text(there));
}

}  // namespace

std::string connection_hints(const rack::SegmentConfiguration& segment) {
  const link::LinkAddress& link = segment.link;
  if (link.kind == link::LinkKind::udp) {
    return udp_hints(segment);
  }
  const std::string& interface = link.name;
  const std::optional<std::string> peer = veth_peer(interface);
  const std::string sudo = ::geteuid() == 0 ? "" : "sudo ";
  std::string text;
  std::string there;
  if (link.kind == link::LinkKind::tap) {
    there = interface;
    text = fmt::format("Masters on this machine use the interface {}:\n", there);
  } else if (peer) {
    there = *peer;
    text = fmt::format("{} is one end of a veth pair; on this machine masters use {}:\n", interface,
                       there);
  } else {
    there = "INTERFACE";
    text = fmt::format(
        "Masters use the interface at the other end of the cable on {} (here: INTERFACE):\n",
        interface);
  }
  text += stator_hints(segment, sudo, "ethercat:" + there);
  text += fmt::format("  {}slaveinfo {}{} -map            # SOEM\n", sudo, there,
                      has_objects(segment) ? " -sdo" : "");
  text += fmt::format(
      "  {}ec_sample {} 1000                 # SOEM 2, process data every 1000 us\n", sudo, there);
  if (installed("ethercat")) {
    text +=
        fmt::format("  MASTER0_DEVICE={} in ethercat.conf, then: ethercat slaves   # IgH\n", there);
  }
  text += fmt::format(
      "  {}python3 -c \"import pysoem; m = pysoem.Master(); m.open('{}'); "
      "print(m.config_init())\"   # pysoem\n",
      sudo, there);
  if (installed("tshark")) {
    text +=
        fmt::format("  {}tshark -i {} -Y ecat                 # watch the frames\n", sudo, there);
  }
  return text;
}

}  // namespace stator::cli
