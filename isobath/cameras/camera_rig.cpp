#include <fmt/format.h>
#include <isobath/cameras/camera_rig.hpp>

namespace isobath {

std::vector<Field> fields(CamerasConfig& c) {
  std::vector<Field> all = fields(c.ranger);
  for (Field& field : fields(c.navigation)) all.push_back(std::move(field));
  return all;
}

std::optional<Swath> CameraRig::on_pair(const CameraPair& pair) {
  ++pairs_;
  fault_ = ranger_.update(pair);
  if (fault_ != PairFault::kNone) return {};
  ++ranged_;
  ranges_ += ranger_.swath().soundings.size();
  navigation_.on_pair(ranger_, pair.time);
  return ranger_.swath();
}

void CameraRig::describe(const std::string& name, std::map<std::string, std::string>& details) const {
  details[name] = fmt::format("{} pairs, {} with ranges, {} ranges", pairs_, ranged_, ranges_);
  const CameraNavigation::Counts& n = navigation_.counts();
  if (n.carried == 0) return;
  details[name + " navigation"] =
      fmt::format("{} fixes carried by pictures; the motion of {} of {} pairs was found, {} keys", n.carried, n.moved,
                  n.pairs, n.keys);
}

}  // namespace isobath
