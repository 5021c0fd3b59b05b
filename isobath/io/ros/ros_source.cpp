// The events of a recording of ROS: which topics are read, and the order in which their events leave.
//
// One topic of each use (RosUse) is read: the one whose type has the lowest rank; between topics of one rank the one
// with the most messages; between equal ones the first by name. Patterns of InputConfig::topics choose instead within
// the uses that they name. Without them, point clouds and laser scans are left aside in a log with sonar images, since
// they are mostly made from these; attitudes, positions and depths in a log with poses. The report names every topic,
// with what it is used as.
//
// The time of an event is that of the message's header. Where that is not set, or differs from the time of recording by
// more than kMaxStampOffset, the time of recording is used. Events leave by time, at equal times fixes first (in the
// order of the log where it holds records of Isobath); an event is held back until a message was recorded kWait after
// it, or kMaxHeld wait.
#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/name_patterns.hpp>
#include <isobath/io/ros/ros_decoding.hpp>
#include <isobath/io/ros/ros_recording.hpp>
#include <map>
#include <set>

namespace isobath {
namespace {

constexpr Duration kWait = std::chrono::seconds(1);
constexpr std::size_t kMaxHeld = 2000, kMaxTopicsNamed = 200;

/// Whether topic `a` is read rather than `b`, which has the same use.
bool goes_before(const RosTopic& a, const RosTopic& b) {
  const int rank_a = ros_decoder_of(a.type)->rank, rank_b = ros_decoder_of(b.type)->rank;
  if (rank_a != rank_b) return rank_a < rank_b;
  return a.messages != b.messages ? a.messages > b.messages : a.name < b.name;
}

/// Several topics of these can be read together.
bool may_be_several(RosUse use) { return use == RosUse::kImage || use == RosUse::kSoundings || use == RosUse::kRange; }

/// All topics of these are read, whatever the settings name.
bool is_always_read(RosUse use) {
  return use == RosUse::kTransforms || use == RosUse::kPingGeometry || use == RosUse::kOrigin;
}

struct TopicChoice {
  const RosDecoder* decoder = nullptr;
  bool used = false;
  std::string note;
};

std::string count_text(const RosTopic& topic) {
  return fmt::format("{}, {} {}", topic.type, topic.messages, topic.messages == 1 ? "message" : "messages");
}

/// The choice for each topic.
class TopicChooser {
 public:
  TopicChooser(const std::vector<RosTopic>& topics, const InputConfig& config)
      : topics_(topics), config_(config), choices_(topics.size()) {
    for (std::size_t i = 0; i < topics.size(); ++i) consider(i);
    for (const auto& [use, candidates] : by_use_) choose(use, candidates);
    leave_derived_aside();
    find_moving_transforms();
  }
  /// Whether transforms are what states the poses of the vehicle.
  [[nodiscard]] bool poses_from_transforms() const { return poses_from_transforms_; }
  [[nodiscard]] std::vector<TopicChoice> take() { return std::move(choices_); }

 private:
  void consider(std::size_t i) {
    TopicChoice& choice = choices_[i];
    choice.decoder = ros_decoder_of(topics_[i].type);
    if (!choice.decoder) {
      choice.note = "not used: no reader for this type";
    } else if (!topics_[i].definition) {
      choice.note = "not used: the log has no definition of this type that can be read";
    } else if (config_.frame_geometry.empty() &&
               (choice.decoder->decode == decode_image || choice.decoder->decode == decode_compressed_image)) {
      choice.note = "not used: input.frame_geometry does not declare what its rows and columns are";
    } else {
      by_use_[choice.decoder->use].push_back(i);
    }
  }

  void choose(RosUse use, std::vector<std::size_t> candidates) {
    std::vector<std::size_t> named;
    std::ranges::copy_if(candidates, std::back_inserter(named),
                         [&](std::size_t i) { return fits(topics_[i].name, config_.topics); });
    for (const std::size_t i : candidates) choices_[i].note = "not used: name it in input.topics to use it";
    const bool is_named = !named.empty();
    if (is_named) {
      candidates = named;
      named_.insert(use);
    }
    if ((is_named && may_be_several(use)) || is_always_read(use)) {
      for (const std::size_t i : candidates) mark(i, use);
      return;
    }
    mark(*std::ranges::min_element(candidates,
                                   [&](std::size_t a, std::size_t b) { return goes_before(topics_[a], topics_[b]); }),
         use);
  }

  void mark(std::size_t i, RosUse use) {
    choices_[i].used = true;
    choices_[i].note = std::string("used as ") + to_text(use);
  }

  /// What another topic states already.
  void leave_derived_aside() {
    const auto has = [&](RosUse use) { return by_use_.contains(use); };
    for (TopicChoice& choice : choices_) {
      if (!choice.used || named_.contains(choice.decoder->use)) continue;
      const RosUse use = choice.decoder->use;
      const bool part = use == RosUse::kAttitude || use == RosUse::kPosition || use == RosUse::kDepth;
      const bool cloud = choice.decoder->decode == decode_point_cloud || choice.decoder->decode == decode_laser_scan;
      if ((part && has(RosUse::kPose)) || (cloud && has(RosUse::kImage))) {
        choice.used = false;
        choice.note = part ? "not used: the log has poses" : "not used: the log has sonar images";
      }
    }
  }

