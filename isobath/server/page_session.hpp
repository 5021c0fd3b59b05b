// PageSession: the view and the rights of one page. A page shows a run in progress, what was recorded of that run so
// far, or a recording (docs/live-page.md has the messages).
//
// A live page gets what has changed since the last frame. A page of a recording has a playhead of its own, which
// advances by the clock times the speed, however long a frame takes to send; the page gets the items at the playhead.
// If a page seeks several times between two frames, only the last seek is looked up.
//
// Voxels are most of the bytes, so they are sent separately. They go only to pages that ask for them, because they show
// and can draw them: at first after all other items, later by turns with what else is new. Other pages get the larger
// cubes only.
//
// A paced page tells which frames it has shown, and its clock has `made_s`, so that it knows how old its content is, on
// any link (docs/live-page.md). It gets no more than its link carries (LinkPace). On a slow link the records are
// packed, what an operator acts on comes first, and what is bulky comes in slices between (PackedRecords): the newest
// version of each item, when its turn has come.
//
// Requests are untrusted. The session answers a request that it cannot follow with a refusal record, and the server
// counts it. At most kMaxAnswers refusals wait. The session closes the connection after more than kMaxRefusals
// refusals (one is forgiven per second) or after kWrongTokens wrong tokens. Commands need the token; its comparison
// takes the same time wherever a wrong token differs. Without a token there are no commands.
//
// At most one page has command. A page with the token takes it over from the one that has it; the other reads in its
// clock who has it now. A session that ends gives command up. Only the page with command may plan.
//
// One thread, that of the server. The clock is a parameter, so that a test can set it.
#pragma once

#include <chrono>
#include <functional>
#include <isobath/display/playback.hpp>
#include <isobath/display/viewer_feed.hpp>
#include <isobath/server/link_pace.hpp>
#include <isobath/server/packed_records.hpp>
#include <isobath/server/page_request.hpp>
#include <isobath/server/shared_changes.hpp>
#include <isobath/server/web_session.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

enum class PageCommand { kHold, kResume, kAbort, kAcknowledge, kReturn };

class PageSession;

/// Which page of a vehicle has command: at most one. The sessions share it; the server's thread uses it.
struct CommandSeat {
  const PageSession* holder = nullptr;
  std::string by;              ///< "the page at 192.168.2.7"
  double since_s = 0;          ///< on the clock of the run
  std::uint64_t sessions = 0;  ///< so far
};

/// How pages plan the mission of a run. The functions must not block. Those that return a text say why they refuse;
/// empty: they do not.
struct PagePlanning {
  std::function<std::string(const MissionDraft&, const std::string& by)> send;
  std::function<std::string(const MissionDraft&, std::uint64_t session)> preview;
  /// The answer to the preview of this session, as JSON, once.
  std::function<std::optional<std::string>(std::uint64_t session)> answer;
};

/// What the pages of a server show. At least one of `live` and `open_playback` must be set.
struct PageSources {
  std::shared_ptr<SharedChanges> live = nullptr;  ///< null: no run is in progress
  std::function<TimeSpan()> live_span = {};       ///< start of the run and its present time; required with `live`
  std::function<bool()> over = {};                ///< whether the run has ended; null: never
  /// Null: nothing is recorded. Must be cheap; expensive parts are shared between pages.
  std::function<std::unique_ptr<Playback>()> open_playback = {};
  /// Returns why the command was refused; empty: it was accepted. Must not block. Null: no commands.
  std::function<std::string(PageCommand, const std::string& by)> command = {};
  std::optional<PagePlanning> planning = {};                 ///< empty: pages cannot plan
  std::function<void(const std::string&)> handed_over = {};  ///< a sentence that says who has command now
  std::shared_ptr<CommandSeat> seat = std::make_shared<CommandSeat>();
  std::string token = {};            ///< gives the right to command; empty: no page has it
  std::string version = {};          ///< a page of another version should reload
  std::string run = {};              ///< differs from that of any other run; empty: the recording tells it
  std::optional<double> speed = {};  ///< of the run, times real time; 0: no limit
  ViewerFeed* viewers = nullptr;     ///< for viewers of other makers, at /foxglove; null: none
  std::function<std::chrono::steady_clock::time_point()> clock = std::chrono::steady_clock::now;
};

