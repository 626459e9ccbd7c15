#include "stator/link/can_exec/interface_files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <linux/if.h>
#include <linux/if_arp.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stator/link/can_exec/bus_interface.hpp"

namespace stator::link::can_exec {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kClass = "/sys/class/net";
constexpr std::string_view kDevices = "/proc/net/dev";
constexpr std::string_view kOwnDevices = "/proc/self/net/dev";
/// The file in a folder that holds the value of kBusesVariable for which the folder was made.
constexpr const char* kBusesFile = "buses";
/// Names in the folder of what stands for kClass and kDevices.
constexpr const char* kNet = "net";
constexpr const char* kDev = "dev";

/// True while this library itself opens files: these calls must not be redirected.
thread_local bool reads_itself = false;

struct ReadsItself {
  ReadsItself() { reads_itself = true; }
  ~ReadsItself() { reads_itself = false; }
  ReadsItself(const ReadsItself&) = delete;
  ReadsItself& operator=(const ReadsItself&) = delete;
};

std::string read_all(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Where the files are that this library writes.
class Folder {
 public:
  explicit Folder(fs::path path) : path_(std::move(path)) {}

  [[nodiscard]] const fs::path& path() const { return path_; }

  /// Other programs find the file as it was or as it is.
  void write(const fs::path& name, const std::string& text) const {
    static std::uint64_t number = 0;
    std::error_code ignored;
    if (fs::exists(path_ / name, ignored) && read_all(path_ / name) == text) {
      return;
    }
    const fs::path temporary =
        path_ / ("new-" + std::to_string(::getpid()) + "-" + std::to_string(number++));
    std::ofstream(temporary) << text;
    fs::create_directories((path_ / name).parent_path(), ignored);
    fs::rename(temporary, path_ / name, ignored);
  }

 private:
  fs::path path_;
};

/// The user's folder for all its programs; empty if somebody else has it.
fs::path own_directory() {
  const std::string path = directory() + ".interfaces";
  struct stat status {};
  if (::mkdir(path.c_str(), S_IRWXU) != 0 && errno != EEXIST) {
    return {};
  }
  const bool own = ::lstat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode) &&
                   status.st_uid == ::getuid() && (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
  return own ? fs::path(path) : fs::path();
}

/// Removes what was made for buses that have all ended.
void clean(const fs::path& directory) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(directory, ignored)) {
    const std::string of = read_all(entry.path() / kBusesFile);
    bool alive = false;
    for (std::size_t begin = 0; begin < of.size() && !alive;) {
      const std::size_t end = std::min(of.find(':', begin), of.size());
      const std::size_t equals = of.find('=', begin);
      alive = equals < end && fs::exists(of.substr(equals + 1, end - equals - 1), ignored);
      begin = end + 1;
    }
    if (!alive) {
      fs::remove_all(entry.path(), ignored);
    }
  }
}

/// The folder for this set of buses in this network namespace, made if it is missing; nothing if it
/// cannot be made.
std::optional<Folder> open_folder() {
  const fs::path parent = own_directory();
  if (parent.empty()) {
    return std::nullopt;
  }
  struct stat network {};
  ::stat("/proc/self/ns/net", &network);
  const char* const variable = std::getenv(kBusesVariable);  // NOLINT(concurrency-mt-unsafe)
  const std::string of = variable == nullptr ? "" : variable;
  const Folder folder(parent / (std::to_string(std::hash<std::string>()(of)) + "-" +
                                std::to_string(network.st_ino)));
  std::error_code error;
  if (!fs::exists(folder.path() / kBusesFile, error)) {
    clean(parent);
    fs::create_directories(folder.path(), error);
    folder.write(kBusesFile, of);
  }
  return error ? std::nullopt : std::optional(folder);
}

std::string hexadecimal(unsigned value) {
  char text[16];
  static_cast<void>(std::snprintf(text, sizeof text, "0x%x", value));
  return text;
}

