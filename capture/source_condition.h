// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace disparityd::capture {

/// The state of a live camera.
enum class CameraState : unsigned char {
    starting,        ///< found, the first frame has not come yet
    streaming,       ///< frames come
    absent,          ///< not plugged in
    stalled,         ///< no frames; being recovered
    busy,            ///< another program uses it
    no_permission,   ///< this user may not open it
    old_firmware,    ///< it gives no video
    usb2_link,       ///< too slow for the mode
    mode_refused,    ///< it does not offer what was asked for
    no_calibration,  ///< none was found, and unrectified frames are not allowed
    changed,         ///< another camera or calibration than info() says: open the source anew
    failed,          ///< the system refuses it for another reason
    unpaired,        ///< two cameras that are the eyes send frames, but none that belong together
};

/// "streaming", "no-permission": for clients and scripts.
const char* to_string(CameraState state);

/// How far apart the frames are that the two cameras of a pair take together.
struct EyesApart {
    std::int64_t median_ns = 0;  ///< stamp of the right eye's frame minus the left one's, of the newest pairs
    double drift = 0;            ///< how much that grows in time; 1e-6: a microsecond in a second
};

/// The camera behind a live source, and what was done to keep it alive.
struct CameraFacts {
    CameraState state = CameraState::absent;
    std::string model;  ///< empty: none was found yet
    std::string serial;
    std::string node;
    std::string port;
    std::string firmware;        ///< such as "1.42"
    double speed_mbit = 0;       ///< of the USB link; 0 = unknown
    double rate = 0;             ///< frames per second as agreed on; 0 = unknown
    std::uint64_t arrivals = 0;  ///< how often it was found anew
    std::uint64_t restarts = 0;
    std::uint64_t reopens = 0;
    std::uint64_t resets = 0;
    std::uint64_t damaged = 0;  ///< frames that the driver flagged, or whose JPEG could not be decoded in full
    std::uint64_t too_short = 0;
    // Of two cameras that are the eyes, for which the numbers above are sums, and the texts have a comma between:
    std::uint64_t unpaired = 0;      ///< frames of one eye that came, and had no partner
    std::optional<EyesApart> apart;  ///< empty: unknown yet, or one camera
};

/// The state of a camera's sensors.
enum class SensorState : unsigned char {
    starting,       ///< their camera has come; the first sample has not
    streaming,      ///< samples come
    absent,         ///< the camera is there, its sensors are not
    silent,         ///< they send nothing; being opened anew
    no_permission,  ///< this user may not open them
    failed,         ///< the system refuses them for another reason
};

/// "streaming", "no-permission": for clients and scripts.
const char* to_string(SensorState state);

/// The sensors of a live camera that has some.
struct SensorFacts {
    SensorState state = SensorState::absent;
    std::string detail;  ///< one line: what is wrong, what to do; empty when nothing is
    std::string node;    ///< empty: none was opened yet
    std::uint64_t samples = 0;
    std::uint64_t lost = 0;         ///< samples that nobody took in time
    std::uint64_t refused = 0;      ///< reports that could not be read
    std::uint64_t clock_jumps = 0;  ///< of the camera's clock
    double drift = 0;               ///< by how much the host's clock runs faster; 1e-6: a microsecond in a second
};

/// The state of a source, for people. A copy.
struct SourceCondition {
    bool delivering = true;            ///< false: no frames until what `detail` says is mended
    bool reopen = false;               ///< info() no longer holds: the source must be opened anew
    std::string detail;                ///< one line: what is wrong, what to do; empty when nothing is
    std::vector<std::string> notices;  ///< what the user should know although frames come
    std::optional<CameraFacts> camera;
    std::optional<SensorFacts> sensors;
};

}  // namespace disparityd::capture
