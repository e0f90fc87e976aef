// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_reader.h"

#include <utility>

#include "capture/recording/foreign_reader.h"
#include "capture/recording/native_reader.h"
#include "capture/recording/recording_input.h"

namespace disparityd::capture {

std::unique_ptr<RecordingReader> open_recording_reader(const std::string& path) {
    RecordingInput input(path);
    if (input.tag(recording::tag_format) != nullptr) {
        return std::make_unique<NativeReader>(std::move(input));
    }
    return std::make_unique<ForeignReader>(std::move(input));
}

}  // namespace disparityd::capture
