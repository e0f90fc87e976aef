// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/scan_csv.h"

#include <cmath>

#include "clients/json/scan_json.h"
#include "proto/doubt.h"
#include "tools/command_line/table.h"
#include "tools/ctl/output_file.h"

namespace disparityd::tools {
namespace {

using json::ground_word;
using json::sector_word;

/// A whole number of thousandths and the like, as a decimal. It has no "-0.000".
std::string decimal(long number, int decimals) {
    return fixed(static_cast<double>(number) / std::pow(10, decimals), decimals);
}

std::string sector_fields(const ScanSector& sector) {
    const bool occupied = sector.state == SectorState::occupied;
    std::string fields =
        decimal(sector.from_cdeg, 2) + ',' + decimal(sector.to_cdeg, 2) + ',' + sector_word(sector.state) + ',';
    fields += occupied ? decimal(sector.distance_mm, 3) + ',' + decimal(sector.sigma_mm, 3) + ',' : ",,";
    fields += decimal(sector.free_mm, 3) + ',';
    if (!occupied) {
        return fields + ",,,";
    }
    return fields + decimal(sector.low_mm, 3) + ',' + decimal(sector.high_mm, 3) + ',' + std::to_string(sector.pixels) +
           ',' + std::to_string(sector.confidence);
}

std::string trust_fields(const ScanSector& sector) {
    return std::to_string(sector.trust) + ',' +
           proto::doubt_names(std::uint32_t{sector.doubts} << proto::scan_doubt_shift);
}

std::string ground_fields(const proto::ScanHead& head) {
    return ground_word(head.ground) + (',' + std::to_string(head.ground_age)) + ',' + decimal(head.ground_mm, 3) + ',' +
           decimal(head.ground_slope_ahead, 4) + ',' + decimal(head.ground_slope_left, 4);
}

std::string mounting_fields(const proto::ScanHead& head) {
    return head.mounting_height_mm == 0
               ? ",,"
               : decimal(head.mounting_height_mm, 3) + ',' + decimal(head.mounting_pitch_cdeg, 2) + ',' +
                     decimal(head.mounting_roll_cdeg, 2);
}

std::string checked(const std::string& path, bool force) {
    check_absent(path, force);
    return path;
}

}  // namespace

std::string scan_csv_head() {
    return "frame,sequence,monotonic_ns,from_deg,to_deg,state,distance_m,sigma_m,free_m,low_m,high_m,pixels,confidence,"
           "ground,ground_age,ground_height_m,ground_slope_ahead,ground_slope_left,"
           "mounting_height_m,mounting_pitch_deg,mounting_roll_deg,trust,doubts\n";
}

std::string scan_csv_rows(const ScanMoment& moment, const ScanRecord& scan) {
    const std::string begin = std::to_string(moment.frame) + ',' + std::to_string(moment.sequence) + ',' +
                              std::to_string(moment.monotonic_ns) + ',';
    const std::string end = ',' + ground_fields(scan.head) + ',' + mounting_fields(scan.head) + ',';
    std::string rows;
    for (const ScanSector& sector : scan.sectors) {
        rows += begin;
        rows += sector_fields(sector);
        rows += end;
        rows += trust_fields(sector) + '\n';
    }
    return rows;
}

ScanCsv::ScanCsv(const std::string& path, bool force) : file_(checked(path, force)) {
    file_.write(scan_csv_head());
}

void ScanCsv::write(const ScanMoment& moment, const ScanRecord& scan) {
    file_.write(scan_csv_rows(moment, scan));
    file_.flush();
}

}  // namespace disparityd::tools
