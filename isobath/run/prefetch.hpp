// PrefetchSource: reads ahead in a thread of its own, in the order of the input, so that decoding and mapping overlap.
// The events and their order are the same as without it.
#pragma once

#include <condition_variable>
#include <isobath/event/event.hpp>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace isobath {

class PrefetchSource : public Source {
 public:
  explicit PrefetchSource(std::unique_ptr<Source> inner);
  ~PrefetchSource() override;

  std::optional<Event> next() override;
  /// While reading, only bytes read and origin are up to date; the report is complete at the end.
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  static constexpr std::size_t kBatch = 64, kBatchesAhead = 4;
  void read_ahead();

  std::unique_ptr<Source> inner_;
  SourceReport report_;
  std::vector<Event> batch_;
  std::size_t at_ = 0;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::vector<Event>> ready_;
  std::uint64_t bytes_read_ = 0;
  std::optional<GeoOrigin> origin_;
  bool done_ = false;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace isobath
