#pragma once

#include "stator/product/catalogue/catalogue.hpp"

namespace stator::cli {

/// The program stator, with the products of `catalogue`, which must outlive it: does what the
/// command line asks for and says on stderr why it cannot. Returns the exit status: 0, 1 for a
/// failure, 2 for a command line that it does not understand, 3 for a recording that was cut short.
/// To be called once, from main().
[[nodiscard]] int run(int argc, char** argv, const product::Catalogue& catalogue);

}  // namespace stator::cli
