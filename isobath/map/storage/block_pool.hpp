// BlockPool: storage for the internal nodes of region quadtrees (Oskard 1990, III-A; ledger S1-12).
//
// A block is four adjacent 32-bit descriptors, named by its index, so that words stay 32 bits wide and a pool can be
// written to a file and mapped back unchanged. Blocks lie in pages of 1024 (16 KiB). A copy of the pool shares all
// pages: it costs one table of pages, and each side clones a page when it first writes to it. Pages adopted from a
// read-only mapped file are cloned in the same way. Free blocks form a list that runs through their first words.
//
// Threads: other threads may read, copy and destroy copies while the original's own thread writes to it. No thread may
// copy a pool while another writes to it: a page with a single holder is written in place, and only a copy of that
// holder could add a second one.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace isobath {

class BlockPool {
 public:
  using Block = std::array<std::uint32_t, 4>;
  static constexpr std::uint32_t kNone = 0xffffffff;  ///< the end of the list of free blocks
  static constexpr std::uint32_t kBlocksPerPage = 1024;
  static constexpr std::uint32_t kWordsPerPage = 4 * kBlocksPerPage;
  static constexpr std::size_t kPageBytes = sizeof(std::uint32_t) * kWordsPerPage;
  static constexpr std::uint32_t kMaxBlocks = 0x7fffffff;  ///< a link is an index of 31 bits

  BlockPool() = default;
  /// Blocks 0 .. end - 1 in `pages` pages at `words`; `owner` keeps the pages alive, and no thread writes to them.
  BlockPool(const std::uint32_t* words, std::uint32_t pages, std::shared_ptr<const void> owner, std::uint32_t end);
  /// The free blocks of the adopted pages. The caller has checked the list.
  void adopt_free_list(std::uint32_t head, std::uint32_t count) { free_head_ = head, free_count_ = count; }

  [[nodiscard]] Block block(std::uint32_t index) const {
    const std::uint32_t* words = at(index);
    return {words[0], words[1], words[2], words[3]};
  }
  /// Valid until the next edit, allocation or release.
  [[nodiscard]] const std::uint32_t* at(std::uint32_t index) const {
    return pages_[index / kBlocksPerPage].words + std::size_t{4} * (index % kBlocksPerPage);
  }
  void write(std::uint32_t index, const Block& block) { std::copy(block.begin(), block.end(), edit(index)); }
  /// Clones the block's page if another pool shares it. Valid until the pool is copied.
  std::uint32_t* edit(std::uint32_t index) {
    Page& page = pages_[index / kBlocksPerPage];
    if (!page.own()) page = clone(page);
    return page.heap->words.data() + std::size_t{4} * (index % kBlocksPerPage);
  }
  std::uint32_t allocate(const Block& block);
  void release(std::uint32_t index);
  /// Frees every block whose mark is false; the first of them is allocated next.
  void free_unmarked(const std::vector<bool>& marks);

  [[nodiscard]] std::uint32_t in_use() const { return end_ - free_count_; }
  [[nodiscard]] std::uint32_t end() const { return end_; }  ///< blocks in use or free
  [[nodiscard]] std::uint32_t free_head() const { return free_head_; }
  [[nodiscard]] std::uint32_t free_count() const { return free_count_; }
  [[nodiscard]] std::uint32_t pages() const { return static_cast<std::uint32_t>(pages_.size()); }
  [[nodiscard]] const std::uint32_t* page(std::uint32_t number) const { return pages_[number].words; }
  [[nodiscard]] std::uint32_t mapped_pages() const;
  /// Pages that have the same address in both pools.
  [[nodiscard]] std::uint32_t shared_pages(const BlockPool& other) const;
  /// Blocks that were ever allocated, to see that nothing is built and thrown away (S1-15).
  [[nodiscard]] std::uint64_t allocations() const { return allocations_; }

 private:
  struct HeapPage {
    alignas(64) std::atomic<std::uint32_t> holders{1};
    alignas(64) std::array<std::uint32_t, kWordsPerPage> words{};
  };
  /// One holder's share in a page.
  struct Page {
    const std::uint32_t* words = nullptr;
    HeapPage* heap = nullptr;  ///< null for a page of the mapped file

    explicit Page(const std::uint32_t* mapped) : words(mapped) {}
    explicit Page(std::unique_ptr<HeapPage> fresh) : words(fresh->words.data()), heap(fresh.release()) {}
    Page(const Page& other) : words(other.words), heap(other.heap) {
      if (heap != nullptr) heap->holders.fetch_add(1, std::memory_order_relaxed);
    }
    Page(Page&& other) noexcept : words(other.words), heap(std::exchange(other.heap, nullptr)) {}
    Page& operator=(Page other) noexcept {
      std::swap(words, other.words);
      std::swap(heap, other.heap);
      return *this;
    }
    ~Page() {
      if (heap != nullptr && heap->holders.fetch_sub(1, std::memory_order_acq_rel) == 1) delete heap;
    }
    /// Acquire: the last other holder finished its reads of the page before it released it.
    [[nodiscard]] bool own() const { return heap != nullptr && heap->holders.load(std::memory_order_acquire) == 1; }
  };
  static Page clone(const Page& page);

  std::vector<Page> pages_;
  std::shared_ptr<const void> mapping_;
  std::uint32_t end_ = 0;
  std::uint32_t free_head_ = kNone;
  std::uint32_t free_count_ = 0;
  std::uint64_t allocations_ = 0;
};

}  // namespace isobath
