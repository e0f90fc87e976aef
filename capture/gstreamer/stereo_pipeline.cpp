// SPDX-License-Identifier: Apache-2.0
#include "capture/gstreamer/stereo_pipeline.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gst/app/gstappsink.h>

#include "base/message_text.h"
#include "base/start_thread.h"
#include "capture/shown_source.h"

namespace disparityd::capture {

/// Shared with threads of GStreamer, which may outlive the pipeline's owner.
struct StereoPipelineState {
    GstPtr<GstElement> pipeline;
    std::vector<GstElement*> sinks;  ///< of the left eye or both, of the right one; the pipeline's
    std::string devices;
    std::unique_ptr<GstFeed> feed;
    std::mutex states;  ///< one thread at a time changes the state of the elements, as long as that takes

    std::mutex mutex;  ///< what follows
    std::condition_variable changed;
    bool starting = false;
    bool stopping = false;
    bool stopped = false;
    bool left = false;  ///< to itself: it did not stop in time
    std::string warning;
    std::map<std::string, guint64> left_out;  ///< frames, by element
};

namespace {

constexpr std::chrono::milliseconds longest_stop{3000};
constexpr std::chrono::milliseconds longest_stop_of_a_start{300};  ///< that hangs

std::atomic<int> left_pipelines{0};  ///< that hang still

[[noreturn]] void refuse(const std::string& what) {
    throw std::invalid_argument("source gst: " + what);
}

GstPtr<GstElement> parse(const std::string& text) {
    start_gstreamer();
    GError* error = nullptr;
    GstElement* const made = gst_parse_launch_full(text.c_str(), nullptr, GST_PARSE_FLAG_FATAL_ERRORS, &error);
    GstPtr<GstElement> pipeline(made != nullptr ? GST_ELEMENT(gst_object_ref_sink(made)) : nullptr);
    const GstPtr<GError> problem(error);
    if (problem || !pipeline) {
        const bool unknown =
            problem && problem->domain == GST_PARSE_ERROR && problem->code == GST_PARSE_ERROR_NO_SUCH_ELEMENT;
        refuse("the pipeline cannot be made: " +
               without_passwords(base::printable(problem ? problem->message : "no reason is given", 300)) +
               (unknown ? "; its plugin may not be installed (gstreamer1.0-plugins-base, -good, -bad, -ugly, "
                          "gstreamer1.0-libav): gst-inspect-1.0 lists those that are"
                        : ""));
    }
    if (GST_IS_PIPELINE(pipeline.get()) == FALSE) {
        refuse(
            "found a single element, expected a pipeline that ends in an appsink, as "
            "gst:v4l2src device=/dev/video0 ! jpegdec ! appsink");
    }
    return pipeline;
}

void for_each_element(GstElement& pipeline, const std::function<void(GstElement&)>& use) {
    const GstPtr<GstIterator> all(gst_bin_iterate_recurse(GST_BIN(&pipeline)));
    gst_iterator_foreach(
        all.get(),
        [](const GValue* value, gpointer call) {
            (*static_cast<const std::function<void(GstElement&)>*>(call))(*GST_ELEMENT(g_value_get_object(value)));
        },
        const_cast<std::function<void(GstElement&)>*>(&use));
}

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + name;
    }
    return text;
}

std::string name_of(GstElement& element) {
    return base::printable(GST_OBJECT_NAME(&element));
}

bool has_property(GstElement& element, const char* name, GType type) {
    const GParamSpec* const property = g_object_class_find_property(G_OBJECT_GET_CLASS(&element), name);
    return property != nullptr && property->value_type == type;
}

std::string kind_of(GstElement& element) {
    GstElementFactory* const factory = gst_element_get_factory(&element);
    return factory != nullptr ? base::printable(GST_OBJECT_NAME(factory)) : "element";
}

GstPtr<gchar> text_property(GstElement& element, const char* name) {
    gchar* text = nullptr;
    g_object_get(&element, name, &text, nullptr);
    return GstPtr<gchar>(text);
}

