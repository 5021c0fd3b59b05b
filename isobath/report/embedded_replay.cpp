#include <algorithm>
#include <cmath>
#include <isobath/base/base64.hpp>
#include <isobath/display/live_page.hpp>
#include <isobath/report/embedded_replay.hpp>
#include <new>
#include <set>
#include <stdexcept>
#include <unordered_map>
#include <zlib.h>

namespace isobath {
namespace {

constexpr double kRawPerPacked = 4;   ///< raw bytes kept during the run, per packed byte in the report
constexpr int kFast = 1, kWell = 6;   ///< levels of zlib
constexpr int kMaxTries = 4;          ///< attempts to get under the bound without thinning more than needed
constexpr double kSurelyMore = 1.15;  ///< if the estimate exceeds the bound by this factor, packing is not tried

/// Maximum number of packed bytes, so that base64 of them fits into replay_mb.
double packed_bytes(const ReportConfig& config) { return config.replay_mb * 1e6 / 4 * 3 - 3; }

/// Whether a kind of item belongs into the replay: no times of real clocks, and no items of a single page.
bool is_of_the_run(DisplayKind kind) {
  return kind != DisplayKind::kTimes && kind != DisplayKind::kClock && kind != DisplayKind::kRefusal;
}

DisplayKind kind_of_record(const std::string& record) { return static_cast<DisplayKind>(record[0]); }
bool is_gone(const std::string& record) { return (record[1] & 1) != 0; }
std::uint64_t number_of(const std::string& record) {
  std::uint64_t number = 0;
  std::copy_n(record.data() + 8, sizeof number, reinterpret_cast<char*>(&number));
  return number;
}

/// Appends a block. Its header holds time, bytes of its records, 0.
void append_block(std::string& out, Time time, const std::string& records) {
  const std::int64_t ns = time.time_since_epoch().count();
  const std::uint32_t sizes[2] = {static_cast<std::uint32_t>(records.size()), 0};
  out.append(reinterpret_cast<const char*>(&ns), sizeof ns);
  out.append(reinterpret_cast<const char*>(sizes), sizeof sizes);
  out += records;
}

/// The header states no file name, time or system, so that equal input gives equal bytes. Most of the data are echo
/// samples with few repetitions; hence Z_FILTERED.
std::string gzip_of(std::string_view bytes, int level) {
  constexpr int kGzip = 16, kAnySystem = 255;
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, MAX_WBITS + kGzip, 8, Z_FILTERED) != Z_OK) {
    throw std::bad_alloc();
  }
  gz_header head{};
  head.os = kAnySystem;
  deflateSetHeader(&stream, &head);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

/// The size that gzip_of would give, estimated from every eighth piece.
double packed_estimate(std::string_view bytes) {
  constexpr std::size_t kPiece = 1 << 18, kEach = 8;
  std::size_t taken = 0, packed = 0;
  for (std::size_t at = 0; at < bytes.size(); at += kEach * kPiece) {
    const std::string_view piece = bytes.substr(at, kPiece);
    taken += piece.size();
    packed += gzip_of(piece, kFast).size();
  }
  return static_cast<double>(packed) / static_cast<double>(taken) * static_cast<double>(bytes.size());
}

}  // namespace

EmbeddedReplay::EmbeddedReplay(const ReportConfig& config)
    : config_(config), max_replaced_(static_cast<std::size_t>(kRawPerPacked * packed_bytes(config))) {
  interval_s_.fill(config.replay_s);
}

bool EmbeddedReplay::wanted(const ReportConfig& config) { return config.replay && !live_page().empty(); }

void EmbeddedReplay::sample(Time time, const DisplayState& items) {
  if (!blocks_.empty() && time - blocks_.back().time < seconds(config_.replay_s)) return;
  take(time, items);
}

void EmbeddedReplay::take(Time time, const DisplayState& items) {
  const DisplayState::Changes changes = items.changes_after(stamp_);
  stamp_ = changes.stamp;
  std::set<Key> forgotten;
  if (changes.whole) {
    for (const auto& [key, newest] : newest_) {
      if (!newest.gone) forgotten.insert(key);
    }
  }
  if (blocks_.empty() && changes.records.empty()) return;
  // Changes after the last event get the time of that event.
  if (blocks_.empty() || time > blocks_.back().time) blocks_.push_back({time, {}});
  Block& block = blocks_.back();
  for_each_record(changes.records, [&](const DisplayRecord& record) {
    if (!is_of_the_run(record.kind)) return;
    forgotten.erase({record.kind, record.number});
    put(block, record);
  });
  for (const auto& [kind, number] : forgotten) put(block, {kind, true, false, false, number, time, {}});
  if (replaced() > max_replaced_) thin_to(max_replaced_ / 4 * 3);
}

void EmbeddedReplay::put(Block& block, const DisplayRecord& record) {
  std::string& bytes = block.records.emplace_back();
  bytes.reserve(record.payload.size() + 32);
  append_record(bytes, record.kind, record.number, record.time, record.payload, record.gone);
  bytes_ += bytes.size();
  const bool first = blocks_.size() == 1;
  if (first) first_bytes_ += bytes.size();
  Newest& newest = newest_.try_emplace({record.kind, record.number}, Newest{0, false}).first->second;
  newest_bytes_ -= newest.bytes;
  newest = {first ? 0 : bytes.size(), record.gone};
  newest_bytes_ += newest.bytes;
}