/// Throws Error if the sources are incomplete or the token is too short.
void check_page_sources(const PageSources& sources);

/// What a session keeps of a page whose link is paced (link_pace.hpp).
struct PacedPage {
  LinkPace link;
  std::chrono::steady_clock::time_point opened, clock_sent;
  std::uint64_t frame = 0, clock_frame = 0;  ///< numbers of the last frame, and of the last with a clock
  bool packs = true;                         ///< the link is slow
  std::uint64_t urgent_stamp = 0, bulky_stamp = 0;
  PackedRecords batch{PackedRecords::Channel::kBulky, {}};  ///< bulky records that are being sent
  double batch_s = 0;                                       ///< when they were made
  bool batch_more = false, batch_is_voxels = false, bulky_afresh = false;
  double urgent_s = -1, bulky_s = -1;  ///< the page has all changes up to these times of the session
  double seen = -1, seen_s = 0;        ///< the frame that the page has shown, and when it told so
};

class PageSession final : public WebSession {
 public:
  static constexpr int kMaxAnswers = 8, kWrongTokens = 3, kMaxRefusals = 30;
  static constexpr std::size_t kMinToken = 16;  ///< characters

  static constexpr std::chrono::milliseconds kKeepAlive{500};  ///< a paced page gets a clock at least so often

  /// The sources must outlive the session and have been checked. A page that is not `paced` gets all that the socket
  /// takes. Throws Error if a recording cannot be opened.
  explicit PageSession(const PageSources& sources, bool paced = false);
  /// Gives command up.
  ~PageSession() override;

  void on_client(const std::string& address) override;
  Hearing on_message(std::string_view text) override;
  WebFrame next() override;

 private:
  using Clock = std::chrono::steady_clock;

  Hearing refuse(const BadRequest& refusal, std::string_view reason, bool hang_up = false);
  Hearing follow(const PageRequest& request);
  Hearing play(bool playing);
  Hearing control(const std::string& token);
  Hearing release();
  Hearing command(const std::string& word);
  Hearing plan(const PageRequest& request);
  [[nodiscard]] bool has_command() const { return sources_.seat->holder == this; }
  void give_command_up(const std::string& how);
  Hearing detail(const std::string& word);
  Hearing seen(double frame);

  void look_at_now();
  void look_at_recording();
  [[nodiscard]] bool runs() const;
  [[nodiscard]] TimeSpan span() const;
  [[nodiscard]] Time start() const;
  [[nodiscard]] Time playhead() const;
  void put_playhead(Time moment);
  void show_recording();
  void try_to_show_recording();
  /// Everything is sent anew.
  void restart();
  WebFrame next_paced();
  WebFrame next_unpacked();
  WebFrame next_packed();
  void next_batch();
  void add_answers(std::string& out, Time now);
  [[nodiscard]] bool clock_is_due() const;
  void add_clock(std::string& out, Time now);
  [[nodiscard]] Time shown_now() const { return live_ ? sources_.live_span().end : playhead(); }
  [[nodiscard]] double session_s() const;
  WebFrame next_voxels();
  SharedChanges::Piece changes(DisplayPart part, std::uint64_t& stamp);
  [[nodiscard]] std::string clock_text() const;

  const PageSources& sources_;
  std::unique_ptr<Playback> playback_;
  bool live_;
  const std::uint64_t number_;   ///< of the session
  std::string name_ = "a page";  ///< in the log

  bool playing_ = true;
  double speed_ = 1;
  Time head_;  ///< where the playhead was at head_set_
  Clock::time_point head_set_;
  DisplayState shown_;              ///< items of the recording at shown_time_
  std::optional<Time> shown_time_;  ///< the moment that was looked up last
  std::uint64_t stamp_ = 0;         ///< the page has all changes up to here, except voxels
  std::uint64_t voxel_stamp_ = 0;   ///< the page has the voxels up to here
  bool voxels_ = false;             ///< the page asked for voxels
  bool voxels_next_ = false;        ///< the next frame is one of voxels
  bool forget_ = false;             ///< the page must drop its items: it shows another source now

  std::optional<PacedPage> paced_;

  std::vector<std::string> answers_;
  std::string said_clock_;
  int wrong_tokens_ = 0;
  double refusals_ = 0;
  Clock::time_point last_refusal_;
};

}  // namespace isobath
