// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/report.h"

#include <algorithm>
#include <cmath>
#include <ostream>

#include <nlohmann/json.hpp>

#include "tools/bench/machine.h"
#include "tools/bench/opencv_contestant.h"

namespace disparityd::bench {
namespace {

using tools::fixed;

std::string milliseconds(double ms) {
    return fixed(ms, ms < 100 ? 2 : 1);
}

std::string ratio(const Measurement* other, const Measurement& measurement) {
    if (other == nullptr) {
        return "-";
    }
    const double times = other->median_ms() / measurement.median_ms();
    return fixed(times, times < 10 ? 2 : 1);
}

/// Of "cpu/sgm": "sgm".
std::string method_of(const Measurement& measurement) {
    return measurement.name.substr(measurement.name.find('/') + 1);
}

std::string megabytes(double mb) {
    return std::isnan(mb) ? "-" : fixed(mb, mb < 10 ? 1 : 0);
}

nlohmann::ordered_json number(double value) {
    return std::isnan(value) ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(std::round(value * 1e4) / 1e4);
}

}  // namespace

void print_head(bool markdown, std::ostream& to) {
    std::vector<std::string> lines = describe_machine();
    const std::vector<std::string> opencv = describe_opencv();
    lines.insert(lines.end(), opencv.begin(), opencv.end());
    lines.push_back(
        "MB: held at once (malloc and mmap counted) from the making of a matcher to the end of its first frame; "
        "OpenCV's is freed after each frame");
    for (const std::string& line : lines) {
        to << (markdown ? "- " : "") << line << '\n';
    }
    to << std::flush;
}

void print(const tools::Table& table, bool markdown, std::ostream& to) {
    markdown ? table.print_markdown(to) : table.print(to);
}

const Measurement* find(const std::vector<Measurement>& measurements, const std::string& name, const std::string& isa,
                        int threads) {
    const auto found = std::find_if(measurements.begin(), measurements.end(), [&](const Measurement& measurement) {
        return measurement.name == name && (isa.empty() || measurement.isa == isa) && measurement.threads == threads;
    });
    return found == measurements.end() ? nullptr : &*found;
}

void print_measurements(const std::vector<Measurement>& measurements, bool markdown, std::ostream& to) {
    if (measurements.empty()) {
        return;
    }
    const Measurement& any = measurements.front();
    to << '\n'
       << (markdown ? "#### " : "") << any.scene << ' ' << any.width << 'x' << any.height << ", D " << any.disparities
       << '\n'
       << (markdown ? "\n" : "");
    tools::Table table({"contestant", "isa", "threads", "ms median", "min", "quartiles", "cpu ms", "runs", "frames/s",
                        "GDE/s", "MB", "x naive", "x scalar", "x 3WAY"});
    for (const Measurement& one : measurements) {
        const std::string naive = "naive/" + method_of(one);
        table.add(
            {one.name, one.isa, std::to_string(one.threads), milliseconds(one.median_ms()), milliseconds(one.min_ms()),
             milliseconds(one.lower_quartile_ms()) + ".." + milliseconds(one.upper_quartile_ms()),
             milliseconds(one.median_cpu_ms()), std::to_string(one.ms.size()), fixed(one.frames_per_second(), 1),
             fixed(one.gde_per_second(), 2), megabytes(one.memory_mb),
             ratio(find(measurements, naive, "compiled", 1), one), ratio(find(measurements, naive, "scalar", 1), one),
             ratio(find(measurements, "opencv/3way", "", one.threads), one)});
    }
    print(table, markdown, to);
}

void print_json(const std::vector<Measurement>& measurements, std::ostream& to) {
    auto list = nlohmann::ordered_json::array();
    for (const Measurement& one : measurements) {
        list.push_back({{"name", one.name},
                        {"isa", one.isa},
                        {"scene", one.scene},
                        {"width", one.width},
                        {"height", one.height},
                        {"disparities", one.disparities},
                        {"threads", one.threads},
                        {"median_ms", number(one.median_ms())},
                        {"min_ms", number(one.min_ms())},
                        {"q1_ms", number(one.lower_quartile_ms())},
                        {"q3_ms", number(one.upper_quartile_ms())},
                        {"cpu_ms", number(one.median_cpu_ms())},
                        {"runs", one.ms.size()},
                        {"frames_per_s", number(one.frames_per_second())},
                        {"gde_per_s", number(one.gde_per_second())},
                        {"memory_mb", number(one.memory_mb)}});
    }
    to << list.dump(2) << '\n';
}

}  // namespace disparityd::bench
