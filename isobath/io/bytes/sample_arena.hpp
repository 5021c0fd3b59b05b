// SampleArena: memory for the samples of pings that cannot be views of their input (text, packed or compressed). The
// arena hands out slices of large blocks: a ping keeps its block alive, and hundreds of pings need only one allocation.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>

namespace isobath {

class SampleArena {
 public:
  /// `count` bytes of undefined value, valid as long as the current owner() is held.
  std::byte* take(std::size_t count) {
    if (count > size_ - used_) {
      size_ = std::max(count, kBlock);
      used_ = 0;
      block_ = std::make_shared_for_overwrite<std::byte[]>(size_);
      owner_ = block_;
    }
    used_ += count;
    return block_.get() + used_ - count;
  }
  /// Returns the unused end of the last slice.
  void give_back(std::size_t count) { used_ -= std::min(count, used_); }
  [[nodiscard]] const std::shared_ptr<const void>& owner() const { return owner_; }

 private:
  static constexpr std::size_t kBlock = std::size_t{256} << 10;
  std::shared_ptr<std::byte[]> block_;
  std::shared_ptr<const void> owner_;
  std::size_t size_ = 0;
  std::size_t used_ = 0;
};

}  // namespace isobath
