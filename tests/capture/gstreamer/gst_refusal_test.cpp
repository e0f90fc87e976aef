// SPDX-License-Identifier: Apache-2.0
//
// Pipelines that cannot be played: one line each, nothing on standard error, nothing hangs.
#include "capture/gstreamer/gst_picture.h"
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
    if (GetParam().name != std::string("no_element") && played.problem.find("no element") != std::string::npos) {
        GTEST_SKIP() << played.problem;
    }
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
        Refused{"drop", "videotestsrc ! appsink drop=true max-buffers=1",
                "found drop, max-buffers, which are not used here, leave them out"},
        Refused{"offset", "videotestsrc ! appsink sync=false ts-offset=5", "found ts-offset, which"},
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
                "videotestsrc ! " + caps + "! capssetter caps=video/x-raw,multiview-mode=top-bottom ! appsink",
                "it declares the stereo layout \"top-bottom\", expected no flags and side by side"},
        Refused{"other_eye",
                test_source("num-buffers=3", "10", 64) + "! appsink name=left " +
                    test_source("num-buffers=3", "10", 64) +
                    "! capssetter caps=video/x-raw,multiview-mode=left ! appsink name=right",
                "the stereo layout \"left\", expected no flags and the eye of its appsink, \"right\""},
        Refused{"sizes",
                test_source("num-buffers=3", "10", 64) + "! appsink name=left " +
                    test_source("num-buffers=3", "10", 80) + "! appsink name=right",
                "at the appsinks left and right"},
        Refused{"no_file", "multifilesrc location=/nowhere/%d.png caps=image/png,framerate=5/1 ! pngdec ! appsink",
                "Error while reading from file \"/nowhere/0.png\""},
        Refused{"no_device", "v4l2src device=/dev/video77 ! appsink", "Cannot identify device '/dev/video77'"},
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

TEST(GstPictures, FlagsOfADeclaredLayoutAreRefused) {
    GstVideoInfo info;
    gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY8, 128, 48);
    GST_VIDEO_INFO_MULTIVIEW_MODE(&info) = GST_VIDEO_MULTIVIEW_MODE_SIDE_BY_SIDE;
    const auto made = [&](GstVideoMultiviewFlags flags) {
        GST_VIDEO_INFO_MULTIVIEW_FLAGS(&info) = flags;
        const GstPtr<GstCaps> of_flags(gst_video_info_to_caps(&info));
        return GstConverter(*of_flags, GstConverter::Holds::both_eyes).picture().width;
    };
    EXPECT_EQ(made(GST_VIDEO_MULTIVIEW_FLAGS_NONE), 128);
    for (const auto flag : {GST_VIDEO_MULTIVIEW_FLAGS_RIGHT_VIEW_FIRST, GST_VIDEO_MULTIVIEW_FLAGS_LEFT_FLOPPED,
                            GST_VIDEO_MULTIVIEW_FLAGS_RIGHT_FLIPPED, GST_VIDEO_MULTIVIEW_FLAGS_MIXED_MONO}) {
        EXPECT_THAT(test::refusal([&] { made(flag); }), HasSubstr("\"side-by-side\" with multiview-flags"));
    }
}

}  // namespace
}  // namespace disparityd::capture
