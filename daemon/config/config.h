// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration_lookup.h"
#include "calibration/rectification.h"
#include "capture/frame_source.h"
#include "kernels/options.h"
#include "obstacles/scan_options.h"
#include "pipeline/distance_limits.h"
#include "trust/trust_options.h"

namespace disparityd::daemon {

enum class PolicyChoice : unsigned char { automatic, live, replay };
enum class SourceStart : unsigned char { at_once, on_client };
enum class LogLevel : unsigned char { debug, info, warning, error };
enum class WhenClientIsGone : unsigned char { go_on, stop };
enum class LogTarget : unsigned char { automatic, terminal, journal };

/// The checked configuration. disparityd.example.toml documents each key; the sections have the same names.
struct Config {
    struct Source {
        std::string uri = "v4l2:auto";
        capture::Pace pace = capture::Pace::source;
        bool loop = false;
        SourceStart start = SourceStart::at_once;       ///< on_client: recordings, folders and files only
        capture::Stamp stamp = capture::Stamp::source;  ///< cameras only
        int time_offset_us = 0;                         ///< added to the stamps of frames
        std::string calibration;                        ///< empty = what the source brings
        /// Folders with calibrations by serial number of the camera, separated by colons.
        std::string calibration_folders = calibration::standard_calibration_folders;
        bool allow_unrectified = false;  ///< cameras only
        bool sensors = true;             ///< cameras only
        std::string controls;            ///< cameras only; see capture::parse_camera_settings()
        int stall_ms = 1000;             ///< cameras only
        PolicyChoice policy = PolicyChoice::automatic;
    } source;

    struct Rectify {
        calibration::RectifiedGeometry geometry;
        bool colour = false;
        bool right = false;
        bool raw = false;
    } rectify;

    struct Match {
        std::string backend = "auto";
        std::optional<Preset> preset = Preset::obstacles;  ///< sgm: what the defaults of the options are; none: its own
        MatchOptions options = preset_options(Preset::obstacles);
        bool depth = true;
        bool depth_error = false;
        double subpixel_error_px = ScanOptions{}.subpixel_error_px;  ///< one sigma of a disparity
    } match;

    struct Temporal {
        bool enabled = false;
    } temporal;

    /// What of the rectified left image shows the robot itself: see ImageMask.
    struct Mask {
        std::vector<std::string> polygons;
        std::string image;  ///< a file; empty: none
    } mask;

    struct ObstacleScan {
        bool enabled = false;
        ScanOptions options;  ///< but for subpixel_error_px
    } scan;

    struct Trust {
        bool enabled = true;
        trust::TrustOptions options;
    } trust;

    pipeline::DistanceLimits output;

    struct Pipeline {
        int slots = 4;
        int workers = 0;              ///< 0 = one per core, or as many as `cores`, rounded up
        std::optional<double> cores;  ///< of processor time, at most; none = all
        bool pin_workers = true;
        bool on_demand = false;  ///< live sources only
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
        std::string certificate;       ///< PEM; empty = TCP is not encrypted
        std::string key;               ///< PEM
        std::string client_authority;  ///< PEM; empty = clients need no certificate
        std::string tokens;            ///< a file; empty = clients need no token
        bool insecure = false;
        bool tcp_control = false;
        int idle_timeout_s = 60;  ///< 0 = never
    } socket;

    /// Names of groups and certificates; empty lists: see disparityd.example.toml.
    struct Access {
        std::vector<std::string> view_groups;
        std::vector<std::string> control_groups;
        std::vector<std::string> control_certificates;
    } access;

    struct Log {
        LogLevel level = LogLevel::info;
        LogTarget target = LogTarget::automatic;
    } log;

    struct Record {
        bool enabled = true;
        std::string directory;  ///< empty = see resolved_record_directory()
        int keep_free_mb = 500;
        int max_mb = 0;  ///< 0 = no limit
        int max_s = 0;   ///< 0 = no limit
        WhenClientIsGone when_client_is_gone = WhenClientIsGone::go_on;
    } record;

    struct SelfCalibration {
        bool enabled = true;
        bool replays = false;
        int interval_s = 10;
        std::string directory;  ///< empty = see resolved_correction_directory()
    } self_calibration;

    /// One line for each thing to know about what was set: keys of [match] that the method does not use, a preset that
    /// an older file could not choose, and folders that cannot be written to now.
    std::vector<std::string> notes;
};

/// A value from the command line. `origin` is the text that the user typed, for messages.
struct Override {
    std::string section;
    std::string key;
    std::string text;
    std::string origin;
};

/// Parses "section.key=value", the form of --set. Throws std::invalid_argument for any other form.
Override parse_override(const std::string& text);

/// Reads the file (an empty path: the defaults), applies the overrides and checks all values. Match keys that are not
/// set get those of the preset (sgm) or default_options(method). Throws std::invalid_argument with one line: where,
/// key, what was found, what is allowed.
Config load_config(const std::string& path, const std::vector<Override>& overrides);

/// Does the same for a text. `name` is the name of the file in messages.
Config parse_config(const std::string& text, const std::string& name, const std::vector<Override>& overrides = {});

/// Returns the path of the Unix socket, empty if the socket is off. "auto" takes the first of these folders that exists
/// and is writable: $RUNTIME_DIRECTORY, /run/disparityd, $XDG_RUNTIME_DIR, /tmp. The file is disparityd.sock. "-<name>"
/// stands before the dot unless the shared memory is named "default"; in /tmp the user's number follows.
std::string resolved_unix_path(const Config& config);

/// The folder for recordings of clients: the configured one, else $STATE_DIRECTORY, else the working directory.
struct RecordDirectory {
    std::string path;
    bool chosen = true;  ///< false: the working directory, which nobody has chosen for recordings
};
RecordDirectory resolved_record_directory(const Config& config);

/// Returns the folder for corrections of calibrations: the configured one, else $STATE_DIRECTORY; empty: none is kept.
std::string resolved_correction_directory(const Config& config);

}  // namespace disparityd::daemon
