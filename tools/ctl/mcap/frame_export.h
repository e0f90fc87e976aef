// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "capture/frame_source.h"
#include "clients/cpp/disparity_client.hpp"
#include "formats/mcap_file.h"
#include "obstacles/scan_options.h"
#include "products/frame_info.h"
#include "tools/ctl/mcap/mcap_parts.h"
#include "tools/ctl/mcap/raw_pair.h"
#include "tools/ctl/mcap/ros_mcap.h"
#include "tools/ctl/processing/frame_chain.h"

namespace disparityd::tools {

/// What goes into the file, and how.
struct ExportPlan {
    std::string file;
    formats::McapFile::Existing existing = formats::McapFile::Existing::refused;
    std::string camera = "stereo";
    McapParts parts;
    std::optional<ScanOptions> scan = {};  ///< where scans are made: tells where their frame lies
    DisparityRange range = {};
    bool interpolated = false;  ///< rejected pixels are filled
};

/// Writes the frames of a source into an MCAP file: of each first the samples of its sensors and the raw pair, as they
/// were captured, then what was made of it. The file is made with the first frame. take_raw() and one of the others may
/// be called by two threads; all others by one. Throws as RosMcap, and as calibration_of().
class FrameExport {
public:
    FrameExport(ExportPlan plan, const capture::SourceInfo& source);

    /// Returns the products that the pipeline must make.
    const std::vector<disparity::Product>& products() const { return products_; }

    /// Keeps what a frame holds as it was captured, until it is written: as many as are in the pipeline.
    void take_raw(const capture::RawFrame& frame);

    /// Writes the frame of a slot, and what was kept of it.
    void write(const pipeline::FrameSlot& slot, const FrameChain& chain);

    /// Writes a frame as it was captured, of which nothing else is made.
    void write_raw(const capture::RawFrame& frame);

    /// Writes the samples of frames that were kept and did not come out, as those behind the last good one, and ends
    /// the file, where there is one. take_raw() is not called any more.
    void finish();

    std::uint64_t frames() const { return frames_; }  ///< that were given to it
    const std::optional<RosMcap>& file() const { return file_; }

private:
    /// What a frame held as it was captured.
    struct Captured {
        std::uint64_t sequence = 0;
        std::vector<disparity::SensorSample> samples;
        std::vector<RosMessageBytes> pair;
    };

    void begin(const capture::RawFrame& frame);
    void open(std::int64_t realtime_ns, const std::optional<calibration::StereoCalibration>& calibration);
    void write_samples(const Captured& captured);
    void write_captured(std::uint64_t sequence);

    const ExportPlan plan_;
    const std::optional<calibration::StereoCalibration> calibration_;
    const bool synthetic_;
    std::vector<McapTopic> topics_;
    std::vector<disparity::Product> products_;
    const ros::Encoding encoding_;
    bool wants_samples_ = false;
    std::mutex mutex_;
    std::optional<RawPair> raw_;     ///< of the thread that calls take_raw()
    std::deque<Captured> captured_;  ///< under the mutex
    std::optional<RosMcap> file_;
    disparity::Frame frame_;
    std::uint64_t frames_ = 0;
};

}  // namespace disparityd::tools
