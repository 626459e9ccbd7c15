// How masters reach the link of a segment: what each of them has to be told, ready to paste.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/wiring.hpp"
#include "stator/rack/run/connections.hpp"

namespace stator::rack {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kClientsGuide = "how-to/clients.md";
constexpr std::string_view kLinksGuide = "how-to/links.md";
constexpr std::string_view kFirstDriveGuide = "tutorials/first-drive.md";

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

std::string sudo() {
  return ::geteuid() == 0 ? "" : "sudo ";
}

bool has_axis(const DeviceConfiguration& device) {
  return !product::Setup(device.setup).axes().empty();
}

/// " --position N" of the first device with an axis, where it is not the first; nothing if there is
/// none: a slave controller chip has an I/O block and no CiA 402, a junction nothing at all.
std::optional<std::string> position_of_axis(const SegmentConfiguration& segment) {
  const std::vector<std::size_t> order = frame_order(segment);
  const auto found = std::ranges::find_if(
      order, [&segment](std::size_t device) { return has_axis(segment.devices[device]); });
  if (found == order.end()) {
    return std::nullopt;
  }
  const auto position = found - order.begin();
  return position == 0 ? "" : fmt::format(" --position {}", position);
}

/// Some device has objects that slaveinfo can list.
bool has_objects(const SegmentConfiguration& segment) {
  return std::ranges::any_of(segment.devices, [](const DeviceConfiguration& device) {
    return device.setup.product().has_objects(device.setup);
  });
}

Connection stator_itself(const SegmentConfiguration& segment, const std::string& rights,
                         const std::string& link) {
  Connection stator{.program = "stator",
                    .lines = fmt::format("{}stator scan --link {}", rights, link),
                    .explanation = "The small master inside Stator lists the slaves.",
                    .guide = kFirstDriveGuide};
  stator.printed = fmt::format("  {}\n", stator.lines);
  if (const auto position = position_of_axis(segment)) {
    const std::string move =
        fmt::format("{}stator move --link {}{} --revolutions 10", rights, link, *position);
    stator.lines += "\n" + move;
    stator.printed += fmt::format("  {}\n", move);
    stator.explanation = "The small master inside Stator lists the slaves, then turns an axis.";
  }
  return stator;
}

/// Masters that send datagrams: ours; those that open interfaces cannot.
Connections udp_connections(const SegmentConfiguration& segment) {
  link::LinkAddress there = segment.link;
  std::string where;
  if (there.name == "0.0.0.0") {
    there.name = "127.0.0.1";
    where = "Masters on this machine send to 127.0.0.1, others to an address of this machine";
  } else {
    where = fmt::format("Masters send to {}", there.name);
  }
  return {std::move(where),
          {stator_itself(segment, "", to_text(there)),
           {.program = "SOEM, pysoem, IgH, ethercrab, TwinCAT",
            .lines = fmt::format("{0}ip link add drive type veth peer name master\n"
                                 "{0}ip link set drive up\n"
                                 "{0}ip link set master up\n"
                                 "{0}stator run RACK.toml --link ethercat:drive",
                                 sudo()),
            .explanation =
                "They open a network interface and cannot speak over UDP. Run this rack on one "
                "instead, here on a veth pair, whose other end \"master\" they open; for TwinCAT, "
                "on a network card with a cable to its machine.",
            .guide = kLinksGuide}}};
}

Connection soem(const SegmentConfiguration& segment, const std::string& there) {
  const std::string info =
      fmt::format("{}slaveinfo {}{} -map", sudo(), there, has_objects(segment) ? " -sdo" : "");
  const std::string sample = fmt::format("{}ec_sample {} 1000", sudo(), there);
  return {.program = "SOEM",
          .lines = info + "\n" + sample,
          .explanation =
              "SOEM's own samples: slaveinfo lists slaves, objects and mapping; "
              "ec_sample, of SOEM 2, exchanges process data every 1000 us.",
          .guide = kFirstDriveGuide,
          .printed = fmt::format("  {}            # SOEM\n  {}                 # SOEM 2, process "
                                 "data every 1000 us\n",
                                 info, sample)};
}

Connection pysoem(const std::string& there) {
  Connection pysoem{.program = "pysoem",
                    .lines = fmt::format("{}python3 -c \"import pysoem; m = pysoem.Master(); "
                                         "m.open('{}'); print(m.config_init())\"",
                                         sudo(), there),
                    .explanation = "SOEM for Python prints how many slaves it has found.",
                    .guide = kClientsGuide};
  pysoem.printed = fmt::format("  {}   # pysoem\n", pysoem.lines);
  return pysoem;
}

/// The line that `run` prints names the file where a distribution keeps it; loading the modules by
/// hand is the same everywhere, and takes the address that the file would need.
Connection igh(const std::string& there) {
  return {.program = "IgH EtherCAT master",
          .lines = fmt::format("sudo modprobe ec_master main_devices=$(cat "
                               "/sys/class/net/{}/address)\n"
                               "sudo modprobe ec_generic\n"
                               "sudo ethercat slaves",
                               there),
          .explanation = fmt::format(
              "Its kernel modules take the interface by its MAC address; to have it at each start, "
              "MASTER0_DEVICE in ethercat.conf is that address and DEVICE_MODULES \"generic\". {} "
              "must be up.",
              there),
          .guide = kLinksGuide,
          .printed = installed("ethercat")
                         ? fmt::format("  MASTER0_DEVICE={} in ethercat.conf, then: ethercat "
                                       "slaves   # IgH\n",
                                       there)
                         : ""};
}

Connection ethercrab(const std::string& there) {
  return {.program = "ethercrab",
          .lines = fmt::format(
              R"(// cargo add ethercrab smol
use ethercrab::std::{{ethercat_now, tx_rx_task}};
use ethercrab::{{MainDevice, MainDeviceConfig, PduStorage, Timeouts}};

static STORAGE: PduStorage<16, {{ PduStorage::element_size(1100) }}> = PduStorage::new();

fn main() {{
    let (tx, rx, pdu_loop) = STORAGE.try_split().unwrap();
    let main_device = MainDevice::new(pdu_loop, Timeouts::default(), MainDeviceConfig::default());
    let task = tx_rx_task("{}", tx, rx).unwrap();
    smol::block_on(async {{
        smol::spawn(async move {{ task.await.map(|_| ()) }}).detach();
        let group = main_device.init_single_group::<16, 512>(ethercat_now).await.unwrap();
        for device in group.iter(&main_device) {{
            println!("{{}}", device.name());
        }}
    }});
}})",
              there),
          .explanation =
              "A program in Rust that names the slaves; as root, or with CAP_NET_RAW "
              "given to what cargo built.",
          .guide = kClientsGuide};
}

