#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/open_source.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/studies/comparison.hpp>
#include <isobath/studies/comparison_pictures.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using nlohmann::ordered_json;

struct Quantiles {
  double low = 0, median = 0, high = 0;
};
template <class Value>
Quantiles quantiles(const std::vector<StrongestEcho>& echoes, Value value) {
  if (echoes.empty()) return {};
  std::vector<double> v;
  for (const StrongestEcho& e : echoes) v.push_back(value(e));
  std::sort(v.begin(), v.end());
  const auto at = [&](double p) {
    return v[static_cast<std::size_t>(std::lround(p * static_cast<double>(v.size() - 1)))];
  };
  return {at(0.16), at(0.5), at(0.84)};
}

SampleStatistics collect(const std::filesystem::path& input, const CompareRequest& request) {
  std::unique_ptr<Source> source;
  if (is_scene(input)) {
    source = std::make_unique<SimulatedSource>(open_scene(input), request.configuration.simulation, request.threads);
  } else {
    source = open_source(input, request.configuration.input);
  }
  SampleCollector collector(request.configuration.calibration.blanking_m);
  std::uint64_t pings = 0;
  while (const auto event = source->next()) {
    const auto* ping = std::get_if<Ping>(&*event);
    if (!ping || check(*ping) != PingFault::kNone) continue;
    collector.add(*ping);
    if (request.progress) request.progress(source->report(), ++pings);
  }
  SampleStatistics out = collector.finish(input.string());
  out.format = source->report().format;
  return out;
}

double histogram_distance(const SampleStatistics& a, const SampleStatistics& b) {
  const EchoDistribution da(a.levels, a.background), db(b.levels, b.background);
  double most = 0;
  for (double x = 0.5; x < kFullCounts; ++x)
    most = std::max(most, std::abs(da.rate_at_or_above(x) - db.rate_at_or_above(x)));
  return most;
}

std::string short_name(const std::string& name) {
  std::filesystem::path path = name;
  if (!path.has_filename()) path = path.parent_path();
  return path.filename().string();
}

ordered_json levels_json(const RangeLevels& r) {
  return {{"near_m", r.near_m},
          {"far_m", r.far_m},
          {"samples", r.samples},
          {"mean", r.mean},
          {"deviation", r.deviation},
          {"level_16", r.low},
          {"median", r.median},
          {"level_84", r.high},
          {"level_99", r.top},
          {"zeros", r.zeros},
          {"background_mean", r.background},
          {"background_limit", r.background_limit}};
}

ordered_json samples_json(const SampleStatistics& s) {
  ordered_json ranges = ordered_json::array(), fits = ordered_json::array();
  for (const RangeLevels& r : s.ranges) ranges.push_back(levels_json(r));
  for (const NoiseFit& f : s.fits) {
    fits.push_back({{"law", to_text(f.law)},
                    {"location", f.location},
                    {"scale", f.scale},
                    {"shape", f.shape},
                    {"statistic", f.statistic},
                    {"samples", f.samples}});
  }
  const auto spread = [&](auto value) {
    const Quantiles q = quantiles(s.strongest, value);
    return ordered_json{{"low_16", q.low}, {"median", q.median}, {"high_84", q.high}};
  };
  return {{"input", s.name},
          {"format", s.format},
          {"pings", s.pings},
          {"pings_left_out", s.left_out},
          {"scans", s.scans},
          {"blind_m", s.blanking_m},
          {"all", levels_json(s.all)},
          {"spread_over_scans", s.spread_over_scans},
          {"spread_over_cells", s.spread_over_cells},
          {"background",
           {{"share", s.background_share},
            {"mean", s.background_mean},
            {"deviation", s.background_deviation},
            {"fits", fits}}},
          {"bright", {{"share", s.bright_share}, {"over_background_db", s.bright_over_db}}},
          {"brightest", {{"share", kBrightestShare}, {"mean", s.brightest_mean}, {"others", s.brightest_others}}},
          {"strongest_echo",
           {{"level", spread([](const StrongestEcho& e) { return e.level; })},
            {"range_m", spread([](const StrongestEcho& e) { return e.range_m; })},
            {"length_m", spread([](const StrongestEcho& e) { return e.length_m; })},
            {"width_deg", spread([](const StrongestEcho& e) { return e.width.degrees(); })}}},
          {"ranges", ranges}};
}

