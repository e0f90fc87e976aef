// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config_keys.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "base/number_text.h"
#include "capture/camera/camera_controls.h"
#include "kernels/match_fields.h"
#include "obstacles/gravity_ground.h"

namespace disparityd::daemon {
namespace {

constexpr const char* all_cores = "all";

std::string in_quotes(std::string_view text) {
    return '"' + std::string(text) + '"';
}

std::string number_text(double number) {
    std::ostringstream text;
    text << number;
    return text.str();
}

/// As TOML has it: with a point, so that it is no whole number.
std::string toml_text(double number) {
    const std::string text = number_text(number);
    return text + (text.find_first_not_of("-0123456789") == std::string::npos ? ".0" : "");
}

/// Makes a key for the field of the configuration that `field` returns.
template <typename Field>
ConfigKey text_key(std::string_view section, std::string_view name, std::string allowed, Field field,
                   bool (*valid)(const std::string&) = nullptr) {
    return {section,
            name,
            std::move(allowed),
            std::string(),
            [field, valid](Config& config, const ConfigValue& value) {
                const auto* text = std::get_if<std::string>(&value);
                if (text == nullptr || (valid != nullptr && !valid(*text))) {
                    return false;
                }
                field(config) = *text;
                return true;
            },
            [field](const Config& config) -> ConfigValue { return field(const_cast<Config&>(config)); }};
}

/// Makes a key for a list of names, none of them empty.
template <typename Field>
ConfigKey names_key(std::string_view section, std::string_view name, std::string allowed, Field field) {
    return {section,
            name,
            std::move(allowed),
            std::vector<std::string>{},
            [field](Config& config, const ConfigValue& value) {
                const auto* numbers = std::get_if<std::vector<std::int64_t>>(&value);
                const auto* names = std::get_if<std::vector<std::string>>(&value);
                if (numbers != nullptr && numbers->empty()) {  // [] may be a list of either
                    field(config).clear();
                    return true;
                }
                if (names == nullptr || std::find(names->begin(), names->end(), "") != names->end()) {
                    return false;
                }
                field(config) = *names;
                return true;
            },
            [field](const Config& config) -> ConfigValue { return field(const_cast<Config&>(config)); }};
}

template <typename Field>
ConfigKey bool_key(std::string_view section, std::string_view name, Field field) {
    return {section,
            name,
            "true or false",
            false,
            [field](Config& config, const ConfigValue& value) {
                const auto* flag = std::get_if<bool>(&value);
                if (flag == nullptr) {
                    return false;
                }
                field(config) = *flag;
                return true;
            },
            [field](const Config& config) -> ConfigValue { return field(const_cast<Config&>(config)); }};
}

template <typename Field>
ConfigKey int_key(std::string_view section, std::string_view name, std::string allowed, Field field,
                  std::function<bool(std::int64_t)> valid) {
    return {section,
            name,
            std::move(allowed),
            std::int64_t{0},
            [field, valid = std::move(valid)](Config& config, const ConfigValue& value) {
                const auto* number = std::get_if<std::int64_t>(&value);
                if (number == nullptr || !valid(*number)) {
                    return false;
                }
                field(config) = static_cast<int>(*number);
                return true;
            },
            [field](const Config& config) -> ConfigValue { return std::int64_t{field(const_cast<Config&>(config))}; }};
}

template <typename Field>
ConfigKey range_key(std::string_view section, std::string_view name, int least, int most, Field field) {
    return int_key(section, name, std::to_string(least) + " .. " + std::to_string(most), field,
                   [least, most](std::int64_t number) { return number >= least && number <= most; });
}

/// Makes a key for a number that need not be whole.
template <typename Field>
ConfigKey number_key(std::string_view section, std::string_view name, double least, double most, Field field) {
    return {section,
            name,
            number_text(least) + " .. " + number_text(most),
            0.0,
            [field, least, most](Config& config, const ConfigValue& value) {
                const auto* whole = std::get_if<std::int64_t>(&value);
                const auto* real = std::get_if<double>(&value);
                if (whole == nullptr && real == nullptr) {
                    return false;
                }
                const double number = whole != nullptr ? static_cast<double>(*whole) : *real;
                if (!(number >= least && number <= most)) {  // refuses what is no number, too
                    return false;
                }
                field(config) = number;
                return true;
            },
            [field](const Config& config) -> ConfigValue { return field(const_cast<Config&>(config)); }};
}

/// Makes a key for a number of cores, or "all", for which the field is none. Text may be a number, too: the command
/// line gives text.
template <typename Field>
ConfigKey cores_key(std::string_view section, std::string_view name, Field field) {
    constexpr double least = 0.1, most = 256;
    return {section,
            name,
            "\"all\" or a number of cores, " + number_text(least) + " .. " + number_text(most),
            std::string(all_cores),
            [field](Config& config, const ConfigValue& value) {
                const auto* text = std::get_if<std::string>(&value);
                const auto* whole = std::get_if<std::int64_t>(&value);
                const auto* real = std::get_if<double>(&value);
                if (text != nullptr && *text == all_cores) {
                    field(config).reset();
                    return true;
                }
                const auto cores = text != nullptr    ? base::parse_number(*text)
                                   : whole != nullptr ? std::optional(static_cast<double>(*whole))
                                   : real != nullptr  ? std::optional(*real)
                                                      : std::nullopt;
                if (!cores || !(*cores >= least && *cores <= most)) {
                    return false;
                }
                field(config) = cores;
                return true;
            },
            [field](const Config& config) -> ConfigValue {
                const std::optional<double> cores = field(const_cast<Config&>(config));
                return cores ? ConfigValue(*cores) : ConfigValue(std::string(all_cores));
            }};
}

template <typename Enum>
using Names = std::vector<std::pair<std::string_view, Enum>>;

/// Returns the values with their names.
template <typename Enum, std::size_t count>
Names<Enum> names_of(const std::array<Enum, count>& values) {
    Names<Enum> names;
    for (const Enum value : values) {
        names.emplace_back(to_string(value), value);
    }
    return names;
}

template <typename Enum, typename Field>
ConfigKey name_key(std::string_view section, std::string_view name, const Names<Enum>& list, Field field) {
    std::string allowed;
    for (const auto& [word, _] : list) {
        allowed += (allowed.empty() ? "" : " or ") + in_quotes(word);
    }
    return {section,
            name,
            allowed,
            std::string(),
            [field, list](Config& config, const ConfigValue& value) {
                const auto* text = std::get_if<std::string>(&value);
                const auto match = std::find_if(list.begin(), list.end(), [text](const auto& entry) {
                    return text != nullptr && entry.first == *text;
                });
                if (match == list.end()) {
                    return false;
                }
                field(config) = match->second;
                return true;
            },
            [field, list](const Config& config) -> ConfigValue {
                const auto match = std::find_if(list.begin(), list.end(), [&](const auto& entry) {
                    return entry.second == field(const_cast<Config&>(config));
                });
                return std::string(match->first);
            }};
}

bool set_region(Config& config, const ConfigValue& value) {
    const auto* numbers = std::get_if<std::vector<std::int64_t>>(&value);
    if (numbers == nullptr || (numbers->size() != 4 && !numbers->empty())) {
        return false;
    }
    const bool in_range = std::all_of(numbers->begin(), numbers->end(), [](auto n) { return n >= 0 && n <= 8192; });
    if (!in_range || (!numbers->empty() && ((*numbers)[2] == 0 || (*numbers)[3] == 0))) {
        return false;
    }
    const auto at = [numbers](std::size_t i) { return numbers->empty() ? 0 : static_cast<int>((*numbers)[i]); };
    config.rectify.geometry.region = {at(0), at(1), at(2), at(3)};
    return true;
}

ConfigValue get_region(const Config& config) {
    const auto& region = config.rectify.geometry.region;
    if (region.width == 0) {
        return std::vector<std::int64_t>{};
    }
    return std::vector<std::int64_t>{region.x, region.y, region.width, region.height};
}

bool is_object_name(const std::string& text) {
    return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
    });
}

