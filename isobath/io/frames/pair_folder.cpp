#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/delimited_text.hpp>
#include <isobath/io/frames/camera_pictures.hpp>
#include <isobath/io/frames/frame_folder.hpp>
#include <isobath/io/frames/pair_reader.hpp>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

namespace isobath {
namespace {

namespace fs = std::filesystem;

/// Names by number where they are numbers, else by text: "9" before "10".
struct ByNumber {
  bool operator()(const std::string& a, const std::string& b) const {
    std::uint64_t x = 0, y = 0;
    const bool numbers = read(a, x) && read(b, y);
    return numbers && x != y ? x < y : a < b;
  }
  static bool read(const std::string& text, std::uint64_t& value) {
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    return problem == std::errc() && end == text.data() + text.size();
  }
};
using Pictures = std::map<std::string, fs::path, ByNumber>;

/// What * stands for in a name; empty: the name does not fit.
std::string star_of(std::string_view name, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  const std::string_view head = pattern.substr(0, star), tail = pattern.substr(star + 1);
  if (name.size() <= head.size() + tail.size() || !name.starts_with(head) || !name.ends_with(tail)) return {};
  return std::string(name.substr(head.size(), name.size() - head.size() - tail.size()));
}

Pictures pictures_of(const fs::path& folder, const std::string& pattern) {
  Pictures found;
  std::error_code problem;
  for (fs::directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
    std::error_code unknown;
    const std::string star = star_of(at->path().filename().string(), pattern);
    if (!star.empty() && at->is_regular_file(unknown)) found.emplace(star, at->path());
  }
  return found;
}

/// The times of a CSV file, by name.
std::map<std::string, Time> times_of(const std::string& file) {
  DelimitedText table = open_delimited_text(file);
  const int name = table.required("name"), t_s = table.column("t_s"), time_us = table.column("time_us");
  if ((t_s < 0) == (time_us < 0)) table.refuse_names("one column of time is needed", "t_s or time_us");
  std::map<std::string, Time> times;
  while (table.next()) {
    if (t_s >= 0) {
      const auto value = table.number(t_s);
      if (value && representable_seconds(*value)) times.emplace(table.cell(name), Time{seconds(*value)});
      continue;
    }
    const auto value = table.integer(time_us);
    if (value && std::abs(*value) < std::int64_t{9'000'000'000'000'000})
      times.emplace(table.cell(name), Time{std::chrono::microseconds(*value)});
  }
  return times;
}

std::uint64_t size_of_file(const fs::path& file) {
  std::error_code unknown;
  const auto size = fs::file_size(file, unknown);
  return unknown ? 0 : size;
}

class PairFolder final : public PairReader {
 public:
  PairFolder(const fs::path& folder, const PairRig& rig, SourceReport& report) {
    const Pictures left = pictures_of(folder, rig.left), right = pictures_of(folder, rig.right);
    std::map<std::string, Time> times;
    if (!rig.times.empty()) times = times_of(rig.times);
    for (const auto& [name, picture] : left) {
      const auto other = right.find(name);
      if (other == right.end()) continue;
      const auto time = time_of_pair(name, rig, times);
      if (time) pairs_.push_back({*time, picture, other->second});
      if (!time) ++report.rejected["pair whose time is not stated"];
    }
    std::uint64_t lonely = 0;
    for (const auto& [name, picture] : left) lonely += right.contains(name) ? 0 : 1;
    for (const auto& [name, picture] : right) lonely += left.contains(name) ? 0 : 1;
    if (lonely > 0) report.rejected["picture without its partner"] += lonely;
    if (pairs_.empty()) {
      throw Error(fmt::format("holds no pair of pictures with a time: {} left, {} right", left.size(), right.size()),
                  {folder.string()}, rig.left + " and " + rig.right, "pairs.left and pairs.right name them");
    }
    std::ranges::stable_sort(pairs_, {}, &Named::time);
    report.format = "folder of camera pairs";
    report.details["pairs"] = std::to_string(pairs_.size());
    for (const Named& pair : pairs_) report.bytes_total += size_of_file(pair.left) + size_of_file(pair.right);
  }

  std::optional<CameraPair> next(SourceReport& report) override {
    while (at_ < pairs_.size()) {
      const Named& named = pairs_[at_++];
      CameraPair pair{named.time, {}, {}};
      const bool both = read(named.left, pair.left, report) && read(named.right, pair.right, report);
      if (both) return pair;
      ++report.rejected["pair with an unreadable picture"];
    }
    return {};
  }

 private:
  struct Named {
    Time time;
    fs::path left, right;
  };

  std::optional<Time> time_of_pair(const std::string& name, const PairRig& rig,
                                   const std::map<std::string, Time>& times) const {
    if (!rig.times.empty()) {
      const auto found = times.find(name);
      return found == times.end() ? std::nullopt : std::optional(found->second);
    }
    if (rig.rate_hz <= 0) return time_of_frame(name + ".png");
    return Time{seconds(rig.start_s + static_cast<double>(pairs_.size()) / rig.rate_hz)};
  }

  static bool read(const fs::path& file, CameraImage& image, SourceReport& report) {
    const std::uint64_t bytes = size_of_file(file);
    const std::uint64_t from = std::exchange(report.bytes_read, report.bytes_read + bytes);
    try {
      image = read_camera_image(file);
      return true;
    } catch (const Error&) {
      report.add_damage(from, bytes, "unreadable picture " + file.filename().string());
      return false;
    }
  }

  std::vector<Named> pairs_;
  std::size_t at_ = 0;
};

}  // namespace

bool looks_like_pair_folder(const fs::path& folder) {
  std::error_code unknown;
  return fs::is_regular_file(folder / PairRig::kFile, unknown);
}

std::unique_ptr<PairReader> open_pair_folder(const fs::path& folder, const PairRig& rig, SourceReport& report) {
  return std::make_unique<PairFolder>(folder, rig, report);
}

}  // namespace isobath