/// Keeps only the newest record of each item in each interval of its kind. The first block is an interval of its own.
void EmbeddedReplay::thin(DisplayKind kind) {
  const double interval_s = interval_s_[index_of(kind)];
  std::unordered_map<std::uint64_t, double> kept;  // by item: the interval of the record kept last
  for (auto block = blocks_.rbegin(); block != blocks_.rend(); ++block) {
    const bool first = std::next(block) == blocks_.rend();
    const double stretch = first ? -1 : std::floor(to_seconds(block->time - blocks_.front().time) / interval_s);
    std::vector<std::string>& records = block->records;
    const auto from = std::remove_if(records.rbegin(), records.rend(), [&](const std::string& record) {
      if (kind_of_record(record) != kind) return false;
      const auto [met, fresh] = kept.try_emplace(number_of(record), stretch);
      const bool older = !fresh && met->second == stretch;
      met->second = stretch;
      if (older) bytes_ -= record.size();
      if (older && first) first_bytes_ -= record.size();
      return older;
    });
    records.erase(records.begin(), from.base());
  }
}

/// The kind with the most bytes in replaced records, without those of the first block.
DisplayKind EmbeddedReplay::heaviest() const {
  std::array<std::size_t, kKinds> bytes{};
  for (std::size_t i = 1; i < blocks_.size(); ++i) {
    for (const std::string& record : blocks_[i].records) bytes[index_of(kind_of_record(record))] += record.size();
  }
  for (const auto& [key, newest] : newest_) bytes[index_of(key.first)] -= newest.bytes;
  return static_cast<DisplayKind>(std::max_element(bytes.begin(), bytes.end()) - bytes.begin());
}

void EmbeddedReplay::thin_to(std::size_t max_replaced) {
  while (replaced() > max_replaced) {
    const DisplayKind kind = heaviest();
    interval_s_[index_of(kind)] *= 2;
    thin(kind);
  }
  // Blocks without records are dropped, except the first and the last: they state when the run began and ended.
  std::erase_if(blocks_, [this](const Block& block) {
    return block.records.empty() && &block != &blocks_.front() && &block != &blocks_.back();
  });
}

std::string EmbeddedReplay::blocks() const {
  std::string out;
  std::map<Key, const std::string*> whole;
  std::size_t whole_bytes = 0, since = 0;
  for (const Block& block : blocks_) {
    std::string records;
    for (const std::string& record : block.records) {
      records += record;
      const Key key{kind_of_record(record), number_of(record)};
      const auto was = whole.find(key);
      if (was != whole.end()) whole_bytes -= was->second->size();
      if (is_gone(record)) {
        if (was != whole.end()) whole.erase(was);
        continue;
      }
      whole_bytes += record.size();
      whole[key] = &record;
    }
    since += records.size();
    if (&block == &blocks_.front() || since > kWholeAfter * whole_bytes) {
      records.clear();
      for (const auto& [key, record] : whole) records += *record;
      mark_as_whole(records);
      since = 0;
    }
    append_block(out, block.time, records);
  }
  return out;
}

std::string EmbeddedReplay::finish(Time last, const DisplayState& items) {
  take(last, items);
  if (blocks_.empty()) return {};
  for (std::size_t kind = 1; kind < kKinds; ++kind) {  // thins what came since the last thinning, too
    if (interval_s_[kind] > config_.replay_s) thin(static_cast<DisplayKind>(kind));
  }
  const double most = packed_bytes(config_);
  for (int tries = 1;; ++tries) {
    const std::string all = blocks();
    std::string packed;
    double size = static_cast<double>(all.size()) < most ? 0 : packed_estimate(all);
    const bool estimated = size > kSurelyMore * most;
    if (!estimated) {
      packed = gzip_of(all, kWell);
      size = static_cast<double>(packed.size());
      if (size <= most) return to_base64(packed);
    }
    const std::size_t before = replaced();
    // The estimate uses kFast and tends to be too high. An interval that was doubled is never halved again.
    const double share = tries < kMaxTries ? (estimated ? 1.1 : 0.95) * most / size : 0;
    thin_to(static_cast<std::size_t>(share * static_cast<double>(before)));
    if (replaced() == before) return {};
  }
}

std::string page_with_recording(std::string_view page, std::string_view recording) {
  constexpr std::string_view kBegin = "<!-- recording", kEnd = "-->";
  const std::size_t begin = page.find(kBegin), end = page.find(kEnd, begin);
  if (begin == std::string_view::npos || end == std::string_view::npos) {
    throw std::logic_error("the page has no placeholder for a recording");
  }
  std::string out;
  out.reserve(page.size() + recording.size() + 128);
  out.append(page.substr(0, begin))
      .append("<script type=\"application/octet-stream+base64\" id=\"isobath-recording\">")
      .append(recording)
      .append("</script>")
      .append(page.substr(end + kEnd.size()));
  return out;
}

}  // namespace isobath