bool is_not_empty(const std::string& text) {
    return !text.empty();
}

bool are_sensor_axes(const std::string& text) {
    return text.empty() || scan::parse_sensor_axes(text).has_value();
}

bool is_camera_settings(const std::string& text) {
    try {
        capture::parse_camera_settings(text, "");
        return true;
    } catch (const std::invalid_argument&) {
        return false;
    }
}

bool is_socket_path(const std::string& text) {
    return text.size() < 108;
}

/// Makes the key of a number or switch of matching.
ConfigKey match_key(const MatchField& row) {
    if (const auto* const flag = std::get_if<bool& (*)(MatchOptions&)>(&row.field)) {
        return bool_key("match", row.name, [of = *flag](Config& config) -> bool& { return of(config.match.options); });
    }
    return int_key(
        "match", row.name, row.allowed(),
        [of = std::get<int& (*)(MatchOptions&)>(row.field)](Config& config) -> int& {
            return of(config.match.options);
        },
        [&row](std::int64_t number) { return row.allows(number); });
}

/// Makes the key of an option of the obstacle scan.
ConfigKey scan_key(const ScanField& row) {
    return std::visit(
        [&row](auto member) {
            const auto field = [member](Config & config) -> auto& {
                return config.scan.options.*member;
            };
            using Value = std::remove_reference_t<decltype(ScanOptions().*member)>;
            if constexpr (std::is_same_v<Value, int>) {
                return range_key("scan", row.name, static_cast<int>(row.min), static_cast<int>(row.max), field);
            } else if constexpr (std::is_same_v<Value, double>) {
                return number_key("scan", row.name, row.min, row.max, field);
            } else if constexpr (std::is_same_v<Value, bool>) {
                return bool_key("scan", row.name, field);
            } else if constexpr (std::is_same_v<Value, GroundMode>) {
                return name_key<GroundMode>("scan", row.name,
                                            {{"fitted", GroundMode::fitted},
                                             {"configured", GroundMode::configured},
                                             {"gravity", GroundMode::gravity},
                                             {"autopilot", GroundMode::autopilot}},
                                            field);
            } else {
                return text_key("scan", row.name, "\"\" or " + std::string(scan::sensor_axes_form), field,
                                are_sensor_axes);
            }
        },
        row.field);
}

