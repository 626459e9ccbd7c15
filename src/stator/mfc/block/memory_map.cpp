#include "stator/mfc/block/memory_map.hpp"

namespace stator::mfc {

MemoryMap::MemoryMap(const Configuration& configuration)
    : write_count_(place(configuration, Direction::write, 0)),
      read_count_(place(configuration, Direction::read, write_count_)) {}

std::size_t MemoryMap::place(const Configuration& configuration, Direction direction,
                             std::size_t from) {
  const unsigned number = direction == Direction::write ? 0U : 1U;
  Block& block = blocks_[number];
  block.start = configuration.block_start(number);
  std::size_t count = 0;
  for (const Register& entry : kRegisters) {
    if (entry.direction != direction || !entry.mappable()) {
      continue;
    }
    const Mapping mapping = configuration.mapping(entry.number);
    if (!mapping.enabled) {
      continue;
    }
    registers_[from + count] = {entry.number, entry.size, mapping.trigger, block.end()};
    ++count;
    block.length += entry.mapped_size();
    mapped_ |= std::uint64_t{1} << entry.number;
  }
  return count;
}

}  // namespace stator::mfc
