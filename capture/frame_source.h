// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/calibration.h"
#include "calibration/calibration_correction.h"
#include "capture/eye_layout.h"
#include "capture/sensor_sample.h"
#include "kernels/raw_image.h"

namespace disparityd::capture {

class ControlOverrides;
struct SourceCondition;
struct CameraControl;
struct CameraSetting;

/// Facts about one captured frame, as a bit set in RawFrame::flags; they survive a recording.
enum FrameFlag : std::uint32_t {
    frame_flag_none = 0,
    frame_flag_corrupt = 1U << 0,          ///< the driver marked the frame as damaged
    frame_flag_discontinuity = 1U << 1,    ///< first frame after a gap, a restart or a loop
    frame_flag_exposure_centre = 1U << 2,  ///< its stamps were moved to the centre of its exposure
};

/// A frame on loan from its source: the pixels stay valid until give_back().
struct RawFrame {
    RawImage image;
    std::uint64_t sequence = 0;        ///< counts captured frames; a gap means lost ones
    std::int64_t monotonic_ns = 0;     ///< CLOCK_MONOTONIC at capture (as recorded, when replayed)
    std::int64_t realtime_ns = 0;      ///< CLOCK_REALTIME at capture (as recorded, when replayed)
    std::uint32_t flags = 0;           ///< FrameFlag bits
    std::uint32_t dropped_before = 0;  ///< frames known to be lost between the previous one and this
    /// How far monotonic_ns was moved from the driver's stamp to the centre of the exposure.
    std::int64_t to_exposure_ns = 0;
    int loan = -1;  ///< the source's own number for the buffer
    /// The JPEG that the camera sent the frame as; empty unless SourceInfo::jpegs is set. Valid until give_back().
    std::span<const std::uint8_t> jpeg{};
    /// What the calibration was corrected by when this frame was rectified; of a source, what a recording says.
    calibration::CalibrationCorrection correction;
    /// What the camera's sensors measured and sent since the frame before, in order; a frame carries at most
    /// most_samples. Valid until the next call of next() or until this frame is given back, whichever comes first.
    std::span<const SensorSample> sensors{};
    /// What the user calls the frame: the name of the left image's file. Empty where frames have none (cameras,
    /// recordings). Valid as long as the source lives.
    std::string_view name;

    static constexpr std::size_t most_samples = 1024;
};

/// What a source delivers. Constant from open to close.
struct SourceInfo {
    std::string name;         ///< what the user called it, such as "scene:vga"
    std::string description;  ///< one line for people
    PixelFormat format = PixelFormat::grey8;
    int eye_width = 0;
    int height = 0;
    double rate = 0;                           ///< nominal frames per second; 0 = unknown (image folders)
    bool live = false;                         ///< frames come by the clock and are lost when nobody takes them
    bool synthetic = false;                    ///< frames are drawn, or a recording of drawn ones: no camera saw them
    std::optional<std::uint64_t> frame_count;  ///< when known beforehand
    /// Empty: unknown; the frames can only be used unrectified.
    std::optional<calibration::StereoCalibration> calibration;
    /// How the eyes lie in RawFrame::jpeg. Empty: frames are no JPEGs.
    std::optional<EyeLayout> jpegs;
    std::string serial;  ///< of the camera that the calibration is used for; empty = unknown
    int time_offset_us =
        0;  ///< what SourceOptions::time_offset_us has moved the frames' stamps by, here or when recorded
};

/// Where frames come from. One thread calls next(); give_back() and interrupt() may come from any thread.
class FrameSource {
public:
    enum class Next {
        frame,        ///< `frame` holds a loan
        timeout,      ///< nothing until the deadline; try again
        end,          ///< the last frame was delivered before; every later call says so too
        interrupted,  ///< interrupt() was called; every later call says so too
    };

    virtual ~FrameSource() = default;

    virtual const SourceInfo& info() const = 0;

    /// Waits for the next frame until `deadline`. At most `loans` frames (see SourceOptions) may be out at a time;
    /// with all of them out, next() waits for one to come back. Allocates nothing for scene: and for live cameras
    /// (but libjpeg does, for those that send JPEGs).
    /// Throws std::runtime_error with one line for people when the input is damaged; the source has then ended.
    virtual Next next(RawFrame& frame, std::chrono::steady_clock::time_point deadline) = 0;

    /// Ends the loan of a frame that next() gave.
    virtual void give_back(const RawFrame& frame) noexcept = 0;

