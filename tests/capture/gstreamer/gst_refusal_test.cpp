// SPDX-License-Identifier: Apache-2.0
//
// Pipelines that cannot be played: one line each, nothing on standard error, nothing hangs.
#include "tests/capture/gstreamer/gst_fixture.h"

namespace disparityd::capture {
namespace {

using test::options_of;
using test::test_source;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

struct Refused {
    const char* name;
    std::string pipeline;
    std::string told;
    bool waits = false;  ///< until the time for a frame is over
};

void PrintTo(const Refused& refused, std::ostream* stream) {
    *stream << refused.name;
}

class GstRefusal : public testing::TestWithParam<Refused> {};

TEST_P(GstRefusal, IsOneLine) {
    SourceOptions options = options_of(GetParam().pipeline);
    options.stall_time = std::chrono::milliseconds(GetParam().waits ? 30 : 2000);
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const test::Played played = test::play_all(options);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
    EXPECT_THAT(testing::internal::GetCapturedStdout(), IsEmpty());
    EXPECT_THAT(played.problem, AllOf(HasSubstr("source gst: "), HasSubstr(GetParam().told)));
}

const std::string caps = "video/x-raw,format=GRAY8,width=128,height=48 ";

INSTANTIATE_TEST_SUITE_P(
    All, GstRefusal,
    testing::Values(
        Refused{"no_element", "nosuchsrc ! appsink", "no element \"nosuchsrc\"; its plugin may not be installed"},
        Refused{"no_property", "videotestsrc speed=3 ! appsink", "no property \"speed\""},
        Refused{"no_link", "videotestsrc ! audioconvert ! appsink", "could not link"},
        Refused{"one_element", "appsink", "found a single element"},
        Refused{"no_sink", "videotestsrc ! fakesink", "the pipeline has no appsink"},
        Refused{"names", "videotestsrc ! appsink name=a videotestsrc ! appsink name=b", "found the appsinks a, b"},
        Refused{"three", "videotestsrc ! appsink videotestsrc ! appsink videotestsrc ! appsink", "found the appsinks"},
        Refused{"drop", "videotestsrc ! appsink drop=true max-buffers=1", "leave them out"},
        Refused{"format", "videotestsrc ! video/x-raw,format=GRAY16_LE ! appsink",
                "offered is video/x-raw, format=(string)GRAY16_LE"},
        Refused{"users_caps", "videotestsrc ! appsink caps=video/x-raw,format=P010_10LE", "allowed is video/x-raw"},
        Refused{"encoded", "multifilesrc location=/bin/sh num-buffers=1 caps=image/jpeg ! appsink",
                "offered is image/jpeg; the appsink takes"},
        Refused{"one_eye", "videotestsrc ! video/x-raw,width=64,height=48 ! appsink", "which are those of one eye"},
        Refused{"odd", "videotestsrc ! video/x-raw,format=GRAY8,width=129,height=48 ! appsink", "no two equal halves"},
        Refused{"interlaced", "videotestsrc ! video/x-raw,interlace-mode=interleaved,width=128,height=48 ! appsink",
                "put deinterlace"},
        Refused{"top_bottom",
                "videotestsrc ! capssetter caps=video/x-raw,multiview-mode=top-bottom ! " + caps + "! appsink", ""},
        Refused{"sizes",
                test_source("num-buffers=3", "10", 64) + "! appsink name=left " +
                    test_source("num-buffers=3", "10", 80) + "! appsink name=right",
                "at the appsinks left and right"},
        Refused{"no_file", "multifilesrc location=/nowhere/%d.png caps=image/png,framerate=5/1 ! pngdec ! appsink", ""},
        Refused{"no_device", "v4l2src device=/dev/video77 ! appsink", ""},
        Refused{"no_frame", "videotestsrc ! valve drop=true ! " + caps + "! appsink", "no frame has come for 0.3 s",
                true},
        Refused{"no_live_frame", "videotestsrc is-live=true ! valve drop=true ! " + caps + "! appsink",
                "no frame has come for 0.3 s", true},
        Refused{"no_frame_of_an_eye",
                test_source("num-buffers=3", "10", 64) + "! appsink name=left " + test_source("", "10", 64) +
                    "! valve drop=true ! appsink name=right",
                "put a queue in front of each appsink", true},
        Refused{"no_pair",
                test_source("num-buffers=3", "10", 64) + "! appsink name=left " +
                    test_source("num-buffers=3 timestamp-offset=50000000", "10", 64) + "! appsink name=right",
                "none at most 5 ms apart"},
        Refused{"empty", "videotestsrc num-buffers=0 ! appsink", "ended without a frame"}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace disparityd::capture
