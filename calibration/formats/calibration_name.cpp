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

/// Splits at the comma between two files.
void split_files(CalibrationName& result, const std::string& files) {
    result.first = files;
    if (base::is_file(files)) {
        return;
    }
    bool found = false;
    for (auto comma = files.find(','); comma != std::string::npos; comma = files.find(',', comma + 1)) {
        const std::string first = files.substr(0, comma);
        const std::string second = files.substr(comma + 1);
        const bool both = base::is_file(first) && base::is_file(second);
        if (both || !found) {
            result.first = first;
            result.second = second;
            found = true;
        }
        if (both) {
            return;
        }
    }
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
        split_files(result, name);
        return result;
    }
    split_files(result, name.substr(0, mark));
    for (const std::string_view setting : base::split(std::string_view(name).substr(mark + 1), '&')) {
        read_setting(result, setting, name);
    }
    return result;
}

}  // namespace disparityd::calibration
