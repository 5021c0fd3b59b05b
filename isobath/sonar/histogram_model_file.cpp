#include <bit>
#include <cmath>
#include <cstring>
#include <isobath/base/error.hpp>
#include <isobath/base/text_file.hpp>
#include <isobath/sonar/histogram_model.hpp>
#include <nlohmann/json.hpp>
#include <zlib.h>

namespace isobath {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "counts are written as they are in memory");

constexpr std::string_view kMagic("isobath intensity histograms\n");
constexpr std::uint32_t kFileVersion = 1;
constexpr std::size_t kMaxHeader = std::size_t{4} << 20;
constexpr const char* kWrittenBy = "a histogram model is written by `isobath calibrate`";

std::uint32_t crc_of_model(std::string_view bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string u32(std::uint32_t value) { return {reinterpret_cast<const char*>(&value), sizeof value}; }

std::uint32_t u32_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Reads the keys of the header; each must exist and have its type.
class HeaderReader {
 public:
  HeaderReader(std::string_view text, const std::string& file) : file_(file) {
    json_ = Json::parse(text, nullptr, false);
    if (!json_.is_object()) throw Error("the header is not JSON", {file, {}, {}, {}, {}}, {}, kWrittenBy);
  }

  [[nodiscard]] double number(const char* key) const {
    const Json& value = at(key);
    if (!value.is_number()) fail(key, "a number");
    return value.get<double>();
  }
  [[nodiscard]] int integer(const char* key, int most) const {
    const double value = number(key);
    if (!(value >= 0 && value <= most && value == std::floor(value))) fail(key, "a whole number, not negative");
    return static_cast<int>(value);
  }
  [[nodiscard]] std::string text(const char* key) const {
    if (!at(key).is_string()) fail(key, "a text");
    return at(key).get<std::string>();
  }
  [[nodiscard]] std::vector<double> numbers(const char* key) const {
    if (!at(key).is_array()) fail(key, "a list of numbers");
    std::vector<double> values;
    for (const Json& value : at(key)) {
      if (!value.is_number()) fail(key, "a list of numbers");
      values.push_back(value.get<double>());
    }
    return values;
  }

 private:
  [[nodiscard]] const Json& at(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) throw Error("missing", {file_, {}, {}, {}, key}, {}, kWrittenBy);
    return *found;
  }
  [[noreturn]] void fail(const char* key, const char* allowed) const {
    throw Error("wrong type", {file_, {}, {}, {}, key}, allowed);
  }

  Json json_;
  std::string file_;
};

std::string header_of(const HistogramModel& model) {
  const HistogramConfig& c = model.config;
  Json azimuths = Json::array();
  for (const Angle a : model.azimuth) azimuths.push_back(a.degrees());
  const Json header = {{"source", model.source},
                       {"levels", c.levels},
                       {"level_width", c.level_width},
                       {"smoothing", c.smoothing},
                       {"drop_share", c.drop_share},
                       {"pool_bins", c.pool_bins},
                       {"pool_beams", c.pool_beams},
                       {"most_evidence", c.max_log_odds},
                       {"start_m", model.window.start_m},
                       {"bin_m", model.window.bin_m},
                       {"bins", model.window.bins},
                       {"full_scale", model.full_scale},
                       {"background_pings", model.background_pings},
                       {"marked_pings", model.marked_pings},
                       {"azimuth_deg", std::move(azimuths)},
                       {"object", model.object}};
  return header.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

HistogramModel model_of(const HeaderReader& header) {
  constexpr int kMax = 1 << 30;
  HistogramModel model;
  model.source = header.text("source");
  model.config = {header.integer("levels", kMax), header.number("level_width"),      header.number("smoothing"),
                  header.number("drop_share"),    header.integer("pool_bins", kMax), header.integer("pool_beams", kMax),
                  header.number("most_evidence")};
  model.window = {header.number("start_m"), header.number("bin_m"), header.integer("bins", kMax)};
  model.full_scale = header.number("full_scale");
  model.background_pings = header.integer("background_pings", kMax);
  model.marked_pings = header.integer("marked_pings", kMax);
  for (const double a : header.numbers("azimuth_deg")) model.azimuth.push_back(Angle::degrees(a));
  for (const double n : header.numbers("object")) {
    if (!(n >= 0 && n <= 1e15)) throw Error("out of range", {{}, {}, {}, {}, "object"}, "counts of samples");
    model.object.push_back(static_cast<std::uint64_t>(n));
  }
  return model;
}

}  // namespace

std::string write_histogram_model(const HistogramModel& model) {
  model.check();
  const std::string header = header_of(model);
  std::string bytes(kMagic);
  bytes += u32(kFileVersion) + u32(static_cast<std::uint32_t>(header.size())) + header;
  bytes.append(reinterpret_cast<const char*>(model.noise.data()), model.noise.size() * sizeof(std::uint16_t));
  return bytes + u32(crc_of_model(bytes));
}

HistogramModel read_histogram_model(std::string_view bytes, const std::string& file) {
  const auto refuse = [&](const char* problem, const std::string& allowed = {}) {
    throw Error(problem, {file, {}, {}, {}, {}}, allowed, kWrittenBy);
  };
  if (!bytes.starts_with(kMagic)) refuse("not a histogram model");
  const std::size_t fixed = kMagic.size() + 8;
  if (bytes.size() < fixed + 4) refuse("ends within its header");
  if (u32_at(bytes, kMagic.size()) != kFileVersion) refuse("unknown version", std::to_string(kFileVersion));
  const std::size_t header_bytes = u32_at(bytes, kMagic.size() + 4);
  if (header_bytes > kMaxHeader || header_bytes > bytes.size() - fixed - 4) refuse("ends within its header");
  if (crc_of_model(bytes.substr(0, bytes.size() - 4)) != u32_at(bytes, bytes.size() - 4)) {
    refuse("damaged: wrong checksum");
  }
  HistogramModel model = model_of(HeaderReader(bytes.substr(fixed, header_bytes), file));
  const std::string_view counts = bytes.substr(fixed + header_bytes, bytes.size() - fixed - header_bytes - 4);
  if (counts.size() % sizeof(std::uint16_t) != 0) refuse("half a count at its end");
  model.noise.resize(counts.size() / sizeof(std::uint16_t));
  if (!counts.empty()) std::memcpy(model.noise.data(), counts.data(), counts.size());
  model.check(file);
  return model;
}

HistogramModel load_histogram_model(const std::filesystem::path& path) {
  constexpr std::size_t kMaxMib = 512;  // histograms of single pixels are large
  return read_histogram_model(text_of_file(path.string(), kMaxMib), path.string());
}

}  // namespace isobath
