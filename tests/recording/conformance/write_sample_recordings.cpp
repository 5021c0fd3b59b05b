// Writes <folder>/whole.mcap: half a minute of a simulated mission with everything that a recording can hold, numbers
// that JSON lacks among it; cut.mcap, the same without its end; and expected.json: messages by topic, -1: some.
#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/display/display_bytes.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/map/voxel/voxel_blocks.hpp>
#include <isobath/recording/run_recorder.hpp>
#include <limits>
#include <tests/support/mission_runs.hpp>

namespace isobath {
namespace {

/// Tells the recorder of all that happens, and counts.
class Recording : public OnboardObserver {
 public:
  explicit Recording(RunRecorder& recorder) : recorder_(recorder) {}
  void on_event(const Event& event) override {
    recorder_.on_event(event);
    time_ = time_of(event);
    fixes += std::holds_alternative<Navigation>(event) ? 1 : 0;
    pings += std::holds_alternative<Ping>(event) ? 1 : 0;
  }
  void on_fix(const Navigation& fix) override { recorder_.on_fix(fix); }
  void on_ping(const PosedPing& ping) override { recorder_.on_ping(ping); }
  void on_scan(const ScanResult& scan) override { recorder_.on_scan(scan); }
  void on_setpoint(Time time, const Setpoint& setpoint) override {
    recorder_.setpoint(time, setpoint);
    show();
  }
  Time time() const { return time_; }

  int fixes = 0, pings = 0;

 private:
  /// One block of voxels that grows, and a line of text.
  void show() {
    ++shown_;
    const std::uint32_t count = shown_ / 50 % 100;
    std::vector<std::uint8_t> shades(VoxelBlocks::kVolume);
    std::fill_n(shades.begin(), count, std::uint8_t{0x7f});
    DisplayBytes voxels;
    voxels.add(0.25F).add(16).add(-32).add(8).add(count).append_packed(shades);
    items_.set(DisplayKind::kVoxels, 3, time_, voxels.take());
    items_.set(DisplayKind::kVehicle, 0, time_, std::string(80, static_cast<char>(shown_)));
    recorder_.sample(time_, items_);
  }

  RunRecorder& recorder_;
  DisplayState items_;
  Time time_;
  int shown_ = 0;
};

template <std::size_t... kType>
void say_one_of_each(RunRecorder& recorder, Time time, std::index_sequence<kType...>) {
  std::uint64_t number = 1'000'000;
  (recorder.on_message({number++, time, "somebody \"quoted\" \xff", Message(std::in_place_index<kType>)}), ...);
}

void write_recordings(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  Scenario scenario = test::scenario_of("simulated_mission_1");
  LoopRequest request;
  request.configuration.simulation.duration_s = 30;
  const MissionSetup setup = setup_of(scenario);
  RunRecorder recorder(folder / "whole.mcap", request.configuration);
  recorder.describe(Simulator(scenario.scene, {}), "[scene]\n");
  recorder.describe(setup);
  recorder.locate({1.5, 103.8});
  const auto executor = make_serial_helm(setup, request.configuration);
  executor->show_messages_to([&recorder](const Envelope& envelope) { recorder.on_message(envelope); });
  Recording recording(recorder);
  request.observers.push_back(&recording);
  run_closed_loop(scenario, *executor, request);
  std::map<std::string, int> expected{{"/navigation", recording.fixes}, {"/ping", recording.pings}};
  say_one_of_each(recorder, recording.time(), std::make_index_sequence<kMessageTypes>());
  HelmOrder order;
  order.setpoint.depth = std::numeric_limits<double>::quiet_NaN();
  recorder.on_message({2, recording.time(), "pilot", order});
  recorder.close();
  if (!recorder.problem().empty()) throw std::runtime_error(recorder.problem());

  for (const char* topic :
       {"/messages", "/display", "/display/whole", "/setpoint", "/foxglove/tf", "/foxglove/pose", "/foxglove/location",
        "/foxglove/points", "/foxglove/sonar", "/foxglove/occupancy", "/foxglove/obstacles", "/foxglove/plan",
        "/foxglove/track", "/foxglove/voxels", "/foxglove/log"}) {
    expected[topic] = -1;
  }
  std::string text;
  for (const auto& [topic, count] : expected) {
    text += fmt::format("{}\"{}\": {}", text.empty() ? "{" : ", ", topic, count);
  }
  write_whole_file(folder / "expected.json", text + "}\n");
  auto bytes = read_whole_file(folder / "whole.mcap", 1 << 30);
  bytes.resize(bytes.size() * 6 / 10);
  write_whole_file(folder / "cut.mcap", bytes);
}

}  // namespace
}  // namespace isobath

int main(int count, char** arguments) {
  if (count != 2) return 2;
  try {
    isobath::write_recordings(arguments[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
