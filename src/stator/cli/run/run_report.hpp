#pragma once

#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/run/runner.hpp"

namespace stator::cli {

/// Says which networks a rack runs on, what is there, and how masters and programs reach it.
void print_networks(const rack::RackConfiguration& configuration, rack::Rack& rack,
                    rack::Runner& runner);

/// Says what each network has done until the end.
void print_end(const rack::RackConfiguration& configuration, rack::Rack& rack,
               rack::Runner& runner);

}  // namespace stator::cli
