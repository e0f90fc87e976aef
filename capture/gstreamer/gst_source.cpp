// SPDX-License-Identifier: Apache-2.0
#include "capture/gstreamer/gst_source.h"

#include <stdexcept>
#include <utility>

#include "capture/gstreamer/gst_live.h"
#include "capture/gstreamer/gst_opened.h"
#include "capture/gstreamer/gst_reader.h"
#include "capture/recording/recording_source.h"

namespace disparityd::capture {

std::unique_ptr<FrameSource> open_gst(const SourceOptions& options) {
    const GstUri uri = parse_gst_uri(options.uri);
    auto first = std::make_shared<GstOpened>(open_gst_pipeline(uri, options));
    if (first->live) {
        return make_gst_live(uri, options, std::move(*first));
    }
    if (options.loop && !first->pipeline->devices().empty()) {
        throw std::invalid_argument("source gst: found a loop over " + first->pipeline->devices() +
                                    ", which gives its pictures once; expected files");
    }
    const auto stop = std::make_shared<std::atomic<bool>>(false);
    SourceOptions again = options;
    again.progress = nullptr;  // whoever prepares the source is done then
    return play(options, [=] {
        GstOpened opened = first->pipeline ? std::exchange(*first, {}) : open_gst_pipeline(uri, again, stop);
        return std::make_unique<GstReader>(std::move(opened), again, stop);
    });
}

}  // namespace disparityd::capture
