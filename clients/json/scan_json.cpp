// SPDX-License-Identifier: Apache-2.0
#include "clients/json/scan_json.h"

#include "proto/doubt.h"

namespace disparityd::json {
namespace {

Json sector_json(const disparity::ScanSector& sector) {
    const bool occupied = sector.state == disparity::SectorState::occupied;
    const auto of_obstacle = [occupied](auto value) { return occupied ? Json(value) : Json(); };
    return {{"from_deg", sector.from_deg},
            {"to_deg", sector.to_deg},
            {"state", sector_word(sector.state)},
            {"distance_m", of_obstacle(sector.distance_m)},
            {"sigma_m", of_obstacle(sector.sigma_m)},
            {"free_m", sector.free_m},
            {"low_m", of_obstacle(sector.low_m)},
            {"high_m", of_obstacle(sector.high_m)},
            {"pixels", of_obstacle(sector.pixels)},
            {"confidence", of_obstacle(sector.confidence)},
            {"near", sector.is_near()},
            {"trust", sector.trust},
            {"doubts", doubts_json(sector.doubts)}};
}

}  // namespace

Json doubts_json(std::uint32_t flags) {
    Json list = Json::array();
    for (const proto::DoubtFacts& doubt : proto::doubts) {
        if ((flags & doubt.bit) != 0) {
            list.push_back(doubt.name);
        }
    }
    return list;
}

Json to_json(const disparity::Scan& scan) {
    Json json{{"ground",
               {{"source", ground_word(scan.ground)},
                {"age", scan.ground_age},
                {"height_m", scan.ground_height_m},
                {"slope_ahead", scan.ground_slope_ahead},
                {"slope_left", scan.ground_slope_left}}},
              {"mounting", scan.mounting ? Json{{"height_m", scan.mounting->height_m},
                                                {"pitch_deg", scan.mounting->pitch_deg},
                                                {"roll_deg", scan.mounting->roll_deg}}
                                         : Json()},
              {"low_m", scan.low_m},
              {"high_m", scan.high_m},
              {"min_m", scan.min_m},
              {"max_m", scan.max_m},
              {"sectors", Json::array()}};
    for (const disparity::ScanSector& sector : scan.sectors) {
        json["sectors"].push_back(sector_json(sector));
    }
    return json;
}

}  // namespace disparityd::json