/// Whether what is read is gone then, as from a pipe or a device: such a path is no file that can be played again.
bool is_stream(const gchar* path) {
    std::error_code error;
    const auto status = path != nullptr ? std::filesystem::status(path, error) : std::filesystem::file_status();
    return std::filesystem::is_other(status);
}

/// Whether an element gives what is not in a file and not made up. What a descriptor leads to nobody knows.
bool is_device(GstElement& element) {
    const gchar* const text = gst_element_get_metadata(&element, GST_ELEMENT_METADATA_KLASS);
    if (GST_OBJECT_FLAG_IS_SET(&element, GST_ELEMENT_FLAG_SOURCE) == FALSE || text == nullptr) {
        return false;
    }
    if (has_property(element, "uri", G_TYPE_STRING)) {
        const GstPtr<gchar> uri = text_property(element, "uri");
        if (uri && g_str_has_prefix(uri.get(), "file:") != FALSE) {
            return is_stream(GstPtr<gchar>(g_filename_from_uri(uri.get(), nullptr, nullptr)).get());
        }
        return uri && g_str_has_prefix(uri.get(), "data:") == FALSE;
    }
    if (has_property(element, "location", G_TYPE_STRING) && is_stream(text_property(element, "location").get())) {
        return true;
    }
    const std::string classes = text;
    const std::string kind = kind_of(element);
    const bool decided_inside = GST_IS_BIN(&element) != FALSE && classes.starts_with("Generic");
    return !decided_inside && !kind.ends_with("testsrc") &&
           (classes.find("File") == std::string::npos || kind == "fdsrc");
}

bool stamps_arrivals(GstElement& element) {
    gboolean stamps = FALSE;
    if (has_property(element, "do-timestamp", G_TYPE_BOOLEAN)) {
        g_object_get(&element, "do-timestamp", &stamps, nullptr);
    }
    return stamps != FALSE;
}

/// Returns the kinds of devices. `all_stamp` becomes whether each stamps what it gets.
std::string devices_of(GstElement& pipeline, bool& all_stamp) {
    std::vector<std::string> kinds;
    all_stamp = true;
    for_each_element(pipeline, [&](GstElement& element) {
        if (is_device(element)) {
            all_stamp = all_stamp && stamps_arrivals(element);
            if (std::find(kinds.begin(), kinds.end(), kind_of(element)) == kinds.end()) {
                kinds.push_back(kind_of(element));
            }
        }
    });
    return joined(kinds);
}

/// Returns the appsinks, the left one first.
std::vector<GstElement*> sinks_of(GstElement& pipeline) {
    std::vector<GstElement*> sinks;
    for_each_element(pipeline, [&](GstElement& element) {
        if (GST_IS_APP_SINK(&element) != FALSE) {
            sinks.push_back(&element);
        }
    });
    if (sinks.empty()) {
        refuse(
            "the pipeline has no appsink; expected one at its end with both eyes side by side, as ... ! appsink, or "
            "two, name=left and name=right");
    }
    std::sort(sinks.begin(), sinks.end(),
              [](GstElement* one, GstElement* other) { return name_of(*one) < name_of(*other); });
    if (sinks.size() > 1 && (sinks.size() > 2 || name_of(*sinks[0]) != "left" || name_of(*sinks[1]) != "right")) {
        std::vector<std::string> names;
        for (GstElement* const sink : sinks) {
            names.push_back(name_of(*sink));
        }
        refuse("found the appsinks " + joined(names) +
               "; expected one, or two that are called left and right: appsink name=left");
    }
    return sinks;
}