/// Levels of both recordings in eight intervals of their common range.
std::vector<HtmlReport::Row> range_rows(const CompareOutcome& c) {
  const double near = std::max(c.a.all.near_m, c.b.all.near_m), far = std::min(c.a.all.far_m, c.b.all.far_m);
  std::vector<HtmlReport::Row> rows;
  constexpr int kStretches = 8;
  for (int i = 0; i < kStretches && far > near; ++i) {
    const double from = near + (far - near) * i / kStretches, to = near + (far - near) * (i + 1) / kStretches;
    HtmlReport::Row row{fmt::format("{:.2f} to {:.2f}", from, to)};
    for (const SampleStatistics* s : {&c.a, &c.b}) {
      std::vector<std::uint64_t> counts(static_cast<std::size_t>(s->levels.count()), 0);
      for (const RangeLevels& r : s->ranges) {
        const double middle = (r.near_m + r.far_m) / 2;
        if (middle < from || middle >= to) continue;
        for (std::size_t l = 0; l < counts.size(); ++l) counts[l] += r.counts[l];
      }
      const RangeLevels r = levels_of(s->levels, counts);
      row.push_back(fmt::format("{:.1f}", r.mean));
      row.push_back(fmt::format("{:.1f} ({:.1f} to {:.1f})", r.median, r.low, r.high));
      row.push_back(fmt::format("{:.0f}", r.top));
      row.push_back(fmt::format("{:.0f} %", 100 * r.zeros));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::vector<ComparedValue> compared_values(const CompareOutcome& c) {
  std::vector<ComparedValue> rows;
  const auto add = [&](const std::string& what, auto text) { rows.push_back({what, text(c.a), text(c.b)}); };
  using S = SampleStatistics;
  const auto spread = [](const Quantiles& q, int digits) {
    return fmt::format("{:.{}f} ({:.{}f} to {:.{}f})", q.median, digits, q.low, digits, q.high, digits);
  };
  add("pings; scans", [](const S& s) { return fmt::format("{}; {}", s.pings, s.scans); });
  add("samples of value 0, %", [](const S& s) { return fmt::format("{:.1f}", 100 * s.all.zeros); });
  add("all samples: mean; standard deviation, counts",
      [](const S& s) { return fmt::format("{:.1f}; {:.1f}", s.all.mean, s.all.deviation); });
  add("median (16 to 84 %); 99 %, counts", [](const S& s) {
    return fmt::format("{:.1f} ({:.1f} to {:.1f}); {:.0f}", s.all.median, s.all.low, s.all.high, s.all.top);
  });
  add("spread of a cell from scan to scan (rms), counts",
      [](const S& s) { return s.scans > 1 ? fmt::format("{:.1f}", s.spread_over_scans) : std::string("one scan"); });
  add("spread of the mean image from cell to cell, counts",
      [](const S& s) { return fmt::format("{:.1f}", s.spread_over_cells); });
  add("background: share of the samples, %",
      [](const S& s) { return fmt::format("{:.1f}", 100 * s.background_share); });
  add("background: mean; standard deviation, counts",
      [](const S& s) { return fmt::format("{:.1f}; {:.1f}", s.background_mean, s.background_deviation); });
  for (std::size_t i = 0; i < c.a.fits.size(); ++i) {
    add(fmt::format("{} fitted to it (misfit per sample, x 1000)", law_name(c.a.fits[i].law)), [i](const S& s) {
      const NoiseFit& f = s.fits[i];
      if (!std::isfinite(f.statistic)) return std::string("does not apply");
      const std::string misfit = fmt::format("{:.0f}", 1000 * f.statistic / static_cast<double>(f.samples));
      if (f.law == NoiseLaw::kGaussian)
        return fmt::format("mean {:.1f}, sigma {:.1f} ({})", f.location, f.scale, misfit);
      if (f.law == NoiseLaw::kRayleigh) return fmt::format("scale {:.1f} ({})", f.scale, misfit);
      return fmt::format("shape {:.3g}, scale {:.2g} ({})", f.shape, f.scale, misfit);
    });
  }
  add("bright samples: share, %", [](const S& s) { return fmt::format("{:.2f}", 100 * s.bright_share); });
  add("bright samples over the background, dB", [](const S& s) { return fmt::format("{:.1f}", s.bright_over_db); });
  add("brightest 0.2 % of a scan: mean; the others, counts",
      [](const S& s) { return fmt::format("{:.0f}; {:.1f}", s.brightest_mean, s.brightest_others); });
  add("strongest echo of a scan, counts",
      [&](const S& s) { return spread(quantiles(s.strongest, [](const StrongestEcho& e) { return e.level; }), 0); });
  add("its range, m",
      [&](const S& s) { return spread(quantiles(s.strongest, [](const StrongestEcho& e) { return e.range_m; }), 2); });
  add("its length along range at -6 dB, m",
      [&](const S& s) { return spread(quantiles(s.strongest, [](const StrongestEcho& e) { return e.length_m; }), 3); });
  add("its width across bearing at -6 dB, deg", [&](const S& s) {
    return spread(quantiles(s.strongest, [](const StrongestEcho& e) { return e.width.degrees(); }), 1);
  });
  return rows;
}

std::string to_json(const CompareOutcome& outcome) {
  const ordered_json json = {{"a", samples_json(outcome.a)},
                             {"b", samples_json(outcome.b)},
                             {"background_distance", outcome.background_distance}};
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

// Report -------------------------------------------------------------------------------------------------------------

namespace {

/// The names of the recordings in charts and tables.
struct RecordingNames {
  std::string a, b;
};

/// PNG.
struct ComparisonPictures {
  std::string levels, background, exceedance, scan_a, scan_b, mean_a, mean_b;
};

PlanExtent common_extent(const PlanExtent& a, const PlanExtent& b) {
  return {std::min(a.x_min, b.x_min), std::max(a.x_max, b.x_max), std::min(a.y_min, b.y_min),
          std::max(a.y_max, b.y_max)};
}

ComparisonPictures draw_comparison(const CompareOutcome& c, const RecordingNames& names) {
  const PlanExtent extent = common_extent(extent_of(c.a.mean), extent_of(c.b.mean));
  const double top = top_of(c);
  ComparisonPictures pictures;
  pictures.levels = level_chart(c, names.a, names.b);
  pictures.background = background_chart(c, names.a, names.b);
  pictures.exceedance = exceedance_chart(c, names.a, names.b);
  pictures.scan_a = image_picture(c.a.scan, extent, top, names.a + ", one scan");
  pictures.scan_b = image_picture(c.b.scan, extent, top, names.b + ", one scan");
  pictures.mean_a = image_picture(c.a.mean, extent, top, names.a + ", mean");
  pictures.mean_b = image_picture(c.b.mean, extent, top, names.b + ", mean");
  return pictures;
}

void add_images(HtmlReport& page, const ComparisonPictures& pictures) {
  page.heading("Images");
  page.begin_row();
  page.figure(pictures.scan_a,
              "One scan of A. Brightness is the square root of the level, the same in all four pictures.");
  page.figure(pictures.scan_b, "One scan of B.");
  page.end_row();
  page.begin_row();
  page.figure(pictures.mean_a, "Mean of all scans of A.");
  page.figure(pictures.mean_b, "Mean of all scans of B.");
  page.end_row();
}

void add_statistics(HtmlReport& page, const CompareOutcome& c, const RecordingNames& names) {
  page.heading("Statistics");
  std::vector<HtmlReport::Row> rows;
  for (const ComparedValue& v : compared_values(c)) rows.push_back({v.what, v.a, v.b});
  page.table({"", names.a, names.b}, rows);
  page.paragraph(fmt::format(
      "Background samples stay below the median of their range plus three times the distance from the 16 % level to "
      "the median (from the median to the 84 % level if at least 40 % of the samples are 0). Bright samples are at "
      "least 12 dB above the mean background of their range, and at least {:.0f} counts. Brackets give 16 to 84 % of "
      "the scans. The misfit is the Anderson-Darling statistic: smaller fits better. The backgrounds differ by at most "
      "{:.1f} % of the samples (Kolmogorov-Smirnov).",
      kBrightLeast, 100 * c.background_distance));
}

void add_levels(HtmlReport& page, const CompareOutcome& c, const ComparisonPictures& pictures) {
  page.heading("By range");
  page.figure(pictures.levels, "All bearings together, echoes included.");
  page.table({"range (m)", "A: mean", "A: median (16 to 84 %)", "A: 99 %", "A: zeros", "B: mean",
              "B: median (16 to 84 %)", "B: 99 %", "B: zeros"},
             range_rows(c));
  page.heading("By value");
  page.begin_row();
  page.figure(pictures.background, "The background, on a logarithmic scale.");
  page.figure(pictures.exceedance, "All samples beyond the blind zone.");
  page.end_row();
}

std::string comparison_page(const CompareOutcome& c, const RecordingNames& names, const ComparisonPictures& pictures,
                            const Configuration& configuration) {
  HtmlReport page("Isobath: two recordings side by side",
                  fmt::format("A: {} ({}). B: {} ({}). Samples in counts of a full scale of 255; ranges nearer than "
                              "{:g} m (A) and {:g} m (B) are drawn but not counted.",
                              c.a.name, c.a.format, c.b.name, c.b.format, c.a.all.near_m, c.b.all.near_m));
  if (c.a.left_out + c.b.left_out > 0) {
    page.warning(fmt::format("Left out: {} pings of A and {} of B whose range or beams differ from the first ping's.",
                             c.a.left_out, c.b.left_out));
  }
  add_images(page, pictures);
  add_statistics(page, c, names);
  add_levels(page, c, pictures);
  page.folded("Configuration in force", to_toml(configuration, true));
  return page.html();
}

}  // namespace

CompareOutcome compare(const CompareRequest& request) {
  CompareOutcome outcome;
  outcome.a = collect(request.a, request);
  outcome.b = collect(request.b, request);
  outcome.background_distance = histogram_distance(outcome.a, outcome.b);

  const RecordingNames names{"A: " + short_name(outcome.a.name), "B: " + short_name(outcome.b.name)};
  make_folder(request.out);
  const auto write = [&](const std::string& name, const std::string& bytes) {
    write_whole_file(request.out / name, bytes);
    outcome.files.emplace_back(name);
  };
  const ComparisonPictures pictures = draw_comparison(outcome, names);
  write("comparison.json", to_json(outcome));
  write("levels.png", pictures.levels);
  write("background.png", pictures.background);
  write("exceedance.png", pictures.exceedance);
  write("scan_a.png", pictures.scan_a);
  write("scan_b.png", pictures.scan_b);
  write("mean_a.png", pictures.mean_a);
  write("mean_b.png", pictures.mean_b);
  write("report.html", comparison_page(outcome, names, pictures, request.configuration));
  return outcome;
}

}  // namespace isobath
