// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/scan_arguments.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <variant>

#include <CLI/CLI.hpp>

#include "base/number_text.h"

namespace disparityd::tools {
namespace {

[[noreturn]] void refuse_setting(const std::string& setting, const std::string& allowed) {
    throw std::invalid_argument("--scan-set: found '" + setting + "', allowed: " + allowed);
}

std::string all_scan_keys() {
    std::string list;
    for (const ScanField& field : scan_fields()) {
        list += (list.empty() ? "" : ", ") + std::string(field.name);
    }
    return list;
}

int whole_number(const std::string& setting, std::string_view value) {
    int number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || end != value.data() + value.size()) {
        refuse_setting(setting, "a whole number");
    }
    return number;
}

double real_number(const std::string& setting, std::string_view value) {
    const auto number = base::parse_number(value);
    if (!number) {
        refuse_setting(setting, "a number");
    }
    return *number;
}

GroundMode ground_mode(const std::string& setting, std::string_view value) {
    const auto mode = parse_ground_mode(value);
    if (!mode) {
        refuse_setting(setting, std::string(ground_mode_names));
    }
    return *mode;
}

bool truth(const std::string& setting, std::string_view value) {
    if (value != "true" && value != "false") {
        refuse_setting(setting, "true or false");
    }
    return value == "true";
}

/// Stores the value of one KEY=VALUE.
void apply_setting(const std::string& setting, ScanOptions& options) {
    const std::string_view text = setting;
    const std::size_t equals = text.find('=');
    const auto fields = scan_fields();
    const auto key = std::find_if(fields.begin(), fields.end(),
                                  [&](const ScanField& candidate) { return candidate.name == text.substr(0, equals); });
    if (key == fields.end() || equals == std::string_view::npos) {
        refuse_setting(setting, "KEY=VALUE, where KEY is one of " + all_scan_keys());
    }
    const std::string_view value = text.substr(equals + 1);
    if (const auto* const whole = std::get_if<int ScanOptions::*>(&key->field)) {
        options.*(*whole) = whole_number(setting, value);
    } else if (const auto* const real = std::get_if<double ScanOptions::*>(&key->field)) {
        options.*(*real) = real_number(setting, value);
    } else if (const auto* const flag = std::get_if<bool ScanOptions::*>(&key->field)) {
        options.*(*flag) = truth(setting, value);
    } else if (const auto* const text_field = std::get_if<std::string ScanOptions::*>(&key->field)) {
        options.*(*text_field) = value;
    } else {
        options.*(std::get<GroundMode ScanOptions::*>(key->field)) = ground_mode(setting, value);
    }
}

}  // namespace

CLI::Option* ScanArguments::add_to(CLI::App& app) {
    return app
        .add_option(
            "--scan-set", settings_,
            "an option of the scan, such as camera_height_m=0.4; may be given several times: " + all_scan_keys())
        ->allow_extra_args(false)
        ->type_name("KEY=VALUE");
}

ScanOptions ScanArguments::options(bool calibrated) const {
    ScanOptions options;
    options.min_confidence = default_min_confidence(calibrated);
    for (const std::string& setting : settings_) {
        apply_setting(setting, options);
    }
    if (const std::string wrong = validate(options); !wrong.empty()) {
        throw std::invalid_argument("--scan-set: " + wrong);
    }
    return options;
}

}  // namespace disparityd::tools
