#pragma once

#include <filesystem>
#include <string>

#include "stator/cli/run/run_options.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/replay/recording_format.hpp"

namespace stator::cli {

/// What a recording of the rack that `options` ask for has to keep: those options, the rack file
/// and the files it names, and the kept files as they are now. Throws Failure for what no recording
/// can hold.
[[nodiscard]] replay::RecordingHeader header_of(const RunOptions& options,
                                                const rack::RackConfiguration& configuration);

/// The options of a recording. Its files are written below `folder`, the kept ones into `state` (if
/// it is not empty). Throws Failure when that fails.
[[nodiscard]] RunOptions options_of(const replay::RecordingHeader& header,
                                    const std::filesystem::path& folder,
                                    const std::filesystem::path& state);

}  // namespace stator::cli
