// The records of a frame.
#pragma once

#include <isobath/server/web_session.hpp>
#include <tests/support/display_records.hpp>

namespace isobath::test {

inline std::vector<Record> records_of(const WebFrame& frame) {
  return records_of((frame.shared ? *frame.shared : std::string()) + frame.own);
}

}  // namespace isobath::test
