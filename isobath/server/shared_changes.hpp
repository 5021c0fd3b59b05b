// SharedChanges: encodes the changes of DisplayState once for all clients that are at the same stamp.
//
// The server asks for its clients one after the other. Clients with the same stamp that ask within kShared get the same
// bytes, although the items may have changed in between. Clients that keep up therefore stay together, and ten of them
// cost one encoding. Memory: kKept pieces of kPieceBytes, and the pieces that are being sent.
//
// One thread calls it; other threads may fill the items.
#pragma once

#include <array>
#include <chrono>
#include <isobath/display/display_state.hpp>
#include <memory>

namespace isobath {

class SharedChanges {
 public:
  using Clock = std::chrono::steady_clock;
  /// A piece has at most so many bytes, which bounds what is being sent to one client; the rest follows.
  static constexpr std::size_t kPieceBytes = 1 << 20;
  static constexpr Clock::duration kShared = std::chrono::milliseconds(20);

  /// The items must outlive this.
  explicit SharedChanges(const DisplayState& items) : items_(items) {}

  struct Piece {
    std::shared_ptr<const std::string> records;  ///< null: nothing has changed
    std::uint64_t stamp = 0;                     ///< stamp of the last change in it
    bool whole = false, more = false;            ///< as in DisplayState::Changes
  };
  Piece after(std::uint64_t stamp, Clock::time_point now, DisplayPart part = DisplayPart::kAll);
  [[nodiscard]] const DisplayState& items() const { return items_; }
  /// Number of pieces that were encoded; reused ones do not count.
  [[nodiscard]] std::uint64_t encoded() const { return encoded_; }

 private:
  static constexpr std::size_t kKept = 8;
  struct Kept {
    std::uint64_t from = 0;
    DisplayPart part = DisplayPart::kAll;
    Clock::time_point made;
    Piece piece;
  };

  const DisplayState& items_;
  std::array<Kept, kKept> kept_;
  std::size_t oldest_ = 0;
  std::uint64_t encoded_ = 0;
};

}  // namespace isobath