/// Returns the properties of an appsink that the user has set and nobody would heed.
std::string set_properties(GstElement& sink) {
    guint count = 0;
    GParamSpec** const all = g_object_class_list_properties(G_OBJECT_GET_CLASS(&sink), &count);
    const GstPtr<gchar> owned(reinterpret_cast<gchar*>(all));  // g_free() takes both
    std::vector<std::string> set;
    for (GParamSpec* const property : std::span(all, count)) {
        const std::string name = property->name;
        constexpr GParamFlags both = G_PARAM_READWRITE;
        if ((property->flags & both) != both || name == "name" || name == "parent" || name == "caps" ||
            name == "sync" || name == "emit-signals") {
            continue;
        }
        GValue value = G_VALUE_INIT;
        g_value_init(&value, property->value_type);
        g_object_get_property(G_OBJECT(&sink), property->name, &value);
        if (g_param_value_defaults(property, &value) == FALSE) {
            set.push_back(name);
        }
        g_value_unset(&value);
    }
    std::sort(set.begin(), set.end());
    return joined(set);
}

/// Asks for the formats that are taken, of those that the user allows. How many pictures wait is our business.
void set_up_sink(GstElement& element) {
    GstAppSink* const sink = GST_APP_SINK(&element);
    if (const std::string set = set_properties(element); !set.empty()) {
        refuse("appsink " + name_of(element) + ": found " + set +
               ", which are not used here, leave them out; allowed are name, caps and sync: of a live pipeline the "
               "newest frames are taken, of files all");
    }
    GstPtr<GstCaps> wanted = taken_caps();
    if (const GstPtr<GstCaps> users(gst_app_sink_get_caps(sink)); users) {
        GstPtr<GstCaps> both(gst_caps_intersect(users.get(), wanted.get()));
        if (gst_caps_is_empty(both.get()) != FALSE) {
            refuse("appsink " + name_of(element) + ": found caps=" + caps_text(users.get()) + ", allowed is " +
                   taken_formats);
        }
        wanted = std::move(both);
    }
    gst_app_sink_set_caps(sink, wanted.get());
    g_object_set(sink, "sync", FALSE, "emit-signals", FALSE, nullptr);
}

/// Says what a pipeline offers to an appsink, and what that takes.
std::string offered_to(GstElement& sink) {
    const GstPtr<GstPad> pad(gst_element_get_static_pad(&sink, "sink"));
    const GstPtr<GstCaps> offered(gst_pad_peer_query_caps(pad.get(), nullptr));
    const std::string taken = std::string("; the appsink takes ") + taken_formats +
                              ": put videoconvert or a decoder in front of it, nvvidconv behind what is NVIDIA's";
    return (offered && gst_caps_is_any(offered.get()) == FALSE ? "; offered is " + caps_text(offered.get()) : "") +
           taken;
}

// What follows is called by GStreamer, in threads of its own. Each call owns a part of the state.

using Owner = std::shared_ptr<StereoPipelineState>;

void disown(gpointer owner) {
    delete static_cast<Owner*>(owner);
}

StereoPipelineState& state_of(gpointer owner) {
    return **static_cast<Owner*>(owner);
}

Eye eye_of(const StereoPipelineState& state, GstAppSink* sink) {
    return GST_ELEMENT(sink) == state.sinks.front() ? Eye::left : Eye::right;
}

GstFlowReturn on_sample(GstAppSink* sink, gpointer owner) {
    StereoPipelineState& state = state_of(owner);
    const GstPtr<GstSample> sample(gst_app_sink_pull_sample(sink));
    const bool taken =
        sample && state.feed->accept(eye_of(state, sink), *sample,
                                     static_cast<std::int64_t>(gst_element_get_base_time(GST_ELEMENT(sink))));
    return taken ? GST_FLOW_OK : GST_FLOW_FLUSHING;
}

void on_end(GstAppSink* sink, gpointer owner) {
    StereoPipelineState& state = state_of(owner);
    state.feed->end(eye_of(state, sink));
}

