// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <gst/gst.h>

namespace disparityd::capture {

struct GstDelete {
    void operator()(GstBus* bus) const { gst_object_unref(bus); }
    void operator()(GstCaps* caps) const { gst_caps_unref(caps); }
    void operator()(GstClock* clock) const { gst_object_unref(clock); }
    void operator()(GstElement* element) const { gst_object_unref(element); }
    void operator()(GstIterator* iterator) const { gst_iterator_free(iterator); }
    void operator()(GstPad* pad) const { gst_object_unref(pad); }
    void operator()(GstQuery* query) const { gst_query_unref(query); }
    void operator()(GstSample* sample) const { gst_sample_unref(sample); }
    void operator()(GError* error) const { g_error_free(error); }
    void operator()(gchar* text) const { g_free(text); }
};
template <typename T>
using GstPtr = std::unique_ptr<T, GstDelete>;

/// Starts GStreamer, once for the process, and takes the log of GLib away from standard output and error: its last line
/// is kept for last_gst_warning(). Throws std::runtime_error.
void start_gstreamer();

/// What GLib, GStreamer or a plugin complained of last, in one line; empty: nothing.
std::string last_gst_warning();

/// Forgets it: it was of another pipeline.
void forget_gst_warning();

/// Says in one line what an element's message means: the element, the message, and what stands behind it in short.
std::string gst_words(GstMessage* message, const GError& error, const gchar* debug);

/// The text of caps, for a line of a message.
std::string caps_text(const GstCaps* caps);

}  // namespace disparityd::capture
