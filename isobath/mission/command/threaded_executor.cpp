#include <algorithm>
#include <condition_variable>
#include <fmt/format.h>
#include <isobath/mission/command/threaded_executor.hpp>
#include <mutex>
#include <system_error>
#include <utility>

namespace isobath {

/// One agent with its mailbox; kept alive by the executor, and by its thread for as long as that runs.
struct ThreadedExecutor::Post {
  struct Item {
    std::shared_ptr<const Envelope> envelope;  ///< null: a tick
    Time time;
  };
  std::string name;
  AgentLevel level = AgentLevel::kMission;
  std::unique_ptr<Agent> agent;  ///< touched by its own thread only
  std::condition_variable work;
  std::deque<Item> mailbox;
  bool tick_waits = false;
  bool full = false;  ///< reported, until the mailbox has been empty
  bool lost = false;
  bool hanging = false;
  bool dying = false;
  bool ended = false;  ///< its thread is about to return
  int said = 0;        ///< since the last tick
  std::optional<Time> turn_since;
};

/// All that threads share, under one mutex. The mutex is held for queues only, never during a turn.
struct ThreadedExecutor::State {
  State(const VehicleParameters& vehicle, const ExecutorConfig& c, std::function<Time()> of_clock, Recorder recorder)
      : config(c), clock(std::move(of_clock)), bus(std::move(recorder)), arbiter(c.arbiter, vehicle) {}

  std::mutex mutex;
  std::condition_variable rested;  ///< a turn has ended
  ExecutorConfig config;
  std::function<Time()> clock;
  Bus bus;
  CommandArbiter arbiter;
  std::vector<std::shared_ptr<Post>> posts;
  std::optional<Time> latest;
  Time next_tick;
  Setpoint setpoint;
  ExecutorCounts counts;
  bool stopping = false;

