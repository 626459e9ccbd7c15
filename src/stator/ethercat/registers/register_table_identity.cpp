// Product and vendor ID, user RAM: 0x0E00-0x0FFF.

#include "stator/ethercat/registers/register_rows.hpp"

namespace stator::ethercat {

namespace {

using namespace notation;

// Registers are {address, bits, name, effect, feature, repetition}, their fields {highest bit,
// lowest bit, name, bus, host, reset, {line of the TMC8461 datasheet, of the TMC8670's}}.
constexpr RegisterRow kIdentityRows[] = {
    {0x0E00, 64, "Product ID", E::none, F::product_identity},
    {63, 0, "product_id", r, r, 0, {6173, 2596}},
    {0x0E08, 64, "Vendor ID", E::none, F::product_identity},
    {63, 0, "vendor_id", r, r, 0, {6184, 0}},
    {0x0F80, 1024, "User RAM", E::none, F::user_ram},
    {1023, 0, "user_ram", rw, rw, 0, {2390, 1245}},
};

}  // namespace

std::span<const RegisterDeclaration> identity_registers() {
  return RegisterTable<kIdentityRows>::registers();
}

}  // namespace stator::ethercat
