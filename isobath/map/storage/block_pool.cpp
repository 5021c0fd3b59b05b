#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/map/storage/block_pool.hpp>

namespace isobath {

BlockPool::BlockPool(const std::uint32_t* words, std::uint32_t pages, std::shared_ptr<const void> owner,
                     std::uint32_t end)
    : mapping_(std::move(owner)), end_(end) {
  pages_.reserve(pages);
  for (std::uint32_t i = 0; i < pages; ++i) pages_.emplace_back(words + std::size_t{kWordsPerPage} * i);
}

BlockPool::Page BlockPool::clone(const Page& page) {
  auto fresh = std::make_unique<HeapPage>();
  std::copy_n(page.words, kWordsPerPage, fresh->words.begin());
  return Page(std::move(fresh));
}

std::uint32_t BlockPool::allocate(const Block& block) {
  ++allocations_;
  std::uint32_t index = free_head_;
  if (index != kNone) {
    free_head_ = *at(index);
    --free_count_;
  } else {
    ISOBATH_ASSERT(end_ < kMaxBlocks);
    index = end_++;
    if (index % kBlocksPerPage == 0) pages_.emplace_back(std::make_unique<HeapPage>());
  }
  write(index, block);
  return index;
}

void BlockPool::release(std::uint32_t index) {
  write(index, {free_head_, 0, 0, 0});
  free_head_ = index;
  ++free_count_;
}

void BlockPool::free_unmarked(const std::vector<bool>& marks) {
  free_head_ = kNone;
  free_count_ = 0;
  for (std::uint32_t i = end_; i-- > 0;) {
    if (!marks[i]) release(i);
  }
}

std::uint32_t BlockPool::mapped_pages() const {
  return static_cast<std::uint32_t>(
      std::count_if(pages_.begin(), pages_.end(), [](const Page& p) { return p.heap == nullptr; }));
}

std::uint32_t BlockPool::shared_pages(const BlockPool& other) const {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < std::min(pages_.size(), other.pages_.size()); ++i) {
    count += pages_[i].words == other.pages_[i].words;
  }
  return count;
}

}  // namespace isobath
