// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/subpixel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "tools/command_line/table.h"
#include "tools/eval/means.h"

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

struct SubpixelTally {
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

std::vector<Figure> subpixel_figures() {
    return {{"bad-0.5 nonocc %", "bad05_nonocc"},
            {"bad-0.5 of measured %", "bad05_measured"},
            {"RMS px", "rms_px", 3},
            {"near whole px %", "near_whole", 1},
            {"of the truth %", "truth_near_whole", 1}};
}

/// Returns the values in the order of subpixel_figures().
std::vector<double> subpixel_values(const SubpixelAccuracy& accuracy) {
    return {accuracy.bad05, accuracy.bad05_measured, accuracy.rms, accuracy.near_whole, accuracy.truth_near_whole};
}

std::vector<std::string> head_of_subpixel_rows() {
    std::vector<std::string> head{"scene", "method", "backend", "D"};
    for (const Figure& figure : subpixel_figures()) {
        head.push_back(figure.heading);
    }
    return head;
}

}  // namespace

SubpixelAccuracy measure_subpixel(const images::FloatMap& disparity, const images::FloatMap& truth,
                                  const std::vector<std::uint8_t>& non_occluded) {
    if (disparity.values.size() != truth.values.size() || disparity.width != truth.width ||
        (!non_occluded.empty() && non_occluded.size() != truth.values.size())) {
        throw std::invalid_argument("disparity, ground truth and mask differ in size");
    }
    SubpixelTally tally;
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

Measurements measurements(const std::vector<SubpixelRow>& rows) {
    Measurements measured{subpixel_figures(), {}};
    for (const SubpixelRow& row : rows) {
        measured.rows.push_back({row.scene, row.method, row.backend, subpixel_values(row.accuracy)});
    }
    return measured;
}

void print_subpixel_table(const std::vector<SubpixelRow>& rows, bool markdown, std::ostream& to) {
    tools::Table table(head_of_subpixel_rows());
    const Measurements measured = measurements(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        std::vector<std::string> line{rows[i].scene, rows[i].method, rows[i].backend,
                                      std::to_string(rows[i].disparities)};
        append_figures(measured.rows[i].values, measured.figures, line);
        table.add(line);
    }
    for (const Mean& mean : means(measured)) {
        std::vector<std::string> line{"mean", mean.method, mean.backend, ""};
        append_figures(mean.values, measured.figures, line);
        table.add(line);
    }
    markdown ? table.print_markdown(to) : table.print(to);
}

nlohmann::ordered_json subpixel_json(const std::vector<SubpixelRow>& rows) {
    auto list = nlohmann::ordered_json::array();
    for (const SubpixelRow& row : rows) {
        const SubpixelAccuracy& accuracy = row.accuracy;
        auto fractions = nlohmann::ordered_json::array();
        for (const double fraction : accuracy.fractions) {
            fractions.push_back(rounded_number(fraction));
        }
        nlohmann::ordered_json object{
            {"scene", row.scene}, {"method", row.method}, {"backend", row.backend}, {"disparities", row.disparities}};
        add_figures(subpixel_values(accuracy), subpixel_figures(), object);
        object["fractions"] = fractions;
        list.push_back(object);
    }
    return list;
}

}  // namespace disparityd::eval
