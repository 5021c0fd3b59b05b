// The check of a map: what is known of the differences must come out, and nothing else.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/studies/crosscheck.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using Json = nlohmann::json;

CrosscheckSample sample(double observed, double predicted, int confidence = 10) {
  return {static_cast<float>(observed), static_cast<float>(predicted), static_cast<std::uint8_t>(confidence), 0, 1.f};
}

TEST(Crosscheck, SmallCasesAreExact) {
  EXPECT_EQ(difference_statistics({}).n, 0u);
  EXPECT_TRUE(std::isnan(difference_statistics({}).median_m));
  const DifferenceStatistics one = difference_statistics({-0.25});
  EXPECT_EQ(one.median_m, -0.25);
  EXPECT_EQ(one.robust_sd_m, 0);
  EXPECT_EQ(one.p95_m, 0.25);
  // 1 2 4 8 16: median 4; distances 3 2 0 4 12, their median 3; 95 % lies 0.8 of the way from 8 to 16.
  const DifferenceStatistics five = difference_statistics({16, 1, 8, 2, 4});
  EXPECT_EQ(five.n, 5u);
  EXPECT_EQ(five.median_m, 4);
  EXPECT_DOUBLE_EQ(five.robust_sd_m, 1.4826 * 3);
  EXPECT_DOUBLE_EQ(five.p95_m, 14.4);
  EXPECT_EQ(difference_statistics({1, 2}).median_m, 1.5);
}

TEST(Crosscheck, NormalNoiseIsRecovered) {
  Random random(5);
  CrosscheckInput input;
  constexpr double kBias = -0.07, kSigma = 0.2;
  constexpr int kCount = 40000;
  for (int i = 0; i < kCount; ++i) {
    const double depth = random.uniform(1, 9);
    input.samples.push_back(sample(depth + kBias + kSigma * random.normal(), depth, 20));
  }
  input.offered = 2 * kCount;
  const CrosscheckResult r = crosscheck(input);
  EXPECT_EQ(r.all.n, static_cast<std::uint64_t>(kCount));
  EXPECT_DOUBLE_EQ(r.covered, 0.5);
  // Standard errors: of a median 1.2533 sigma / sqrt(n), of the scaled MAD 1.17 sigma / sqrt(n) about.
  const double error = kSigma / std::sqrt(kCount);
  EXPECT_NEAR(r.all.median_m, kBias, 4 * 1.26 * error);
  EXPECT_NEAR(r.all.robust_sd_m, kSigma, 4 * 1.17 * error);
  // P(|x| <= p) = 0.95 with a bias: Phi((p - b) / s) - Phi((-p - b) / s).
  const double p = r.all.p95_m;
  EXPECT_NEAR(1 - normal_tail((p - kBias) / kSigma) - normal_tail((p + kBias) / kSigma), 0.95, 0.005);
  // Confidence 20 promises all; within 0.5 m lie so many:
  ASSERT_EQ(r.calibration.size(), 1u);
  const double expected = 1 - normal_tail((0.5 - kBias) / kSigma) - normal_tail((0.5 + kBias) / kSigma);
  EXPECT_LT(r.calibration[0].interval.low, expected);
  EXPECT_GT(r.calibration[0].interval.high, expected);
  EXPECT_NEAR(r.calibration_error, 1 - expected, 0.002);
  EXPECT_NEAR(r.shoaler, normal_tail((0.5 + kBias) / kSigma), 0.003);
}

TEST(Crosscheck, OutliersDoNotMoveTheRobustNumbers) {
  Random random(6);
  CrosscheckInput clean, dirty;
  for (int i = 0; i < 4000; ++i) {
    const CrosscheckSample s = sample(5 + 0.1 * random.normal(), 5);
    clean.samples.push_back(s);
    dirty.samples.push_back(i % 50 == 0 ? sample(0.3, 5) : s);
  }
  const CrosscheckResult a = crosscheck(clean), b = crosscheck(dirty);
  EXPECT_NEAR(a.all.median_m, b.all.median_m, 0.01);
  EXPECT_NEAR(a.all.robust_sd_m, b.all.robust_sd_m, 0.01);
  EXPECT_NEAR(b.shoaler, 0.02, 1e-9) << "negative: the bottom is shoaler than the map says";
  EXPECT_EQ(a.shoaler, 0);
}

