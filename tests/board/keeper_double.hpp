#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "stator/board/assembly/board.hpp"
#include "stator/board/peripheral/kept_content.hpp"

namespace stator::board {

/// Keeps the one memory of a board as a disk would: later, or never.
class KeeperDouble final : public ContentKeeper {
 public:
  explicit KeeperDouble(Board& board) : content(board.kept_parts().at(0).content) {
    content->connect(this);
  }
  ~KeeperDouble() override { content->connect(nullptr); }

  bool keep(std::span<const std::byte> bytes) override {
    taken.assign(bytes.begin(), bytes.end());
    ++orders;
    return at_once;
  }
  void finish(bool well) {
    if (well) {
      kept = taken;
    }
    content->finish(well);
  }

  KeptContent* content;
  std::vector<std::byte> taken;
  std::vector<std::byte> kept;
  int orders = 0;
  bool at_once = false;
};

}  // namespace stator::board