Connection twincat(const SegmentConfiguration& segment, bool cable) {
  std::vector<std::string> types;
  for (const DeviceConfiguration& device : segment.devices) {
    const std::string& type = device.setup.product().identity().type;
    if (std::ranges::find(types, type) == types.end()) {
      types.push_back(type);
    }
  }
  std::string lines;
  for (const std::string& type : types) {
    lines += fmt::format("{1}stator export esi {0} -o {0}.xml", type, lines.empty() ? "" : "\n");
  }
  return {.program = "TwinCAT",
          .lines = std::move(lines),
          .explanation = fmt::format(
              "{}Copy these files into C:\\TwinCAT\\3.1\\Config\\Io\\EtherCAT, restart TwinCAT in "
              "Config mode, then right-click on I/O > Devices and scan.",
              cable ? ""
                    : "It runs on a Windows machine, to which this interface has no cable: "
                      "give the segment a network card that has. "),
          .guide = kLinksGuide};
}

Connection tshark(const std::string& there) {
  Connection tshark{.program = "Wireshark",
                    .lines = fmt::format("{}tshark -i {} -Y ecat", sudo(), there),
                    .explanation =
                        "Shows the frames as they pass, decoded; wireshark does the "
                        "same in a window.",
                    .guide = kLinksGuide};
  if (installed("tshark")) {
    tshark.printed = fmt::format("  {}                 # watch the frames\n", tshark.lines);
  }
  return tshark;
}

}  // namespace

Connections connections_of(const SegmentConfiguration& segment) {
  const link::LinkAddress& link = segment.link;
  if (link.kind == link::LinkKind::udp) {
    return udp_connections(segment);
  }
  const std::string& interface = link.name;
  const std::optional<std::string> peer = veth_peer(interface);
  Connections connections;
  std::string there = "INTERFACE";
  if (link.kind == link::LinkKind::tap) {
    there = interface;
    connections.where = fmt::format("Masters on this machine use the interface {}", there);
  } else if (peer) {
    there = *peer;
    connections.where = fmt::format("{} is one end of a veth pair; on this machine masters use {}",
                                    interface, there);
  } else {
    connections.where = fmt::format(
        "Masters use the interface at the other end of the cable on {} (here: INTERFACE)",
        interface);
  }
  const bool cable = link.kind == link::LinkKind::raw_ethernet && !peer;
  connections.programs = {stator_itself(segment, sudo(), "ethercat:" + there),
                          soem(segment, there),
                          igh(there),
                          pysoem(there),
                          ethercrab(there),
                          twincat(segment, cable),
                          tshark(there)};
  return connections;
}

}  // namespace stator::rack