// Limits of IHO S-44, edition 6, table 1, at 20 m: 0.2121, 0.2915, 0.5636 twice, 1.1012 m.
TEST(Crosscheck, OrdersOfSurveyAllowWhatTheStandardSays) {
  EXPECT_NEAR(total_vertical_uncertainty(0.5, 0.013, 0), 0.5, 1e-12);
  CrosscheckInput input;
  for (const double d : {0.2, 0.22, -0.29, 0.3, -0.55, 0.57, 1.0, 1.2}) input.samples.push_back(sample(20, 20 - d));
  const CrosscheckResult r = crosscheck(input);
  ASSERT_EQ(r.s44.size(), 5u);
  const std::array<std::uint64_t, 5> within = {1, 3, 5, 5, 7};
  for (std::size_t i = 0; i < within.size(); ++i) {
    EXPECT_EQ(r.s44[i].within, within[i]) << r.s44[i].name;
    EXPECT_DOUBLE_EQ(r.s44[i].share, static_cast<double>(within[i]) / 8);
    EXPECT_FALSE(r.s44[i].met);
  }
  input.samples.resize(1);
  for (const auto& order : crosscheck(input).s44) EXPECT_TRUE(order.met) << order.name;
}

TEST(Crosscheck, ClassesHoldWhatBelongsToThem) {
  CrosscheckInput input;
  for (int c = 0; c <= 20; ++c) input.samples.push_back(sample(0.5 + 0.4 * c, 0.5 + 0.4 * c - 0.01 * c, c));
  const CrosscheckResult r = crosscheck(input);
  ASSERT_EQ(r.by_confidence.size(), 5u);
  const std::array<std::uint64_t, 5> n = {5, 5, 5, 5, 1};
  for (std::size_t k = 0; k < n.size(); ++k) {
    EXPECT_EQ(r.by_confidence[k].differences.n, n[k]);
    EXPECT_NEAR(r.by_confidence[k].differences.median_m, k == 4 ? 0.2 : 0.01 * (5.0 * static_cast<double>(k) + 2),
                1e-6);
  }
  // 0.5 to 8.5 m in steps of 1 m: nine classes, the borders belong to the deeper.
  ASSERT_EQ(r.by_depth.size(), 9u);
  std::uint64_t total = 0;
  for (std::size_t k = 0; k < r.by_depth.size(); ++k) {
    EXPECT_EQ(r.by_depth[k].from_m, static_cast<double>(k));
    EXPECT_EQ(r.by_depth[k].to_m, static_cast<double>(k + 1));
    total += r.by_depth[k].differences.n;
  }
  EXPECT_EQ(total, 21u);
  EXPECT_EQ(r.calibration.size(), 21u);
}

TEST(Crosscheck, AnHonestMapKeepsItsPromises) {
  Random random(7);
  CrosscheckInput honest, boasting;
  for (int c = 1; c <= 19; ++c) {
    for (int i = 0; i < 2000; ++i) {
      const bool agrees = random.uniform() < c / 20.0;
      honest.samples.push_back(sample(agrees ? 40.7 : 42, 40, c));  // 2 % of 40.7 m is more than 0.5 m
      boasting.samples.push_back(sample(agrees ? 40.7 : 42, 40, 20));
    }
  }
  const CrosscheckResult r = crosscheck(honest);
  int outside = 0;
  for (const auto& p : r.calibration) {
    EXPECT_EQ(p.n, 2000u);
    EXPECT_DOUBLE_EQ(p.promised, p.confidence / 20.0);
    outside += p.promised < p.interval.low || p.promised > p.interval.high ? 1 : 0;
  }
  EXPECT_LE(outside, 3) << "of 19 intervals of 95 %";
  EXPECT_LT(r.calibration_error, 0.02);
  EXPECT_NEAR(crosscheck(boasting).calibration_error, 0.5, 0.02);
}

// ledger: S1-76
TEST(Crosscheck, AMapPromisesWhatItsOwnRevisitsShowed) {
  Random random(8);
  CrosscheckInput input;
  constexpr double kSlope = 0.3, kOffset = 2;  // m to the north, of the log
  for (int i = 0; i < 4000; ++i) {
    const bool agrees = random.uniform() < 0.9;
    input.revisits.add({.difference_m = agrees ? 0.2 : 0.8, .confidence = 7, .slope = 0.0, .apart_min = 1500});
    const double slope = i % 2 == 0 ? kSlope : -kSlope;
    CrosscheckSample s = sample(5 + slope * kOffset + 0.1 * random.normal(), 5, 7);
    s.gradient = Eigen::Vector2d(slope, i % 3 == 0 ? 0.1 : -0.1);
    s.independent = i % 4 == 0;
    input.samples.push_back(s);
  }
  const CrosscheckResult r = crosscheck(input);
  ASSERT_EQ(r.calibration.size(), 1u);
  EXPECT_TRUE(r.calibration[0].learnt);
  EXPECT_NEAR(r.calibration[0].promised, 0.9, 0.01);
  EXPECT_EQ(r.calibration[0].independent, 1000u);
  EXPECT_LT(r.calibration[0].share, 0.3) << "0.6 m of error on the slopes";
  EXPECT_GT(r.calibration[0].aligned, 0.99) << "which the offset of the log explains";
  ASSERT_TRUE(r.uncertainty);
  EXPECT_NEAR(r.uncertainty->tvu_m(0.5, 0.0), 0.8, 0.1) << "a tenth of the revisits differ by 0.8 m";
  EXPECT_EQ(r.within.back().n, 1000u);
  EXPECT_NE(to_text(r).find("learnt from 4000 revisits of other surveys"), std::string::npos);
}

