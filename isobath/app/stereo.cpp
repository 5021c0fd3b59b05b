#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/settings_json.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/stereo/chessboard_calibration.hpp>
#include <isobath/studies/stereo_study.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

namespace isobath::app {
namespace {

using Clock = std::chrono::steady_clock;  // for timings only; no result depends on it

struct StereoOptions {
  StereoRequest request;
  SettingOptions config;
  std::filesystem::path out = "out/stereo";
  std::vector<std::string> pictures, calibration;
  Chessboard board;
  std::string corners = "9x6";
  bool calibrate = false, format = false, show_settings = false, json = false;
};

struct Timing {
  double match_ms = 0;
  double cpu_ms = 0;
};

nlohmann::ordered_json ranges_json(const RangeScore& score) {
  return {{"pixels", score.pixels},         {"bias", score.bias},
          {"axis_bias", score.axis_bias},   {"median_error", score.median_error},
          {"within_5cm", score.within_5cm}, {"usable_range_m", score.usable_range_m}};
}

nlohmann::ordered_json study_json(const StereoPair& pair, const StereoStudy& study, const Timing& timing) {
  nlohmann::ordered_json json{{"width", pair.left.width},
                              {"height", pair.left.height},
                              {"match_ms", timing.match_ms},
                              {"match_cpu_ms", timing.cpu_ms}};
  if (!study.motion) {
    for (int i = 0; i < kPixelStates; ++i) {
      const auto state = static_cast<PixelState>(i);
      json["shares"][name_of(state)] = study.map.share_of(state);
    }
  }
  if (study.vertical) {
    json["vertical"] = {{"patches", study.vertical->patches},
                        {"median_px", study.vertical->median_px},
                        {"median_absolute_px", study.vertical->median_absolute_px}};
  }
  if (const auto& s = study.score) {
    json["truth"] = {{"pixels", s->pixels},
                     {"valid", s->valid},
                     {"bad_1", s->bad_1},
                     {"bad_2", s->bad_2},
                     {"wrong_1", s->wrong_1},
                     {"wrong_2", s->wrong_2},
                     {"error_px", s->mean_error_px},
                     {"hidden", s->hidden},
                     {"hidden_flagged", s->hidden_flagged}};
  }
  json["points"] = study.points.size();
  json["readings"] = study.readings;
  if (study.ranges) json["ranges"] = ranges_json(*study.ranges);
  if (study.ranges_off_focus) json["ranges_off_focus"] = ranges_json(*study.ranges_off_focus);
  return json;
}

void print_ranges(const char* name, const RangeScore& score) {
  fmt::print(
      "{}: {} pixels, depth {:+.1f} % of the true one (median; {:+.1f} % near the axis), off by {:.1f} % "
      "(median), {:.1f} % within 5 cm\n",
      name, score.pixels, 100 * score.bias, 100 * score.axis_bias, 100 * score.median_error, 100 * score.within_5cm);
}

void print_study(const StereoPair& pair, const StereoStudy& study, const Timing& timing) {
  fmt::print("{} x {} pixels, matched in {:.1f} ms ({:.1f} ms of processor time)\n", pair.left.width, pair.left.height,
             timing.match_ms, timing.cpu_ms);
  if (!study.motion) {
    for (int i = 0; i < kPixelStates; ++i) {
      const auto state = static_cast<PixelState>(i);
      fmt::print("{:5.1f} %  {}\n", 100 * study.map.share_of(state), name_of(state));
    }
  }
  if (study.vertical) {
    fmt::print("rows miss each other by {:.2f} pixels (median of {} patches)\n", study.vertical->median_absolute_px,
               study.vertical->patches);
  }
  if (const auto& s = study.score) {
    fmt::print(
        "against the truth, {} pixels that both cameras see: {:.1f} % valid; off by more than 1 pixel or not "
        "valid {:.2f} %, more than 2 {:.2f} %; of the valid ones {:.2f} % and {:.2f} %\n",
        s->pixels, 100 * s->valid, 100 * s->bad_1, 100 * s->bad_2, 100 * s->wrong_1, 100 * s->wrong_2);
    fmt::print("of {} pixels that only the left camera sees, {:.1f} % are marked\n", s->hidden,
               100 * s->hidden_flagged);
  }
  if (study.points.empty()) fmt::print("no ranges: the pair has no calibration\n");
  if (!study.points.empty()) fmt::print("{} points, {} range readings\n", study.points.size(), study.readings);
  if (study.ranges) print_ranges("against the scene", *study.ranges);
  if (study.ranges_off_focus) print_ranges("more than 10 degrees off the focus of expansion", *study.ranges_off_focus);
  if (study.ranges) fmt::print("usable to {:.1f} m\n", study.ranges->usable_range_m);
}

/// 3 to 100; 0: no such number.
int corners_in(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && number >= 3 && number <= 100 ? number : 0;
}

/// Pictures of a chessboard: first those of the left camera, then those of the right one in the same order.
int calibrate_pair(StereoOptions& options) {
  const std::size_t pairs = options.pictures.size() / 2;
  if (options.pictures.size() % 2 != 0 || pairs < 3)
    throw Error(fmt::format("{} pictures are no pairs", options.pictures.size()), {}, "at least 3 pairs",
                "first all of the left camera, then all of the right one");
  Chessboard& board = options.board;
  const std::size_t by = std::min(options.corners.find('x'), options.corners.size());
  board.columns = corners_in(std::string_view(options.corners).substr(0, by));
  board.rows = corners_in(std::string_view(options.corners).substr(std::min(by + 1, options.corners.size())));
  if (board.columns == 0 || board.rows == 0)
    throw Error("\"" + options.corners + "\" is no size of a board", {}, "inner corners, such as 9x6");
  check_output_folder(options.out, "--out");
  std::vector<CameraImage> left, right;
  for (std::size_t i = 0; i < pairs; ++i) {
    left.push_back(read_camera_image(options.pictures[i]));
    right.push_back(read_camera_image(options.pictures[pairs + i]));
  }
  const ChessboardCalibration found = calibrate_chessboard(left, right, board);
  make_folder(options.out);
  write_whole_file(options.out / "rig.toml", stereo_calibration_toml(found.calibration));
  const double baseline = found.calibration.p_RL.norm();
  if (options.json) {
    nlohmann::ordered_json json{
        {"pairs", pairs}, {"used", found.used}, {"rms_px", found.rms_px}, {"baseline_m", baseline}};
    add_files(json, options.out, {"rig.toml"});
    print_json(json);
    return kSuccess;
  }
  fmt::print(
      "{} of {} pairs show the whole board; corners off by {:.2f} pixels (rms); baseline {:.4f} m\n"
      "written to {}: rig.toml\n",
      found.used, pairs, found.rms_px, baseline, options.out.string());
  return kSuccess;
}

int see(StereoOptions& options) {
  StereoRequest& request = options.request;
  std::vector<Section> all = sections(request);
  options.config.read_into(all);
  if (options.show_settings) {
    print_settings(sections(request), options.json);
    return kSuccess;
  }
  if (options.format) {
    fmt::print("{}", stereo_calibration_template());
    return kSuccess;
  }
  if (options.calibrate) return calibrate_pair(options);
  if (request.scene.empty() != (options.pictures.size() == 2))
    throw Error("needs two pictures, or --scene", {}, {}, "isobath stereo LEFT RIGHT");
  if (options.pictures.size() == 2) {
    request.left = options.pictures[0];
    request.right = options.pictures[1];
  }
  request.calibration.assign(options.calibration.begin(), options.calibration.end());
  check_output_folder(options.out, "--out");
  const StereoPair pair = prepare_pair(request);
  Timing timing;
  const auto start = Clock::now();
  const std::clock_t cpu = std::clock();
  DisparityMap map;
  if (!pair.calibration.moves) DenseMatcher(matching_of(request), request.plain).match(pair.left, pair.right, map);
  StereoStudy study;
  if (pair.calibration.moves) study = study_motion(pair, request);
  timing.match_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  timing.cpu_ms = 1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  if (!pair.calibration.moves) study = study_pair(pair, std::move(map), request);
  const auto files = write_stereo(pair, study, options.out);
  if (options.json) {
    nlohmann::ordered_json json = study_json(pair, study, timing);
    add_files(json, options.out, files);
    print_json(json);
    return kSuccess;
  }
  print_study(pair, study, timing);
  fmt::print("written to {}:", options.out.string());
  for (const auto& file : files) fmt::print(" {}", file.string());
  fmt::print("\n");
  return kSuccess;
}

}  // namespace

Action add_stereo(CLI::App& program) {
  auto options = std::make_shared<StereoOptions>();
  StereoRequest& request = options->request;
  CLI::App* command = program.add_subcommand(
      "stereo", "Ranges from a pair of pictures: two cameras, or one that moves; from files or from a scene");
  command->add_option("PICTURES", options->pictures, "The left and the right picture (.png, .jpg)")
      ->type_name("LEFT RIGHT")
      ->expected(0, 1000)
      ->check(reads());
  command->add_option("--calibration", options->calibration, "Cameras: TOML, or the YAML files of OpenCV")
      ->type_name("FILE")
      ->check(reads());
  command->add_option("--truth", request.truth, "True disparities of the left picture (.pfm, or grey .png)")
      ->type_name("FILE")
      ->check(reads());
  command->add_option("--truth-scale", request.truth_scale, "Pixels of disparity per grey level of a .png")
      ->capture_default_str()
      ->check(number(1e-6, 1e6));
  command->add_option("--scene", request.scene, "Simulate the pair in this scene (.toml)")
      ->type_name("FILE")
      ->check(reads())
      ->group("Simulation");
  command->add_option("--seed", request.seed, "Seed of texture and noise")
      ->capture_default_str()
      ->check(whole(0, 1'000'000))
      ->group("Simulation");
  command
      ->add_flag("--calibrate", options->calibrate,
                 "Find the calibration from pictures of a chessboard: all left ones, then all right ones")
      ->group("Calibration");
  command->add_option("--board", options->corners, "Inner corners of the board")
      ->capture_default_str()
      ->type_name("COLUMNSxROWS")
      ->group("Calibration");
  command->add_option("--square", options->board.square_m, "Side of its squares, m")
      ->capture_default_str()
      ->check(number(1e-4, 10))
      ->group("Calibration");
  command->add_flag("--in-air", request.in_air, "Range as if there were no port before the cameras");
  command->add_flag("--plain", request.plain, "Match with plain loops, without vectors: the same result");
  command->add_flag("--format", options->format, "Print the format of a calibration, explained, and exit")
      ->group("Output");
  add_output_folder(*command, options->out, "Folder for pictures and points", "--out,-o");
  add_json_flag(*command, options->json);
  command->add_flag("--settings", options->show_settings, "Print all settings, explained, and exit")->group("Output");
  const auto names = [] {
    StereoRequest any;
    return setting_names(sections(any));
  };
  options->config.add_to(*command, names, "stereo.disparities=128; isobath stereo --settings lists all");
  add_example(*command, "stereo left.png right.png --calibration rig.toml --out out/stereo");
  add_example(*command, "stereo --calibrate left*.jpg right*.jpg --square 0.025 --out out/rig");
  add_example(*command, "stereo left.png right.png --truth disparity.pfm --set stereo.window=9 --json");
  return [options] { return see(*options); };
}

}  // namespace isobath::app
