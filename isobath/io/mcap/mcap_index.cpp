#include <algorithm>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/mcap_chunks.hpp>
#include <isobath/io/mcap/mcap_index.hpp>

namespace isobath {

using mcap::IndexedChunk;
using mcap::PlacedMessage;
using mcap::Unpacked;

struct McapIndex::State {
  State(std::unique_ptr<std::istream> input, const std::string& name) : table(std::move(input), name, kCacheBytes) {}

  mcap::ChunkTable table;

  std::vector<std::size_t> chunks_of(std::span<const std::uint16_t> wanted, std::uint64_t from, std::uint64_t to) const;
  struct Found {
    std::uint64_t time;
    std::size_t chunk;
  };
  std::optional<Found> last_of(std::uint16_t channel, std::uint64_t time);
};

/// The undamaged chunks that may hold messages of these channels in this span, by start time.
std::vector<std::size_t> McapIndex::State::chunks_of(std::span<const std::uint16_t> wanted, std::uint64_t from,
                                                     std::uint64_t to) const {
  const std::vector<IndexedChunk>& chunks = table.chunks();
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const IndexedChunk& c = chunks[i];
    if (c.damaged || c.start > to || c.end < from) continue;
    if (std::any_of(wanted.begin(), wanted.end(), [&](std::uint16_t id) { return c.may_hold(id); })) {
      found.push_back(i);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [&](std::size_t a, std::size_t b) { return chunks[a].start < chunks[b].start; });
  return found;
}

/// The last message time of a channel at or before `time`, and the last chunk that has it.
std::optional<McapIndex::State::Found> McapIndex::State::last_of(std::uint16_t channel, std::uint64_t time) {
  const std::vector<IndexedChunk>& chunks = table.chunks();
  std::vector<std::size_t> candidates = chunks_of({&channel, 1}, 0, time);
  const auto latest = [&](std::size_t i) { return std::min(chunks[i].end, time); };
  std::sort(candidates.begin(), candidates.end(),
            [&](std::size_t a, std::size_t b) { return latest(a) != latest(b) ? latest(a) > latest(b) : a > b; });
  std::optional<Found> found;
  for (const std::size_t i : candidates) {
    if (found && latest(i) < found->time) break;
    const std::vector<std::uint64_t> all = table.times(i, channel);
    const auto after = std::upper_bound(all.begin(), all.end(), time);
    if (after == all.begin()) continue;
    const std::uint64_t last = *std::prev(after);
    if (!found || last > found->time || (last == found->time && i > found->chunk)) found = Found{last, i};
  }
  return found;
}

namespace {

std::unique_ptr<std::istream> opened_for_index(const std::filesystem::path& file) {
  auto input = std::make_unique<std::ifstream>(file, std::ios::binary);
  if (!*input) throw Error("cannot be read", {file.string(), {}, {}, {}, {}});
  return input;
}

}  // namespace

McapIndex::McapIndex(const std::filesystem::path& file) : McapIndex(opened_for_index(file), file.string()) {}
McapIndex::McapIndex(std::unique_ptr<std::istream> input, const std::string& name)
    : state_(std::make_unique<State>(std::move(input), name)) {}
McapIndex::~McapIndex() = default;

bool McapIndex::refresh() { return state_->table.refresh(); }
bool McapIndex::complete() const { return state_->table.complete(); }

std::optional<McapIndex::Span> McapIndex::span() const {
  const auto& chunks = state_->table.chunks();
  if (chunks.empty()) return std::nullopt;
  Span span{chunks[0].start, chunks[0].end};
  for (const IndexedChunk& c : chunks) span = {std::min(span.first, c.start), std::max(span.last, c.end)};
  return span;
}

const std::map<std::uint16_t, McapChannel>& McapIndex::channels() const { return state_->table.channels; }

const McapSchema* McapIndex::schema(std::uint16_t id) const {
  const auto at = state_->table.schemas.find(id);
  return at == state_->table.schemas.end() ? nullptr : &at->second;
}

std::optional<std::uint16_t> McapIndex::channel_of(std::string_view topic) const {
  for (const auto& [id, channel] : state_->table.channels) {
    if (channel.topic == topic) return id;
  }
  return std::nullopt;
}

void McapIndex::visit(std::span<const std::uint16_t> channels, std::uint64_t from, std::uint64_t to,
                      const Visit& visit) {
  State& s = *state_;
  struct Waiting {
    Unpacked chunk;
    std::vector<PlacedMessage> messages;  ///< the requested messages, by time
    std::size_t next = 0;
    [[nodiscard]] std::uint64_t time() const { return messages[next].time; }
  };
  const auto later = [](const Waiting& a, const Waiting& b) {
    return a.time() != b.time() ? a.time() > b.time() : a.chunk->chunk > b.chunk->chunk;
  };
  std::vector<Waiting> waiting;  // a heap; the next message is in the first element
  std::uint64_t bytes = 0;
  const auto give = [&] {
    std::pop_heap(waiting.begin(), waiting.end(), later);
    Waiting& first = waiting.back();
    const bool more = visit(mcap::message_at(first.chunk, first.messages[first.next]));
    if (++first.next < first.messages.size()) {
      std::push_heap(waiting.begin(), waiting.end(), later);
    } else {
      bytes -= first.chunk->size();
      waiting.pop_back();
    }
    return more;
  };
  for (const std::size_t i : s.chunks_of(channels, from, to)) {
    while (!waiting.empty() && (waiting.front().time() < s.table.chunks()[i].start || bytes > kMaxMerged)) {
      if (!give()) return;
    }
    Waiting fresh{s.table.unpacked(i), {}};
    if (!fresh.chunk) continue;
    for (const PlacedMessage& m : fresh.chunk->messages) {
      const bool wanted = std::find(channels.begin(), channels.end(), m.channel) != channels.end();
      if (wanted && m.time >= from && m.time <= to) fresh.messages.push_back(m);
    }
    if (fresh.messages.empty()) continue;
    std::stable_sort(fresh.messages.begin(), fresh.messages.end(),
                     [](const PlacedMessage& a, const PlacedMessage& b) { return a.time < b.time; });
    bytes += fresh.chunk->size();
    waiting.push_back(std::move(fresh));
    std::push_heap(waiting.begin(), waiting.end(), later);
  }
  while (!waiting.empty() && give()) {
  }
}

std::optional<McapMessage> McapIndex::last(std::uint16_t channel, std::uint64_t time) {
  State& s = *state_;
  while (const auto found = s.last_of(channel, time)) {
    const Unpacked chunk = s.table.unpacked(found->chunk);
    if (!chunk) continue;  // damaged: the next search skips it
    const auto at = std::find_if(chunk->messages.rbegin(), chunk->messages.rend(),
                                 [&](const PlacedMessage& m) { return m.channel == channel && m.time == found->time; });
    if (at != chunk->messages.rend()) return mcap::message_at(chunk, *at);
    s.table.distrust(found->chunk);
  }
  return std::nullopt;
}

std::optional<std::uint64_t> McapIndex::time_before(std::uint16_t channel, std::uint64_t time) {
  if (time == 0) return std::nullopt;
  const auto found = state_->last_of(channel, time - 1);
  return found ? std::optional(found->time) : std::nullopt;
}

std::optional<std::uint64_t> McapIndex::time_after(std::uint16_t channel, std::uint64_t time) {
  State& s = *state_;
  std::optional<std::uint64_t> found;
  for (const std::size_t i : s.chunks_of({&channel, 1}, time, ~std::uint64_t{0})) {
    if (found && s.table.chunks()[i].start > *found) break;
    const std::vector<std::uint64_t> all = s.table.times(i, channel);
    const auto after = std::upper_bound(all.begin(), all.end(), time);
    if (after != all.end()) found = std::min(found.value_or(*after), *after);
  }
  return found;
}

McapIndex::Counts McapIndex::counts() const {
  Counts counts = state_->table.counts;
  counts.chunks = state_->table.chunks().size();
  return counts;
}

const SourceReport& McapIndex::report() const { return state_->table.report; }

}  // namespace isobath
