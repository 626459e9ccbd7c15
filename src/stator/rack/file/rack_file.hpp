#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/changes.hpp"
#include "stator/rack/file/rack_file_error.hpp"
#include "stator/rack/file/system_files.hpp"
#include "stator/settings/files.hpp"
#include "stator/settings/key.hpp"
#include "stator/settings/value.hpp"

namespace stator::rack {

/// Reads a rack file (docs/rack-file.md) of devices of `catalogue`. Throws RackFileError with file,
/// line, reason and remedy for a file that cannot be read, is no TOML - or JSON, where its name
/// ends in ".json" -, has unknown keys or values out of range. `changes` are made to it before it
/// is read.
[[nodiscard]] RackConfiguration load_rack_file(const std::string& path,
                                               const product::Catalogue& catalogue,
                                               Changes changes = {});

/// The same for the text of a rack file; `name` stands for the file in messages.
[[nodiscard]] RackConfiguration parse_rack_file(std::string_view text, const std::string& name,
                                                const product::Catalogue& catalogue);

/// The same for a tree, whoever made it; problems of it name the file `name` where it is not empty.
/// What it names is looked for in `files`.
[[nodiscard]] RackConfiguration read_rack_tree(settings::Value tree, const std::string& name,
                                               const product::Catalogue& catalogue,
                                               Changes changes = {},
                                               const settings::Files& files = system_files());

/// A rack of one device as it leaves its box, with `changes`, whose paths begin with its type, e.g.
/// "tmcm-3315.axis[0].supply_voltage=24". Throws RackFileError, std::runtime_error for a type that
/// `catalogue` has not.
[[nodiscard]] RackConfiguration load_single_device(const std::string& type,
                                                   const product::Catalogue& catalogue,
                                                   Changes changes);

/// Words of the rack file and the command line for the clocks and the wait modes.
inline constexpr std::array kClockKinds{
    settings::Word{"real", static_cast<std::int64_t>(ClockKind::real)},
    settings::Word{"lockstep", static_cast<std::int64_t>(ClockKind::lockstep)}};
inline constexpr std::array kWaitModes{
    settings::Word{"block", static_cast<std::int64_t>(link::WaitMode::block)},
    settings::Word{"spin", static_cast<std::int64_t>(link::WaitMode::spin)},
    settings::Word{"adaptive", static_cast<std::int64_t>(link::WaitMode::adaptive)}};
/// That a thread can be tied to.
inline constexpr settings::WholeRange kProcessors{0, 1023};

}  // namespace stator::rack