    /// Makes a waiting next() return at once.
    virtual void interrupt() noexcept = 0;

    /// Returns how the source stands at the moment (capture/source_condition.h). Any thread. Sources of this room
    /// other than live cameras always deliver.
    virtual SourceCondition condition() const;

    /// Sets controls of a live camera in this order and says how all of them stand then
    /// (capture/camera/camera_controls.h). They hold until the source ends, also for a camera that is opened anew
    /// (capture/camera/control_overrides.h). Any thread; takes milliseconds for each. Throws std::invalid_argument when
    /// a name or value is not allowed or the source is no camera, std::runtime_error when the camera is not there or
    /// refuses.
    virtual std::vector<CameraControl> set_camera_controls(const std::vector<CameraSetting>& settings);
};

/// Says how frames are timed that do not come from a camera.
enum class Pace {
    source,   ///< at the source's own rate, as a camera would
    fastest,  ///< as soon as somebody asks: offline work
};

/// Says which moment the stamps of a camera's frames tell.
enum class Stamp {
    source,           ///< what the source says
    exposure_centre,  ///< moved by half the exposure, where the driver reports it
};

struct SourceOptions {
    std::string uri;  ///< "v4l2:hd720@30", "scene:vga@15", a folder, a pattern with %d, a video file
    int loans = 8;    ///< frames that may be out at the same time
    Pace pace = Pace::source;
    bool loop = false;             ///< start again after the last frame
    std::string calibration_path;  ///< overrides what the source brings; empty = the source's own
    bool calibrated = true;        ///< false: the calibration of a file or folder is not looked at, whatever it is
    int time_offset_us =
        0;  ///< is added to the stamps of all frames, unless they contain an offset; -100'000 .. 100'000
    /// Of images: those that cannot be read, or have another size than the first, are left out; each is told to
    /// `report`, and the next frame counts them as dropped. Otherwise they end the source.
    bool skip_damaged = false;
    /// Of images: which of the sequence are played, so that those that belong together can be (runs_of_one_geometry()
    /// in images/image_sequence.h). Frames keep the numbers and times that they have in the whole.
    std::size_t first_image = 0;
    std::size_t image_count = SIZE_MAX;  ///< at most
    // Of cameras only:
    Stamp stamp = Stamp::source;
    bool wait_for_camera = false;   ///< one that is not there, or cannot be used yet, is waited for; else a refusal
    bool allow_unrectified = true;  ///< a camera without calibration delivers frames all the same
    std::vector<std::string> calibration_folders;  ///< searched for SN<serial>.conf and the like, in this order
    bool sensors = true;                           ///< read the camera's sensors, if it has some
    std::string controls;  ///< "gain-left=30 auto-exposure=0": set in this order whenever the camera is opened
    /// What FrameSource::set_camera_controls() has set on sources before this one, which are to hold here too; this one
    /// adds its own. Empty: it keeps them for itself.
    std::shared_ptr<ControlOverrides> control_overrides;
    std::string likely_port;  ///< USB port of the camera that was used before, the likeliest of several; may be empty
    int decoders = 2;         ///< threads that decode JPEGs, for a camera that sends them; 0: next() decodes
    std::chrono::milliseconds stall_time{1000};  ///< a camera that gives no frame for so long is restarted
    /// Hears, one line each, what happens to the camera and what is done about it, what images are converted and which
    /// are left out; may be empty. Called in the thread that opens or calls next(), and about the sensors in theirs.
    std::function<void(const std::string& line, bool trouble)> report;
    /// Called while a source prepares itself (rendering ahead), with done/total; may be empty.
    std::function<void(int done, int total)> progress;
};

/// A row of the table of sources.
struct SourceKind {
    std::string_view name;         ///< "v4l2", "scene", "folder", "recording"
    std::string_view description;  ///< one line for people, with an example
    bool (*accepts)(const std::string& uri);
    std::unique_ptr<FrameSource> (*open)(const SourceOptions& options);
    bool is_kept = false;  ///< a file or a folder, whose frames wait for whoever takes them
    /// Such a one may take its calibration from SourceOptions::calibration_folders: its files do not say all of it.
    bool calibrated_elsewhere = false;
};

const std::vector<SourceKind>& source_kinds();

/// Opens the first kind that accepts the URI. Throws std::invalid_argument (what, where, found, allowed) when the
/// user must change something, std::runtime_error when the system refuses.
std::unique_ptr<FrameSource> open_source(const SourceOptions& options);

}  // namespace disparityd::capture
