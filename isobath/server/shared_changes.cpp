#include <isobath/server/shared_changes.hpp>
#include <utility>

namespace isobath {

SharedChanges::Piece SharedChanges::after(std::uint64_t stamp, Clock::time_point now, DisplayPart part) {
  for (const Kept& kept : kept_) {
    if (kept.piece.records && kept.from == stamp && kept.part == part && now - kept.made < kShared) return kept.piece;
  }
  DisplayState::Changes changes = items_.changes_after(stamp, kPieceBytes, part);
  Piece piece{nullptr, changes.stamp, changes.whole, changes.more};
  if (changes.records.empty()) return piece;
  ++encoded_;
  piece.records = std::make_shared<const std::string>(std::move(changes.records));
  kept_[oldest_] = {stamp, part, now, piece};
  oldest_ = (oldest_ + 1) % kKept;
  return piece;
}

}  // namespace isobath
