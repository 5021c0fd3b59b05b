// SampleArena: room for the samples of pings that cannot be views of their input (text, packed or compressed). Slices
// of large blocks: a ping keeps its block alive, and only one allocation in hundreds of pings happens.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>

namespace isobath {

class SampleArena {
 public:
  /// `count` bytes of undefined value, valid as long as owner() of this moment is held.
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
  /// The end of the slice taken last, which turned out not to be needed.
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
