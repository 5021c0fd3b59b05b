#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/control_study.hpp>

namespace isobath {
namespace {

constexpr int kErrorChartWidth = 760, kErrorChartHeight = 380;

Stroke stroke_of(ControlKind control) {
  switch (control) {
    case ControlKind::kPid: return {palette::kObstacle, 1.6, false};
    case ControlKind::kModel: return {palette::kHidden, 1.6, true};
    case ControlKind::kAdaptive: return {palette::kTrack, 2.2, false};
  }
  return {};
}

/// The median error of each kind of control over the time from the change on.
std::string error_chart(const std::vector<const ControlRow*>& rows) {
  double top = 0.05;
  for (const ControlRow* row : rows) top = std::max(top, 1.1 * std::ranges::max(row->error_m));
  const ControlRow& first = *rows.front();
  // A vehicle that is carried away must not hide the others.
  const double shown = std::min(top, 2.0);
  ChartPicture chart(kErrorChartWidth, kErrorChartHeight,
                     fmt::format("{}, {}: {}", first.vehicle, to_text(first.task), explained(first.change)),
                     {"time after the change (s)", first.time_s.front(), first.time_s.back()},
                     {"error, median of the runs (m)", 0, shown});
  chart.mark(0, "change", palette::kInk);
  for (const ControlRow* row : rows) {
    std::vector<double> error = row->error_m;
    for (double& e : error) e = e > shown ? NAN : e;
    chart.curve(row->time_s, error, stroke_of(row->control), to_text(row->control));
  }
  chart.finish();
  return chart.png();
}

std::string control_csv(const ControlStudy& study) {
  std::string text =
      "vehicle,task,change,control,runs,recovered,before_rms_m,at_rms_m,at_max_m,at_max_most_m,after_rms_m,"
      "after_rms_most_m,at_depth_most_m,at_level_most_m,final_depth_most_m,final_level_most_m,recovery_s\n";
  for (const ControlRow& r : study.rows) {
    text += fmt::format(
        "{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.1f}\n", r.vehicle,
        to_text(r.task), to_text(r.change), to_text(r.control), r.runs, r.recovered, r.before_rms_m.median,
        r.at_rms_m.median, r.at_max_m.median, r.at_max_m.most, r.after_rms_m.median, r.after_rms_m.most,
        r.at_depth_max_m.most, r.at_level_max_m.most, r.final_depth_m.most, r.final_level_m.most, r.recovery_s.median);
  }
  return text;
}

/// Rows that differ only by the kind of control, in the order of the study.
std::vector<std::vector<const ControlRow*>> compared_rows(const ControlStudy& study) {
  std::vector<std::vector<const ControlRow*>> groups;
  for (const ControlRow& row : study.rows) {
    const bool same = !groups.empty() && groups.back().front()->vehicle == row.vehicle &&
                      groups.back().front()->task == row.task && groups.back().front()->change == row.change;
    if (!same) groups.emplace_back();
    groups.back().push_back(&row);
  }
  return groups;
}

}  // namespace

std::vector<std::filesystem::path> write_control_report(const ControlRequest& request, const ControlStudy& study,
                                                        const std::filesystem::path& folder) {
  make_folder(folder);
  HtmlReport page("Control of a vehicle that changes",
                  fmt::format("Three kinds of control in {} runs each, from run {} on. Half-way something changes that "
                              "the control does not know.",
                              request.runs, request.first_run));
  std::vector<std::filesystem::path> files = {"report.html", "control.csv"};
  if (!study.bars.empty()) {
    page.heading("What the adaptive control must show");
    std::vector<HtmlReport::Row> rows;
    for (const ControlBar& bar : study.bars) {
      rows.push_back({bar.vehicle, bar.what, fmt::format("{:.3f}", bar.value), fmt::format("{:.3f}", bar.bar),
                      bar.met           ? "met"
                      : bar.why.empty() ? "NOT MET"
                                        : "cannot: " + bar.why});
    }
    page.table({"vehicle", "what", "value", "bar", ""}, rows);
  }
  page.heading("Errors");
  page.paragraph(
      "Medians of the runs: root mean square before the change (m), greatest error in the interval after it (m), root "
      "mean square at the end (m), time until the error stays at the former level. Intervals are 20 s of a vehicle "
      "that "
      "hovers, 40 s of one that does not. \"no\": more than half of the runs do not return.");
  std::vector<HtmlReport::Row> table = control_table(study);
  const HtmlReport::Row header = table.front();
  table.erase(table.begin());
  page.table(header, table);
  page.heading("Error over time");
  for (const auto& rows : compared_rows(study)) {
    const ControlRow& first = *rows.front();
    const std::string png = error_chart(rows);
    const std::string name = fmt::format("{}-{}-{}.png", std::filesystem::path(first.vehicle).stem().string(),
                                         to_text(first.task), to_text(first.change));
    write_whole_file(folder / name, png);
    files.emplace_back(name);
    page.figure(png, fmt::format("{}, {}: {}.", first.vehicle, to_text(first.task), explained(first.change)));
  }
  write_whole_file(folder / "control.csv", control_csv(study));
  page.save(folder / "report.html");
  return files;
}

}  // namespace isobath
