#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace stator::board {

/// Stores the content of a memory on a board beyond the life of the process.
class ContentKeeper {
 public:
  ContentKeeper() = default;
  ContentKeeper(const ContentKeeper&) = delete;
  ContentKeeper& operator=(const ContentKeeper&) = delete;
  virtual ~ContentKeeper() = default;

  /// Takes the whole of what is to be kept; not again before that has ended. True: it counts as
  /// kept at once; false: KeptContent::finish() follows.
  [[nodiscard]] virtual bool keep(std::span<const std::byte> content) = 0;
};

/// A memory on a board that keeps its content without supply. It is busy while it writes, which
/// lasts as long as its document says and until the keeper has told the end.
class KeptContent {
 public:
  KeptContent() = default;
  KeptContent(const KeptContent&) = delete;
  KeptContent& operator=(const KeptContent&) = delete;
  virtual ~KeptContent() = default;

  /// What it holds but for a write that has not ended.
  [[nodiscard]] virtual std::span<const std::byte> content() const = 0;
  /// Takes what content() gave, before the first access. False: it is of another length.
  [[nodiscard]] virtual bool load(std::span<const std::byte> content) = 0;
  /// From now on writes go to `keeper`, which must outlive its use; null: to nobody. Allocates.
  virtual void connect(ContentKeeper* keeper) = 0;
  /// The end of what the keeper took; not kept: the old content is there again.
  virtual void finish(bool kept) = 0;
};

/// Such a memory and the name of the peripheral it is in.
struct KeptPart {
  std::string name;
  KeptContent* content = nullptr;
};

}  // namespace stator::board
