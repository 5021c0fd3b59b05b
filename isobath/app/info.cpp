#include <cstdio>
#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/io/open.hpp>
#include <isobath/runtime/inspection.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const SourceReport& report, const Inspection& facts) {
  ordered_json json{{"format", report.format}, {"bytes", report.bytes_total}, {"bytes_skipped", report.bytes_skipped}};
  for (const auto& [key, value] : report.details) json["details"][key] = value;
  for (const StreamFacts& s : facts.streams) {
    json["streams"].push_back({{"name", s.name},
                               {"events", s.events},
                               {"first", to_text(s.first)},
                               {"last", to_text(s.last)},
                               {"rate_hz", s.rate()},
                               {"median_interval_s", s.median_interval_s},
                               {"gaps", s.gaps},
                               {"longest_gap_s", s.longest_gap_s},
                               {"steps_back", s.backwards}});
  }
  for (const PingGeometry& g : facts.geometries) {
    json["geometries"].push_back(
        {{"beams", g.beams}, {"bins", g.bins}, {"start_m", g.start_m}, {"end_m", g.end_m}, {"pings", g.pings}});
  }
  json["damage"] = ordered_json::array();
  for (const Damage& d : report.damages) {
    json["damage"].push_back({{"offset", d.offset}, {"bytes", d.bytes}, {"reason", d.reason}});
  }
  json["rejected"] = ordered_json::object();
  for (const auto& [reason, count] : report.rejected) json["rejected"][reason] = count;
  return json;
}

void print(const std::string& input, const SourceReport& report, const Inspection& facts) {
  fmt::print("{}: {}\n", input, report.format);
  for (const auto& [key, value] : report.details) fmt::print("  {:<12} {}\n", key, value);
  for (const StreamFacts& s : facts.streams) {
    fmt::print("  {:<12} {} from {} to {}, {:.2f}/s", s.name, s.events, to_text(s.first), to_text(s.last), s.rate());
    if (s.gaps > 0) {
      fmt::print(", {} gaps, the longest {:.3f} s at {}", s.gaps, s.longest_gap_s, to_text(s.longest_gap_at));
    }
    if (s.backwards > 0) fmt::print(", {} steps back in time", s.backwards);
    fmt::print("\n");
  }
  for (const PingGeometry& g : facts.geometries) {
    fmt::print("  {:<12} {} beams x {} bins, {:.3f} .. {:.3f} m ({} pings)\n", "geometry", g.beams, g.bins, g.start_m,
               g.end_m, g.pings);
  }
  if (!facts.geometries.empty()) {
    fmt::print("  {:<12} azimuth {:.2f} .. {:.2f} deg, beam {:.2f} x {:.1f} deg, intensity {:g} .. {:g} of {:g}\n",
               "beams", facts.azimuth_min_deg, facts.azimuth_max_deg, facts.beam_width_deg, facts.beam_height_deg,
               facts.intensity_min, facts.intensity_max, facts.full_scale);
  }
  for (const auto& [reason, count] : report.rejected) fmt::print("  {:<12} {} x {}\n", "rejected", count, reason);
  for (const Damage& d : report.damages)
    fmt::print("  {:<12} {} bytes at {}: {}\n", "damage", d.bytes, d.offset, d.reason);
}

}  // namespace

Action add_info(CLI::App& program) {
  struct Options {
    ConfigOptions config;
    std::string input;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("info", "What is in a file: streams, rates, gaps, damage");
  command->add_option("FILE", options->input, "Log, or folder of frames")->required();
  command->add_flag("--json", options->json, "One JSON object instead of text");
  options->config.add_to(*command);
  return [options] {
    const auto source = open_source(options->input, options->config.read().input);
    ProgressLine progress;
    const Inspection facts = inspect(*source, [&](std::uint64_t events) {
      progress.show(source->report().bytes_read, source->report().bytes_total, events);
    });
    progress.clear();
    if (options->json) {
      fmt::print("{}\n", to_json(source->report(), facts).dump(2, ' ', false, ordered_json::error_handler_t::replace));
    } else {
      print(options->input, source->report(), facts);
    }
    return kSuccess;
  };
}

}  // namespace isobath::app
