// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/calibration_name.h"

#include "base/file_kind.h"
#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/lens_model.h"

namespace disparityd::calibration {

namespace {

constexpr std::size_t most_files = 3;  // two cameras and an inertial sensor

void read_setting(CalibrationName& result, std::string_view setting, const std::string& name) {
    const auto equals = std::min(setting.find('='), setting.size());
    const std::string_view key = setting.substr(0, equals);
    const std::string_view value = setting.substr(std::min(equals + 1, setting.size()));
    if ((key == "unit" && result.unit_mm) || (key == "model" && result.lens) || (key == "pair" && result.pair)) {
        refuse_calibration(name,
                           "found '" + base::printable(key) + "' twice behind the question mark; once is allowed");
    }
    if (key == "unit" && millimetres_of_unit(value)) {
        result.unit_mm = millimetres_of_unit(value);
    } else if (key == "model" && (value == "brown" || value == "fisheye")) {
        result.lens = value == "brown" ? LensModel::pinhole : LensModel::fisheye;
    } else if (key == "pair" && (value == "grey" || value == "colour")) {
        result.pair = value == "grey" ? KittiPair::grey : KittiPair::colour;
    } else {
        refuse_calibration(
            name, "found '" + base::printable(setting) +
                      "' behind the question mark; allowed are unit=mm, unit=cm, unit=m, unit=25mm (the "
                      "side of a square), model=brown, model=fisheye, pair=grey and pair=colour, with & between them");
    }
}

/// Splits at the commas between files. Those that exist tell which commas are meant.
std::vector<std::string> split_files(std::string_view files) {
    std::vector<std::string> parts;
    while (parts.size() + 1 < most_files && !base::is_file(std::string(files))) {
        const auto first = files.find(',');
        if (first == std::string_view::npos) {
            break;
        }
        auto comma = first;
        while (comma != std::string_view::npos && !base::is_file(std::string(files.substr(0, comma)))) {
            comma = files.find(',', comma + 1);
        }
        comma = comma == std::string_view::npos ? first : comma;
        parts.emplace_back(files.substr(0, comma));
        files.remove_prefix(comma + 1);
    }
    parts.emplace_back(files);
    return parts;
}

}  // namespace

std::optional<double> millimetres_of_unit(std::string_view unit) {
    const std::string name = plain_name(base::trim(unit));
    for (const auto& [names, millimetres] : {std::pair("mm millimetre millimetres millimeter millimeters", 1.0),
                                             {"cm centimetre centimetres centimeter centimeters", 10.0},
                                             {"m metre metres meter meters", 1000.0}}) {
        for (const std::string_view known : base::split(names, ' ')) {
            if (name == known) {
                return millimetres;
            }
        }
    }
    const std::string_view trimmed = base::trim(unit);
    const auto length =
        trimmed.ends_with("mm") ? base::parse_number(base::trim(trimmed.substr(0, trimmed.size() - 2))) : std::nullopt;
    constexpr double least = 1e-3, most = 1e5;
    return length && *length >= least && *length <= most ? length : std::nullopt;
}

CalibrationName parse_calibration_name(const std::string& name) {
    CalibrationName result;
    const auto mark = name.rfind('?');
    if (mark == std::string::npos || base::is_file(name)) {
        result.files = split_files(name);
        return result;
    }
    result.files = split_files(std::string_view(name).substr(0, mark));
    for (const std::string_view setting : base::split(std::string_view(name).substr(mark + 1), '&')) {
        read_setting(result, setting, name);
    }
    return result;
}

}  // namespace disparityd::calibration