TEST(Crosscheck, WhatIsNoNumberIsLeftOutAndSaid) {
  CrosscheckInput input;
  input.samples = {sample(5, 5), sample(NAN, 5), sample(5, INFINITY), sample(3e38, 5), sample(5, 5, 255)};
  input.offered = 10;
  input.left_out = {{"no depth in the map", 6}};
  const CrosscheckResult r = crosscheck(input);
  EXPECT_EQ(r.all.n, 1u);
  EXPECT_DOUBLE_EQ(r.covered, 0.1);
  ASSERT_EQ(r.left_out.size(), 3u);
  EXPECT_EQ(r.left_out[1].second, 3u);
  EXPECT_EQ(r.left_out[2].second, 1u);
  EXPECT_EQ(crosscheck_page(input, r).html().find("nan"), std::string::npos);
}

TEST(Crosscheck, JsonHasTheAgreedKeys) {
  CrosscheckInput input;
  for (int i = 0; i < 100; ++i) input.samples.push_back(sample(3 + 0.05 * i, 3 + 0.05 * i + 0.01 * (i % 7), i % 21));
  input.offered = 120;
  const CrosscheckResult r = crosscheck(input);
  const Json json = Json::parse(to_json(r));
  EXPECT_EQ(json["n"], 100);
  EXPECT_DOUBLE_EQ(json["covered"], 100.0 / 120);
  for (const char* key : {"median_m", "robust_sd_m", "p95_m"}) {
    EXPECT_TRUE(json[key].is_number()) << key;
    EXPECT_TRUE(json["by_confidence"][0][key].is_number()) << key;
    EXPECT_TRUE(json["by_depth"][0][key].is_number()) << key;
  }
  ASSERT_EQ(json["by_confidence"].size(), 5u);
  EXPECT_EQ(json["by_confidence"][1]["class"], "5-9");
  EXPECT_EQ(json["by_confidence"][4]["class"], "20");
  EXPECT_EQ(json["s44"].size(), 5u);
  EXPECT_EQ(json["calibration"].size(), 21u);
  EXPECT_EQ(to_json(r), to_json(crosscheck(input)));
  EXPECT_NE(to_text(r).find("IHO S-44"), std::string::npos);
}

TEST(Crosscheck, NothingToCompareIsSaid) {
  CrosscheckInput input;
  input.offered = 7;
  const CrosscheckResult r = crosscheck(input);
  const Json json = Json::parse(to_json(r));
  EXPECT_EQ(json["n"], 0);
  EXPECT_TRUE(json["median_m"].is_null());
  EXPECT_EQ(json["by_confidence"].size(), 5u);
  EXPECT_NE(crosscheck_page(input, r).html().find("None of the 7 soundings"), std::string::npos);
  EXPECT_EQ(to_text(r).find("nan"), std::string::npos);
  for (const auto& order : r.s44) EXPECT_FALSE(order.met);
}

TEST(Crosscheck, PageShowsThreePicturesAndTheWarning) {
  Random random(9);
  CrosscheckInput input;
  input.map = "lake <old>";
  for (int i = 0; i < 300; ++i) {
    const double depth = random.uniform(2, 8);
    input.samples.push_back(sample(depth + 0.3 * random.normal(), depth, 5 + i % 16));
  }
  input.offered = 300;
  const CrosscheckResult r = crosscheck(input);
  const std::string html = crosscheck_page(input, r).html();
  std::size_t pictures = 0;
  for (std::size_t at = html.find("<img"); at != std::string::npos; at = html.find("<img", at + 1)) ++pictures;
  EXPECT_EQ(pictures, 3u);
  EXPECT_NE(html.find("lake &lt;old&gt;"), std::string::npos);
  EXPECT_GT(r.shoaler, 0);
  EXPECT_NE(html.find("class=\"warning\""), std::string::npos);
}

}  // namespace
}  // namespace isobath