/// The one that the errors of depths follow from, too.
bool of_match(const ScanField& field) {
    return field.name == "subpixel_error_px";
}

// Shorthand for the way from the configuration to a field.
#define FIELD(member)         \
    [](Config & c) -> auto& { \
        return c.member;      \
    }

void add_input_keys(std::vector<ConfigKey>& keys) {
    keys.push_back(text_key("source", "uri", "the name of a source (disparityctl sources lists them)",
                            FIELD(source.uri), is_not_empty));
    keys.push_back(name_key<capture::Pace>("source", "pace",
                                           {{"source", capture::Pace::source}, {"fastest", capture::Pace::fastest}},
                                           FIELD(source.pace)));
    keys.push_back(bool_key("source", "loop", FIELD(source.loop)));
    keys.push_back(name_key<SourceStart>("source", "start",
                                         {{"at-once", SourceStart::at_once}, {"on-client", SourceStart::on_client}},
                                         FIELD(source.start)));
    keys.push_back(name_key<capture::Stamp>(
        "source", "stamp", {{"source", capture::Stamp::source}, {"exposure-centre", capture::Stamp::exposure_centre}},
        FIELD(source.stamp)));
    keys.push_back(range_key("source", "time_offset_us", -100000, 100000, FIELD(source.time_offset_us)));
    keys.push_back(text_key("source", "calibration", "a file name, or \"\"", FIELD(source.calibration)));
    keys.push_back(text_key("source", "calibration_folders", "folders with ':' between them, or \"\"",
                            FIELD(source.calibration_folders)));
    keys.push_back(bool_key("source", "allow_unrectified", FIELD(source.allow_unrectified)));
    keys.push_back(bool_key("source", "sensors", FIELD(source.sensors)));
    keys.push_back(text_key("source", "controls", "NAME=NUMBER with spaces between, or \"\"", FIELD(source.controls),
                            is_camera_settings));
    keys.push_back(range_key("source", "stall_ms", 200, 60000, FIELD(source.stall_ms)));
    keys.push_back(
        name_key("source", "policy",
                 Names<PolicyChoice>{
                     {"auto", PolicyChoice::automatic}, {"live", PolicyChoice::live}, {"replay", PolicyChoice::replay}},
                 FIELD(source.policy)));
    keys.push_back(range_key("rectify", "width", 0, 8192, FIELD(rectify.geometry.width)));
    keys.push_back(range_key("rectify", "height", 0, 8192, FIELD(rectify.geometry.height)));
    keys.push_back({"rectify", "region",
                    "[] or [x, y, width, height] in pixels, each 0 .. 8192, width and height at least 1",
                    std::vector<std::int64_t>{}, set_region, get_region});
    keys.push_back(bool_key("rectify", "colour", FIELD(rectify.colour)));
    keys.push_back(bool_key("rectify", "right", FIELD(rectify.right)));
    keys.push_back(bool_key("rectify", "raw", FIELD(rectify.raw)));
}

