#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/server/page_session.hpp>
#include <isobath/server/thinned_echoes.hpp>
#include <nlohmann/json.hpp>
#include <utility>

namespace isobath {
namespace {

using Ask = PageRequest::Ask;

constexpr std::size_t kUrgentPieces = 4;  ///< urgent records are packed to a quarter and less
constexpr int kLevel = 6;

bool same_secret(std::string_view said, std::string_view secret) {
  unsigned differs = said.size() == secret.size() ? 0 : 1;
  for (std::size_t i = 0; i < said.size(); ++i) {
    differs |= static_cast<unsigned char>(said[i]) ^ static_cast<unsigned char>(secret[i % secret.size()]);
  }
  return differs == 0;
}

double rounded_ms(Duration since) { return std::round(to_seconds(since) * 1e3) / 1e3; }

}  // namespace

void check_page_sources(const PageSources& sources) {
  if (!sources.live && !sources.open_playback) throw Error("a page has neither a run nor a recording to show");
  if (sources.live && !sources.live_span) throw Error("the run that a page shows has no clock");
  if (!sources.token.empty() && sources.token.size() < PageSession::kMinToken) {
    throw Error("the token is too short", {}, "16 characters or more", "make one with: openssl rand -hex 16");
  }
}

PageSession::PageSession(const PageSources& sources, bool paced)
    : sources_(sources),
      live_(sources.live != nullptr),
      number_(++sources.seat->sessions),
      last_refusal_(sources.clock()) {
  if (paced) paced_.emplace().opened = sources_.clock();
  if (live_) return;
  playback_ = sources_.open_playback();
  put_playhead(playback_->span().start);
}

PageSession::~PageSession() {
  if (has_command()) give_command_up("has closed or lost its connection");
}

void PageSession::on_client(const std::string& address) {
  constexpr std::string_view kMapped = "::ffff:";
  name_ = "the page at " + (address.starts_with(kMapped) ? address.substr(kMapped.size()) : address);
}

Hearing PageSession::refuse(const BadRequest& refusal, std::string_view reason, bool hang_up) {
  const Clock::time_point now = sources_.clock();
  refusals_ = std::max(0.0, refusals_ - std::chrono::duration<double>(now - last_refusal_).count()) + 1;
  last_refusal_ = now;
  if (answers_.size() == kMaxAnswers) answers_.erase(answers_.begin());
  answers_.push_back(refusal_text(refusal));
  return {reason, hang_up || refusals_ > kMaxRefusals};
}

Hearing PageSession::on_message(std::string_view text) {
  const auto request = page_request_of(text);
  if (!request) return refuse(request.error(), "ask");
  try {
    return follow(*request);
  } catch (const Error& error) {
    return refuse({"", error.what()}, "recording");
  }
}

Hearing PageSession::follow(const PageRequest& request) {
  if (request.ask == Ask::kSeen) return seen(request.number);
  voxels_next_ = false;  // the answer to the request comes first
  switch (request.ask) {
    case Ask::kControl: return control(request.word);
    case Ask::kRelease: return release();
    case Ask::kCommand: return command(request.word);
    case Ask::kPreview:
    case Ask::kMission: return plan(request);
    case Ask::kDetail: return detail(request.word);
    case Ask::kPlay:
      if (!live_) return play(true);
      if (runs()) return {};  // it plays already
      if (!sources_.open_playback) return refuse({"play", "nothing is recorded"}, "no_recording");
      look_at_recording();
      return play(true);
    case Ask::kLive:
      if (!sources_.live) return refuse({"live", "a recording has no live view"}, "no_now");
      look_at_now();
      return {};
    case Ask::kSpeed:
      if (live_) return refuse({"speed", "the live view has its own speed"}, "no_recording");
      put_playhead(playhead());
      speed_ = request.number;
      return {};
    case Ask::kPause:
    case Ask::kSeek:
    case Ask::kStep:
    case Ask::kSeen: break;
  }
  if (!sources_.open_playback) {
    return refuse({request.ask == Ask::kSeek ? "seek" : "pause", "nothing is recorded"}, "no_recording");
  }
  look_at_recording();
  if (request.ask == Ask::kPause) return play(false);
  if (request.ask == Ask::kStep) {
    const Time from = playhead();
    playing_ = false;
    put_playhead(playback_->step(from, static_cast<int>(request.number)));
    return {};
  }
  const TimeSpan all = span();
  const double first = to_seconds(all.start - start()), last = to_seconds(all.end - start());
  put_playhead(start() + seconds(std::clamp(request.number, first, last)));
  return {};
}

Hearing PageSession::play(bool playing) {
  const bool again = playing && !runs() && playhead() >= span().end;
  put_playhead(again ? span().start : playhead());
  playing_ = playing;
  return {};
}

Hearing PageSession::control(const std::string& token) {
  if (sources_.token.empty() || !sources_.command) {
    return refuse({"control", "this program takes no commands"}, "no_control");
  }
  if (!same_secret(token, sources_.token)) {
    ++wrong_tokens_;
    return refuse({"control", "that is not the token"}, "token", wrong_tokens_ >= kWrongTokens);
  }
  if (has_command()) return {};
  CommandSeat& seat = *sources_.seat;
  const std::string from = seat.holder ? ", which it takes over from " + seat.by : "";
  const double since_s = sources_.live ? to_seconds(sources_.live_span().end - start()) : 0;
  seat = {this, name_, since_s, seat.sessions};
  if (sources_.handed_over) sources_.handed_over(name_ + " has command" + from);
  return {};
}

void PageSession::give_command_up(const std::string& how) {
  sources_.seat->holder = nullptr;
  if (sources_.handed_over) sources_.handed_over(name_ + " " + how + "; no page has command");
}

Hearing PageSession::release() {
  if (!has_command()) return refuse({"release", "this page does not have command"}, "no_control");
  give_command_up("has given command up");
  return {};
}

/// Checks and plans the draft, or gives it to the vehicle.
Hearing PageSession::plan(const PageRequest& request) {
  const bool sends = request.ask == Ask::kMission;
  const char* const what = sends ? "mission" : "preview";
  if (!has_command()) return refuse({what, "this page does not have command"}, "no_control");
  if (!sources_.planning) return refuse({what, "this run has no mission that a page can plan"}, "no_control");
  const std::string why =
      sends ? sources_.planning->send(request.draft, name_) : sources_.planning->preview(request.draft, number_);
  return why.empty() ? Hearing{} : refuse({what, why}, what);
}

Hearing PageSession::command(const std::string& word) {
  static const std::pair<const char*, PageCommand> kWords[] = {{"hold", PageCommand::kHold},
                                                               {"resume", PageCommand::kResume},
                                                               {"abort", PageCommand::kAbort},
                                                               {"acknowledge", PageCommand::kAcknowledge},
                                                               {"return", PageCommand::kReturn}};
  if (!has_command()) return refuse({"command", "this page may not command"}, "no_control");
  const auto* found = std::find_if(std::begin(kWords), std::end(kWords), [&](auto& w) { return word == w.first; });
  if (found == std::end(kWords))
    return refuse({"command", "the command must be hold, resume, abort, acknowledge or return"}, "ask");
  const std::string why = sources_.command(found->second, name_);
  return why.empty() ? Hearing{} : refuse({word, why}, "command");
}

Hearing PageSession::detail(const std::string& word) {
  if (word != "all" && word != "cubes") return refuse({"detail", "voxels must be all or cubes"}, "ask");
  const bool wanted = word == "all";
  if (wanted && !voxels_) voxel_stamp_ = 0;  // the page may have dropped those that it had
  voxels_ = wanted;
  return {};
}

Hearing PageSession::seen(double frame) {
  if (!paced_) return refuse({"seen", "this page is not paced"}, "ask");
  paced_->link.on_seen(static_cast<std::uint64_t>(frame), sources_.clock());
  paced_->seen = frame;
  paced_->seen_s = session_s();
  return {};
}

void PageSession::restart() {
  stamp_ = 0;
  forget_ = true;
  if (!paced_) return;
  paced_->urgent_stamp = 0;
  paced_->urgent_s = paced_->bulky_s = -1;
}

void PageSession::look_at_now() {
  if (live_) return;
  live_ = true;
  restart();
}

void PageSession::look_at_recording() {
  if (!live_) return;
  if (!playback_) playback_ = sources_.open_playback();
  playing_ = true;
  speed_ = 1;
  put_playhead(sources_.live_span().end);
  live_ = false;
  shown_.clear();
  shown_time_.reset();
  restart();
}

/// Whether the run is in progress.
bool PageSession::runs() const { return sources_.live && !(sources_.over && sources_.over()); }

/// The times that a page may seek; an empty span if nothing is recorded.
TimeSpan PageSession::span() const {
  if (playback_) return playback_->span();
  const TimeSpan run = sources_.live_span();
  return {sources_.open_playback ? run.start : run.end, run.end};
}

/// The zero of the page's seconds.
Time PageSession::start() const { return sources_.live ? sources_.live_span().start : playback_->span().start; }

Time PageSession::playhead() const {
  if (!playing_) return head_;
  const Time end = span().end;
  const double gone = std::chrono::duration<double>(sources_.clock() - head_set_).count() * speed_;
  const double left = std::max(0.0, to_seconds(end - head_));
  return std::min(end, head_ + seconds(std::clamp(gone, 0.0, left)));
}

void PageSession::put_playhead(Time moment) {
  const TimeSpan all = span();
  head_ = std::clamp(moment, all.start, all.end);
  head_set_ = sources_.clock();
}

void PageSession::show_recording() {
  const Time moment = playhead();
  if (moment >= span().end) {  // at the end of what is recorded: wait there while the run goes on
    put_playhead(moment);
    playing_ = playing_ && runs();
  }
  if (shown_time_ == moment) return;
  shown_time_ = moment;  // also if it fails, so that it is not retried in every frame
  playback_->show(moment, shown_);
}

std::string PageSession::clock_text() const {
  const TimeSpan all = span();
  const Time from = start();
  const Time now = shown_now();
  // A recording that was opened before the run went on ends before the present.
  const Time end = live_ ? std::max(all.end, now) : all.end;
  nlohmann::json clock{{"now_s", rounded_ms(now - from)},      {"start_s", rounded_ms(all.start - from)},
                       {"end_s", rounded_ms(end - from)},      {"live", live_},
                       {"playing", live_ ? runs() : playing_}, {"speed", live_ ? sources_.speed.value_or(1) : speed_},
                       {"version", sources_.version}};
  if (!sources_.run.empty()) clock["run"] = sources_.run;
  if (!sources_.token.empty()) clock["control"] = has_command();
  if (sources_.planning) clock["plans"] = true;
  if (const CommandSeat& seat = *sources_.seat; seat.holder) {
    clock["command"] = {{"by", seat.by}, {"since_s", rounded_ms(seconds(seat.since_s))}};
  }
  if (sources_.live && !runs()) clock["over"] = true;
  if (sources_.live) clock["live_s"] = rounded_ms(sources_.live_span().end - from);
  return clock.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

SharedChanges::Piece PageSession::changes(DisplayPart part, std::uint64_t& stamp) {
  SharedChanges::Piece piece;
  if (live_) {
    piece = sources_.live->after(stamp, sources_.clock(), part);
  } else {
    DisplayState::Changes changes = shown_.changes_after(stamp, SharedChanges::kPieceBytes, part);
    piece = {nullptr, changes.stamp, changes.whole, changes.more};
    if (!changes.records.empty()) piece.records = std::make_shared<const std::string>(std::move(changes.records));
  }
  stamp = piece.stamp;
  return piece;
}

WebFrame PageSession::next() { return paced_ ? next_paced() : next_unpacked(); }

/// If it fails, the page goes on showing what it shows.
void PageSession::try_to_show_recording() {
  try {
    show_recording();
  } catch (const Error& error) {
    if (shown_time_) put_playhead(*shown_time_);
    playing_ = false;
    refuse({"", error.what()}, "recording");
  }
}

WebFrame PageSession::next_unpacked() {
  if (std::exchange(voxels_next_, false)) {
    WebFrame frame = next_voxels();
    if (frame.shared) return frame;
  }
  WebFrame frame;
  if (!live_) try_to_show_recording();
  SharedChanges::Piece piece = changes(DisplayPart::kAllButVoxels, stamp_);
  if (piece.whole || forget_) voxel_stamp_ = 0;
  voxels_next_ = voxels_ && !piece.more;
  frame.shared = std::move(piece.records);
  frame.more = piece.more || voxels_next_;
  if (paced_ && !piece.more) paced_->urgent_s = paced_->bulky_s = session_s();

  const Time now = shown_now();
  if (clock_is_due() || piece.whole || forget_) add_clock(frame.own, now);
  if (forget_ && !frame.shared) mark_as_whole(frame.own);
  forget_ = false;
  add_answers(frame.own, now);
  if (frame.bytes() > 0 || !voxels_next_) return frame;
  voxels_next_ = false;
  return next_voxels();
}

void PageSession::add_answers(std::string& out, Time now) {
  for (const std::string& answer : answers_) append_record(out, DisplayKind::kRefusal, 0, now, answer);
  answers_.clear();
  if (!sources_.planning) return;
  if (const auto preview = sources_.planning->answer(number_))
    append_record(out, DisplayKind::kPreview, 0, now, *preview);
}

double PageSession::session_s() const {
  return std::chrono::duration<double>(sources_.clock() - paced_->opened).count();
}

bool PageSession::clock_is_due() const {
  return clock_text() != said_clock_ || (paced_ && sources_.clock() - paced_->clock_sent >= kKeepAlive);
}

void PageSession::add_clock(std::string& out, Time now) {
  said_clock_ = clock_text();
  if (!paced_) return append_record(out, DisplayKind::kClock, 0, now, said_clock_);
  paced_->clock_sent = sources_.clock();
  paced_->clock_frame = paced_->frame + 1;
  std::string text = said_clock_;
  text.back() = ',';
  text += fmt::format("\"frame\":{},\"seen\":{},\"seen_s\":{:.4f}", paced_->frame + 1, paced_->seen, paced_->seen_s);
  if (paced_->urgent_s >= 0) text += fmt::format(",\"made_s\":{:.4f}", paced_->urgent_s);
  if (paced_->bulky_s >= 0) text += fmt::format(",\"maps_s\":{:.4f}", paced_->bulky_s);
  append_record(out, DisplayKind::kClock, 0, now, text + "}");
}

WebFrame PageSession::next_paced() {
  PacedPage& p = *paced_;
  if (p.link.room() == 0) return {};
  const bool slow = p.link.window() < SharedChanges::kPieceBytes;
  if (slow && !p.packs) p.urgent_stamp = p.bulky_stamp = stamp_;
  if (!slow && p.packs && p.batch.left() == 0) stamp_ = std::min(p.urgent_stamp, p.bulky_stamp);
  p.packs = slow || (p.packs && p.batch.left() > 0);
  WebFrame frame = p.packs ? next_packed() : next_unpacked();
  if (frame.bytes() == 0) return frame;
  if (p.clock_frame != p.frame + 1) add_clock(frame.own, shown_now());  // the number of the frame
  p.link.on_sent(++p.frame, frame.bytes(), sources_.clock());
  return frame;
}

WebFrame PageSession::next_packed() {
  PacedPage& p = *paced_;
  if (!live_) try_to_show_recording();
  const DisplayState& items = live_ ? sources_.live->items() : shown_;
  const std::size_t piece =
      std::max<std::size_t>(LinkPace::kMinWindow / 2, std::min(p.link.room(), p.link.window() / 4));
  DisplayState::Changes urgent = items.changes_after(p.urgent_stamp, kUrgentPieces * piece, DisplayPart::kUrgent);
  p.urgent_stamp = urgent.stamp;
  if (!urgent.more) p.urgent_s = session_s();
  if (urgent.whole || forget_) {
    p.bulky_stamp = voxel_stamp_ = 0;
    p.bulky_afresh = true;
    p.batch.bytes.clear();
    p.batch.sent = 0;
  }
  if (p.batch.left() == 0 && !urgent.more) next_batch();

  const Time now = shown_now();
  std::string records;
  if (forget_ || urgent.whole || !urgent.records.empty() || p.batch.left() > 0 || clock_is_due())
    add_clock(records, now);
  if (forget_ || urgent.whole) mark_as_whole(records);
  if (urgent.whole) urgent.records[1] = 0;  // the clock before it says so
  forget_ = false;
  records += urgent.records;
  add_answers(records, now);
  WebFrame frame;
  if (records.empty()) return frame;
  PackedRecords first{PackedRecords::Channel::kUrgent, packed(records, Packing::kZlib, kLevel)};
  first.append_slice(frame.own, first.bytes.size(), now);
  if (p.batch.left() > 0 && frame.bytes() < piece) p.batch.append_slice(frame.own, piece - frame.bytes(), now);
  if (p.batch.left() == 0 && !p.batch.bytes.empty() && !p.batch_more) p.bulky_s = p.batch_s;
  frame.more = urgent.more || p.batch.left() > 0 || p.batch_more;
  return frame;
}

/// What is bulky and new, as much as the link carries soon. Voxels have every second turn.
void PageSession::next_batch() {
  PacedPage& p = *paced_;
  const DisplayState& items = live_ ? sources_.live->items() : shown_;
  DisplayState::Changes changes;
  bool voxels = voxels_ && !p.batch_is_voxels;
  for (int turn = 0; turn < 2 && changes.records.empty(); ++turn, voxels = voxels_ && !voxels) {
    std::uint64_t& stamp = voxels ? voxel_stamp_ : p.bulky_stamp;
    changes = items.changes_after(stamp, p.link.window(), voxels ? DisplayPart::kVoxels : DisplayPart::kBulky);
    stamp = changes.stamp;
    p.batch_is_voxels = voxels;
    if (!voxels && changes.whole && !std::exchange(p.bulky_afresh, false)) forget_ = true;
  }
  if (live_ && runs()) {  // else no newer ping would replace a thinned one
    ThinnedEchoes thin = thinned_echoes(changes.records, p.link.window() / 2);
    changes.records = std::move(thin.records);
    if (thin.thinned) p.link.want_more();
  }
  p.batch_s = session_s();
  p.batch_more = changes.more;
  p.batch.sent = 0;
  p.batch.bytes = changes.records.empty() ? std::string() : packed(changes.records, Packing::kZlib, kLevel);
  if (changes.records.empty()) p.bulky_s = p.batch_s;
}

/// Further voxels wait until all other items have had their turn.
WebFrame PageSession::next_voxels() {
  SharedChanges::Piece piece = changes(DisplayPart::kVoxels, voxel_stamp_);
  return {std::move(piece.records), {}, piece.more};
}

}  // namespace isobath
