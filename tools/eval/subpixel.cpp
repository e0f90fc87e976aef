// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/subpixel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "tools/command_line/table.h"
#include "tools/eval/rounded_number.h"

namespace disparityd::eval {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

double share(std::size_t count, std::size_t of) {
    return of == 0 ? none : 100.0 * static_cast<double>(count) / static_cast<double>(of);
}

/// Index of the sixteenth that a disparity lies next to.
std::size_t sixteenth(float disparity) {
    const long d16 = std::lround(disparity * 16);
    return static_cast<std::size_t>(((d16 % 16) + 16) % 16);
}

bool is_near_whole(std::size_t sixteenths) {
    return sixteenths <= 1 || sixteenths == 15;
}

struct Tally {
    std::size_t judged = 0, measured = 0, far = 0, near_whole = 0, truth_near_whole = 0, fitted = 0;
    double squares = 0;
    std::array<std::size_t, 16> fractions = {};

    void add(float disparity, float truth) {
        ++judged;
        if (!std::isfinite(disparity)) {
            return;
        }
        ++measured;
        const double error = std::abs(disparity - truth);
        far += error > 0.5 ? 1U : 0U;
        if (error <= 1) {
            ++fitted;
            squares += error * error;
        }
        ++fractions[sixteenth(disparity)];
        near_whole += is_near_whole(sixteenth(disparity)) ? 1U : 0U;
        truth_near_whole += is_near_whole(sixteenth(truth)) ? 1U : 0U;
    }
};

/// The mean of every figure.
SubpixelAccuracy mean(const std::vector<SubpixelAccuracy>& all) {
    SubpixelAccuracy sum;
    const auto count = static_cast<double>(all.size());
    for (const SubpixelAccuracy& one : all) {
        sum.bad05 += one.bad05 / count;
        sum.bad05_measured += one.bad05_measured / count;
        sum.rms += one.rms / count;
        sum.near_whole += one.near_whole / count;
        sum.truth_near_whole += one.truth_near_whole / count;
        for (std::size_t i = 0; i < sum.fractions.size(); ++i) {
            sum.fractions[i] += one.fractions[i] / count;
        }
    }
    return sum;
}

std::string text(double value, int decimals) {
    return std::isnan(value) ? "-" : tools::fixed(value, decimals);
}

void add_line(const std::string& scene, const SubpixelRow& row, const std::string& disparities,
              const SubpixelAccuracy& accuracy, tools::Table& table) {
    table.add({scene, row.method, row.backend, disparities, text(accuracy.bad05, 2), text(accuracy.bad05_measured, 2),
               text(accuracy.rms, 3), text(accuracy.near_whole, 1), text(accuracy.truth_near_whole, 1)});
}

}  // namespace

SubpixelAccuracy measure_subpixel(const images::FloatMap& disparity, const images::FloatMap& truth,
                                  const std::vector<std::uint8_t>& non_occluded) {
    if (disparity.values.size() != truth.values.size() || disparity.width != truth.width ||
        (!non_occluded.empty() && non_occluded.size() != truth.values.size())) {
        throw std::invalid_argument("disparity, ground truth and mask differ in size");
    }
    Tally tally;
    for (std::size_t i = 0; i < truth.values.size(); ++i) {
        if (std::isfinite(truth.values[i]) && (non_occluded.empty() || non_occluded[i] != 0)) {
            tally.add(disparity.values[i], truth.values[i]);
        }
    }
    SubpixelAccuracy accuracy;
    accuracy.bad05 = share(tally.judged - tally.measured + tally.far, tally.judged);
    accuracy.bad05_measured = share(tally.far, tally.measured);
    accuracy.rms = tally.fitted == 0 ? none : std::sqrt(tally.squares / static_cast<double>(tally.fitted));
    accuracy.near_whole = share(tally.near_whole, tally.measured);
    accuracy.truth_near_whole = share(tally.truth_near_whole, tally.measured);
    std::transform(tally.fractions.begin(), tally.fractions.end(), accuracy.fractions.begin(),
                   [&](std::size_t count) { return share(count, tally.measured); });
    return accuracy;
}

void print_subpixel_table(const std::vector<SubpixelRow>& rows, bool markdown, std::ostream& to) {
    tools::Table table({"scene", "method", "backend", "D", "bad-0.5 nonocc %", "bad-0.5 of measured %", "RMS px",
                        "near whole px %", "of the truth %"});
    for (const SubpixelRow& row : rows) {
        add_line(row.scene, row, std::to_string(row.disparities), row.accuracy, table);
    }
    for (auto row = rows.begin(); row != rows.end(); ++row) {
        const auto same = [&](const SubpixelRow& other) {
            return other.method == row->method && other.backend == row->backend;
        };
        if (std::any_of(rows.begin(), row, same)) {
            continue;
        }
        std::vector<SubpixelAccuracy> all;
        for (auto other = row; other != rows.end(); ++other) {
            if (same(*other)) {
                all.push_back(other->accuracy);
            }
        }
        add_line("mean", *row, "", mean(all), table);
    }
    markdown ? table.print_markdown(to) : table.print(to);
}

void print_subpixel_json(const std::vector<SubpixelRow>& rows, std::ostream& to) {
    auto list = nlohmann::ordered_json::array();
    for (const SubpixelRow& row : rows) {
        const SubpixelAccuracy& accuracy = row.accuracy;
        auto fractions = nlohmann::ordered_json::array();
        for (const double fraction : accuracy.fractions) {
            fractions.push_back(rounded_number(fraction));
        }
        list.push_back({{"scene", row.scene},
                        {"method", row.method},
                        {"backend", row.backend},
                        {"disparities", row.disparities},
                        {"bad05_nonocc", rounded_number(accuracy.bad05)},
                        {"bad05_measured", rounded_number(accuracy.bad05_measured)},
                        {"rms_px", rounded_number(accuracy.rms)},
                        {"near_whole", rounded_number(accuracy.near_whole)},
                        {"truth_near_whole", rounded_number(accuracy.truth_near_whole)},
                        {"fractions", fractions}});
    }
    to << list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

}  // namespace disparityd::eval
