#pragma once

#include <string>
#include <utility>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/link/system/path_lock.hpp"

namespace stator::link {

/// A raw pseudo-terminal under a name that stays the same. The name is a symbolic link that
/// vanishes with the object and that nobody else who uses this class takes meanwhile; one that an
/// earlier process has left behind is replaced, anything else at that place is left alone. Programs
/// may open and close it as often as they like.
class PseudoTerminal {
 public:
  static base::Expected<PseudoTerminal, LinkError> open(const std::string& path);
  PseudoTerminal(PseudoTerminal&& other) noexcept { *this = std::move(other); }
  PseudoTerminal& operator=(PseudoTerminal&& other) noexcept;
  ~PseudoTerminal();

  /// This process's end; reading and writing never wait.
  [[nodiscard]] int master() const { return master_.get(); }
  /// The programs' end.
  [[nodiscard]] int client_end() const { return client_end_.get(); }
  /// What a program opens.
  [[nodiscard]] const std::string& path() const { return path_; }
  /// The terminal behind the name, e.g. "/dev/pts/4".
  [[nodiscard]] const std::string& terminal() const { return terminal_; }

 private:
  explicit PseudoTerminal(std::string path) : path_(std::move(path)) {}

  base::Expected<void, LinkError> open_terminal();
  base::Expected<void, LinkError> place_name();
  /// The name is there and leads to a terminal that is gone, or that a process which was killed
  /// has called so.
  [[nodiscard]] bool name_is_left_behind() const;
  [[nodiscard]] std::string name_leads_to() const;

  std::string path_;
  PathLock lock_;
  /// Empty while the name is not this object's.
  std::string terminal_;
  FileDescriptor master_;
  /// Held open so that the line outlives its clients: without it the last one to close would take
  /// the settings with it, and reading at the master would fail.
  FileDescriptor client_end_;
};

}  // namespace stator::link
