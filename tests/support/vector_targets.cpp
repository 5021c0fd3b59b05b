#include <cstdint>
#include <hwy/targets.h>
#include <isobath/base/error.hpp>
#include <string>
#include <string_view>
#include <tests/support/vector_targets.hpp>

namespace isobath::test {

std::vector<const char*> vector_targets() {
  std::vector<const char*> names;
  for (const auto target : hwy::SupportedAndGeneratedTargets()) names.push_back(hwy::TargetName(target));
  return names;
}

void use_vector_target(const char* name) {
  hwy::SetSupportedTargetsForTest(0);
  std::int64_t wanted = 0;
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    if (std::string_view(hwy::TargetName(target)) == name) wanted = target;
  }
  if (*name != 0 && wanted == 0) throw Error(std::string("this processor has no instruction set ") + name);
  hwy::SetSupportedTargetsForTest(wanted);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace isobath::test
