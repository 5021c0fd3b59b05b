// PageOptions: the options of the commands that serve the live page. VehiclePage: what the page of one vehicle shows
// while its run goes on, and what it orders. `interrupted`: whether the user has asked the program to end.
#pragma once

#include <atomic>
#include <chrono>
#include <CLI/CLI.hpp>
#include <csignal>
#include <isobath/display/display_state.hpp>
#include <isobath/display/viewer_feed.hpp>
#include <isobath/recording/recorded_playback.hpp>
#include <isobath/run/run_request.hpp>
#include <isobath/server/page_site.hpp>
#include <isobath/server/web_server.hpp>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace isobath::app {

/// Whether SIGINT or SIGTERM has come since listen_for_interrupt.
bool is_interrupted();
void listen_for_interrupt();
void wait_for_interrupt();

struct PageOptions {
  std::string token_file;
  std::optional<std::string> address;
  std::optional<int> port;
  std::vector<std::string> limits;

  void add_to(CLI::App& command);
  /// Throws Error.
  [[nodiscard]] WebServerConfig server() const;
  /// Reads the token from its file, because every user of the machine can read the command line.
  [[nodiscard]] std::string token() const;
};
std::string place_of(const WebServerConfig& config, int port);

/// The command of a page that waits for the run, if there is one. Any thread may call it.
class Orders {
 public:
  std::string take(PageCommand command) {
    const std::lock_guard lock(mutex_);
    if (over_) return "the mission is over";
    if (order_) return "the previous command is still pending";
    using Kind = OperatorCommand::Kind;
    switch (command) {
      case PageCommand::kHold: order_ = Kind::kHold; break;
      case PageCommand::kResume: order_ = Kind::kResume; break;
      case PageCommand::kAbort: order_ = Kind::kAbort; break;
      case PageCommand::kAcknowledge: order_ = Kind::kAcknowledge; break;
    }
    return {};
  }
  std::optional<OperatorCommand::Kind> next() {
    const std::lock_guard lock(mutex_);
    return std::exchange(order_, std::nullopt);
  }
  void close() {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }

 private:
  std::mutex mutex_;
  std::optional<OperatorCommand::Kind> order_;
  bool over_ = false;
};

/// Start of the run and its present time, on its own clock.
inline TimeSpan span_of(const DisplayState& items) {
  const auto [first, last] = items.times();
  return {first, last};
}

/// What the page of one vehicle shows, and what it orders.
class VehiclePage {
 public:
  VehiclePage() = default;
  VehiclePage(const VehiclePage&) = delete;
  VehiclePage& operator=(const VehiclePage&) = delete;
  ~VehiclePage() = default;

  [[nodiscard]] RunWatch watch(double speed) {
    return {&items_, speed, [] { return is_interrupted(); }, [this] { return orders_.next(); }, &viewers_};
  }
  /// Sources of the page; throws Error as check_page_sources.
  const PageSources& sources(const std::filesystem::path& record, const std::string& token, double speed) {
    sources_.live = std::shared_ptr<SharedChanges>(&shared_, [](SharedChanges*) {});
    sources_.live_span = [this] { return span_of(items_); };
    sources_.over = [this] { return over_.load(); };
    sources_.open_playback = [record] { return std::make_unique<RecordedPlayback>(record); };
    sources_.token = token;
    if (!token.empty()) sources_.command = [this](PageCommand command) { return orders_.take(command); };
    sources_.version = ISOBATH_VERSION;
    sources_.run = std::to_string(std::chrono::steady_clock::now().time_since_epoch().count());
    sources_.speed = speed;
    sources_.viewers = &viewers_;
    check_page_sources(sources_);
    return sources_;
  }
  void close() {
    orders_.close();
    over_ = true;
  }

 private:
  DisplayState items_;
  SharedChanges shared_{items_};
  ViewerFeed viewers_;
  Orders orders_;
  std::atomic<bool> over_{false};
  PageSources sources_;
};

}  // namespace isobath::app
