// ViewerFeed: the messages of a run for viewers of other makers that connect to its server, by channel: a topic whose
// schema the viewer knows. A run writes, the server's sessions read; any thread may call any function.
//
// A channel keeps its newest message alone, so that a slow viewer misses messages and does not fall behind; a channel
// of events, such as a log, keeps the newest kEvents. A run has few topics and schemas.
#pragma once

#include <cstdint>
#include <deque>
#include <isobath/base/time.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

class ViewerFeed {
 public:
  static constexpr std::size_t kEvents = 256;

  struct Channel {
    std::string topic, schema_name, schema;  ///< JSON messages; `schema` is a JSON Schema
    bool events = false;                     ///< each message counts, not only the newest
  };
  struct Message {
    std::uint64_t number = 0;  ///< rises by one from message to message of a channel, from 1
    Time time;
    std::shared_ptr<const std::string> body;
  };

  /// Returns the number of the channel, counted from 0; that of an earlier one with this topic.
  std::size_t open(const Channel& channel);
  void write(std::size_t channel, Time time, std::string body);

  /// The channels from number `from` on.
  [[nodiscard]] std::vector<Channel> channels(std::size_t from) const;
  /// The oldest message that is kept with a greater number; empty: there is none.
  [[nodiscard]] std::optional<Message> after(std::size_t channel, std::uint64_t number) const;
  /// Time of the newest message of all.
  [[nodiscard]] std::optional<Time> latest() const;

  /// Counts a viewer while it exists.
  class Viewer {
   public:
    explicit Viewer(ViewerFeed& feed) : feed_(feed) { feed_.count(+1); }
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;
    ~Viewer() { feed_.count(-1); }

   private:
    ViewerFeed& feed_;
  };
  /// Whether there is a viewer, for messages that cost much to make.
  [[nodiscard]] bool watched() const;

 private:
  struct Kept {
    Channel channel;
    std::uint64_t number = 0;
    std::deque<Message> messages;
  };
  void count(int change);

  mutable std::mutex mutex_;
  std::vector<Kept> channels_;
  std::optional<Time> latest_;
  int viewers_ = 0;
};

}  // namespace isobath
