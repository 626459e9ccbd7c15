#pragma once

/// @file
/// The version of the library, which is that of the program: semantic versioning,
/// https://semver.org. This is the one place where it stands; CMakeLists.txt reads it.

/// What is incompatible with versions before. 0: anything may change with the next number.
#define STATOR_VERSION_MAJOR 0
/// What was added.
#define STATOR_VERSION_MINOR 1
/// What was mended.
#define STATOR_VERSION_PATCH 0

namespace stator {

/// A version of Stator.
struct Version {
  int major_number = 0;  ///< changes with what is incompatible
  int minor_number = 0;  ///< changes with what is new
  int patch_number = 0;  ///< changes with what is mended
};

/// That of the headers a program is compiled with.
inline constexpr Version kVersion{STATOR_VERSION_MAJOR, STATOR_VERSION_MINOR, STATOR_VERSION_PATCH};

}  // namespace stator