/// What Linux shows of an interface in /sys/class/net.
void write_interface(const Folder& folder, const Bus& bus) {
  const InterfaceState state = ask(bus);
  const fs::path path = fs::path(kNet) / bus.name;
  // The flags that are told by other files are left out.
  const unsigned flags = interface_flags(state) & ~unsigned{IFF_RUNNING | IFF_LOWER_UP};
  const std::string index = std::to_string(bus.index);
  const std::string up = state.up ? "1" : "0";
  const std::pair<const char*, std::string> files[]{
      {"addr_assign_type", "0"},
      {"addr_len", "0"},
      {"address", ""},
      {"broadcast", ""},
      {"carrier", up},
      {"dev_id", "0x0"},
      {"dev_port", "0"},
      {"dormant", "0"},
      {"flags", hexadecimal(flags)},
      {"ifalias", ""},
      {"ifindex", index},
      {"iflink", index},
      {"link_mode", "0"},
      {"mtu", std::to_string(CAN_MTU)},
      {"operstate", state.up ? "up" : "down"},
      {"tx_queue_len", std::to_string(kTransmitQueue)},
      {"type", std::to_string(ARPHRD_CAN)},
      {"uevent", "INTERFACE=" + bus.name + "\nIFINDEX=" + index},
      {"statistics/rx_bytes", std::to_string(state.port.bytes_received)},
      {"statistics/rx_dropped", std::to_string(state.port.frames_dropped)},
      {"statistics/rx_errors", "0"},
      {"statistics/rx_packets", std::to_string(state.port.frames_received)},
      {"statistics/tx_bytes", std::to_string(state.port.bytes_sent)},
      {"statistics/tx_dropped", "0"},
      {"statistics/tx_errors", "0"},
      {"statistics/tx_packets", std::to_string(state.port.frames_sent)},
  };
  for (const auto& [name, text] : files) {
    folder.write(path / name, text + "\n");
  }
}

/// The folder that stands for /sys/class/net: the machine's interfaces as links, then the buses.
fs::path write_class(const Folder& folder) {
  fs::path path = folder.path() / kNet;
  std::error_code ignored;
  fs::create_directories(path, ignored);
  for (const auto& entry : fs::directory_iterator(path, ignored)) {
    const fs::path machine = fs::path(kClass) / entry.path().filename();
    if (entry.is_symlink(ignored) && !fs::exists(machine, ignored)) {
      fs::remove(entry.path(), ignored);
    }
  }
  for (const auto& entry : fs::directory_iterator(kClass, ignored)) {
    if (bus_named(entry.path().filename().c_str()) == nullptr) {
      fs::create_symlink(entry.path(), path / entry.path().filename(), ignored);
    }
  }
  for (const Bus& bus : buses()) {
    write_interface(folder, bus);
  }
  return path;
}

fs::path write_devices(const Folder& folder) {
  std::string text = read_all(kDevices);
  for (const Bus& bus : buses()) {
    const PortState port = ask(bus).port;
    char line[256];
    static_cast<void>(std::snprintf(
        line, sizeof line,
        "%6s: %7llu %7llu    0 %4llu    0     0          0         0 %8llu %7llu    0    "
        "0    0     0       0          0\n",
        bus.name.c_str(), static_cast<unsigned long long>(port.bytes_received),
        static_cast<unsigned long long>(port.frames_received),
        static_cast<unsigned long long>(port.frames_dropped),
        static_cast<unsigned long long>(port.bytes_sent),
        static_cast<unsigned long long>(port.frames_sent)));
    text += line;
  }
  folder.write(kDev, text);
  return folder.path() / kDev;
}

/// The file to open in place of `path`; empty: `path` itself.
fs::path stand_in(std::string_view path) {
  static auto* const mutex = new std::mutex;
  const bool devices = path == kDevices || path == kOwnDevices;
  std::string_view rest = path;
  if (!devices) {
    rest.remove_prefix(kClass.size());
    rest.remove_prefix(std::min(rest.find_first_not_of('/'), rest.size()));
  }
  const std::string name(rest.substr(0, rest.find('/')));
  const Bus* const bus = devices ? nullptr : bus_named(name.c_str());
  // Files of the machine's own interfaces are left as they are.
  if (!devices && bus == nullptr && !name.empty() && name != ".") {
    return {};
  }
  const std::scoped_lock lock(*mutex);
  const auto folder = open_folder();
  if (!folder) {
    return {};
  }
  if (devices) {
    return write_devices(*folder);
  }
  if (bus == nullptr) {
    return write_class(*folder);
  }
  write_interface(*folder, *bus);
  return folder->path() / kNet / rest;
}

}  // namespace

const char* interface_file(const char* path, std::string& buffer) {
  if (path == nullptr || path[0] != '/' || reads_itself) {
    return path;
  }
  const std::string_view given = path;
  const bool in_class =
      given.starts_with(kClass) && (given.size() == kClass.size() || given[kClass.size()] == '/');
  if ((!in_class && given != kDevices && given != kOwnDevices) || buses().empty()) {
    return path;
  }
  const int error = errno;
  const ReadsItself guard;
  buffer = stand_in(given).string();
  errno = error;
  return buffer.empty() ? path : buffer.c_str();
}

}  // namespace stator::link::can_exec
