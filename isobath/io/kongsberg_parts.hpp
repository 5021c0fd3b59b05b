// WaterParts: the water column of a Kongsberg ping out of the k records that it is spread over (Kongsberg 160692). They
// belong together by serial number, counter and time, state how many there are and which one each is, and those of two
// heads alternate. Bounded: one ping a head, kMostHeads heads, kMostParts parts. Refusals are counted in the report.
#pragma once

#include <isobath/io/event.hpp>
#include <isobath/io/kongsberg_water.hpp>

namespace isobath {

class WaterParts {
 public:
  static constexpr std::size_t kMostHeads = 8, kMostParts = 256;

  /// `report` must live as long as this.
  explicit WaterParts(SourceReport& report) : report_(report) {}

  /// A record from its length field to its last sample. The whole, if this was the last part, without mount and widths;
  /// valid until the next call.
  WaterRecord* take(const RecordView& record, Time time);
  /// Nothing follows: pings of which parts are missing are counted.
  void finish();

 private:
  struct Beam {
    double to_port_deg;
    std::size_t first, at, count;  ///< `at`: of its samples in `samples`
    double tilt_deg;
  };
  struct Waiting {
    std::uint16_t serial, counter;
    Time time;
    std::vector<std::vector<Beam>> parts;  ///< by number; empty: not here yet
    std::size_t missing;
    std::vector<std::byte> samples;
  };
  Waiting& waiting_of(const RecordView& record, Time time, std::size_t parts);
  void forget(std::vector<Waiting>::iterator ping);
  void reject(const char* reason) { ++report_.rejected[reason]; }

  SourceReport& report_;
  std::vector<Waiting> waiting_;
  WaterRecord whole_;
};

}  // namespace isobath
