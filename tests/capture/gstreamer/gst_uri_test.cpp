// SPDX-License-Identifier: Apache-2.0
//
// What stands in front of a pipeline, and what a build without GStreamer says.
#include "capture/gstreamer/gst_uri.h"

#include "capture/shown_source.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/played_source.h"

namespace disparityd::capture {
namespace {

using test::refusal;
using testing::HasSubstr;

TEST(GstUri, OptionsStandInFrontOfThePipelineWhichMayHoldAnything) {
    EXPECT_TRUE(is_gst("gst:a ! b"));
    EXPECT_TRUE(is_gst("gst?within_ms=1:a ! b"));
    EXPECT_FALSE(is_gst("gst.mkv"));
    const GstUri plain = parse_gst_uri("gst:rtspsrc location=rtsp://host:554/a?b=c@d ! appsink");
    EXPECT_EQ(plain.pipeline, "rtspsrc location=rtsp://host:554/a?b=c@d ! appsink");
    EXPECT_EQ(plain.within_ns, 5'000'000);
    const GstUri wide = parse_gst_uri("gst?within_ms=12.5:a ! b:c");
    EXPECT_EQ(wide.pipeline, "a ! b:c");
    EXPECT_EQ(wide.within_ns, 12'500'000);
}

TEST(GstUri, WhatIsWrongIsOneLine) {
    EXPECT_THAT(refusal([] { parse_gst_uri("gst:"); }), HasSubstr("there is no pipeline"));
    EXPECT_THAT(refusal([] { parse_gst_uri("gst?within_ms=3"); }), HasSubstr("there is no pipeline"));
    EXPECT_THAT(refusal([] { parse_gst_uri("gst?within_ms=x:a"); }), HasSubstr("allowed is 0 to 1000"));
    EXPECT_THAT(refusal([] { parse_gst_uri("gst?fast=1:a"); }), HasSubstr("allowed is within_ms="));
}

TEST(GstUri, WhatMayBeAPasswordIsNotShown) {
    for (const auto& [uri, shown] :
         {std::pair("gst:rtspsrc location=rtsp://me:p@ss@host:554/a?b=c@d ! appsink",
                    "gst:rtspsrc location=rtsp://***@host:554/a?b=c@d ! appsink"),
          std::pair("gst:a uri=\"http://me@one/x\" b uri=http://two ! c",
                    "gst:a uri=\"http://***@one/x\" b uri=http://two ! c"),
          std::pair("gst:rtspsrc user-id=me user-pw = \"a \\\" b\" latency=3",
                    "gst:rtspsrc user-id=*** user-pw = *** latency=3"),
          std::pair("gst:a proxy-pw=(string)'x y' passphrase=a\\ b", "gst:a proxy-pw=*** passphrase=***"),
          std::pair("gst:a location=\"http://h/x?Token=abc\" ! b", "gst:a location=\"http://h/x?Token=***\" ! b"),
          std::pair("gst:a user-pw=", "gst:a user-pw=***"), std::pair("gst:a width=3 ! b", "gst:a width=3 ! b"),
          std::pair("token=3.mkv", "token=3.mkv")}) {
        EXPECT_EQ(shown_source(uri), shown);
    }
}

#ifndef DISPARITYD_WITH_GSTREAMER
TEST(GstAbsent, ABuildWithoutGstreamerSaysWhatToInstall) {
    SourceOptions options;
    options.uri = "gst:videotestsrc ! appsink";
    EXPECT_THAT(test::play_all(options).problem, HasSubstr("built without GStreamer; install libgstreamer1.0-dev"));
}
#endif

}  // namespace
}  // namespace disparityd::capture
