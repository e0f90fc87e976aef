// SPDX-License-Identifier: Apache-2.0
//
// SVO2 files: their messages by themselves, and as a source, from which frames are read.
#include <algorithm>

#include "capture/svo/annex_b.h"
#include "capture/svo/svo_reader.h"
#include "tests/fuzz/first_frames.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

namespace {

void read_message(std::span<const std::uint8_t> bytes) {
    fuzz::accepted<std::runtime_error>("", [&] { capture::read_svo_header(bytes); });
    fuzz::accepted<std::runtime_error>("", [&] { capture::read_svo_sensors(bytes); });
    fuzz::accepted<std::runtime_error>("", [&] {
        const capture::SvoVideoMessage video = capture::read_svo_video(bytes);
        fuzz::expect(video.payload.size() <= bytes.size(), "a payload without bytes");
    });
    capture::annex_b_start(bytes);
    const capture::SvoPayload kind = capture::payload_kind(bytes);
    if (kind != capture::SvoPayload::unknown && kind != capture::SvoPayload::annex_b) {
        fuzz::accepted<std::invalid_argument>("", [&] {
            fuzz::accepted<std::runtime_error>("", [&] {
                const auto picture = capture::unpack_svo_picture(kind, bytes, capture::SvoSize{64, 24});
                fuzz::expect(picture.width % 2 == 0 && picture.width / 2 >= picture.height, "a picture of one eye");
            });
        });
    }
}

void read_frames(const std::string& path) {
    capture::SourceOptions options;
    options.uri = path;
    capture::SvoReader reader(options);
    fuzz::read_first_frames(reader);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    read_message({data, size});
    const fuzz::MemoryFile file(fuzz::text_of(data, size));
    fuzz::accepted<std::invalid_argument>(
        "", [&] { fuzz::accepted<std::runtime_error>(file.path(), [&] { read_frames(file.path()); }); });
    return 0;
}
