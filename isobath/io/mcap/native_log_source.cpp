#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/io/mcap/native_log_decoding.hpp>
#include <isobath/io/mcap/native_log_kinds.hpp>
#include <utility>

namespace isobath {
namespace {

class NativeLogSource final : public Source {
 public:
  NativeLogSource(std::unique_ptr<std::istream> input, const std::string& name) : reader_(std::move(input), name) {
    reader_.report().format = "Isobath log (MCAP)";
    learn_metadata();
    waiting_ = next_event();
    std::string topics;
    bool ours = false;
    for (const auto& [id, channel] : reader_.channels()) {
      topics += (topics.empty() ? "" : ", ") + channel.topic;
      ours = ours || is_ours(channel);
    }
    if (!ours) {
      throw Error("MCAP without Isobath channels", {name, {}, {}, {}, {}},
                  fmt::format("{}, {}, {}, {}", native::kPing.name, native::kNavigation.name, native::kRange.name,
                              native::kSwath.name),
                  topics.empty() ? "" : "it holds " + topics.substr(0, 200));
    }
  }

  std::optional<Event> next() override { return waiting_ ? std::exchange(waiting_, std::nullopt) : next_event(); }
  [[nodiscard]] const SourceReport& report() const override { return std::as_const(reader_).report(); }

 private:
  std::optional<Event> next_event() {
    while (const auto message = reader_.next()) {
      const McapChannel& channel = *reader_.channel(message->channel_id);
      const McapSchema* schema = reader_.schema(channel.schema_id);
      if (schema && is_aside(schema->name)) continue;
      if (!is_ours(channel)) {
        ++reader_.report().rejected["message of a channel that is not from Isobath"];
        continue;
      }
      if (auto event = native::decode_event(schema->name, *message, fans_)) return event;
      ++reader_.report().rejected["message that cannot be decoded"];
    }
    learn_metadata();
    return std::nullopt;
  }

  [[nodiscard]] bool is_ours(const McapChannel& channel) const {
    const McapSchema* schema = reader_.schema(channel.schema_id);
    return schema && channel.message_encoding == "cdr" && schema->name.starts_with("isobath/msg/");
  }

  /// Channels that are not inputs of a vehicle: ground truth, which only the scorer may read, and derived data, which
  /// is computed again.
  static bool is_aside(const std::string& kind) {
    return kind == native::kTrueMotion.name || kind == native::kEchoTruth.name || kind == native::kSetpoint.name ||
           kind == native::kDecision.name || kind.starts_with("isobath.") || kind.starts_with("foxglove.");
  }

  void learn_metadata() {
    SourceReport& report = reader_.report();
    for (; metadata_seen_ < reader_.metadata().size(); ++metadata_seen_) {
      const McapMetadata& item = reader_.metadata()[metadata_seen_];
      if (item.name == native::kDetails) report.details.insert(item.values.begin(), item.values.end());
      if (item.name == native::kOrigin) learn_origin(item, report);
    }
  }

  static void learn_origin(const McapMetadata& item, SourceReport& report) {
    GeoOrigin origin;
    const auto read = [&](const char* key, double& value) {
      const auto at = item.values.find(key);
      if (at == item.values.end()) return false;
      const std::string& text = at->second;
      return std::from_chars(text.data(), text.data() + text.size(), value).ec == std::errc();
    };
    const bool complete = read("latitude_deg", origin.latitude_deg) && read("longitude_deg", origin.longitude_deg);
    if (complete && valid(origin)) report.origin = origin;
  }

  McapReader reader_;
  native::FanStore fans_;
  std::optional<Event> waiting_;
  std::size_t metadata_seen_ = 0;
};

std::unique_ptr<std::istream> opened(const std::filesystem::path& file) {
  auto input = std::make_unique<std::ifstream>(file, std::ios::binary);
  if (!*input) throw Error("cannot be read", {file.string(), {}, {}, {}, {}});
  return input;
}

}  // namespace

TruthReader::TruthReader(const std::filesystem::path& file)
    : reader_(std::make_unique<McapReader>(opened(file), file.string())) {}
TruthReader::~TruthReader() = default;

std::optional<std::variant<TrueMotion, EchoTruth>> TruthReader::next() {
  while (const auto message = reader_->next()) {
    const McapSchema* schema = reader_->schema(reader_->channel(message->channel_id)->schema_id);
    if (!schema) continue;
    if (schema->name == native::kTrueMotion.name) {
      if (auto motion = native::decode_motion(message->data)) return std::move(*motion);
    } else if (schema->name == native::kEchoTruth.name) {
      if (auto echoes = native::decode_echoes(message->data)) return std::move(*echoes);
    }
  }
  return std::nullopt;
}

std::vector<std::string> decisions_in(const std::filesystem::path& file) {
  McapReader reader(opened(file), file.string());
  std::vector<std::string> decisions;
  while (const auto message = reader.next()) {
    const McapSchema* schema = reader.schema(reader.channel(message->channel_id)->schema_id);
    if (!schema || schema->name != native::kDecision.name) continue;
    decisions.emplace_back(message->data.begin(), message->data.end());
  }
  return decisions;
}

std::optional<std::string> attachment_in(const std::filesystem::path& file, const std::string& name) {
  McapReader reader(opened(file), file.string());
  const auto found = [&]() -> std::optional<std::string> {
    for (const McapAttachment& a : reader.attachments()) {
      if (a.name == name) return a.data;
    }
    return std::nullopt;
  };
  auto text = found();  // attachments at the head are known from the start
  while (!text && reader.next()) text = found();
  return text ? text : found();
}

std::unique_ptr<Source> open_native_log(std::unique_ptr<std::istream> input, const std::string& name) {
  return std::make_unique<NativeLogSource>(std::move(input), name);
}

std::unique_ptr<Source> open_native_log(const std::filesystem::path& file, const InputConfig&) {
  return open_native_log(opened(file), file.string());
}

}  // namespace isobath