/// Converters and decoders leave frames out when they are told that they are late. What sources lose shows in the
/// numbers of the frames, and what other sinks leave out is not ours.
void count_left_out(StereoPipelineState& state, GstMessage* message) {
    GstObject* const element = message->src;
    GstFormat format = GST_FORMAT_UNDEFINED;
    guint64 processed = 0;
    guint64 left_out = 0;
    gst_message_parse_qos_stats(message, &format, &processed, &left_out);
    if (element == nullptr || format != GST_FORMAT_BUFFERS || left_out == GST_CLOCK_TIME_NONE ||
        GST_OBJECT_FLAG_IS_SET(element, GST_ELEMENT_FLAG_SINK) != FALSE ||
        GST_OBJECT_FLAG_IS_SET(element, GST_ELEMENT_FLAG_SOURCE) != FALSE) {
        return;
    }
    const std::lock_guard lock(state.mutex);
    guint64& before = state.left_out[GST_OBJECT_NAME(element)];
    if (left_out > before) {
        state.feed->add_lost(left_out - before);
    }
    before = left_out;
}

std::string words_of(GstMessage* message, void (*take_apart)(GstMessage*, GError**, gchar**)) {
    GError* error = nullptr;
    gchar* debug = nullptr;
    take_apart(message, &error, &debug);
    const GstPtr<GError> owned(error);
    const GstPtr<gchar> owned_debug(debug);
    return error != nullptr ? gst_words(message, *error, debug) : std::string("no reason is given");
}

GstBusSyncReply on_message(GstBus*, GstMessage* message, gpointer owner) {
    StereoPipelineState& state = state_of(owner);
    try {
        switch (GST_MESSAGE_TYPE(message)) {
            case GST_MESSAGE_ERROR: state.feed->fail({words_of(message, gst_message_parse_error), false}); break;
            case GST_MESSAGE_EOS: state.feed->end(); break;
            case GST_MESSAGE_QOS: count_left_out(state, message); break;
            case GST_MESSAGE_WARNING: {
                const std::string words = words_of(message, gst_message_parse_warning);
                const std::lock_guard lock(state.mutex);
                state.warning = words;
                break;
            }
            default: break;
        }
    } catch (const std::exception&) {  // no memory for the words
        state.feed->end();
    }
    gst_message_unref(message);
    return GST_BUS_DROP;
}

bool is_stopping(StereoPipelineState& state) {
    const std::lock_guard lock(state.mutex);
    return state.stopping;
}

void begin_states(GstElement* pipeline, StereoPipelineState& state) {
    const std::lock_guard lock(state.states);
    for (const GstState wanted : {GST_STATE_PAUSED, GST_STATE_PLAYING}) {
        if (is_stopping(state)) {
            return;
        }
        switch (gst_element_set_state(pipeline, wanted)) {
            case GST_STATE_CHANGE_NO_PREROLL: state.feed->set_live(); break;
            case GST_STATE_CHANGE_FAILURE:
                state.feed->fail({"an element refuses to start and gives no reason", false});  // unless one did
                return;
            default: break;
        }
    }
}

void begin(GstElement* pipeline, gpointer owner) {
    StereoPipelineState& state = state_of(owner);
    begin_states(pipeline, state);
    const std::lock_guard lock(state.mutex);
    state.starting = false;
}

/// Ends the pipeline, and what it owns of the state.
void finish(GstElement* pipeline, gpointer owner) {
    StereoPipelineState& state = state_of(owner);
    const std::lock_guard lock(state.states);
    gst_element_set_state(pipeline, GST_STATE_NULL);
    GstAppSinkCallbacks none{};
    for (GstElement* const sink : state.sinks) {
        gst_app_sink_set_callbacks(GST_APP_SINK(sink), &none, nullptr, nullptr);
    }
    const GstPtr<GstBus> bus(gst_element_get_bus(pipeline));
    gst_bus_set_sync_handler(bus.get(), nullptr, nullptr, nullptr);
    const std::lock_guard stopped_lock(state.mutex);
    state.stopped = true;
    left_pipelines -= state.left ? 1 : 0;
    state.changed.notify_all();
}

}  // namespace

