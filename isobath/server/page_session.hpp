// PageSession: what one page looks at, and what it may do: a run that is under way, what was recorded of it so far, or
// a recording alone (docs/live-page.md has the messages).
//
// A page that looks at now gets what has changed since the last frame. One that looks at a recording has a playhead of
// its own: it goes with the clock, times the speed, over whatever time a frame took to send, and the page gets what was
// to be seen there. Of the moments that a page asks for between two frames only the last is looked up.
//
// Voxels are most of the bytes, and go apart from all else: to a page that asked for them (it can draw so many, and
// shows them), by turns with what else is new, and after all of it at first. Other pages have the larger cubes.
//
// Requests are untrusted. What cannot be followed is answered by a record, of which no more than kMostAnswers wait, and
// counted; more than kMostRefusals, of which one is forgiven a second, or kWrongTokens wrong tokens hang up. Commands
// need the token, which is compared in a time that does not depend on where it differs; without one there are none.
//
// One thread, that of the server; the clock is given, so that a test can set it.
#pragma once

#include <chrono>
#include <functional>
#include <isobath/runtime/playback.hpp>
#include <isobath/server/page_request.hpp>
#include <isobath/server/shared_changes.hpp>
#include <isobath/server/web_session.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

enum class PageCommand { kHold, kResume, kAbort };

/// What all pages of a server look at. Either of `live` and `open_playback` must be there.
struct PageSources {
  std::shared_ptr<SharedChanges> live = nullptr;  ///< null: no run is under way
  std::function<TimeSpan()> live_span = {};       ///< of the run: its start, and now; with `live`
  std::function<bool()> over = {};                ///< of the run; null: never
  /// Null: nothing is recorded. Must be cheap: what is dear is shared.
  std::function<std::unique_ptr<Playback>()> open_playback = {};
  /// Says why a command was not taken; nothing where it was. Must not wait. Null: no commands.
  std::function<std::string(PageCommand)> command = {};
  std::string token = {};    ///< of those who may command; empty: nobody
  std::string version = {};  ///< a page of another version should load itself again
  std::function<std::chrono::steady_clock::time_point()> clock = std::chrono::steady_clock::now;
};

/// Throws Error where the sources lack what pages need, or the token could be guessed.
void check_page_sources(const PageSources& sources);

class PageSession final : public WebSession {
 public:
  static constexpr int kMostAnswers = 8, kWrongTokens = 3, kMostRefusals = 30;
  static constexpr std::size_t kLeastToken = 16;  ///< characters

  /// The sources must outlive it, and have been checked. Throws Error where a recording cannot be opened.
  explicit PageSession(const PageSources& sources);

  Hearing hear(std::string_view text) override;
  WebFrame next() override;

 private:
  using Clock = std::chrono::steady_clock;

  Hearing refuse(const BadRequest& refusal, std::string_view reason, bool hang_up = false);
  Hearing follow(const PageRequest& request);
  Hearing play(bool playing);
  Hearing control(const std::string& token);
  Hearing command(const std::string& word);
  Hearing detail(const std::string& word);

  void look_at_now();
  void look_at_recording();
  [[nodiscard]] bool runs() const;
  [[nodiscard]] TimeSpan span() const;
  [[nodiscard]] Time start() const;
  [[nodiscard]] Time playhead() const;
  void put_playhead(Time moment);
  void show_recording();
  WebFrame next_voxels();
  SharedChanges::Piece changes(DisplayPart part, std::uint64_t& stamp);
  [[nodiscard]] std::string clock_text() const;

  const PageSources& sources_;
  std::unique_ptr<Playback> playback_;
  bool live_;
  bool control_ = false;

  bool playing_ = true;
  double speed_ = 1;
  Time head_;  ///< where the playhead was at head_set_
  Clock::time_point head_set_;
  DisplayItems shown_;              ///< of the recording
  std::optional<Time> shown_time_;  ///< of which moment
  std::uint64_t stamp_ = 0;         ///< up to which it has all but voxels
  std::uint64_t voxel_stamp_ = 0;   ///< up to which it has the voxels
  bool voxels_ = false;             ///< it wants them
  bool voxels_next_ = false;        ///< it is their turn
  bool forget_ = false;             ///< what the page has is of something else

  std::vector<std::string> answers_;
  std::string said_clock_;
  int wrong_tokens_ = 0;
  double refusals_ = 0;
  Clock::time_point last_refusal_;
};

}  // namespace isobath
