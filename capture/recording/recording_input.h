// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/recording/recording_ffmpeg.h"
#include "capture/recording/recording_segment.h"

namespace disparityd::capture {

/// A video file whose container FFmpeg has opened. One thread uses an object at a time.
class RecordingInput {
public:
    /// Throws std::invalid_argument with one line when this is no video that can be read, std::runtime_error when the
    /// system refuses to read it.
    explicit RecordingInput(const std::string& path);

    const std::string& path() const { return path_; }
    AVFormatContext& context() const { return *context_; }

    /// The value of a tag of the container, valid as long as the input; nullptr when there is none.
    const char* tag(const char* key) const;

    /// Whether tags of a recording stand in the file's first bytes, also where damage keeps FFmpeg from finding them.
    bool has_native_tags() const { return has_native_tags_; }

    /// Decodes the first pictures, to find out what the container does not say. Throws std::invalid_argument.
    void probe();

    /// Returns the indices of the streams with videos.
    std::vector<int> video_tracks() const;

    /// Returns what a stream is called, in lower case; empty when it has no name.
    std::string track_name(int track) const;

    /// Returns the index of the video stream. Throws std::invalid_argument when there is none, or more than one.
    int only_video() const;

    /// Has FFmpeg skip all other streams.
    void choose_video(int chosen);

    /// Whether a Matroska file says how long it is. One that was never closed does not.
    bool says_its_size() const { return segment_ && segment_->size; }

    /// "5 of 10 bytes are there" when the file is shorter than it says.
    std::optional<std::string> missing_bytes() const;

private:
    struct CloseInput {
        void operator()(AVFormatContext* input) const { avformat_close_input(&input); }
    };

    void open(bool has_native_tag);

    std::string path_;
    std::uint64_t file_size_ = 0;
    std::optional<MatroskaSegment> segment_;
    bool has_native_tags_ = false;
    std::unique_ptr<AVFormatContext, CloseInput> context_;
};

}  // namespace disparityd::capture
