// MissionDesk: what pages order while a run goes on, and what they plan for it.
//
//   MissionDesk desk;                    // outlives the run
//   desk.open(setup, config);            // the run: before its first event
//   desk.on_message(envelope);           // the run: every message of its agents
//   if (auto order = desk.next()) ...    // the run: before each event
//   desk.preview(draft, page);           // a page: the answer comes from preview_text
//   desk.send(draft, "the page at ...");
//
// A preview is planned in a thread of its own, from what the agents have last been told, so that neither the run nor
// the server waits: one at a time, and after kMaxPreview the rest of its legs has no route. Any thread may call.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <future>
#include <isobath/mission/agents/mission_preview.hpp>
#include <isobath/mission/plan/mission_draft.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/run/mission_in_force.hpp>
#include <mutex>
#include <optional>
#include <string>

namespace isobath {

class MissionDesk {
 public:
  static constexpr std::chrono::seconds kMaxPreview{5};

  MissionDesk() = default;
  MissionDesk(const MissionDesk&) = delete;
  MissionDesk& operator=(const MissionDesk&) = delete;
  /// Waits for the leg that is being planned.
  ~MissionDesk();

  // The run.
  /// Before this, and in a run that does not steer, orders are refused.
  void open(const MissionSetup& setup, const MissionConfig& config);
  void on_message(const Envelope& envelope);
  /// The order that waits, if there is one.
  [[nodiscard]] std::optional<OperatorCommand> next();
  /// The run is over: from now on orders are refused.
  void close();

  // The pages. Each returns why it refuses; empty: it does not.
  [[nodiscard]] std::string order(OperatorCommand command);
  [[nodiscard]] std::string send(const MissionDraft& draft, const std::string& by);
  /// `page`: a number of the page, by which it asks for the answer.
  [[nodiscard]] std::string preview(const MissionDraft& draft, std::uint64_t page);
  /// The answer to the preview of this page as JSON (docs/live-page.md), once.
  [[nodiscard]] std::optional<std::string> preview_text(std::uint64_t page);
  /// Notes who has command; the order never waits for others.
  void hand_over(const std::string& sentence);

 private:
  /// The plan of the draft. Throws Error.
  [[nodiscard]] MissionPlan checked(const MissionDraft& draft) const;
  [[nodiscard]] std::string planned(const MissionDraft& draft) const;

  MissionInForce in_force_;
  mutable std::mutex mutex_;  ///< guards what follows
  std::optional<MissionConfig> config_;
  VehicleParameters vehicle_;
  MissionKnowledge known_;
  std::deque<OperatorCommand> orders_;
  bool over_ = false, planning_ = false;
  std::uint64_t page_ = 0;             ///< whose preview it is
  std::optional<std::string> answer_;  ///< to that page, until it is fetched

  std::atomic<bool> stop_ = false;
  std::future<void> worker_;  ///< last, because it uses all other members; only the thread of the pages sets it
};

}  // namespace isobath