StereoPipeline::StereoPipeline(const std::string& text, std::size_t waiting)
    : state_(std::make_shared<StereoPipelineState>()) {
    if (left_pipelines >= most_left) {
        throw std::runtime_error("source gst: " + std::to_string(left_pipelines) +
                                 " pipelines that were ended hang still, and no other is made until one has ended: "
                                 "restart the program, or what its elements wait for");
    }
    forget_gst_warning();
    state_->pipeline = parse(text);
    state_->sinks = sinks_of(*state_->pipeline);
    bool all_stamp = false;
    state_->devices = devices_of(*state_->pipeline, all_stamp);
    for (GstElement* const sink : state_->sinks) {
        set_up_sink(*sink);
    }
    state_->feed = std::make_unique<GstFeed>(waiting, has_two_sinks());
    // Stamps of live pipelines are those of CLOCK_MONOTONIC, whatever clocks their elements have.
    const GstPtr<GstClock> clock(gst_system_clock_obtain());
    gst_pipeline_use_clock(GST_PIPELINE(state_->pipeline.get()), clock.get());
    GstAppSinkCallbacks calls{};
    calls.new_sample = on_sample;
    calls.eos = on_end;
    for (GstElement* const sink : state_->sinks) {
        gst_app_sink_set_callbacks(GST_APP_SINK(sink), &calls, new Owner(state_), disown);
    }
    const GstPtr<GstBus> bus(gst_element_get_bus(state_->pipeline.get()));
    gst_bus_set_sync_handler(bus.get(), on_message, new Owner(state_), disown);
}

StereoPipeline::~StereoPipeline() {
    stop();
}

bool StereoPipeline::has_two_sinks() const {
    return state_->sinks.size() == 2;
}

const std::string& StereoPipeline::devices() const {
    return state_->devices;
}

void StereoPipeline::start() {
    const base::SignalsBlocked inherited;
    started_ = true;
    state_->starting = true;  // nobody else has it yet
    gst_element_call_async(state_->pipeline.get(), begin, new Owner(state_), disown);
}

bool StereoPipeline::ask_live() {
    const GstPtr<GstQuery> query(gst_query_new_latency());
    if (gst_element_query(state_->pipeline.get(), query.get()) != FALSE) {
        gboolean live = FALSE;
        gst_query_parse_latency(query.get(), &live, nullptr, nullptr);
        if (live != FALSE) {
            feed().set_live();
        }
    }
    if (!feed().live()) {
        bool all_stamp = false;
        state_->devices = devices_of(*state_->pipeline, all_stamp);
        if (!state_->devices.empty() && all_stamp) {
            feed().set_live();
        }
    }
    return feed().live();
}

GstFeed& StereoPipeline::feed() {
    return *state_->feed;
}

GstProblem StereoPipeline::problem() const {
    GstProblem problem = *state_->feed->problem();
    if (problem.text.find("not-negotiated") != std::string::npos ||
        problem.text.find("not negotiated") != std::string::npos) {
        const bool right = has_two_sinks() && state_->feed->arrived(Eye::left) > 0;
        problem.text += offered_to(*state_->sinks[right ? 1 : 0]);
        problem.users = true;
    }
    return problem;
}

std::string StereoPipeline::warning() const {
    const std::lock_guard lock(state_->mutex);
    return state_->warning;
}

void StereoPipeline::stop() {
    {
        const std::lock_guard lock(state_->mutex);
        if (std::exchange(state_->stopping, true)) {
            return;
        }
    }
    state_->feed->close();
    auto* const owner = new Owner(state_);
    if (!started_) {
        finish(state_->pipeline.get(), owner);
        disown(owner);
        return;
    }
    const base::SignalsBlocked inherited;
    gst_element_call_async(state_->pipeline.get(), finish, owner, disown);
    std::unique_lock lock(state_->mutex);
    state_->left = !state_->changed.wait_for(lock, state_->starting ? longest_stop_of_a_start : longest_stop,
                                             [this] { return state_->stopped; });
    left_pipelines += state_->left ? 1 : 0;
}

}  // namespace disparityd::capture
