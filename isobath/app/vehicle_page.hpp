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
#include <isobath/run/mission_desk.hpp>
#include <isobath/run/run_request.hpp>
#include <isobath/server/page_site.hpp>
#include <isobath/server/web_server.hpp>
#include <optional>
#include <string>
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
    return {&items_, speed, [] { return is_interrupted(); }, [this] { return desk_.next(); }, &desk_, &viewers_};
  }
  /// Sources of the page; throws Error as check_page_sources.
  const PageSources& sources(const std::filesystem::path& record, const std::string& token, double speed) {
    sources_.live = std::shared_ptr<SharedChanges>(&shared_, [](SharedChanges*) {});
    sources_.live_span = [this] { return span_of(items_); };
    sources_.over = [this] { return over_.load(); };
    sources_.open_playback = [record] { return std::make_unique<RecordedPlayback>(record); };
    sources_.token = token;
    if (!token.empty()) take_orders();
    sources_.version = ISOBATH_VERSION;
    sources_.run = std::to_string(std::chrono::steady_clock::now().time_since_epoch().count());
    sources_.speed = speed;
    sources_.viewers = &viewers_;
    check_page_sources(sources_);
    return sources_;
  }
  void close() {
    desk_.close();
    over_ = true;
  }

 private:
  void take_orders();

  DisplayState items_;
  SharedChanges shared_{items_};
  ViewerFeed viewers_;
  MissionDesk desk_;
  std::atomic<bool> over_{false};
  PageSources sources_;
};

}  // namespace isobath::app
