// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include <unistd.h>

#include "base/failure_text.h"
#include "base/message_text.h"
#include "base/text_file.h"
#include "daemon/config/config_keys.h"
#include "daemon/config/socket_address.h"
#include "daemon/config/toml_text.h"
#include "kernels/match_fields.h"

namespace disparityd::daemon {
namespace {

/// One value for one key, and where the user wrote it.
struct Assignment {
    const ConfigKey* key;
    ConfigValue value;
    std::string where;
};

/// Throws the line. Keys and values come from outside, so it is made printable.
[[noreturn]] void refuse(const std::string& line) {
    constexpr std::size_t longest = 800;
    throw std::invalid_argument(base::printable(line, longest));
}

std::string key_name(std::string_view section, std::string_view name) {
    return '[' + std::string(section) + "] " + std::string(name);
}

int edit_distance(std::string_view a, std::string_view b) {
    std::vector<int> row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 0; i < a.size(); ++i) {
        int diagonal = row[0];
        row[0] = static_cast<int>(i) + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const int replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

/// Returns "did you mean ...?" if one of the names is close, else the list of all names.
std::string suggestion(std::string_view found, const std::set<std::string_view>& names) {
    const auto nearest = std::min_element(names.begin(), names.end(), [found](auto a, auto b) {
        return edit_distance(found, a) < edit_distance(found, b);
    });
    if (nearest != names.end() &&
        edit_distance(found, *nearest) <= std::max<int>(1, static_cast<int>(found.size()) / 3)) {
        return "did you mean \"" + std::string(*nearest) + "\"?";
    }
    std::string list;
    for (const auto name : names) {
        list += (list.empty() ? "" : ", ") + std::string(name);
    }
    return "allowed: " + list;
}

void check_section(std::string_view section, const std::string& where) {
    std::set<std::string_view> sections;
    for (const ConfigKey& key : config_keys()) {
        sections.insert(key.section);
    }
    if (!sections.contains(section)) {
        refuse(where + ": unknown section [" + base::printable(section) + "]; " + suggestion(section, sections));
    }
}

const ConfigKey& find_key(std::string_view section, std::string_view name, const std::string& where) {
    check_section(section, where);
    std::set<std::string_view> names;
    for (const ConfigKey& key : config_keys()) {
        if (key.section == section && key.name == name) {
            return key;
        }
        if (key.section == section) {
            names.insert(key.name);
        }
    }
    refuse(where + ": unknown key " + key_name(section, base::printable(name)) + "; " + suggestion(name, names));
}

[[noreturn]] void refuse_value(const std::string& where, const ConfigKey& key, const std::string& found) {
    refuse(where + ": " + key_name(key.section, key.name) + ": found " + base::printable(found) +
           ", allowed: " + key.allowed);
}

Assignment to_assignment(const ConfigKey& key, const TomlSetting& setting) {
    if (!setting.value) {
        refuse_value(setting.where, key, setting.found);
    }
    return {&key, *setting.value, setting.where};
}

std::vector<TomlSection> parse_file(const std::string& text, const std::string& name) {
    try {
        return parse_toml(text, name);
    } catch (const std::invalid_argument& error) {
        refuse(error.what());
    }
}

std::vector<Assignment> read_assignments(const std::vector<TomlSection>& file) {
    std::vector<Assignment> assignments;
    for (const TomlSection& section : file) {
        if (!section.is_table) {
            refuse(section.where + ": key " + base::printable(section.name) +
                   " stands outside of a section; allowed: [section] first");
        }
        check_section(section.name, section.where);
        for (const TomlSetting& setting : section.settings) {
            assignments.push_back(to_assignment(find_key(section.name, setting.key, setting.where), setting));
        }
    }
    return assignments;
}

/// Returns the value that the user typed for a key: text as it is, other types as TOML.
Assignment to_assignment(const Override& given) {
    const ConfigKey& key = find_key(given.section, given.key, given.origin);
    const bool quoted = given.text.size() >= 2 && given.text.front() == '"' && given.text.back() == '"';
    if (std::holds_alternative<std::string>(key.example) && !quoted) {
        return {&key, given.text, given.origin};
    }
    if (const auto setting = parse_toml_value(given.text, given.origin)) {
        return to_assignment(key, *setting);
    }
    refuse_value(given.origin, key, '"' + given.text + '"');
}

void apply(Config& config, const Assignment& assignment) {
    if (!assignment.key->set(config, assignment.value)) {
        const bool not_whole = std::holds_alternative<double>(assignment.value) &&
                               std::holds_alternative<std::int64_t>(assignment.key->example);
        refuse_value(assignment.where, *assignment.key,
                     to_text(assignment.value) + (not_whole ? ", which is no whole number" : ""));
    }
}

/// Returns whether the defaults of other match keys depend on this key.
bool decides_defaults(const ConfigKey& key) {
    return key.section == "match" &&
           (key.name == "preset" || key.name == "method" || key.name == "d_min" || key.name == "disparities");
}

/// Returns where a key was set last, for messages about keys that contradict each other.
std::string where_set(const std::vector<Assignment>& assignments, std::string_view section, std::string_view name,
                      const std::string& otherwise) {
    std::string where = otherwise;
    for (const Assignment& assignment : assignments) {
        if (assignment.key->section == section && assignment.key->name == name) {
            where = assignment.where;
        }
    }
    return where;
}

void check_socket(const Config& config, const std::vector<Assignment>& assignments, const std::string& file) {
    const Config::Socket& socket = config.socket;
    const auto refuse_key = [&](const char* section, const char* key, const std::string& why) {
        refuse(where_set(assignments, section, key, file) + ": " + key_name(section, key) + ": " + why);
    };
    if (socket.certificate.empty() != socket.key.empty()) {
        refuse_key("socket", socket.certificate.empty() ? "key" : "certificate",
                   "found without its " + std::string(socket.certificate.empty() ? "certificate" : "key") +
                       ", allowed: certificate and key, or neither");
    }
    if (!socket.client_authority.empty() && socket.certificate.empty()) {
        refuse_key("socket", "client_authority", "found without certificate and key, allowed: with both (TLS)");
    }
    if (!config.access.control_certificates.empty() && socket.client_authority.empty()) {
        refuse_key("access", "control_certificates",
                   "found names, allowed: with [socket] client_authority, which clients' certificates are checked by");
    }
    const bool is_protected =
        !socket.certificate.empty() && (!socket.client_authority.empty() || !socket.tokens.empty());
    if (const std::string problem = tcp_address_problem(socket.tcp, is_protected, socket.insecure); !problem.empty()) {
        refuse_key("socket", "tcp", problem);
    }
}

void check_together(const Config& config, const std::vector<Assignment>& assignments, const std::string& file) {
    const SgmOptions& sgm = config.match.options.sgm;
    if (sgm.p1 >= sgm.p2) {
        refuse(where_set(assignments, "match", "p1", where_set(assignments, "match", "p2", file)) +
               ": [match] p1: found " + std::to_string(sgm.p1) + ", allowed: less than p2, which is " +
               std::to_string(sgm.p2));
    }
    const std::string match_problem = validate(config.match.options);
    if (!match_problem.empty()) {
        refuse(file + ": [match]: " + match_problem);
    }
    const std::string scan_problem = validate(config.scan.options);
    if (!scan_problem.empty()) {
        refuse(file + ": [scan] " + scan_problem);
    }
    if (config.output.max_m > 0 && config.output.min_m >= config.output.max_m) {
        refuse(
            where_set(assignments, "output", "max_distance_m", file) +
            ": [output] max_distance_m: found no more than min_distance_m, allowed: more than that, or 0 for no limit");
    }
    const auto& geometry = config.rectify.geometry;
    if ((geometry.width == 0) != (geometry.height == 0)) {
        refuse(where_set(assignments, "rectify", "width", where_set(assignments, "rectify", "height", file)) +
               ": [rectify] width and height: found " + std::to_string(geometry.width) + " and " +
               std::to_string(geometry.height) + ", allowed: both 0 (the camera's size) or both set");
    }
    check_socket(config, assignments, file);
}

/// Returns a note for a configuration that sets how SGM matches and chooses no preset: from before there were presets,
/// when its other keys had other defaults.
std::vector<std::string> note_on_preset(const std::vector<Assignment>& assignments, const std::string& file) {
    const bool older = std::any_of(assignments.begin(), assignments.end(), [](const Assignment& assignment) {
        constexpr std::string_view others[] = {"backend", "d_min", "disparities", "depth"};
        const ConfigKey& key = *assignment.key;
        return key.section == "match" && std::find(std::begin(others), std::end(others), key.name) == std::end(others);
    });
    if (!older || !where_set(assignments, "match", "preset", "").empty()) {
        return {};
    }
    return {file +
            ": [match] preset: not set, so what the file does not set is that of \"obstacles\" (census-7x5+gradient, 4 "
            "paths); preset = \"paper\" is as before"};
}

/// Returns notes on keys that the chosen method does not use. A file may keep keys of the other methods, so they are
/// allowed; the note says that they change nothing.
std::vector<std::string> notes_on(const Config& config, const std::vector<Assignment>& assignments,
                                  const std::string& file) {
    const Method method = config.match.options.method;
    if (method == Method::sgm) {
        return note_on_preset(assignments, file);
    }
    std::vector<std::string> notes;
    const std::string cost = where_set(assignments, "match", "cost", "");
    if (method == Method::sad && !cost.empty()) {
        notes.push_back(cost + ": [match] cost: only sgm and census use this, the method is sad");
    }
    std::string keys;
    std::string where;
    const auto look = [&](std::string_view key) {
        const std::string found = where_set(assignments, "match", key, "");
        if (!found.empty()) {
            keys += (keys.empty() ? "" : ", ") + std::string(key);
            where = where.empty() ? found : where;
        }
    };
    look("preset");
    for (const MatchField& field : match_fields()) {
        if (field.is_of_sgm()) {
            look(field.name);
        }
    }
    if (!keys.empty()) {
        notes.push_back(where + ": [match] " + keys + ": only sgm uses this, the method is " +
                        std::string(to_string(method)));
    }
    return notes;
}

/// Returns notes on folders that were set and cannot be written to now. That refuses no configuration: the daemon runs
/// without them, and their disk may come later.
std::vector<std::string> notes_on_folders(const Config& config, const std::vector<Assignment>& assignments) {
    std::vector<std::string> notes;
    const auto look = [&](const char* section, const std::string& folder, bool used, const char* until_then) {
        const std::string where = where_set(assignments, section, "directory", "");
        if (used && !where.empty() && !folder.empty() && ::access((folder + "/.").c_str(), W_OK | X_OK) != 0) {
            notes.push_back(where + ": [" + section + "] directory: " + base::printable(folder) + ": " +
                            base::error_text(errno) + "; " + until_then +
                            " until it is a folder that the daemon may write to");
        }
    };
    look("record", config.record.directory, config.record.enabled, "recordings are refused");
    look("self_calibration", config.self_calibration.directory, config.self_calibration.enabled,
         "no correction is kept");
    return notes;
}

std::string read_text(const std::string& path) {
    try {
        return base::read_text_file(path, "configuration");
    } catch (const std::invalid_argument& error) {
        std::error_code ignored;
        const bool found = std::filesystem::is_regular_file(path, ignored);
        refuse(std::string(error.what()) +
               (found ? "" : "; check the path given with --config, or start without it for the defaults"));
    }
}

Config build(std::vector<Assignment> assignments, const std::string& file, const std::vector<Override>& overrides) {
    for (const Override& given : overrides) {
        assignments.push_back(to_assignment(given));
    }
    Config config;
    for (const Assignment& assignment : assignments) {
        if (decides_defaults(*assignment.key)) {
            apply(config, assignment);
        }
    }
    const DisparityRange range = config.match.options.range;
    const Method method = config.match.options.method;
    const bool has_preset = method == Method::sgm && config.match.preset;
    config.match.options = has_preset ? preset_options(*config.match.preset, range) : default_options(method, range);
    for (const Assignment& assignment : assignments) {
        apply(config, assignment);
    }
    if (where_set(assignments, "scan", "min_confidence", "").empty()) {
        config.scan.options.min_confidence = default_min_confidence(calibrates_confidence(config.match.options));
    }
    check_together(config, assignments, file);
    config.notes = notes_on(config, assignments, file);
    for (std::string& note : notes_on_folders(config, assignments)) {
        config.notes.push_back(std::move(note));
    }
    return config;
}

}  // namespace

Override parse_override(const std::string& text) {
    const auto equals = text.find('=');
    const auto dot = text.find('.');
    constexpr std::size_t longest = 200;  // the line also says what was found and what is allowed
    const std::string origin = "--set " + base::printable(text, longest);
    if (equals == std::string::npos || dot == std::string::npos || dot > equals) {
        refuse(origin + ": found no section.key=value, allowed: such as match.disparities=128");
    }
    return {text.substr(0, dot), text.substr(dot + 1, equals - dot - 1), text.substr(equals + 1), origin};
}

Config parse_config(const std::string& text, const std::string& name, const std::vector<Override>& overrides) {
    return build(read_assignments(parse_file(text, name)), name, overrides);
}

Config load_config(const std::string& path, const std::vector<Override>& overrides) {
    if (path.empty()) {
        return build({}, "defaults", overrides);
    }
    return parse_config(read_text(path), path, overrides);
}

}  // namespace disparityd::daemon
