// PairReader: pairs of pictures in the order of their times, from a folder or from a log.
//
// A folder of pairs has pairs.toml (PairRig) and the pictures beside it. One pair is in memory at a time. A picture
// without its partner, one that cannot be read and a name without a time are counted and skipped.
#pragma once

#include <filesystem>
#include <isobath/event/event.hpp>
#include <isobath/io/frames/pair_rig.hpp>
#include <isobath/stereo/optics/camera_pair.hpp>
#include <memory>
#include <optional>

namespace isobath {

class PairReader {
 public:
  virtual ~PairReader() = default;
  /// The next pair that can be read; empty at the end. Damage and counts go to the report.
  virtual std::optional<CameraPair> next(SourceReport& report) = 0;
};

bool looks_like_pair_folder(const std::filesystem::path& folder);
/// Throws Error if the folder holds no pair. States the format, the number of pairs and the bytes in the report.
std::unique_ptr<PairReader> open_pair_folder(const std::filesystem::path& folder, const PairRig& rig,
                                             SourceReport& report);

}  // namespace isobath
