// SharedChanges: what has changed of DisplayItems, encoded once for all who ask for the same at about the same time.
//
// A server asks for all its clients in turn. Who got the same last time gets the very same bytes again, though the
// items may have moved on by a few milliseconds in between: so those who keep up stay together, and ten of them cost
// one encoding. Memory: kKept pieces of kPieceBytes, and what is under way to clients.
//
// One thread; the items may be filled by others.
#pragma once

#include <array>
#include <chrono>
#include <isobath/runtime/display_items.hpp>
#include <memory>

namespace isobath {

class SharedChanges {
 public:
  using Clock = std::chrono::steady_clock;
  /// Beyond so many bytes the rest goes with the next piece: what is under way to one client is bounded.
  static constexpr std::size_t kPieceBytes = 1 << 20;
  static constexpr Clock::duration kShared = std::chrono::milliseconds(20);

  /// The items must outlive this.
  explicit SharedChanges(const DisplayItems& items) : items_(items) {}

  struct Piece {
    std::shared_ptr<const std::string> records;  ///< null: nothing has changed
    std::uint64_t stamp = 0;                     ///< up to which they go
    bool whole = false, more = false;            ///< as of DisplayItems::Changes
  };
  Piece after(std::uint64_t stamp, Clock::time_point now, DisplayPart part = DisplayPart::kAll);
  /// Pieces that were encoded rather than given again.
  [[nodiscard]] std::uint64_t encoded() const { return encoded_; }

 private:
  static constexpr std::size_t kKept = 8;
  struct Kept {
    std::uint64_t from = 0;
    DisplayPart part = DisplayPart::kAll;
    Clock::time_point made;
    Piece piece;
  };

  const DisplayItems& items_;
  std::array<Kept, kKept> kept_;
  std::size_t oldest_ = 0;
  std::uint64_t encoded_ = 0;
};

}  // namespace isobath
