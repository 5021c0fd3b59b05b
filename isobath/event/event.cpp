#include <isobath/event/event.hpp>

namespace isobath {

void SourceReport::add_damage(std::uint64_t offset, std::uint64_t bytes, const std::string& reason) {
  if (bytes == 0) return;
  bytes_skipped += bytes;
  if (!damages.empty() && damages.back().offset + damages.back().bytes == offset && damages.back().reason == reason) {
    damages.back().bytes += bytes;
  } else if (damages.size() < kMaxDamages) {
    damages.push_back({offset, bytes, reason});
  }
}

void SourceReport::note_setting(const std::string& key, const std::string& value) {
  std::string& noted = details[key];
  const bool other = !noted.empty() && noted != value;
  noted = (other ? "varies, last " : "") + value;
}

}  // namespace isobath
