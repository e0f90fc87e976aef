// SPDX-License-Identifier: Apache-2.0
//
// Runs the cases of avoid_cases.json with the decision of the C++ example; avoid_decision_check.py does it with that in
// Python.
#include <fstream>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "clients/examples/obstacle-avoidance/cpp/decision.hpp"

namespace {

using nlohmann::json;

json table() {
    std::ifstream file(AVOID_CASES);
    return json::parse(file);
}

avoid::Options options_of(const json& from) {
    avoid::Options options;
    std::map<std::string, double*> numbers{{"width_m", &options.width_m},
                                           {"margin_m", &options.margin_m},
                                           {"speed_mps", &options.speed_mps},
                                           {"smallest_m", &options.smallest_m},
                                           {"deceleration_mps2", &options.deceleration_mps2},
                                           {"camera_height_m", &options.camera_height_m},
                                           {"camera_pitch_deg", &options.camera_pitch_deg}};
    for (const auto& [name, value] : from.items()) {
        if (name == "good_frames") {
            options.good_frames = value;
        } else if (name == "synthetic") {
            options.synthetic = value;
        } else {
            *numbers.at(name) = value;
        }
    }
    return options;
}

disparity::ScanSector sector_of(const json& from) {
    disparity::ScanSector sector;
    sector.from_deg = from.at(0);
    sector.to_deg = from.at(1);
    sector.state = static_cast<disparity::SectorState>(from.at(2).get<int>());
    sector.distance_m = from.at(3);
    sector.free_m = from.at(4);
    sector.pixels = from.size() > 5 ? from.at(5).get<std::uint32_t>() : 100;
    sector.trust = from.size() > 6 ? from.at(6).get<std::uint8_t>() : 0;
    sector.doubts = from.size() > 7 ? from.at(7).get<std::uint32_t>() : 0;
    return sector;
}

std::optional<disparity::Scan> scan_of(const json& frame) {
    if (frame.contains("no_scan")) {
        return std::nullopt;
    }
    disparity::Scan scan;
    if (frame.contains("mounting")) {
        scan.mounting = {frame.at("mounting").at(0), frame.at("mounting").at(1), 0};
    }
    if (frame.contains("only")) {
        for (const json& sector : frame.at("only")) {
            scan.sectors.push_back(sector_of(sector));
        }
        return scan;
    }
    std::map<double, json> named;
    for (const json& sector : frame.value("sectors", json::array())) {
        named[sector.at(0)] = sector;
    }
    for (int edge = -90; edge < 90; edge += 10) {
        const json usual = {edge, edge + 10, 1, 0, frame.at("free")};
        scan.sectors.push_back(sector_of(named.contains(edge) ? named.at(edge) : usual));
    }
    return scan;
}

avoid::Decision take(avoid::Decider& decider, const json& step) {
    const double at = step.at("at");
    if (step.contains("frame")) {
        const json& frame = step.at("frame");
        const auto scan = scan_of(frame);
        return decider.see({frame.at("age"), frame.value("flags", 0U), scan ? &*scan : nullptr}, at);
    }
    if (step.contains("gone")) {
        return decider.gone(step.at("gone"));
    }
    return step.contains("fail") ? decider.fail(step.at("fail")) : decider.wait(at);
}

TEST(AvoidDecision, CasesOfTheTable) {
    const json cases = table().at("cases");
    ASSERT_FALSE(cases.empty());
    for (const json& one : cases) {
        SCOPED_TRACE(one.at("name").get<std::string>());
        avoid::Decider decider(options_of(one.value("options", json::object())));
        for (const json& step : one.at("steps")) {
            SCOPED_TRACE(step.dump());
            const double patience = decider.patience_s(step.at("at"));
            const avoid::Decision before = decider.decision();
            const avoid::Decision now = take(decider, step);
            EXPECT_EQ(avoid::line_of(now), step.at("line").get<std::string>());
            EXPECT_NEAR(patience, step.value("patience", patience), 1e-9);
            EXPECT_EQ(avoid::is_change(before, now), step.value("change", avoid::is_change(before, now)));
        }
    }
}

}  // namespace
