// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/region_tally.h"

#include <algorithm>
#include <cmath>

#include "tools/eval/accuracy.h"

namespace disparityd::eval {
namespace {

/// The smallest error that so many percent of all do not exceed; `errors` are sorted, at least one.
double quantile(const std::vector<double>& errors, int percent) {
    const std::size_t needed = (errors.size() * static_cast<std::size_t>(percent) + 99) / 100;
    return errors[std::max<std::size_t>(needed, 1) - 1];
}

}  // namespace

void RegionTally::add(const RegionTally& other) {
    pixels += other.pixels;
    measured += other.measured;
    judged += other.judged;
    with_error += other.with_error;
    for (std::size_t i = 0; i < bad.size(); ++i) {
        bad[i] += other.bad[i];
    }
    d1 += other.d1;
    sum += other.sum;
    sum_of_squares += other.sum_of_squares;
    quantiles = unknown_quantiles();
    curves.reset();
}

RegionTally tally(const JudgedMap& map, const images::FloatMap& filled, const images::FloatMap& truth,
                  const std::vector<std::uint8_t>& pixels, Holes holes) {
    RegionTally result;
    std::vector<double> errors;
    std::vector<float> confidences;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (pixels[i] == 0) {
            continue;
        }
        ++result.pixels;
        result.measured += std::isfinite(map.disparity.values[i]) ? 1U : 0U;
        if (!std::isfinite(filled.values[i])) {
            continue;
        }
        const double true_value = static_cast<double>(truth.values[i]);
        const double error = std::abs(static_cast<double>(filled.values[i]) - true_value);
        errors.push_back(error);
        for (std::size_t k = 0; k < RegionTally::limits.size(); ++k) {
            result.bad[k] += error > RegionTally::limits[k] ? 1U : 0U;
        }
        result.d1 += is_d1_outlier(error, true_value) ? 1U : 0U;
        result.sum += error;
        result.sum_of_squares += error * error;
        if (!map.confidence.empty()) {
            confidences.push_back(map.confidence[i]);
        }
    }
    result.with_error = errors.size();
    const std::size_t holes_left = result.pixels - result.with_error;
    result.judged = holes == Holes::left_out ? result.with_error : result.pixels;
    if (holes != Holes::left_out) {
        std::for_each(result.bad.begin(), result.bad.end(), [&](std::size_t& count) { count += holes_left; });
        result.d1 += holes_left;
    }
    if (!errors.empty()) {
        if (!confidences.empty()) {
            result.curves = sparsification(errors, confidences);
        }
        std::sort(errors.begin(), errors.end());
        std::transform(RegionTally::quantile_percents.begin(), RegionTally::quantile_percents.end(),
                       result.quantiles.begin(), [&](int percent) { return quantile(errors, percent); });
    }
    return result;
}

std::vector<Figure> benchmark_figures() {
    return {{"density %", "density"}, {"bad-0.5 %", "bad_05"},   {"bad-1.0 %", "bad_1"},
            {"bad-2.0 %", "bad_2"},   {"bad-3.0 %", "bad_3"},    {"bad-4.0 %", "bad_4"},
            {"D1 %", "d1"},           {"avg px", "avg_px", 3},   {"RMS px", "rms_px", 3},
            {"A50 px", "a50_px", 3},  {"A90 px", "a90_px", 3},   {"A95 px", "a95_px", 3},
            {"A99 px", "a99_px", 3},  {"AUSE px", "ause_px", 3}, {"AUSE relative", "ause_relative", 3}};
}

std::vector<double> values_of(const RegionTally& tally) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> values{percent_of(tally.measured, tally.pixels)};
    for (const std::size_t bad : tally.bad) {
        values.push_back(percent_of(bad, tally.judged));
    }
    values.push_back(percent_of(tally.d1, tally.judged));
    const auto count = static_cast<double>(tally.with_error);
    values.push_back(tally.with_error == 0 ? nan : tally.sum / count);
    values.push_back(tally.with_error == 0 ? nan : std::sqrt(tally.sum_of_squares / count));
    values.insert(values.end(), tally.quantiles.begin(), tally.quantiles.end());
    values.push_back(tally.curves ? tally.curves->area_px() : nan);
    values.push_back(tally.curves ? tally.curves->relative_area() : nan);
    return values;
}

}  // namespace disparityd::eval
