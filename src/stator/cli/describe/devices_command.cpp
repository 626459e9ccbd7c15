#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/rack/core/product_catalogue.hpp"

namespace stator::cli {

void add_devices_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("devices", "List the products that can be run");
  command->callback([] {
    fmt::print("{:12}  {:58}  {}\n", "DEVICE", "WHAT IT IS", "REACHED OVER");
    for (const rack::Product& product : rack::products()) {
      fmt::print("{:12}  {:58}  {}\n", product.type, product.summary, product.reached_over);
    }
  });
}

}  // namespace stator::cli
