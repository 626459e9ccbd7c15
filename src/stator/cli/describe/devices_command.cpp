// stator devices: lists the types of products, what each is and over which network it is reached.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/products.hpp"
#include "stator/product/catalogue/product.hpp"

namespace stator::cli {

void add_devices_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("devices", "List the products that can be run");
  command->callback([] {
    fmt::print("{:12}  {:58}  {}\n", "DEVICE", "WHAT IT IS", "REACHED OVER");
    for (const auto& product : catalogue().products()) {
      const product::Identity& identity = product->identity();
      fmt::print("{:12}  {:58}  {}\n", identity.type, identity.summary, identity.reached_over);
    }
  });
}

}  // namespace stator::cli
