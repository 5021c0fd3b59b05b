#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/frames/frame_folder.hpp>
#include <isobath/io/frames/marked_frames.hpp>
#include <isobath/io/frames/polygon_marks.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxAnnotationBytes = 64 << 20;  // LabelMe may embed the image

fs::path mask_of(const fs::path& frame) {
  std::string stem = frame.stem().string();
  if (!stem.ends_with("_raw")) return {};
  const fs::path mask = frame.parent_path() / (stem.substr(0, stem.size() - 4) + "_annotated.png");
  return fs::exists(mask) ? mask : fs::path();
}

/// The LabelMe annotations beside the frame; empty: none.
fs::path polygons_of(const fs::path& frame) {
  std::string stem = frame.stem().string();
  std::vector<std::string> stems{stem};
  if (stem.ends_with("_raw")) stems.push_back(stem.substr(0, stem.size() - 4));
  for (const std::string& name : stems) {
    for (const char* ending : {".json", ".xml"}) {
      const fs::path file = frame.parent_path() / (name + ending);
      std::error_code unknown;
      if (!fs::is_regular_file(file, unknown) || fs::file_size(file, unknown) > kMaxAnnotationBytes) continue;
      const auto bytes = read_whole_file(file, kMaxAnnotationBytes);
      if (looks_like_polygon_marks({reinterpret_cast<const char*>(bytes.data()), bytes.size()})) return file;
    }
  }
  return {};
}

/// The marks as an image: 255 inside.
GrayImage drawn_marks(const fs::path& polygons, const GrayImage& frame) {
  const auto bytes = read_whole_file(polygons, kMaxAnnotationBytes);
  GrayImage mask{frame.width, frame.height, 1,
                 parse_polygon_marks({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, frame.width,
                                     frame.height, polygons.string())};
  for (std::uint8_t& sample : mask.samples) sample = sample ? 255 : 0;
  return mask;
}

Ping ping_of(const fs::path& file, const FrameGeometry& geometry, const InputConfig& config) {
  auto ping = ping_from_frame(geometry, read_gray_png(file), config);
  if (!ping) throw Error("the size of the frame differs from the geometry", {file.string(), {}, {}, {}, {}});
  ping->time = time_of_frame(file).value_or(Time{});
  ping->X_BS.rotation = Rotation::from_heading(config.mount_heading);
  return *std::move(ping);
}

std::vector<std::uint8_t> marks_of(const Ping& mask) {
  const int beams = mask.intensity.beams(), bins = mask.intensity.bins();
  std::vector<std::uint8_t> marks;
  marks.reserve(static_cast<std::size_t>(beams) * bins);
  const float full = mask.intensity.type() == SampleType::kU8 ? 255 : 65535;
  for (int b = 0; b < beams; ++b) {
    for (int k = 0; k < bins; ++k) marks.push_back(mask.intensity(b, k) == full ? 1 : 0);
  }
  return marks;
}

}  // namespace

std::vector<MarkedFrame> read_marked_frames(const fs::path& folder, const InputConfig& config) {
  const FrameLayout layout = frame_layout(folder, config);
  std::vector<MarkedFrame> frames;
  for (const FrameSet& set : layout.sets) {
    if (!config.set.empty() && set.name != config.set) continue;
    const std::size_t first = frames.size();
    for (const fs::path& file : frames_in(set.folder)) {
      if (file.stem().string().ends_with("_annotated")) continue;
      const fs::path mask = mask_of(file), polygons = mask.empty() ? polygons_of(file) : fs::path();
      MarkedFrame frame{ping_of(file, layout.geometry, config), mask.empty() && polygons.empty(), {}};
      if (!mask.empty()) frame.marked = marks_of(ping_of(mask, layout.geometry, config));
      if (!polygons.empty()) {
        frame.marked = marks_of(*ping_from_frame(layout.geometry, drawn_marks(polygons, read_gray_png(file)), config));
      }
      frames.push_back(std::move(frame));
    }
    std::stable_sort(frames.begin() + static_cast<std::ptrdiff_t>(first), frames.end(),
                     [](const auto& a, const auto& b) { return a.ping.time < b.ping.time; });
  }
  if (frames.empty())
    throw Error("holds no frames" + (config.set.empty() ? "" : " in the set " + config.set),
                {folder.string(), {}, {}, {}, {}});
  return frames;
}

}  // namespace isobath
