// PairFolderWriter: writes a folder of camera pairs, which open_pair_folder reads: PNG pictures named by their time,
// the poses, pairs.toml and the calibration.
#pragma once

#include <fstream>
#include <isobath/io/frames/pair_rig.hpp>
#include <isobath/stereo/optics/camera_pair.hpp>
#include <isobath/vehicle/navigation.hpp>

namespace isobath {

class PairFolderWriter {
 public:
  /// Makes the folder. `rig`: where the cameras stand; `calibration`: the text of their file. Throws Error.
  PairFolderWriter(const std::filesystem::path& folder, PairRig rig, const std::string& calibration);

  void write(const CameraPair& pair);
  void write(const Navigation& fix);
  /// Throws Error where something could not be written.
  void close();
  [[nodiscard]] std::uint64_t pairs() const { return pairs_; }

 private:
  std::filesystem::path folder_;
  std::ofstream poses_;
  std::uint64_t pairs_ = 0;
};

}  // namespace isobath
