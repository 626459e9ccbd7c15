#include "stator/link/system/pseudo_terminal.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include "stator/link/system/failure.hpp"

namespace stator::link {

namespace {

constexpr std::string_view kTerminals = "/dev/pts/";

}  // namespace

base::Expected<PseudoTerminal, LinkError> PseudoTerminal::open(const std::string& path) {
  PseudoTerminal terminal(path);
  auto lock = PathLock::take(path);
  if (!lock) {
    return base::Unexpected{lock.error()};
  }
  terminal.lock_ = std::move(*lock);
  if (const auto opened = terminal.open_terminal(); !opened) {
    return base::Unexpected{opened.error()};
  }
  if (const auto placed = terminal.place_name(); !placed) {
    return base::Unexpected{placed.error()};
  }
  return terminal;
}

PseudoTerminal& PseudoTerminal::operator=(PseudoTerminal&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(lock_, other.lock_);
  std::swap(terminal_, other.terminal_);
  std::swap(master_, other.master_);
  std::swap(client_end_, other.client_end_);
  return *this;
}

PseudoTerminal::~PseudoTerminal() {
  if (!terminal_.empty() && name_leads_to() == terminal_) {
    ::unlink(path_.c_str());
  }
}

base::Expected<void, LinkError> PseudoTerminal::open_terminal() {
  master_ = FileDescriptor(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  std::array<char, 64> name{};
  if (!master_.is_open() || ::grantpt(master_.get()) != 0 || ::unlockpt(master_.get()) != 0 ||
      ::ptsname_r(master_.get(), name.data(), name.size()) != 0) {
    return system_failure("cannot make a pseudo-terminal for " + in_quotes(path_), errno);
  }
  client_end_ = FileDescriptor(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (!client_end_.is_open() || ::tcgetattr(client_end_.get(), &settings) != 0) {
    return system_failure("cannot open " + in_quotes(name.data()), errno);
  }
  ::cfmakeraw(&settings);
  if (::tcsetattr(client_end_.get(), TCSANOW, &settings) != 0) {
    return system_failure("cannot set up " + in_quotes(name.data()), errno);
  }
  terminal_ = name.data();
  return {};
}

std::string PseudoTerminal::name_leads_to() const {
  std::error_code ignored;
  return std::filesystem::read_symlink(path_, ignored).string();
}

bool PseudoTerminal::name_is_left_behind() const {
  const std::string terminal = name_leads_to();
  std::error_code ignored;
  return terminal.starts_with(kTerminals) &&
         (lock_.was_left_behind() || !std::filesystem::exists(terminal, ignored));
}

base::Expected<void, LinkError> PseudoTerminal::place_name() {
  const auto place = [this] {
    return ::symlink(terminal_.c_str(), path_.c_str()) == 0 ? 0 : errno;
  };
  int error = place();
  if (error == EEXIST && name_is_left_behind()) {
    error = ::unlink(path_.c_str()) == 0 ? place() : errno;
  }
  if (error == 0) {
    return {};
  }
  terminal_.clear();
  if (error != EEXIST) {
    return system_failure("cannot give a serial port the name " + in_quotes(path_), error);
  }
  if (const std::string other = name_leads_to(); other.starts_with(kTerminals)) {
    return fail(LinkErrorCode::address_in_use,
                in_quotes(path_) + " leads to " + other +
                    ", a terminal of another program; end that, remove the name, or choose another "
                    "name for the serial port");
  }
  return fail(LinkErrorCode::invalid_option,
              in_quotes(path_) +
                  " exists and is no pseudo-terminal; choose another name for the serial port or "
                  "remove it");
}

}  // namespace stator::link
