// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_reader.h"

#include <optional>
#include <stdexcept>
#include <utility>

#include "base/file_kind.h"
#include "capture/recording/foreign_reader.h"
#include "capture/recording/native_reader.h"
#include "capture/recording/pair_reader.h"
#include "capture/recording/recording_input.h"
#include "capture/two_eyes.h"

namespace disparityd::capture {
namespace {

/// Splits the names of two videos at a comma. Names may have commas, too: files that are there are preferred. One of
/// the two may be missing: reading it says so.
std::optional<std::pair<std::string, std::string>> pair_of_videos(const std::string& uri) {
    std::optional<std::pair<std::string, std::string>> found;
    for (std::size_t comma = uri.find(','); comma != std::string::npos; comma = uri.find(',', comma + 1)) {
        std::pair<std::string, std::string> pair{uri.substr(0, comma), uri.substr(comma + 1)};
        const int there = (base::is_file(pair.first) ? 1 : 0) + (base::is_file(pair.second) ? 1 : 0);
        if (there == 2) {
            return pair;
        }
        found = there == 1 && !found ? pair : found;
    }
    return found;
}

std::unique_ptr<RecordingReader> open_eye(const std::string& path) {
    RecordingInput input(path);
    if (input.has_native_tags()) {
        throw std::invalid_argument(path + ": is a recording of both eyes; of a pair each video shows one");
    }
    input.probe();
    const int stream = input.only_video();
    return std::make_unique<ForeignReader>(std::move(input), stream, ForeignReader::Picture::one_eye);
}

/// Opens the two tracks of a file that show an eye each: by their names, else the first one is the left eye.
std::unique_ptr<RecordingReader> open_tracks(RecordingInput input, const std::vector<int>& tracks) {
    const std::string path = input.path();
    const auto is_called = [&input](int track, const char* eye) {
        return input.track_name(track).find(eye) != std::string::npos;
    };
    for (const int track : tracks) {
        if (is_called(track, "depth") || is_called(track, "disparity")) {
            throw std::invalid_argument(path + ": has a track that is called" + input.track_name(track) +
                                        ", expected one of each eye");
        }
    }
    // One name is enough, where the other track does not have the same.
    const auto only_one_called = [&](std::size_t at, const char* eye, const char* other) {
        return is_called(tracks[at], eye) && !is_called(tracks[at], other) && !is_called(tracks[1 - at], eye);
    };
    const bool exchanged = only_one_called(0, "right", "left") || only_one_called(1, "left", "right");
    const bool named = exchanged || only_one_called(0, "left", "right") || only_one_called(1, "right", "left");
    auto first = std::make_unique<ForeignReader>(std::move(input), tracks[0], ForeignReader::Picture::one_eye);
    RecordingInput again(path);
    again.probe();
    auto second = std::make_unique<ForeignReader>(std::move(again), tracks[1], ForeignReader::Picture::one_eye);
    if (exchanged) {
        std::swap(first, second);
    }
    std::vector<std::string> notices;
    if (!named) {
        notices.push_back(path + ": has two video tracks without names of eyes; the first is taken as the left eye");
    }
    return std::make_unique<PairReader>(std::move(first), std::move(second), path, std::move(notices));
}

}  // namespace

bool is_pair_of_videos(const std::string& uri) {
    return !base::is_file(uri) && pair_of_videos(uri).has_value();
}

std::unique_ptr<RecordingReader> open_recording_reader(const std::string& path) {
    if (const auto pair = base::is_file(path) ? std::nullopt : pair_of_videos(path)) {
        check_two_eyes(pair->first, pair->second);
        auto left = open_eye(pair->first);  // first, so that of two bad names the first is told
        return std::make_unique<PairReader>(std::move(left), open_eye(pair->second), path, std::vector<std::string>());
    }
    RecordingInput input(path);
    if (input.tag(recording::tag_format) != nullptr) {
        const int stream = input.only_video();
        return std::make_unique<NativeReader>(std::move(input), stream);
    }
    if (input.has_native_tags()) {
        throw std::invalid_argument(path + ": the recording is damaged: its tag " + recording::tag_format +
                                    " is missing");
    }
    input.probe();
    if (const std::vector<int> tracks = input.video_tracks(); tracks.size() == 2) {
        return open_tracks(std::move(input), tracks);
    }
    const int stream = input.only_video();
    return std::make_unique<ForeignReader>(std::move(input), stream, ForeignReader::Picture::both_eyes);
}

}  // namespace disparityd::capture