  /// Without poses and positions, /tf states the poses.
  void find_moving_transforms() {
    const auto used = [&](RosUse use) {
      return std::ranges::any_of(choices_, [&](const TopicChoice& c) { return c.used && c.decoder->use == use; });
    };
    if (used(RosUse::kPose) || used(RosUse::kPosition)) return;
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (!choices_[i].used || choices_[i].decoder->use != RosUse::kTransforms) continue;
      if (topics_[i].name.ends_with("tf_static")) continue;
      poses_from_transforms_ = true;
      choices_[i].note += ", and as poses of the vehicle";
    }
    if (!poses_from_transforms_) return;
    for (TopicChoice& choice : choices_) {
      if (!choice.used || (choice.decoder->use != RosUse::kAttitude && choice.decoder->use != RosUse::kDepth)) continue;
      choice.used = false;
      choice.note = "not used: transforms state the poses";
    }
  }

  const std::vector<RosTopic>& topics_;
  const InputConfig& config_;
  bool poses_from_transforms_ = false;
  std::vector<TopicChoice> choices_;
  std::map<RosUse, std::vector<std::size_t>> by_use_;
  std::set<RosUse> named_;  ///< uses that a pattern names
};

class RosSource final : public Source {
 public:
  RosSource(std::unique_ptr<RosRecording> recording, const InputConfig& config)
      : recording_(std::move(recording)), context_(config, recording_->report()) {
    choose();
  }

  std::optional<Event> next() override {
    while (!finished_ && !(newest_ && !held_.empty() && held_.begin()->first.first + kWait <= *newest_) &&
           held_.size() < kMaxHeld) {
      const auto record = recording_->next();
      if (record) {
        take(*record);
      } else {
        finished_ = true;
      }
    }
    if (held_.empty()) return {};
    Event event = std::move(held_.begin()->second);
    held_.erase(held_.begin());
    return event;
  }
  [[nodiscard]] const SourceReport& report() const override { return context_.report; }

 private:
  void choose() {
    const auto& topics = recording_->topics();
    TopicChooser chooser(topics, context_.config);
    context_.poses_from_transforms = chooser.poses_from_transforms();
    choices_ = chooser.take();
    has_records_ = std::ranges::any_of(
        choices_, [](const TopicChoice& c) { return c.used && c.decoder->decode == decode_record; });
    for (std::size_t i = 0; i < topics.size() && i < kMaxTopicsNamed; ++i) name_topic(i);
    tell_gaps();
  }

  void name_topic(std::size_t i) {
    const RosTopic& topic = recording_->topics()[i];
    context_.report.details[topic.name] = count_text(topic) + ", " + choices_[i].note;
  }

  /// Says in one line each what a map would need and the log lacks.
  void tell_gaps() {
    const auto reads = [&](std::initializer_list<RosUse> uses) {
      return std::ranges::any_of(choices_, [&](const TopicChoice& c) {
        return c.used && std::ranges::find(uses, c.decoder->use) != uses.end();
      });
    };
    if (!reads({RosUse::kImage, RosUse::kSoundings, RosUse::kRange})) {
      context_.report.details["sonar"] = "none: no topic holds sonar images, ranges or soundings that can be read";
    }
    if (!reads({RosUse::kPose, RosUse::kPosition}) && !context_.poses_from_transforms) {
      context_.report.details["poses"] =
          "none: no topic holds poses or positions that can be read; input.navigation can name a file of poses";
    }
  }

  void take(const RosRecord& record) {
    if (record.topic >= choices_.size()) choose();  // a topic that the index did not name
    newest_ = newest_ ? std::max(*newest_, record.time) : record.time;
    const TopicChoice& choice = choices_[record.topic];
    if (!choice.used) return;
    const RosTopic& topic = recording_->topics()[record.topic];
    const RosMessage message(*topic.definition, record.data, topic.encoding);
    RosInput input{message, record.time, {}, record.owner};
    if (message.root().has("header")) {
      const RosValue header = message["header"];
      input.time = time_of_header(header, record.time);
      input.frame = header["frame_id"].text();
    }
    std::vector<Event> events;
    const char* fault = choice.decoder->decode(input, context_, events);
    if (!message.missing().empty()) {
      refuse(fmt::format("{} without the field {}", topic.type, message.missing()));
    } else if (!message.ok()) {
      refuse(fmt::format("{} that is cut off or damaged", topic.type));
    } else if (fault) {
      refuse(fault);
    } else {
      for (Event& event : events) hold(std::move(event));
    }
  }

  Time time_of_header(const RosValue& header, Time recorded) {
    const auto stamp = isobath::time_of_header(header, recorded);
    if (stamp || !header["stamp"].time()) return stamp.value_or(recorded);
    context_.report.details["times"] =
        fmt::format("{} messages with a time over {} s from that of their recording, which is used instead",
                    ++far_stamps_, kMaxStampOffset / std::chrono::seconds(1));
    return recorded;
  }

  void hold(Event event) {
    const int order = has_records_ || std::holds_alternative<Navigation>(event) ? 0 : 1;
    const std::pair key{time_of(event), order};
    held_.emplace(key, std::move(event));
  }
  void refuse(const std::string& reason) { ++context_.report.rejected[reason]; }

  std::unique_ptr<RosRecording> recording_;
  RosContext context_;
  std::vector<TopicChoice> choices_;
  std::multimap<std::pair<Time, int>, Event> held_;  ///< equal keys in the order of the log
  std::optional<Time> newest_;                       ///< of the recording
  std::uint64_t far_stamps_ = 0;
  bool has_records_ = false;  ///< of Isobath, which stand in the order of the native log
  bool finished_ = false;
};

}  // namespace

std::unique_ptr<Source> ros_events(std::unique_ptr<RosRecording> recording, const InputConfig& config) {
  return std::make_unique<RosSource>(std::move(recording), config);
}

}  // namespace isobath
