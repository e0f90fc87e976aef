// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capture/camera_calibration.h"
#include "capture/frame_source.h"
#include "capture/rectification.h"
#include "kernels/options.h"

namespace disparityd {

enum class PolicyChoice : unsigned char { automatic, live, replay };
enum class LogLevel : unsigned char { debug, info, warning, error };
enum class LogTarget : unsigned char { automatic, terminal, journal };

/// The configuration, typed and checked. disparityd.example.toml documents every key; the sections have the same names.
struct Config {
    struct Source {
        std::string uri = "scene:vga@15";
        capture::Pace pace = capture::Pace::source;
        bool loop = false;
        std::string calibration;  ///< empty = what the source brings
        /// Folders with calibrations by serial number of cameras, between colons.
        std::string calibration_folders = capture::standard_calibration_folders;
        bool allow_unrectified = false;  ///< cameras only
        bool sensors = true;             ///< cameras only
        std::string controls;            ///< cameras only; see capture::parse_camera_settings()
        int stall_ms = 1000;             ///< cameras only
        PolicyChoice policy = PolicyChoice::automatic;
    } source;

    struct Rectify {
        capture::RectifiedGeometry geometry;
        bool colour = false;
    } rectify;

    struct Match {
        std::string backend = "auto";
        MatchOptions options = default_options(Method::sgm);
        bool depth = true;
    } match;

    struct Pipeline {
        int slots = 4;
        int workers = 0;  ///< 0 = one per core
        bool pin_workers = true;
    } pipeline;

    struct SharedMemory {
        bool enabled = true;
        std::string name = "default";
        int slots = 4;
    } shared_memory;

    struct Socket {
        std::string tcp = "127.0.0.1:9876";  ///< empty = off
        std::string unix_path = "auto";      ///< empty = off; see resolved_unix_path()
        int max_clients = 64;
        int client_queue = 4;
        bool insecure = false;
    } socket;

    struct Log {
        LogLevel level = LogLevel::info;
        LogTarget target = LogTarget::automatic;
    } log;

    struct Record {
        bool enabled = true;
        std::string directory;  ///< empty = see resolved_record_directory()
    } record;

    struct SelfCalibration {
        bool enabled = true;
        bool replays = false;
        int interval_s = 10;
        std::string directory;  ///< empty = see resolved_correction_directory()
    } self_calibration;
};

/// A value from the command line; `origin` is what the user typed, for messages.
struct Override {
    std::string section;
    std::string key;
    std::string text;
    std::string origin;
};

/// "section.key=value" as --set has it. Throws std::invalid_argument for any other form.
Override parse_override(const std::string& text);

/// Reads the file (an empty path: the defaults), applies the overrides on top and checks everything. Match keys that
/// are set nowhere take default_options(method). Throws std::invalid_argument with one line: where, key, what was
/// found, what is allowed.
Config load_config(const std::string& path, const std::vector<Override>& overrides);

/// The same for a text; `name` stands for the file in messages.
Config parse_config(const std::string& text, const std::string& name, const std::vector<Override>& overrides = {});

/// Where the Unix socket lies: "auto" is the first of these whose folder exists and may be written: $RUNTIME_DIRECTORY,
/// /run/disparityd, $XDG_RUNTIME_DIR, /tmp; the file is disparityd.sock, with "-<name>" before the dot when the shared
/// memory is not named "default", and with the user's number in /tmp. Empty when the socket is off.
std::string resolved_unix_path(const Config& config);

/// Where clients may record: the configured folder, $STATE_DIRECTORY, or the working directory.
std::string resolved_record_directory(const Config& config);

/// Where corrections of calibrations are kept: the configured folder, else $STATE_DIRECTORY; empty: nowhere.
std::string resolved_correction_directory(const Config& config);

}  // namespace disparityd