void add_match_keys(std::vector<ConfigKey>& keys) {
    Names<std::optional<Preset>> presets{{"none", std::nullopt}};
    for (const Preset preset : all_presets) {
        presets.emplace_back(to_string(preset), preset);
    }
    keys.push_back(name_key("match", "preset", presets, FIELD(match.preset)));
    keys.push_back(name_key("match", "method", names_of(all_methods), FIELD(match.options.method)));
    keys.push_back(name_key("match", "cost", names_of(all_costs), FIELD(match.options.cost)));
    keys.push_back(
        text_key("match", "backend", "\"auto\" or the name of a back end", FIELD(match.backend), is_not_empty));
    for (const MatchField& field : match_fields()) {
        keys.emplace_back(match_key(field));
    }
    keys.push_back(bool_key("match", "depth", FIELD(match.depth)));
    keys.push_back(bool_key("match", "depth_error", FIELD(match.depth_error)));
    const auto error = std::find_if(scan_fields().begin(), scan_fields().end(), of_match);
    keys.push_back(number_key("match", "subpixel_error_px", error->min, error->max, FIELD(match.subpixel_error_px)));
}

void add_mask_keys(std::vector<ConfigKey>& keys) {
    keys.push_back(names_key("mask", "polygons", "[] or polygons \"x,y x,y x,y\" in pixels", FIELD(mask.polygons)));
    keys.push_back(text_key("mask", "image", "a file name, or \"\"", FIELD(mask.image)));
}

void add_scan_keys(std::vector<ConfigKey>& keys) {
    keys.push_back(bool_key("scan", "enabled", FIELD(scan.enabled)));
    for (const ScanField& field : scan_fields()) {
        if (!of_match(field)) {
            keys.emplace_back(scan_key(field));
        }
    }
}

void add_temporal_keys(std::vector<ConfigKey>& keys) {
    keys.push_back(bool_key("temporal", "enabled", FIELD(temporal.enabled)));
}

void add_trust_keys(std::vector<ConfigKey>& keys) {
    keys.push_back(bool_key("trust", "enabled", FIELD(trust.enabled)));
    keys.push_back(range_key("trust", "dark_level", 1, 255, FIELD(trust.options.dark_level)));
    keys.push_back(number_key("trust", "rows_px", 0.1, 2.5, FIELD(trust.options.rows_px)));
}

void add_limit_keys(std::vector<ConfigKey>& keys) {
    constexpr double most_m = 65;
    keys.push_back(number_key("output", "min_distance_m", 0, most_m, FIELD(output.min_m)));
    keys.push_back(number_key("output", "max_distance_m", 0, most_m, FIELD(output.max_m)));
}

