#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/frames/camera_pictures.hpp>
#include <isobath/io/mcap/mcap.hpp>
#include <isobath/io/ros/ros1_bag.hpp>
#include <isobath/io/ros/ros2_database.hpp>
#include <isobath/io/ros/ros_mcap.hpp>
#include <isobath/io/ros/ros_pairs.hpp>
#include <span>

namespace isobath {
namespace {

constexpr Duration kTogether = std::chrono::milliseconds(5);
constexpr std::size_t kMaxWaitingPictures = 16;  // of one eye, without a partner
constexpr std::uint64_t kMaxPictureSide = 8192;
constexpr const char *kRaw = "sensor_msgs/Image", *kCompressed = "sensor_msgs/CompressedImage";

/// How the samples of a pixel lie.
struct PixelLayout {
  std::string_view encoding;
  std::size_t bytes, red, green, blue;  ///< of a pixel; of grey ones all three are the same
};
constexpr PixelLayout kLayouts[] = {{"mono8", 1, 0, 0, 0}, {"8UC1", 1, 0, 0, 0},  {"rgb8", 3, 0, 1, 2},
                                    {"8UC3", 3, 2, 1, 0},  {"bgr8", 3, 2, 1, 0},  {"rgba8", 4, 0, 1, 2},
                                    {"bgra8", 4, 2, 1, 0}, {"mono16", 2, 1, 1, 1}};

/// Why the message gives no picture; null: it does.
const char* take_raw(const RosMessage& message, CameraImage& image) {
  const std::string_view encoding = message["encoding"].text();
  const std::uint64_t width = message["width"].whole(), height = message["height"].whole();
  const std::uint64_t step = message["step"].whole();
  const bool big = message["is_bigendian"].number() != 0;
  const Bytes data = message["data"].bytes();
  const auto* const layout = std::ranges::find(kLayouts, encoding, &PixelLayout::encoding);
  if (layout == std::end(kLayouts)) return "picture of an encoding that cannot be read";
  if (width == 0 || height == 0 || width > kMaxPictureSide || height > kMaxPictureSide ||
      step < width * layout->bytes || step > (std::uint64_t{1} << 20) || data.size() < step * height) {
    return "picture whose size disagrees with its samples";
  }
  const bool grey = layout->red == layout->blue;
  image = CameraImage(static_cast<int>(width), static_cast<int>(height), grey ? 1 : 3);
  const std::size_t upper = layout->bytes == 2 && big ? 0 : layout->red;
  const std::size_t from[3] = {grey ? upper : layout->red, layout->green, layout->blue};
  std::size_t to = 0;
  for (std::uint64_t y = 0; y < height; ++y) {
    for (std::uint64_t x = 0; x < width; ++x) {
      const std::size_t at = y * step + x * layout->bytes;
      for (int c = 0; c < image.channels; ++c) image.samples[to++] = static_cast<std::uint8_t>(data[at + from[c]]);
    }
  }
  return nullptr;
}

const char* take_compressed(const RosMessage& message, CameraImage& image) {
  const Bytes data = message["data"].bytes();
  if (!message.ok()) return nullptr;
  try {
    image = parse_camera_image({reinterpret_cast<const std::uint8_t*>(data.data()), data.size()}, "picture");
    return nullptr;
  } catch (const Error&) {
    return "compressed picture that cannot be read";
  }
}

class RosPairs final : public PairReader {
 public:
  RosPairs(std::unique_ptr<RosRecording> recording, const PairRig& rig, const std::string& name)
      : recording_(std::move(recording)), topics_{rig.left_topic, rig.right_topic} {
    std::vector<std::string> names;
    for (const RosTopic& topic : recording_->topics()) {
      if (topic.type == kRaw || topic.type == kCompressed) names.push_back(topic.name);
    }
    for (const std::string& wanted : topics_) {
      if (names.empty() || std::ranges::find(names, wanted) != names.end()) continue;
      throw Error("has no pictures on the topic " + wanted, {name}, fmt::format("{}", fmt::join(names, ", ")));
    }
  }

  std::optional<CameraPair> next(SourceReport& report) override {
    for (;;) {
      if (auto pair = oldest_pair(report)) return pair;
      const auto record = recording_->next();
      if (!record) return {};
      const RosTopic& topic = recording_->topics()[record->topic];
      const auto eye = std::ranges::find(topics_, topic.name);
      if (eye == std::end(topics_) || !topic.definition) continue;
      take(topic, *record, waiting_[eye - std::begin(topics_)], report);
    }
  }

 private:
  struct Picture {
    Time time;
    CameraImage image;
  };

  static void take(const RosTopic& topic, const RosRecord& record, std::deque<Picture>& waiting, SourceReport& report) {
    const RosMessage message(*topic.definition, record.data, topic.encoding);
    Picture picture{message["header"]["stamp"].time().value_or(record.time), {}};
    const char* fault = topic.type == kRaw ? take_raw(message, picture.image) : take_compressed(message, picture.image);
    if (!message.ok()) fault = "picture that is cut off or damaged";
    if (fault) {
      ++report.rejected[fault];
      return;
    }
    if (waiting.size() == kMaxWaitingPictures) drop(waiting, report);
    waiting.push_back(std::move(picture));
  }

  std::optional<CameraPair> oldest_pair(SourceReport& report) {
    auto& [left, right] = waiting_;
    while (!left.empty() && !right.empty()) {
      const Duration apart = left.front().time - right.front().time;
      if (apart > kTogether || apart < -kTogether) {
        drop(apart > Duration::zero() ? right : left, report);
        continue;
      }
      CameraPair pair{left.front().time, std::move(left.front().image), std::move(right.front().image)};
      left.pop_front();
      right.pop_front();
      return pair;
    }
    return {};
  }
  static void drop(std::deque<Picture>& waiting, SourceReport& report) {
    waiting.pop_front();
    ++report.rejected["picture without its partner"];
  }

  std::unique_ptr<RosRecording> recording_;
  std::string topics_[2];
  std::deque<Picture> waiting_[2];
};

}  // namespace

std::unique_ptr<RosRecording> open_ros_recording(const std::filesystem::path& file) {
  ByteWindow window = ByteWindow::open(file);
  const Bytes head = window.want(1 << 18);
  const std::span probe{reinterpret_cast<const std::uint8_t*>(head.data()), head.size()};
  const auto opened = [file]() -> std::unique_ptr<std::istream> {
    auto input = std::make_unique<std::ifstream>(file, std::ios::binary);
    if (!*input) throw Error("cannot be read", {file.string()});
    return input;
  };
  if (looks_like_ros1_bag(probe)) return open_ros1_recording(opened(), file.string());
  if (looks_like_ros2_database(head)) return open_ros2_recording(file);
  if (looks_like_mcap(probe) && holds_ros_messages(file)) return open_ros_mcap_recording(opened, file.string());
  throw Error("holds no messages of ROS, so that input.cameras has no pictures to read", {file.string()},
              "a ROS 1 bag, a ROS 2 bag (SQLite), or MCAP");
}

std::unique_ptr<PairReader> open_ros_pairs(std::unique_ptr<RosRecording> recording, const PairRig& rig,
                                           const std::string& name) {
  if (rig.left_topic.empty())
    throw Error("does not name the topics of the pair", {}, {}, "pairs.left_topic and pairs.right_topic");
  return std::make_unique<RosPairs>(std::move(recording), rig, name);
}

}  // namespace isobath
