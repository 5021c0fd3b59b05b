// WaterParts: assembles the water column of a Kongsberg ping from its k records (Kongsberg 160692). Records of one ping
// share serial number, counter and time; each states its own number and the number of records. The records of two heads
// alternate. Memory is bounded: one ping per head, kMaxHeads heads, kMaxParts parts. Refusals are counted in the
// report.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/formats/kongsberg/kongsberg_water.hpp>

namespace isobath {

class WaterParts {
 public:
  static constexpr std::size_t kMaxHeads = 8, kMaxParts = 256;

  /// `report` must outlive this object.
  explicit WaterParts(SourceReport& report) : report_(report) {}

  /// Takes a record, from its length field to its last sample. Returns the water column, without mount and widths, if
  /// this was its last part; it is valid until the next call.
  WaterRecord* add(const RecordView& record, Time time);
  /// Ends the input: counts the pings that lack parts.
  void finish();

 private:
  struct Beam {
    double to_port_deg;
    std::size_t first, at, count;  ///< `at`: offset of its samples in `samples`
    double tilt_deg;
  };
  struct Waiting {
    std::uint16_t serial, counter;
    Time time;
    std::vector<std::vector<Beam>> parts;  ///< by number; empty: not yet received
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
