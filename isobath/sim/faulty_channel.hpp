// FaultyChannel: the readings of one source with the faults of the source applied (fault_config.hpp). Readings of a
// source without an active fault pass unchanged, bit for bit. Random numbers come from the seed of the schedule and the
// position of the fault in it. One thread; nothing throws.
#pragma once

#include <isobath/base/random.hpp>
#include <isobath/base/time.hpp>
#include <isobath/sim/faults.hpp>
#include <isobath/sim/navigation_sensors.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// Applies the faults of one source to its readings. T: NavReading, RangeReading, Navigation or Ping; the `storage` of
/// a Ping must own its samples. The schedule must outlive the channel.
template <class T>
class FaultyChannel {
 public:
  FaultyChannel(const FaultSchedule& schedule, const std::string& source);

  /// Adds a reading that the sensor has made at `now`.
  void push(Time now, T reading);
  /// The next reading that has arrived by `now`, oldest arrival first; empty: none left. Call it also without a push,
  /// since delayed readings become due on their own.
  std::optional<T> pop(Time now);

 private:
  struct Fault {
    std::size_t index;  ///< in the schedule
    Random random;
    std::optional<Time> last_passed = {};
    std::optional<T> held = {};
  };
  struct Waiting {
    Time arrival;
    T reading;
  };
  /// False: the reading is lost.
  bool apply(Fault& fault, Time since, Time now, T& reading, Duration& delay);

  const FaultSchedule* schedule_;
  std::vector<Fault> faults_;
  std::optional<T> last_good_;
  std::vector<Waiting> waiting_;  ///< in order of arrival
};

extern template class FaultyChannel<NavReading>;
extern template class FaultyChannel<RangeReading>;
extern template class FaultyChannel<Navigation>;
extern template class FaultyChannel<Ping>;

}  // namespace isobath