void add_output_keys(std::vector<ConfigKey>& keys) {
    keys.push_back(range_key("pipeline", "slots", 2, 32, FIELD(pipeline.slots)));
    keys.push_back(range_key("pipeline", "workers", 0, 256, FIELD(pipeline.workers)));
    keys.push_back(cores_key("pipeline", "cores", FIELD(pipeline.cores)));
    keys.push_back(bool_key("pipeline", "pin_workers", FIELD(pipeline.pin_workers)));
    keys.push_back(bool_key("pipeline", "on_demand", FIELD(pipeline.on_demand)));
    keys.push_back(bool_key("shared_memory", "enabled", FIELD(shared_memory.enabled)));
    keys.push_back(text_key("shared_memory", "name", "1 .. 64 letters, digits, '-', '_' or '.'",
                            FIELD(shared_memory.name), is_object_name));
    keys.push_back(range_key("shared_memory", "slots", 2, 64, FIELD(shared_memory.slots)));
    keys.push_back(text_key("socket", "tcp", "\"ADDRESS:PORT\", or \"\" for none", FIELD(socket.tcp)));
    keys.push_back(text_key("socket", "unix", "\"auto\", a path of less than 108 bytes, or \"\" for none",
                            FIELD(socket.unix_path), is_socket_path));
    keys.push_back(range_key("socket", "max_clients", 1, 1024, FIELD(socket.max_clients)));
    keys.push_back(range_key("socket", "client_queue", 1, 64, FIELD(socket.client_queue)));
    keys.push_back(text_key("socket", "certificate", "a file name, or \"\"", FIELD(socket.certificate)));
    keys.push_back(text_key("socket", "key", "a file name, or \"\"", FIELD(socket.key)));
    keys.push_back(text_key("socket", "client_authority", "a file name, or \"\"", FIELD(socket.client_authority)));
    keys.push_back(text_key("socket", "tokens", "a file name, or \"\"", FIELD(socket.tokens)));
    keys.push_back(bool_key("socket", "insecure", FIELD(socket.insecure)));
    keys.push_back(bool_key("socket", "tcp_control", FIELD(socket.tcp_control)));
    keys.push_back(range_key("socket", "idle_timeout_s", 0, 86400, FIELD(socket.idle_timeout_s)));
    keys.push_back(names_key("access", "view_groups", "[] or names of groups", FIELD(access.view_groups)));
    keys.push_back(names_key("access", "control_groups", "[] or names of groups", FIELD(access.control_groups)));
    keys.push_back(names_key("access", "control_certificates", "[] or common names of clients' certificates",
                             FIELD(access.control_certificates)));
    keys.push_back(name_key<LogLevel>("log", "level",
                                      {{"debug", LogLevel::debug},
                                       {"info", LogLevel::info},
                                       {"warning", LogLevel::warning},
                                       {"error", LogLevel::error}},
                                      FIELD(log.level)));
    keys.push_back(name_key<LogTarget>(
        "log", "target",
        {{"auto", LogTarget::automatic}, {"terminal", LogTarget::terminal}, {"journal", LogTarget::journal}},
        FIELD(log.target)));
    keys.push_back(bool_key("record", "enabled", FIELD(record.enabled)));
    keys.push_back(text_key("record", "directory", "a folder, or \"\"", FIELD(record.directory)));
    keys.push_back(range_key("record", "keep_free_mb", 0, 100000000, FIELD(record.keep_free_mb)));
    keys.push_back(range_key("record", "max_mb", 0, 100000000, FIELD(record.max_mb)));
    keys.push_back(range_key("record", "max_s", 0, 100000000, FIELD(record.max_s)));
    keys.push_back(name_key<WhenClientIsGone>("record", "when_client_is_gone",
                                              {{"go-on", WhenClientIsGone::go_on}, {"stop", WhenClientIsGone::stop}},
                                              FIELD(record.when_client_is_gone)));
    keys.push_back(bool_key("self_calibration", "enabled", FIELD(self_calibration.enabled)));
    keys.push_back(bool_key("self_calibration", "replays", FIELD(self_calibration.replays)));
    keys.push_back(range_key("self_calibration", "interval_s", 0, 86400, FIELD(self_calibration.interval_s)));
    keys.push_back(text_key("self_calibration", "directory", "a folder, or \"\"", FIELD(self_calibration.directory)));
}

#undef FIELD

}  // namespace

const std::vector<ConfigKey>& config_keys() {
    static const std::vector<ConfigKey> keys = [] {
        std::vector<ConfigKey> list;
        add_input_keys(list);
        add_match_keys(list);
        add_temporal_keys(list);
        add_mask_keys(list);
        add_scan_keys(list);
        add_trust_keys(list);
        add_limit_keys(list);
        add_output_keys(list);
        return list;
    }();
    return keys;
}

std::string to_text(const ConfigValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) {
        return in_quotes(*text);
    }
    if (const auto* number = std::get_if<std::int64_t>(&value)) {
        return std::to_string(*number);
    }
    if (const auto* flag = std::get_if<bool>(&value)) {
        return *flag ? "true" : "false";
    }
    if (const auto* number = std::get_if<double>(&value)) {
        return toml_text(*number);
    }
    std::string list;
    const auto add = [&list](const std::string& element) { list += (list.empty() ? "" : ", ") + element; };
    if (const auto* names = std::get_if<std::vector<std::string>>(&value)) {
        std::for_each(names->begin(), names->end(), [&](const std::string& name) { add(in_quotes(name)); });
    } else {
        for (const auto number : std::get<std::vector<std::int64_t>>(value)) {
            add(std::to_string(number));
        }
    }
    return '[' + list + ']';
}

std::string full_name(const ConfigKey& key) {
    return std::string(key.section) + '.' + std::string(key.name);
}

}  // namespace disparityd::daemon
