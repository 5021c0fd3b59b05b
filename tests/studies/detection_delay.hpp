// The page docs/detection-delay.md, made of what the mapper does.
#pragma once

#include <isobath/studies/detection_delay.hpp>

namespace isobath::test {

/// A row of the table.
std::string row_of(const DetectionDelay& delay);
std::string delay_page(const std::vector<DetectionDelay>& rows);

}  // namespace isobath::test