  Time now();
  void say(const std::string& sender, Message message);
  void decide(const char* what, std::string reason);
  void put(Post& post, Post::Item item);
  void lose(Post& post, bool hung, const std::string& why);
  void watch(Time now);
  void tick(Time now);
  void steer(Time now);
  void end_turn(Post& post, Turn turn);
  static void run(const std::shared_ptr<State>& state, const std::shared_ptr<Post>& post);
};

Time ThreadedExecutor::State::now() {
  const Time read = clock();
  if (!latest) {
    latest = read;
    next_tick = read + kTick;
  }
  if (read < *latest) ++counts.refused;
  latest = std::max(*latest, read);
  return *latest;
}

void ThreadedExecutor::State::put(Post& post, Post::Item item) {
  if (post.mailbox.size() >= static_cast<std::size_t>(config.mailbox)) {
    if (!post.mailbox.front().envelope) post.tick_waits = false;
    post.mailbox.pop_front();
    ++counts.overflow;
  }
  post.mailbox.push_back(std::move(item));
  post.work.notify_one();
}

void ThreadedExecutor::State::say(const std::string& sender, Message message) {
  const Time at = now();
  const auto envelope = std::make_shared<const Envelope>(bus.post(sender, std::move(message), at));
  arbiter.on_message(envelope->message, at, envelope->number);
  std::vector<std::string> overfull;
  for (const auto& post : posts) {
    if (post->lost) continue;
    const std::uint64_t before = counts.overflow;
    put(*post, {envelope, at});
    if (counts.overflow > before && !std::exchange(post->full, true)) overfull.push_back(post->name);
  }
  for (const std::string& name : overfull) decide("drop messages", fmt::format("the mailbox of the {} is full", name));
  if (auto why = bus.take_recorder_loss()) say(kSupervisor, AgentLost{kRecorder, false, std::move(*why)});
}

void ThreadedExecutor::State::decide(const char* what, std::string reason) {
  say(kSupervisor, Decision{now(), kSupervisor, what, std::move(reason)});
}

void ThreadedExecutor::State::lose(Post& post, bool hung, const std::string& why) {
  post.lost = true;
  post.mailbox.clear();
  post.work.notify_one();
  ++counts.lost;
  say(kSupervisor, AgentLost{post.name, hung, why});
  rested.notify_all();
}

void ThreadedExecutor::State::watch(Time at) {
  for (const auto& post : posts) {
    if (post->lost || !post->turn_since || at - *post->turn_since <= config.missed_ticks * kTick) continue;
    lose(*post, true, fmt::format("its turn has not ended for {:.1f} s", to_seconds(at - *post->turn_since)));
  }
}

void ThreadedExecutor::State::tick(Time at) {
  if (at < next_tick) return;
  const auto due = (at - next_tick) / kTick + 1;
  next_tick += due * kTick;
  ++counts.ticks;
  counts.skipped_ticks += static_cast<std::uint64_t>(due - 1);
  for (const auto& post : posts) {
    post->said = 0;
    if (post->lost) continue;
    if (std::exchange(post->tick_waits, true)) {
      ++counts.skipped_ticks;
    } else {
      put(*post, {nullptr, at});
    }
  }
}

void ThreadedExecutor::State::steer(Time at) {
  setpoint = arbiter.steer(at);
  counts.limited = arbiter.limited();
  if (auto change = arbiter.take_change()) say(kCommandArbiter, std::move(*change));
}

void ThreadedExecutor::State::end_turn(Post& post, Turn turn) {
  if (turn.died) return lose(post, false, *turn.died);
  for (Message& message : turn.said) {
    if (post.said == config.max_messages) {
      decide("cut", fmt::format("the {} sent more than {} messages between two ticks", post.name, config.max_messages));
    }
    if (post.said++ < config.max_messages) {
      say(post.name, std::move(message));
    } else {
      ++counts.cut;
    }
  }
}

void ThreadedExecutor::State::run(const std::shared_ptr<State>& state, const std::shared_ptr<Post>& post) {
  std::unique_lock lock(state->mutex);
  while (true) {
    post->work.wait(lock, [&] { return post->lost || state->stopping || !post->mailbox.empty(); });
    if (post->lost || state->stopping) break;
    const Post::Item item = std::move(post->mailbox.front());
    post->mailbox.pop_front();
    if (!item.envelope) post->tick_waits = false;
    if (post->mailbox.empty()) post->full = false;
    post->turn_since = state->now();
    if (post->hanging) {
      post->work.wait(lock, [&] { return post->lost || state->stopping; });
      break;
    }
    const bool dies = post->dying;
    lock.unlock();
    Turn turn = dies            ? Turn{{}, "killed"}
                : item.envelope ? deliver_in_turn(*post->agent, item.envelope->message, item.time)
                                : tick_in_turn(*post->agent, item.time);
    lock.lock();
    post->turn_since.reset();
    if (!post->lost && !state->stopping) state->end_turn(*post, std::move(turn));
    state->rested.notify_all();
  }
  post->ended = true;
}

ThreadedExecutor::ThreadedExecutor(std::vector<AgentSlot> slots, const VehicleParameters& vehicle,
                                   const ExecutorConfig& config, std::function<Time()> clock, Recorder recorder)
    : state_(std::make_shared<State>(vehicle, config, std::move(clock), std::move(recorder))) {
  check_slots(slots, config);
  for (AgentSlot& slot : slots) {
    auto post = std::make_shared<Post>();
    post->name = std::move(slot.name);
    post->level = slot.level;
    post->agent = std::move(slot.agent);
    state_->posts.push_back(std::move(post));
  }
  try {
    for (const auto& post : state_->posts) {
      threads_.emplace_back([state = state_, post] { State::run(state, post); });
    }
  } catch (const std::system_error& e) {
    stop();
    throw Error("no thread is left for an agent", {}, "", e.what());
  }
}

ThreadedExecutor::~ThreadedExecutor() { stop(); }

void ThreadedExecutor::stop() {
  std::unique_lock lock(state_->mutex);
  state_->stopping = true;
  for (const auto& post : state_->posts) post->work.notify_one();
  const Time since = state_->now();
  std::vector<bool> ended(threads_.size(), false);
  for (std::size_t i = 0; i < threads_.size(); ++i) {
    const Post& post = *state_->posts[i];
    while (!post.ended && !post.lost && state_->now() - since <= state_->config.missed_ticks * kTick) {
      lock.unlock();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      lock.lock();
    }
    ended[i] = post.ended;
  }
  const auto posts = std::exchange(state_->posts, {});
  lock.unlock();
  for (std::size_t i = 0; i < threads_.size(); ++i) {
    if (ended[i]) {
      threads_[i].join();
    } else {
      threads_[i].detach();
    }
  }
}

bool ThreadedExecutor::on_message(Message sensed, Time /*now*/) {
  const std::lock_guard lock(state_->mutex);
  state_->say(kFromOutside, std::move(sensed));
  return true;
}

void ThreadedExecutor::advance() {
  const std::lock_guard lock(state_->mutex);
  const Time now = state_->now();
  state_->watch(now);
  state_->tick(now);
  state_->steer(now);
}

Setpoint ThreadedExecutor::helm() {
  advance();
  const std::lock_guard lock(state_->mutex);
  return state_->setpoint;
}

std::uint64_t ThreadedExecutor::served() const {
  const std::lock_guard lock(state_->mutex);
  return state_->arbiter.served();
}

void ThreadedExecutor::settle() {
  std::unique_lock lock(state_->mutex);
  state_->rested.wait(lock, [&] {
    return std::all_of(state_->posts.begin(), state_->posts.end(), [](const auto& post) {
      return post->lost || post->hanging || (post->mailbox.empty() && !post->turn_since);
    });
  });
}

void ThreadedExecutor::hang(std::string_view name) {
  const std::lock_guard lock(state_->mutex);
  post(name).hanging = true;
  state_->rested.notify_all();
}

void ThreadedExecutor::kill(std::string_view name) {
  const std::lock_guard lock(state_->mutex);
  post(name).dying = true;
}

ThreadedExecutor::Post& ThreadedExecutor::post(std::string_view name) const {
  const auto found =
      std::find_if(state_->posts.begin(), state_->posts.end(), [&](const auto& p) { return p->name == name; });
  ISOBATH_ASSERT(found != state_->posts.end());
  return **found;
}

bool ThreadedExecutor::has(std::string_view name) const {
  const std::lock_guard lock(state_->mutex);
  return std::any_of(state_->posts.begin(), state_->posts.end(), [&](const auto& post) { return post->name == name; });
}

bool ThreadedExecutor::lost(std::string_view name) const {
  const std::lock_guard lock(state_->mutex);
  return std::any_of(state_->posts.begin(), state_->posts.end(),
                     [&](const auto& post) { return post->lost && post->name == name; });
}

ExecutorCounts ThreadedExecutor::counts() const {
  const std::lock_guard lock(state_->mutex);
  return state_->counts;
}

std::vector<AgentReport> ThreadedExecutor::crew() const {
  const std::lock_guard lock(state_->mutex);
  std::vector<AgentReport> crew;
  for (const auto& post : state_->posts) {
    crew.push_back({post->name, post->level, state_->bus.sent_by(post->name)});
  }
  return crew;
}

std::map<std::string, Bus::Counts> ThreadedExecutor::said() const {
  const std::lock_guard lock(state_->mutex);
  return state_->bus.said();
}

}  // namespace isobath
